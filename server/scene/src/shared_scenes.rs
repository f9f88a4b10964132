//! Scenes that several servers share: an object store is the truth, and each server's folder holds copies of its own.
//!
//! `scenes/ID.json` is the `metadata.json` of a scene, and `scene-files/ID/VERSION/FILE` the files that it names. A scene is there
//! when its metadata are, which are written last and removed first. What a server copied is named, with its version, in
//! `.shared.json` beside its scenes: what has gone from the store goes from there too, and scenes of its own stay.

use crate::changes::{DocumentStore, StoreAway};
use crate::error::SceneError;
use crate::scene_files::{METADATA_FILE, StoredScene};
use crate::scene_id::SceneId;
use crate::store::SceneStore;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

/// Folder of what says which scenes there are.
const SCENES: &str = "scenes";
/// Folder of their files.
const FILES: &str = "scene-files";
/// What of a server's folder are copies.
const COPIES_FILE: &str = ".shared.json";

/// The scenes of an object store.
#[derive(Debug)]
pub struct SharedScenes {
    store: Arc<dyn DocumentStore>,
    /// When the metadata of the scenes were written that are copied already; held while copies are made.
    seen: Mutex<BTreeMap<String, SystemTime>>,
}

impl SharedScenes {
    /// Of a store.
    pub fn new(store: Arc<dyn DocumentStore>) -> Self {
        Self { store, seen: Mutex::default() }
    }

    /// Puts a scene of a folder into the store, over the one of that id.
    ///
    /// # Errors
    /// [`SceneError::StoreAway`], and as [`SceneStore::list`] of the scene.
    pub fn put(&self, local: &SceneStore, id: &SceneId) -> Result<(), SceneError> {
        let _nobody_copies = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let stored = local.read_metadata(id)?;
        let folder = local.scene_dir(id);
        for file in &stored.files {
            self.store.upload(&object(id, &stored, &file.name), &folder.join(&file.name))?;
        }
        let before = self.metadata(id)?;
        let metadata = std::fs::read(folder.join(METADATA_FILE));
        self.store.put(&described(id), &metadata.map_err(SceneError::io(folder.join(METADATA_FILE)))?)?;
        // It is a copy from now on: somebody may remove it before it is looked for.
        let copies_file = local.scenes_dir().join(COPIES_FILE);
        let mut copies = copies(&copies_file);
        copies.insert(id.to_string(), stored.metadata.version.clone());
        write_copies(&copies_file, &copies)?;
        // Who is copying the one before finds the new one next time.
        match before.filter(|before| before.metadata.version != stored.metadata.version) {
            Some(before) => self.remove_files(id, &before),
            None => Ok(()),
        }
    }

    /// Removes a scene from the store, if it is there.
    ///
    /// # Errors
    /// [`SceneError::StoreAway`].
    pub fn remove(&self, id: &SceneId) -> Result<(), SceneError> {
        let Some(stored) = self.metadata(id)? else { return Ok(()) };
        self.store.remove(&described(id))?;
        self.remove_files(id, &stored)
    }

    /// Copies what is new or other in the store, and removes copies of what is there no more. The scenes that changed; what went wrong
    /// with others does not keep these.
    ///
    /// # Errors
    /// [`SceneError::StoreAway`], [`SceneError::Io`] where the list of copies cannot be written.
    pub fn refresh(&self, local: &SceneStore) -> Result<(Vec<SceneId>, Vec<SceneError>), SceneError> {
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let copies_file = local.scenes_dir().join(COPIES_FILE);
        let before = copies(&copies_file);
        let (mut after, mut changed, mut failed) = (before.clone(), Vec::new(), Vec::new());
        let mut there = BTreeSet::new();
        for found in self.store.list(SCENES)? {
            let name = found.name.strip_prefix(SCENES).and_then(|name| name.strip_prefix('/'));
            let Some(id) = name.and_then(|name| name.strip_suffix(".json")) else { continue };
            let Ok(scene) = SceneId::parse(id) else { continue };
            there.insert(id.to_owned());
            if seen.get(id) == Some(&found.modified) && local.exists(&scene) {
                continue;
            }
            match self.copy(local, &scene) {
                Ok(Some((version, is_new))) => {
                    after.insert(id.to_owned(), version);
                    seen.insert(id.to_owned(), found.modified);
                    changed.extend(is_new.then_some(scene));
                }
                // It has gone meanwhile.
                Ok(None) => _ = there.remove(id),
                Err(error) => failed.push(error),
            }
        }
        for (id, version) in before.iter().filter(|(id, _)| !there.contains(*id)) {
            after.remove(id);
            seen.remove(id);
            let Ok(scene) = SceneId::parse(id) else { continue };
            // What was put in its place here is not the store's.
            if local.read_metadata(&scene).is_ok_and(|stored| stored.metadata.version == *version) {
                match local.remove(&scene) {
                    Ok(()) | Err(SceneError::UnknownScene { .. }) => changed.push(scene),
                    Err(error) => failed.push(error),
                }
            }
        }
        if after != before {
            write_copies(&copies_file, &after)?;
        }
        Ok((changed, failed))
    }

    /// Copies a scene, unless it is here; its version, and whether it had to. None where it is not in the store.
    fn copy(&self, local: &SceneStore, id: &SceneId) -> Result<Option<(String, bool)>, SceneError> {
        let Some((bytes, _)) = self.store.get(&described(id))? else { return Ok(None) };
        let stored = parse(&bytes, id)?;
        let version = stored.metadata.version.clone();
        if local.read_metadata(id).is_ok_and(|here| here.metadata.version == version) {
            return Ok(Some((version, false)));
        }
        let upload = local.upload_folder()?;
        let made = SceneStore::new(upload.made());
        let folder = made.scene_dir(id);
        std::fs::create_dir_all(&folder).map_err(SceneError::io(&folder))?;
        std::fs::write(folder.join(METADATA_FILE), &bytes).map_err(SceneError::io(&folder))?;
        for file in &stored.files {
            // Its name is looked at when the scene is taken.
            let is_plain = Path::new(&file.name).file_name().is_some_and(|name| name == file.name.as_str());
            if !is_plain
                || !self.store.download(&object(id, &stored, &file.name), &folder.join(&file.name))?
            {
                let reason = "is not in the store".to_owned();
                return Err(SceneError::Damaged { scene: id.to_string(), file: file.name.clone(), reason });
            }
        }
        made.verify(id)?;
        local.adopt(&upload, id)?;
        Ok(Some((version, true)))
    }

    fn metadata(&self, id: &SceneId) -> Result<Option<StoredScene>, SceneError> {
        let found = self.store.get(&described(id))?;
        // One that cannot be read has no files that are known.
        Ok(found.and_then(|(bytes, _)| parse(&bytes, id).ok()))
    }

    fn remove_files(&self, id: &SceneId, stored: &StoredScene) -> Result<(), SceneError> {
        for file in &stored.files {
            self.store.remove(&object(id, stored, &file.name))?;
        }
        Ok(())
    }
}

impl From<StoreAway> for SceneError {
    fn from(StoreAway { reason }: StoreAway) -> Self {
        Self::StoreAway { reason }
    }
}

fn described(id: &SceneId) -> String {
    format!("{SCENES}/{id}.json")
}

fn object(id: &SceneId, stored: &StoredScene, file: &str) -> String {
    format!("{FILES}/{id}/{}/{file}", stored.metadata.version)
}

fn parse(bytes: &[u8], id: &SceneId) -> Result<StoredScene, SceneError> {
    StoredScene::parse(bytes, id).map_err(|reason| SceneError::Damaged {
        scene: id.to_string(),
        file: METADATA_FILE.to_owned(),
        reason,
    })
}

/// The copies of a folder, with their versions. Without their list nothing is known to be one, and nothing is removed.
fn copies(path: &Path) -> BTreeMap<String, String> {
    std::fs::read(path).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default()
}

fn write_copies(path: &PathBuf, copies: &BTreeMap<String, String>) -> Result<(), SceneError> {
    let write = || {
        let folder = path.parent().unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder)?;
        let mut file = tempfile::NamedTempFile::new_in(folder)?;
        serde_json::to_writer(&mut file, copies)?;
        file.persist(path).map_err(|error| error.error)
    };
    write().map(drop).map_err(SceneError::io(path))
}
