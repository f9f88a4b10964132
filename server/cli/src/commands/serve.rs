//! `skyglow serve`: the server.

use crate::{
    failure::Failure, folders, logging, partial_settings::PartialSettings, program, settings::Settings,
};
use clap::Args;
use skyglow_app::{SkySource, error::AppError, opening::LoadedEngine};
use skyglow_http::{HttpConfig, MemoryShares, Valkey, router_beside, serve};
use skyglow_scene::{ChangeLimits, SceneStore, SharedScenes};
use std::{future::Future, path::PathBuf, sync::Arc, time::Duration};
use tokio::{
    net::TcpListener,
    signal::unix::{SignalKind, signal},
};

/// Serve the API and the viewer
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow serve --listen 0.0.0.0:8080 --data /var/lib/skyglow")]
pub(crate) struct Serve {
    #[command(flatten)]
    flags: PartialSettings,
    /// TOML file of the same names
    #[arg(long, env = "SKYGLOW_CONFIG", value_name = "FILE")]
    config: Option<PathBuf>,
}

impl Serve {
    /// Runs until SIGTERM or SIGINT.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let settings = self.flags.over_file(self.config.as_deref())?;
        let _traces = match &settings.otlp_endpoint {
            Some(collector) => Some(logging::start_traced("info", collector)?),
            None => {
                logging::start("info");
                None
            }
        };
        // Threads for reading and computing: more of them than keep the cores busy only take memory.
        let cores = std::thread::available_parallelism().map_or(2, std::num::NonZero::get);
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .enable_all()
            .max_blocking_threads((8 * cores).clamp(16, 128))
            .build()
            .map_err(Failure::work)?;
        let result = runtime.block_on(run(settings));
        // A start that was interrupted may still be at work on a thread: it is not waited for.
        runtime.shutdown_background();
        result
    }
}

/// Every connection is a file: as many as the system lets a process have at most.
fn more_files() {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let Rlimit { maximum, .. } = getrlimit(Resource::Nofile);
    let _best_effort = setrlimit(Resource::Nofile, Rlimit { current: maximum, maximum });
}

async fn run(settings: Settings) -> Result<(), Failure> {
    let mut shutdown = std::pin::pin!(shutdown_signal()?);
    more_files();
    // The port comes first: a taken one shows at once.
    let address = settings.listen;
    let listener = TcpListener::bind(address)
        .await
        .map_err(|error| Failure::Work(format!("{address}: {error} (--listen HOST:PORT takes another)")))?;
    let access = settings.access()?;
    let is_shared = settings.store.is_some();
    let valkey = settings.valkey()?;
    let shelf = valkey.clone();
    let started = tokio::task::spawn_blocking(move || start(&settings, shelf));
    let (source, http) = tokio::select! {
        started = started => started.map_err(Failure::work)??,
        () = &mut shutdown => return Ok(()),
    };
    watch_scenes(&source);
    if is_shared {
        watch_store(&source, |source| source.refresh_kept(), "what is kept");
        watch_store(&source, |source| source.refresh_scenes(), "scenes");
    }
    let address = listener.local_addr().map_err(Failure::work)?;
    let facts = source.facts();
    for kind in &facts.kinds {
        let clouds =
            kind.cloud_base_m().map_or_else(String::new, |base_m| format!(" under clouds at {base_m} m"));
        tracing::info!(
            "packs with {} scattering{clouds}, turbidity {}",
            kind.scattering.name(),
            kind.turbidities()
        );
    }
    tracing::info!(executor = facts.executor, adapter = facts.adapter, "serving http://{address}");
    let (end, ended) = tokio::sync::oneshot::channel::<()>();
    let serving = serve(listener, router_beside(source, http.clone(), access, valkey), &http, async {
        // An error says that the sender is gone, which is an end as well.
        let _ = ended.await;
    });
    let mut serving = std::pin::pin!(serving);
    let result = tokio::select! {
        result = &mut serving => result,
        () = shutdown => {
            tracing::info!("ending: no more connections, answers under way finish");
            let _ = end.send(());
            serving.await
        }
    };
    result.map_err(Failure::work)
}

/// How often it is looked for scenes that came, changed, or were damaged and are whole again.
const LOOK_FOR_DAMAGE_EVERY: Duration = Duration::from_secs(60);

/// Reads every scene through, on a thread of its own, to find those that are damaged before somebody asks for them.
fn watch_scenes(source: &Arc<dyn SkySource>) {
    let source = Arc::downgrade(source);
    std::thread::spawn(move || {
        while let Some(source) = source.upgrade() {
            if let Err(error) = source.check_scenes() {
                tracing::warn!(%error, "the scenes cannot be looked through");
            }
            drop(source);
            std::thread::sleep(LOOK_FOR_DAMAGE_EVERY);
        }
    });
}

/// How often it is looked for what other servers kept or removed: longest after that it is gone here too.
const LOOK_FOR_OTHERS_EVERY: Duration = Duration::from_secs(5);

/// Compares what is here with the store that servers share, on a thread of its own.
///
/// * `what`: is compared, for the log.
fn watch_store(
    source: &Arc<dyn SkySource>,
    refresh: fn(&dyn SkySource) -> Result<(), AppError>,
    what: &'static str,
) {
    let source = Arc::downgrade(source);
    std::thread::spawn(move || {
        let mut was_away = false;
        while let Some(source) = source.upgrade() {
            let refreshed = refresh(&*source);
            drop(source);
            let is_away = refreshed.as_ref().is_err_and(|error| !matches!(error, AppError::Busy { .. }));
            match refreshed {
                // Once, and not every five seconds.
                Err(AppError::StoreAway { reason }) if !was_away => {
                    tracing::error!(%reason, "the store of {what} is away: what has no copy here is answered 503");
                }
                Err(error) if is_away && !was_away => {
                    tracing::error!(%error, "{what} cannot be looked through")
                }
                Ok(()) if was_away => tracing::info!("the store of {what} is back"),
                _ => {}
            }
            was_away = is_away;
            std::thread::sleep(LOOK_FOR_OTHERS_EVERY);
        }
    });
}

/// The program behind the interface, and the interface's limits as the memory allows.
///
/// * `shelf`: where drafts are shared.
fn start(
    settings: &Settings,
    shelf: Option<Arc<Valkey>>,
) -> Result<(Arc<dyn SkySource>, HttpConfig), Failure> {
    // Before the minute that a demo takes, not after it.
    folders::packs_of(&settings.packs)?;
    let cleared = SceneStore::new(&settings.data).clear_stale();
    if cleared > 0 {
        tracing::info!("{cleared} folder(s) of ingests that were killed are cleared");
    }
    // What fails at once comes before what takes long.
    std::fs::create_dir_all(&settings.data).map_err(|error| Failure::file(&settings.data, error))?;
    if settings.operator_token_file.is_some() {
        check_sandbox(settings.upload_sandbox_required)?;
    }
    let most_bytes = MemoryShares::most_for_packs();
    let loaded = LoadedEngine::start(&settings.packs, settings.device.into(), Some(most_bytes))
        .map_err(Failure::work)?;
    if !settings.no_demo {
        program::make_demo_if_missing(&settings.data)?;
    }
    let packs_bytes = loaded.main_memory_bytes();
    let shares = MemoryShares::of_machine(packs_bytes, settings.brightness_map_bytes(), &settings.http);
    let shares = shares.map_err(Failure::work)?;
    tracing::info!("{shares}");
    let limits = ChangeLimits { draft_bytes: shares.drafts_bytes, ..settings.change_limits() };
    let max_places = settings.brightness_places.max(1);
    let required = settings.upload_sandbox_required;
    let sizes = &shares.observatory;
    let store = settings.kept_store()?;
    let shared = store.clone().map(|store| SharedScenes::new(store));
    let mut changes = settings.changes(store, limits)?;
    if let Some(shelf) = shelf {
        changes = changes.with_shelf(shelf);
    }
    let source = program::open(loaded, &settings.data, changes, shared, sizes, max_places, required);
    if settings.store.is_some() {
        // Ready is who has the scenes of all.
        if let Err(error) = source.refresh_scenes() {
            tracing::error!(%error, "not all scenes of the store can be copied");
        }
    }
    Ok((source, shares.put_into(settings.http.clone())))
}

/// Says once whether uploads are read behind walls.
fn check_sandbox(is_required: bool) -> Result<(), Failure> {
    match skyglow_app::sandbox::probe() {
        Ok(()) => tracing::info!("uploads are read in a sandbox (Landlock and seccomp)"),
        Err(lacking) if is_required => {
            return Err(Failure::Work(format!(
                "upload_sandbox_required is set, and there is none here: {lacking}"
            )));
        }
        Err(lacking) => tracing::warn!(
            "uploads are read without the whole sandbox ({lacking}): files that refer to others are refused all the same; \
             upload_sandbox_required = true refuses uploads here"
        ),
    }
    Ok(())
}

/// Ready at the first SIGTERM or SIGINT.
fn shutdown_signal() -> Result<impl Future<Output = ()>, Failure> {
    let mut terminate = signal(SignalKind::terminate()).map_err(Failure::work)?;
    let mut interrupt = signal(SignalKind::interrupt()).map_err(Failure::work)?;
    Ok(async move {
        tokio::select! {
            _ = terminate.recv() => (),
            _ = interrupt.recv() => (),
        }
    })
}
