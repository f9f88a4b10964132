//! Engines before the scenes of a folder, with uploads read by a process of their own.

use crate::{
    failure::Failure,
    progress::{self, Stages},
};
use skyglow_app::{SkySource, UploadReader, opening::LoadedEngine, sandbox, upload_reader::UploadTask};
use skyglow_observatory::CacheSizes;
use skyglow_scene::{ChangeStore, SceneStore, SharedScenes, create_demo, demo_is_wanted};
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    sync::Arc,
    time::Duration,
};

/// An engine before the scenes of a folder.
///
/// * `changes`: where scenarios and plans are kept.
/// * `shared`: the scenes that servers share.
/// * `sizes`: what is kept in memory.
/// * `max_places`: of a map of the zenith's brightness.
/// * `sandbox_required`: whether no upload is read where the kernel lacks a part of the sandbox.
pub(crate) fn open(
    loaded: LoadedEngine,
    data: &Path,
    changes: ChangeStore,
    shared: Option<SharedScenes>,
    sizes: &CacheSizes,
    max_places: usize,
    sandbox_required: bool,
) -> Arc<dyn SkySource> {
    let source = loaded.before_kept(data, changes, shared, sizes, max_places);
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
