//! Staging folders beside the scenes while an ingest writes. Each is locked by its process while it is in use, so
//! that what a killed process left behind can be recognized and cleared.

use crate::error::SceneError;
use crate::scene_files::METADATA_FILE;
use crate::scene_id::SceneId;
use std::fs::{File, Permissions};
use std::io::ErrorKind;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// What others may do with the folder of a scene: nothing, and its group may read.
const FOLDER_MODE: u32 = 0o750;
/// Start of the names of these folders: no scene's id starts with a dot.
const PREFIX: &str = ".ingest-";
/// End of the name of a scene that is set aside for its successor.
const ASIDE: &str = "old";

/// A folder for one ingest; removed when it is dropped before it was moved to its place.
#[derive(Debug)]
pub(crate) struct Staging {
    folder: TempDir,
    lock: File,
}

impl Staging {
    /// A new folder below `parent`, in use.
    pub(crate) fn below(parent: &Path) -> Result<Self, SceneError> {
        loop {
            let folder = tempfile::Builder::new()
                .prefix(PREFIX)
                .permissions(Permissions::from_mode(FOLDER_MODE))
                .tempdir_in(parent)
                .map_err(SceneError::io(parent))?;
            let lock = locked(folder.path())?;
            // Another process may have taken it for a stale one before it was locked.
            if folder.path().is_dir() {
                return Ok(Self { folder, lock });
            }
        }
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Renames the folder to `target`. An older scene there changes places with it and is removed after, so that there is a scene
    /// all the while; where the file system cannot do that, the older one is set aside first.
    pub(crate) fn move_to(self, target: &Path, id: &SceneId, replace: bool) -> Result<(), SceneError> {
        let moved = self.put(self.path(), target, id, replace);
        if !self.path().exists() {
            // It is a scene now, nothing to remove.
            let _moved_away = self.folder.keep();
        }
        drop(self.lock);
        moved
    }

    /// The same with a folder within this one, or this one itself.
    pub(crate) fn put(
        &self,
        folder: &Path,
        target: &Path,
        id: &SceneId,
        replace: bool,
    ) -> Result<(), SceneError> {
        if replace && exchanged(folder, target) {
            // The older scene lies where the newer was written, and goes with that folder.
            return Ok(());
        }
        let aside = self.path().with_extension(ASIDE);
        let older = if target.exists() {
            if !replace {
                return Err(SceneError::SceneExists { id: id.to_string() });
            }
            let lock = locked(target)?;
            std::fs::rename(target, &aside).map_err(SceneError::io(target))?;
            Some(lock)
        } else {
            None
        };
        if let Err(error) = std::fs::rename(folder, target) {
            if older.is_some() {
                // Without its successor the older scene stays.
                let _best_effort = std::fs::rename(&aside, target);
            }
            return Err(SceneError::io(target)(error));
        }
        if older.is_some() {
            std::fs::remove_dir_all(&aside).map_err(SceneError::io(&aside))?;
        }
        drop(older);
        Ok(())
    }
}

/// Lets two folders change places; false where one is missing or the file system cannot.
#[cfg(target_os = "linux")]
fn exchanged(one: &Path, other: &Path) -> bool {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE).is_ok()
}

/// Elsewhere folders are renamed one after another.
#[cfg(not(target_os = "linux"))]
fn exchanged(_one: &Path, _other: &Path) -> bool {
    false
}

/// Removes a scene's folder by one rename, so that it is complete or absent, and then its files.
pub(crate) fn remove(folder: &Path, parent: &Path) -> Result<(), SceneError> {
    let staging = Staging::below(parent)?;
    // Inside a folder of its own: what a kill leaves there is no scene set aside, and is not put back.
    std::fs::rename(folder, staging.path().join("removed")).map_err(|error| match error.kind() {
        // Somebody else was faster.
        ErrorKind::NotFound => {
            let id = folder.file_name().map(|name| name.to_string_lossy().into_owned());
            SceneError::UnknownScene { id: id.unwrap_or_default() }
        }
        _ => SceneError::io(folder)(error),
    })
}

/// A folder, in use until the answer is dropped. Where the file system has no locks none is cleared either.
fn locked(folder: &Path) -> Result<File, SceneError> {
    let lock = File::open(folder).map_err(SceneError::io(folder))?;
    let _best_effort = lock.lock();
    Ok(lock)
}

/// Removes the folders of ingests that no longer run, and puts a scene that was set aside back where its
/// successor never came. What cannot be removed stays for the next time. Returns how many were removed.
pub(crate) fn clear_stale(parent: &Path) -> usize {
    let Ok(entries) = std::fs::read_dir(parent) else { return 0 };
    let stale = |path: &PathBuf| path.file_name().is_some_and(|n| n.to_string_lossy().starts_with(PREFIX));
    entries.flatten().map(|entry| entry.path()).filter(stale).filter(|path| clear(path, parent)).count()
}

fn clear(folder: &Path, parent: &Path) -> bool {
    let Ok(lock) = File::open(folder) else { return false };
    if lock.try_lock().is_err() {
        return false;
    }
    let home =
        folder.extension().is_some_and(|extension| extension == ASIDE).then(|| home_of(folder, parent));
    match home.flatten().filter(|home| !home.exists()) {
        Some(home) => std::fs::rename(folder, home).is_ok(),
        None => std::fs::remove_dir_all(folder).is_ok(),
    }
}

/// Where a scene that was set aside belongs.
fn home_of(folder: &Path, parent: &Path) -> Option<PathBuf> {
    let text = std::fs::read(folder.join(METADATA_FILE)).ok()?;
    let stored: serde_json::Value = serde_json::from_slice(&text).ok()?;
    let id = SceneId::parse(stored.pointer("/metadata/id")?.as_str()?).ok()?;
    Some(parent.join(id.as_str()))
}
