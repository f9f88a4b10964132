//! The process that reads uploads, from outside: what lies beyond the upload's folder is not there for it.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what cannot be set up fails the test")]

mod common;

use common::{
    command,
    geotiff::{Crs, town, write_radiance},
};
use skyglow_app::upload_reader::{UploadOutcome, UploadTask};
use skyglow_scene::{IngestOptions, SceneId, SceneStore};
use std::{
    io::Write,
    path::{Path, PathBuf},
    process::Stdio,
};

/// Set where the kernel has no Landlock and the tests are to pass without it.
const WITHOUT: &str = "SKYGLOW_TEST_WITHOUT_LANDLOCK";

fn read(
    folder: &Path,
    raster: PathBuf,
    memory_bytes: u64,
    arguments: &[&str],
) -> (Option<UploadOutcome>, String) {
    let mut options = IngestOptions::new(raster);
    options.id = Some(SceneId::parse("town").unwrap());
    options.max_pixels = Some(1 << 24);
    let task = UploadTask { folder: folder.to_owned(), data: folder.join("made"), memory_bytes, options };
    let mut child = command()
        .arg("--read-upload")
        .args(arguments)
        .env("TMPDIR", folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(&serde_json::to_vec(&task).unwrap()).unwrap();
    let output = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    (serde_json::from_slice(&output.stdout).ok(), told)
}

/// A raster outside of the upload's folder cannot be opened, though it could be before; inside, all that a scene needs is there:
/// libraries, the data of PROJ, threads, room to unpack. The control is the same raster.
#[test]
fn a_reader_sees_its_folder_alone() {
    let (inside, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let raster = outside.path().join("light.tif");
    write_radiance(&raster, Crs::Geographic, &town());
    std::fs::copy(&raster, inside.path().join("light.tif")).unwrap();
    let many = 1 << 34;
    let (outcome, told) = read(inside.path(), inside.path().join("light.tif"), many, &[]);
    assert!(matches!(outcome, Some(UploadOutcome::Done { .. })), "{outcome:?} {told}");
    let made = SceneStore::new(inside.path().join("made"));
    assert!(made.open(&SceneId::parse("town").unwrap()).is_ok());
    if std::env::var_os(WITHOUT).is_some() {
        return;
    }
    std::fs::remove_dir_all(inside.path().join("made")).unwrap();
    for arguments in [&[][..], &["--sandbox-required"]] {
        let (outcome, told) = read(inside.path(), raster.clone(), many, arguments);
        let Some(UploadOutcome::Storage(reason) | UploadOutcome::Refused(reason)) = outcome else {
            panic!("{outcome:?} {told}")
        };
        assert!(reason.contains("ermission denied"), "{reason}; {WITHOUT}=1 leaves this out");
    }
}

/// A reader is told how much memory it may take, and refuses what needs more before it begins.
#[test]
fn a_reader_keeps_to_its_memory() {
    let folder = tempfile::tempdir().unwrap();
    let raster = folder.path().join("light.tif");
    write_radiance(&raster, Crs::Geographic, &town());
    let (outcome, told) = read(folder.path(), raster, 1 << 20, &[]);
    let Some(UploadOutcome::Refused(reason)) = outcome else { panic!("{outcome:?} {told}") };
    assert!(reason.contains("lit pixels needs") && reason.contains("are free"), "{reason}");
}
