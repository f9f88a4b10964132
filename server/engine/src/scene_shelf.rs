//! Scenes kept open.

use crate::error::EngineError;
use skyglow_scene::{Scene, SceneError, SceneId, SceneStore};
use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, PoisonError},
    time::SystemTime,
};

/// Tells one state of a scene's folder from the next without reading it.
type Stamp = (SystemTime, u64);

/// The scenes that were used last, open. A scene that changed on disk is opened again.
#[derive(Debug)]
pub(crate) struct SceneShelf {
    store: SceneStore,
    capacity: usize,
    /// The one used last is at the front.
    open: Mutex<VecDeque<(SceneId, Stamp, Arc<Scene>)>>,
}

impl SceneShelf {
    /// A shelf for at most `capacity` scenes, at least one.
    pub(crate) fn new(store: SceneStore, capacity: usize) -> Self {
        Self { store, capacity: capacity.max(1), open: Mutex::default() }
    }

    /// Where the scenes are stored.
    pub(crate) fn store(&self) -> &SceneStore {
        &self.store
    }

    /// Number of scenes open.
    pub(crate) fn len(&self) -> usize {
        self.open.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// A scene, from the shelf if it is unchanged on disk.
    ///
    /// # Errors
    /// As [`SceneStore::open`].
    pub(crate) fn scene(&self, id: &SceneId) -> Result<Arc<Scene>, EngineError> {
        let stamp = match self.stamp(id) {
            Ok(stamp) => stamp,
            Err(error) => {
                self.forget(id);
                return Err(error.into());
            }
        };
        if let Some(scene) = self.fetch(id, stamp) {
            return Ok(scene);
        }
        // Opened without the lock: another scene's callers go on meanwhile.
        let scene = Arc::new(self.store.open(id)?);
        self.forget(id);
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.push_front((id.clone(), stamp, Arc::clone(&scene)));
        open.truncate(self.capacity);
        Ok(scene)
    }

    fn fetch(&self, id: &SceneId, stamp: Stamp) -> Option<Arc<Scene>> {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let position = open.iter().position(|(known, then, _)| known == id && *then == stamp)?;
        let entry = open.remove(position)?;
        let scene = Arc::clone(&entry.2);
        open.push_front(entry);
        Some(scene)
    }

    fn forget(&self, id: &SceneId) {
        self.open.lock().unwrap_or_else(PoisonError::into_inner).retain(|(known, _, _)| known != id);
    }

    fn stamp(&self, id: &SceneId) -> Result<Stamp, SceneError> {
        let path = self.store.scenes_dir().join(id.as_str()).join("metadata.json");
        let metadata = std::fs::metadata(&path).map_err(|source| match source.kind() {
            std::io::ErrorKind::NotFound => SceneError::UnknownScene { id: id.to_string() },
            _ => SceneError::Io { path: path.clone(), source },
        })?;
        let modified = metadata.modified().map_err(|source| SceneError::Io { path, source })?;
        Ok((modified, metadata.len()))
    }
}
