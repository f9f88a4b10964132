//! Scenes, packs and engine put together.

use crate::{
    device::Device,
    failure::Failure,
    progress::{self, Stages},
};
use skyglow_app::{SkySource, UploadReader, sandbox, upload_reader::UploadTask};
use skyglow_observatory::{CacheSizes, OPEN_SCENE_COUNT, Observatory};
use skyglow_render::{
    Engine, EngineConfig, LeftOutPack, UndamagedTables,
    celestial::{CelestialTables, tables::MAX_KEPT_BYTES},
    resident_tables, undamaged_tables,
};
use skyglow_scene::{ChangeLimits, SceneStore, create_demo, demo_is_wanted};
use skyglow_tables::{Manifest, packs_in};
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    sync::Arc,
    time::Duration,
};

/// An engine with its packs.
pub(crate) struct LoadedEngine {
    engine: Engine,
    manifests: Vec<Manifest>,
    left_out: Vec<LeftOutPack>,
    celestial: Option<CelestialTables>,
}

impl LoadedEngine {
    /// Bytes of main memory that packs and celestial tables take, with what is kept of them.
    pub(crate) fn main_memory_bytes(&self) -> u64 {
        let celestial = if self.celestial.is_some() { MAX_KEPT_BYTES as u64 } else { 0 };
        self.engine.main_memory_bytes() + celestial
    }
}

/// The celestial tables beside packs. Skies without a time need none, so one that is refused is only logged.
fn celestial_tables(packs: &Path) -> Option<CelestialTables> {
    CelestialTables::open(packs).unwrap_or_else(|error| {
        tracing::warn!("no sky of a time is served: {error}");
        None
    })
}

/// An engine over the packs of a folder.
///
/// * `within_bytes`: of memory that packs may take, for a server, which does without those that are damaged; None refuses them.
///
/// # Errors
/// [`Failure::Work`] where there are no packs, one is refused, they do not fit, or there is no such device.
pub(crate) fn start_engine(
    packs: &Path,
    device: Device,
    within_bytes: Option<u64>,
) -> Result<LoadedEngine, Failure> {
    let paths = packs_in(packs).map_err(Failure::work)?;
    if paths.is_empty() {
        return Err(Failure::Work(format!(
            "no table packs in {}: `skyglow precompute` makes them",
            packs.display()
        )));
    }
    let found = match within_bytes {
        Some(most_bytes) => undamaged_tables(&paths, most_bytes),
        None => resident_tables(&paths).map(|(tables, manifests)| UndamagedTables {
            tables,
            manifests,
            left_out: Vec::new(),
        }),
    };
    let UndamagedTables { tables, manifests, left_out } = found.map_err(Failure::work)?;
    for pack in &left_out {
        tracing::warn!(pack = pack.name, "a damaged pack is left out: {}", pack.reason);
    }
    let config = EngineConfig { device: device.into(), tables, ..EngineConfig::default() };
    let engine = Engine::start(config).map_err(Failure::work)?;
    Ok(LoadedEngine { engine, manifests, left_out, celestial: celestial_tables(packs) })
}

/// An engine before the scenes of a folder.
///
/// * `limits`: what is kept of scenarios and plans.
/// * `sizes`: what is kept in memory.
/// * `max_places`: of a map of the zenith's brightness.
/// * `sandbox_required`: whether no upload is read where the kernel lacks a part of the sandbox.
pub(crate) fn open(
    loaded: LoadedEngine,
    data: &Path,
    limits: ChangeLimits,
    sizes: &CacheSizes,
    max_places: usize,
    sandbox_required: bool,
) -> Arc<dyn SkySource> {
    let LoadedEngine { engine, manifests, left_out, celestial } = loaded;
    let mut observatory = Observatory::with_limits(engine, manifests, data, OPEN_SCENE_COUNT, limits, sizes);
    if let Some(tables) = celestial {
        observatory = observatory.with_celestial_tables(tables);
    }
    if !limits.is_none() {
        let changes = observatory.changes().clone();
        std::thread::spawn(move || skyglow_app::stored::read_index(&changes));
    }
    let source = skyglow_app::ObservatorySource::new(Arc::new(observatory));
    let source = source.with_max_places(max_places).without_packs(&left_out);
    // The program that runs, also where its file was replaced meanwhile.
    let program = PathBuf::from("/proc/self/exe");
    if !program.exists() {
        return Arc::new(source);
    }
    let mut arguments = vec![READ_UPLOAD.to_owned()];
    if sandbox_required {
        arguments.push(SANDBOX_REQUIRED.to_owned());
    }
    let reader = UploadReader { program, arguments, longest: MAX_UPLOAD_TIME };
    Arc::new(source.with_upload_reader(reader))
}

/// The argument that makes this program a reader of uploads. No command: nobody but the server calls it.
pub(crate) const READ_UPLOAD: &str = "--read-upload";
/// With this it reads none where the kernel lacks a part of the sandbox.
const SANDBOX_REQUIRED: &str = "--sandbox-required";
/// Longest time that an upload may take to be read.
const MAX_UPLOAD_TIME: Duration = Duration::from_secs(1800);

/// Reads an upload for the server, and ends with it.
pub(crate) fn read_upload() -> ExitCode {
    use rustix::process::{Signal, set_parent_process_death_signal};
    // Where memory runs out, this goes and not the server. Where the system has neither, the reading is what it was before.
    let _best_effort = std::fs::write("/proc/self/oom_score_adj", "1000");
    let _best_effort = set_parent_process_death_signal(Some(Signal::KILL));
    let is_required = std::env::args().nth(2).is_some_and(|argument| argument == SANDBOX_REQUIRED);
    let prepare = |task: &UploadTask| {
        sandbox::limit_memory(task.memory_bytes);
        match sandbox::raise(&task.folder) {
            Err(lacking) if is_required => {
                Err(format!("uploads are read in a sandbox alone here: {lacking}"))
            }
            _ => Ok(()),
        }
    };
    match skyglow_app::read_upload(std::io::stdin().lock(), std::io::stdout().lock(), prepare) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("skyglow: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Makes the demo scene where there is none, or one of an older program.
///
/// # Errors
/// [`Failure::Work`] where the data folder cannot be written.
pub(crate) fn make_demo_if_missing(data: &Path) -> Result<(), Failure> {
    let store = SceneStore::new(data);
    if !demo_is_wanted(&store) {
        return Ok(());
    }
    tracing::info!("making the demo scene in {}", store.scenes_dir().display());
    let stages = Stages::new();
    create_demo(&store, &mut progress::of_ingest(&stages)).map_err(Failure::work)?;
    Ok(())
}
