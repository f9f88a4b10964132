//! Uploads are read by a process of their own: rasters go through libraries of other people's, and one that breaks off over a file
//! takes no server along.

use crate::error::AppError;
use crate::sandbox;
use serde::{Deserialize, Serialize};
use skyglow_scene::{IngestOptions, SceneError, SceneId, SceneStore, ingest};
use std::{
    io::{Read, Write},
    os::unix::process::{CommandExt, ExitStatusExt},
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    time::{Duration, Instant},
};

/// What a reader is to read, as JSON on its standard input.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct UploadTask {
    /// The upload's folder: the only one that a reader may write in.
    pub folder: PathBuf,
    /// The folder in it that the scene is made in, as of [`SceneStore::new`].
    pub data: PathBuf,
    /// Bytes of memory that the reading may take.
    pub memory_bytes: u64,
    /// The files, and what is said of them.
    pub options: IngestOptions,
}

/// What came of it, as JSON on its standard output.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum UploadOutcome {
    /// There is a scene of it.
    Done {
        /// The scene.
        id: SceneId,
    },
    /// It cannot be meant: why, in one sentence.
    Refused(String),
    /// Nothing can be stored: why, in one sentence.
    Storage(String),
}

impl UploadTask {
    /// Reads it, in this process.
    pub fn run(&self) -> UploadOutcome {
        let options = IngestOptions { memory_bytes: Some(self.memory_bytes), ..self.options.clone() };
        match ingest(&SceneStore::new(&self.data), &options, &mut |_| {}) {
            Ok(metadata) => UploadOutcome::Done { id: metadata.id },
            Err(error) => refused(error, &self.options),
        }
    }

    /// Reads it by a program that runs [`read_upload`].
    ///
    /// # Errors
    /// [`AppError::BadUpload`] where the program breaks off, [`AppError::Storage`] where it cannot be started or is ended.
    pub fn run_by(&self, reader: &UploadReader) -> Result<UploadOutcome, AppError> {
        let no_reader =
            |error: std::io::Error| storage(format!("no process can be started that reads uploads: {error}"));
        let task = serde_json::to_vec(self).map_err(AppError::internal)?;
        let mut child = Command::new(&reader.program)
            .args(&reader.arguments)
            .env_clear()
            .envs(sandbox::environment(&self.folder))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            // What a terminal sends to the server is not for it: it ends with its parent.
            .process_group(0)
            .spawn()
            .map_err(no_reader)?;
        if let Some(mut input) = child.stdin.take() {
            // One that has ended already says below why.
            let _ = input.write_all(&task);
        }
        let said = read_beside(child.stdout.take());
        let warned = read_beside(child.stderr.take());
        let status = wait(&mut child, reader.longest).map_err(no_reader)?;
        for line in String::from_utf8_lossy(&warned.join().unwrap_or_default()).lines() {
            tracing::warn!("reading an upload: {line}");
        }
        if let Ok(outcome) = serde_json::from_slice(&said.join().unwrap_or_default()) {
            return Ok(outcome);
        }
        let end = match status.signal() {
            Some(signal) => format!("signal {signal}"),
            None => status.to_string(),
        };
        tracing::warn!("the process that read an upload broke off: {end}");
        Err(match status.signal() {
            Some(signal) if FAULTS.contains(&signal) => AppError::BadUpload {
                reason: format!(
                    "one of the files breaks the libraries that read rasters off, or takes more memory than there is ({end})"
                ),
            },
            _ => storage(format!("the process that read the upload was ended ({end}); try again")),
        })
    }
}

fn storage(reason: String) -> AppError {
    AppError::Storage { reason }
}

/// Reads what a process says, as far as it is believed to have something to say.
fn read_beside(output: Option<impl Read + Send + 'static>) -> std::thread::JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut said = Vec::new();
        // What was cut off is no outcome.
        let _ = output.map(|output| output.take(MAX_SAID_BYTES).read_to_end(&mut said));
        said
    })
}

/// Waits for the end of a process, and ends it where that takes too long, and then whatever it started.
fn wait(child: &mut Child, longest: Duration) -> std::io::Result<ExitStatus> {
    let group = rustix::process::Pid::from_raw(child.id().cast_signed());
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if begun.elapsed() > longest {
            tracing::warn!("the process that reads an upload takes longer than {longest:?}: it is ended");
            child.kill()?;
            break child.wait()?;
        }
        std::thread::sleep(LOOK_EVERY);
    };
    // Mostly there is nobody left.
    let _ = group.map(|group| rustix::process::kill_process_group(group, rustix::process::Signal::KILL));
    Ok(status)
}

/// Bytes that are read of what a reader says and of what it warns of.
const MAX_SAID_BYTES: u64 = 1 << 20;

/// Signals of a process that broke off by itself: illegal instruction, abort, bus error, arithmetic, segmentation.
const FAULTS: [i32; 5] = [4, 6, 7, 8, 11];
/// How often it is looked whether a reader has ended.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// The program that reads uploads, with its arguments.
#[derive(Clone, Debug)]
pub struct UploadReader {
    /// The program.
    pub program: PathBuf,
    /// What it is called with.
    pub arguments: Vec<String>,
    /// After this it is ended.
    pub longest: Duration,
}

/// Reads a task from `input`, does it and writes what came of it: what the program of an [`UploadReader`] does.
///
/// * `prepare`: called before any file is read; what it says is the outcome where it fails.
///
/// # Errors
/// Whatever input and output say.
pub fn read_upload(
    mut input: impl Read,
    mut output: impl Write,
    prepare: impl FnOnce(&UploadTask) -> Result<(), String>,
) -> std::io::Result<()> {
    let mut text = Vec::new();
    input.read_to_end(&mut text)?;
    let task: UploadTask = serde_json::from_slice(&text)?;
    let outcome = prepare(&task).map_or_else(UploadOutcome::Storage, |()| task.run());
    serde_json::to_writer(&mut output, &outcome)?;
    output.flush()
}

/// Why an upload is refused: files by the names of their fields, for nobody outside knows the server's folders.
fn refused(error: SceneError, options: &IngestOptions) -> UploadOutcome {
    let field = |path: &Path| {
        let name = || path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let has = |list: &[PathBuf]| list.iter().any(|own| own == path);
        if options.radiance.len() == 1
            && !has(&options.terrain)
            && Some(path) != options.places.as_deref()
            && !has(&options.masks)
            && !has(&options.quality_files)
            && !has(&options.observation_files)
        {
            // Also what it was unpacked to.
            "radiance".to_owned()
        } else if Some(path) == options.places.as_deref() {
            "places".to_owned()
        } else if has(&options.terrain) {
            format!("terrain \"{}\"", name())
        } else if has(&options.masks) {
            format!("mask \"{}\"", name())
        } else if has(&options.quality_files) {
            format!("quality_file \"{}\"", name())
        } else if has(&options.observation_files) {
            format!("observations_file \"{}\"", name())
        } else {
            format!("radiance \"{}\"", name())
        }
    };
    // The library that reads rasters names files with their folders, and what reads them speaks of a command's options.
    let folder = options
        .radiance
        .first()
        .and_then(|path| path.ancestors().nth(2))
        .map(|folder| format!("{}/", folder.display()));
    let for_upload = |reason: &str| {
        let reason = match &folder {
            Some(folder) if folder.len() > 1 => reason.replace(folder, ""),
            _ => reason.to_owned(),
        };
        reason.replace("their --", "--").replace(" --", " the field ")
    };
    match &error {
        SceneError::Unreadable { path, reason } => {
            let reason = for_upload(reason);
            UploadOutcome::Refused(format!("{} cannot be read as a raster: {reason}", field(path)))
        }
        SceneError::Refused { path, reason } => {
            UploadOutcome::Refused(format!("{}: {}", field(path), for_upload(reason)))
        }
        SceneError::InvalidOption { option, reason } => {
            UploadOutcome::Refused(format!("{}: {reason}", option.trim_start_matches('-').replace('-', "_")))
        }
        SceneError::InvalidId { .. } => UploadOutcome::Refused(error.to_string()),
        _ => UploadOutcome::Storage(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(folder: &Path) -> UploadTask {
        let mut options = IngestOptions::new(folder.join("radiance"));
        options.id = Some(SceneId::parse("town").unwrap());
        UploadTask { folder: folder.to_owned(), data: folder.join("made"), memory_bytes: u64::MAX, options }
    }

    fn shell(script: &str) -> UploadReader {
        let arguments = vec!["-c".to_owned(), script.to_owned()];
        UploadReader { program: "/bin/sh".into(), arguments, longest: Duration::from_millis(500) }
    }

    /// A reader that breaks off is a refusal and one that is ended is not.
    #[test]
    fn only_a_reader_that_breaks_off_is_a_refusal() {
        let folder = tempfile::tempdir().unwrap();
        let task = task(folder.path());
        for signal in ["SEGV", "ABRT"] {
            let refused = task.run_by(&shell(&format!("kill -{signal} $$"))).unwrap_err();
            let AppError::BadUpload { reason } = refused else { panic!("{refused:?}") };
            assert!(reason.contains("signal"), "{reason}");
        }
        // Ended by somebody, with nothing to say, or by the clock.
        for (script, said) in [
            ("kill -TERM $$", "signal 15"),
            ("exit 3", "status: 3"),
            ("echo no", "status: 0"),
            ("exec sleep 60", "signal 9"),
        ] {
            let ended = task.run_by(&shell(script)).unwrap_err();
            let AppError::Storage { reason } = ended else { panic!("{script}: {ended:?}") };
            assert!(reason.contains(said), "{script}: {reason}");
        }
        let none = UploadReader { program: folder.path().join("none"), ..shell("") };
        assert!(matches!(task.run_by(&none), Err(AppError::Storage { .. })));
    }

    /// What a reader started ends with it, and what it says is not read without end.
    #[test]
    fn a_reader_leaves_nobody_and_says_little() {
        let folder = tempfile::tempdir().unwrap();
        let task = task(folder.path());
        let begun = Instant::now();
        for script in ["sleep 60 & exit 3", "yes", "yes >&2"] {
            assert!(matches!(task.run_by(&shell(script)), Err(AppError::Storage { .. })), "{script}");
        }
        assert!(begun.elapsed() < Duration::from_secs(30));
    }

    #[test]
    fn what_a_reader_says_comes_through() {
        let folder = tempfile::tempdir().unwrap();
        let task = task(folder.path());
        std::fs::write(&task.options.radiance[0], "no raster").unwrap();
        let mut said = Vec::new();
        read_upload(&*serde_json::to_vec(&task).unwrap(), &mut said, |_| Ok(())).unwrap();
        let UploadOutcome::Refused(reason) = serde_json::from_slice(&said).unwrap() else { panic!("taken") };
        assert!(reason.starts_with("radiance cannot be read as a raster"), "{reason}");
        said.clear();
        let lacking = |_: &UploadTask| Err("no sandbox".to_owned());
        read_upload(&*serde_json::to_vec(&task).unwrap(), &mut said, lacking).unwrap();
        assert!(matches!(serde_json::from_slice(&said).unwrap(), UploadOutcome::Storage(_)));
    }

    /// A refused upload speaks of fields and of no folder.
    #[test]
    fn a_refused_upload_names_fields_and_no_folder() {
        let options = IngestOptions::new("/srv/data/incoming/7/radiance");
        let reason =
            "/srv/data/incoming/radiance has 8-bit numbers; give their --scale, or choose with --band: a, b";
        let error = SceneError::Refused { path: options.radiance[0].clone(), reason: reason.to_owned() };
        let UploadOutcome::Refused(said) = refused(error, &options) else { panic!("another kind") };
        assert_eq!(
            said,
            "radiance: radiance has 8-bit numbers; give the field scale, or choose with the field band: a, b"
        );
    }
}
