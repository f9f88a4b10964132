//! Scenes that several servers share: an object store is the truth, and each server's folder holds copies of its own.
//!
//! `scenes/ID.json` is the `metadata.json` of a scene, and `scene-files/ID/VERSION/FILE` the files that it names. A scene is there
//! when its metadata are, which are written last and removed first. `scenes/ID.gone` has the version of a scene that was removed: what
//! is merely missing from a store is removed nowhere. What a server copied is named, with its version and the store's address, in
//! `.shared.json` beside its scenes: a scene of its own is never overwritten.

use crate::changes::{DocumentStore, StoreAway};
use crate::error::SceneError;
use crate::scene_files::{METADATA_FILE, StoredScene};
use crate::scene_id::SceneId;
use crate::store::SceneStore;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime};

/// Folder of what says which scenes there are.
const SCENES: &str = "scenes";
/// Folder of their files.
const FILES: &str = "scene-files";
/// What of a server's folder are copies.
const COPIES_FILE: &str = ".shared.json";

/// A scene is looked at so often after it changed: the times of stores are coarse.
const LOOKS: u8 = 3;
/// Pause after a copy that failed, and the longest after several.
const FIRST_PAUSE: Duration = Duration::from_secs(10);
const LONGEST_PAUSE: Duration = Duration::from_secs(600);

/// The scenes of an object store.
#[derive(Debug)]
pub struct SharedScenes {
    store: Arc<dyn DocumentStore>,
    /// By id; held while copies are made.
    seen: Mutex<BTreeMap<String, Seen>>,
    /// Held while the list of copies is written.
    listing: Mutex<()>,
}

/// What is known of a scene of the store.
#[derive(Debug)]
enum Seen {
    /// It is here as it was then, and was looked at so often.
    Copied { modified: SystemTime, looks: u8 },
    /// It could not be copied, and is not tried again before.
    Failed { next: Instant, pause: Duration },
}

/// The list of copies in a folder.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
struct Copies {
    /// Of the store that they are of.
    address: String,
    /// Versions by id.
    copies: BTreeMap<String, String>,
}

impl SharedScenes {
    /// Of a store.
    pub fn new(store: Arc<dyn DocumentStore>) -> Self {
        Self { store, seen: Mutex::default(), listing: Mutex::default() }
    }

    /// Puts a scene of a folder into the store, over the one of that id.
    ///
    /// * `follows`: whether the scene in the folder counts as a copy from now on, which goes when it is removed from the store.
    ///
    /// # Errors
    /// [`SceneError::StoreAway`], [`SceneError::ReplacedMeanwhile`], and what is wrong with the scene.
    pub fn put(&self, local: &SceneStore, id: &SceneId, follows: bool) -> Result<(), SceneError> {
        let path = local.scene_dir(id).join(METADATA_FILE);
        let metadata = std::fs::read(&path).map_err(|_| SceneError::UnknownScene { id: id.to_string() })?;
        let stored = parse(&metadata, id)?;
        for file in &stored.files {
            self.store.upload(&object(id, &stored, &file.name), &local.scene_dir(id).join(&file.name))?;
        }
        // The folder of a scene that is replaced is another one at once.
        if local.read_metadata(id)?.metadata.version != stored.metadata.version {
            return Err(SceneError::ReplacedMeanwhile { id: id.to_string() });
        }
        let before = self.metadata(id)?;
        // What says that one was removed goes first: it may be said of this one at once.
        self.store.remove(&gone(id))?;
        self.store.put(&described(id), &metadata)?;
        if follows {
            self.note(local, id, Some(stored.metadata.version.clone()))?;
        }
        // Who is copying the one before finds the new one next time.
        match before.filter(|before| before.metadata.version != stored.metadata.version) {
            Some(before) => self.remove_files(id, &before),
            None => Ok(()),
        }
    }

    /// Removes the scene of a folder from the store and, in time, from the folders that have a copy, if it is there: another by that
    /// name stays.
    ///
    /// # Errors
    /// [`SceneError::StoreAway`].
    pub fn remove(&self, local: &SceneStore, id: &SceneId) -> Result<(), SceneError> {
        let Some(stored) = self.metadata(id)? else { return Ok(()) };
        if local.read_metadata(id).is_ok_and(|here| here.metadata.version != stored.metadata.version) {
            return Ok(());
        }
        self.store.put(&gone(id), stored.metadata.version.as_bytes())?;
        self.store.remove(&described(id))?;
        self.remove_files(id, &stored)
    }

    /// Copies what is new or other in the store, and removes copies of what was removed there. The scenes that changed; what went wrong
    /// with others does not keep these, and is tried again later and later.
    ///
    /// # Errors
    /// [`SceneError::StoreAway`].
    pub fn refresh(&self, local: &SceneStore) -> Result<(Vec<SceneId>, Vec<SceneError>), SceneError> {
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let (mut changed, mut failed) = (Vec::new(), Vec::new());
        for found in self.store.list(SCENES)? {
            let name =
                found.name.strip_prefix(SCENES).and_then(|name| name.strip_prefix('/')).unwrap_or_default();
            let Some((id, kind)) = name.rsplit_once('.') else { continue };
            let Ok(scene) = SceneId::parse(id) else { continue };
            if kind == "gone" {
                match self.remove_copy(local, &scene) {
                    Ok(is_removed) => changed.extend(is_removed.then_some(scene)),
                    Err(error) => failed.push(error),
                }
                continue;
            }
            let (looks, pause) = match seen.get(id) {
                Some(Seen::Copied { modified, looks })
                    if *modified == found.modified && local.exists(&scene) =>
                {
                    (*looks, FIRST_PAUSE)
                }
                Some(Seen::Failed { next, .. }) if *next > Instant::now() => continue,
                Some(Seen::Failed { pause, .. }) => (0, (2 * *pause).min(LONGEST_PAUSE)),
                _ => (0, FIRST_PAUSE),
            };
            if looks >= LOOKS {
                continue;
            }
            let now = match self.copy(local, &scene) {
                Ok(is_new) => {
                    changed.extend(is_new.then_some(scene));
                    Seen::Copied { modified: found.modified, looks: looks + 1 }
                }
                Err(error) => {
                    failed.push(error);
                    Seen::Failed { next: Instant::now() + pause, pause }
                }
            };
            seen.insert(id.to_owned(), now);
        }
        Ok((changed, failed))
    }

    /// Copies a scene, unless it is here or not in the store any more; whether it had to.
    fn copy(&self, local: &SceneStore, id: &SceneId) -> Result<bool, SceneError> {
        let Some((bytes, _)) = self.store.get(&described(id))? else { return Ok(false) };
        let stored = parse(&bytes, id)?;
        let version = stored.metadata.version.clone();
        let here = local.read_metadata(id).ok().map(|here| here.metadata.version);
        let known = self.copies(local).copies.get(id.as_str()).cloned();
        if here.as_ref() == Some(&version) {
            if known.as_ref() != Some(&version) {
                self.note(local, id, Some(version))?;
            }
            return Ok(false);
        }
        if here.is_some() && here != known {
            return Err(SceneError::OwnScene { id: id.to_string() });
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
        // What came in its place meanwhile is this server's own.
        if local.read_metadata(id).ok().map(|here| here.metadata.version) != here {
            return Err(SceneError::OwnScene { id: id.to_string() });
        }
        local.adopt(&upload, id)?;
        self.note(local, id, Some(version))?;
        Ok(true)
    }

    /// Removes the copy of a scene that was removed from the store; whether there was one.
    fn remove_copy(&self, local: &SceneStore, id: &SceneId) -> Result<bool, SceneError> {
        let Some(version) = self.copies(local).copies.get(id.as_str()).cloned() else { return Ok(false) };
        let is_of_it = |removed: Vec<u8>| removed == version.as_bytes();
        if !self.store.get(&gone(id))?.is_some_and(|(removed, _)| is_of_it(removed)) {
            return Ok(false);
        }
        let here = local.read_metadata(id).ok().map(|here| here.metadata.version);
        // What was put in its place here is not the store's.
        if here.as_ref() == Some(&version) {
            match local.remove(id) {
                Ok(()) | Err(SceneError::UnknownScene { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        self.note(local, id, None)?;
        Ok(here == Some(version))
    }

    fn metadata(&self, id: &SceneId) -> Result<Option<StoredScene>, SceneError> {
        let found = self.store.get(&described(id))?;
        // One that cannot be read has no files that are known.
        Ok(found.and_then(|(bytes, _)| parse(&bytes, id).ok()))
    }

    /// The copies of a folder. Without their list, or with that of another store, nothing is known to be one.
    fn copies(&self, local: &SceneStore) -> Copies {
        let read = std::fs::read(local.scenes_dir().join(COPIES_FILE)).ok();
        let copies: Option<Copies> = read.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        let address = self.store.address();
        let of_this = copies.filter(|copies| copies.address == address);
        of_this.unwrap_or(Copies { address, copies: BTreeMap::new() })
    }

    /// Notes the version of a copy, or that there is none.
    fn note(&self, local: &SceneStore, id: &SceneId, version: Option<String>) -> Result<(), SceneError> {
        let _one_by_one = self.listing.lock().unwrap_or_else(PoisonError::into_inner);
        let mut copies = self.copies(local);
        match version {
            Some(version) => _ = copies.copies.insert(id.to_string(), version),
            None => _ = copies.copies.remove(id.as_str()),
        }
        let path = local.scenes_dir().join(COPIES_FILE);
        let write = || {
            let folder = local.scenes_dir();
            std::fs::create_dir_all(folder)?;
            let mut file = tempfile::NamedTempFile::new_in(folder)?;
            serde_json::to_writer(&mut file, &copies)?;
            file.persist(&path).map_err(|error| error.error)
        };
        write().map(drop).map_err(SceneError::io(&path))
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

/// The version of a scene that was removed.
fn gone(id: &SceneId) -> String {
    format!("{SCENES}/{id}.gone")
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
