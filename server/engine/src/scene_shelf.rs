//! Scenes kept open.

use crate::error::EngineError;
use skyglow_scene::{ChangeId, ChangeStep, ChangeStore, Scene, SceneError, SceneId, SceneStore};
use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, PoisonError},
    time::SystemTime,
};

/// Tells one state of a scene's folder from the next without reading it.
type Stamp = (SystemTime, u64);

/// Changed scenes that are kept; they share what was not touched with the scene itself.
const CHANGED_SCENE_COUNT: usize = 16;

/// The scenes that were used last, open. A scene that changed on disk is opened again.
#[derive(Debug)]
pub(crate) struct SceneShelf {
    store: SceneStore,
    changes: ChangeStore,
    capacity: usize,
    /// Scenes with changes; the one used last is at the front. Their versions tell of which state of the scene they are.
    changed: Mutex<VecDeque<(ChangeId, String, Arc<Scene>)>>,
    /// The one used last is at the front.
    open: Mutex<VecDeque<(SceneId, Stamp, Arc<Scene>)>>,
}

impl SceneShelf {
    /// A shelf for at most `capacity` scenes, at least one.
    pub(crate) fn new(store: SceneStore, changes: ChangeStore, capacity: usize) -> Self {
        let (open, changed) = Default::default();
        Self { store, changes, capacity: capacity.max(1), open, changed }
    }

    /// Where scenarios and plans are stored.
    pub(crate) fn changes(&self) -> &ChangeStore {
        &self.changes
    }

    /// A scene with the changes of a scenario or plan, or as it is.
    ///
    /// # Errors
    /// As [`Self::scene`], [`EngineError::ChangeStore`], [`EngineError::Change`].
    pub(crate) fn changed_scene(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
    ) -> Result<Arc<Scene>, EngineError> {
        let scene = self.scene(id)?;
        let Some(scenario) = scenario else { return Ok(scene) };
        // Read each time: it may be gone or belong to another scene.
        let steps = || self.changes.steps(scenario, id, &scene.metadata().version);
        let is_wanted = |(known, version, _): &(ChangeId, String, Arc<Scene>)| {
            known == scenario && *version == scene.metadata().version
        };
        let kept = {
            let mut changed = self.changed.lock().unwrap_or_else(PoisonError::into_inner);
            let position = changed.iter().position(is_wanted);
            position
                .and_then(|position| changed.remove(position))
                .inspect(|entry| changed.push_front(entry.clone()))
        };
        if let Some((_, _, kept)) = kept
            && self.changes.is_there(scenario)
        {
            return Ok(kept);
        }
        let changed = Arc::new(with_changes(&scene, &steps()?, scenario.as_str())?);
        let mut list = self.changed.lock().unwrap_or_else(PoisonError::into_inner);
        list.retain(|entry| !is_wanted(entry));
        list.push_front((scenario.clone(), scene.metadata().version.clone(), Arc::clone(&changed)));
        list.truncate(CHANGED_SCENE_COUNT);
        Ok(changed)
    }

    /// A scene with the changes of a scenario or plan, and one more step.
    ///
    /// # Errors
    /// As [`Self::changed_scene`].
    pub(crate) fn with_step(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
        step: ChangeStep,
        mark: &str,
    ) -> Result<Arc<Scene>, EngineError> {
        let scene = self.scene(id)?;
        let mut steps = match scenario {
            Some(scenario) => self.changes.steps(scenario, id, &scene.metadata().version)?,
            None => Vec::new(),
        };
        steps.push(step);
        Ok(Arc::new(with_changes(&scene, &steps, mark)?))
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

fn with_changes(scene: &Scene, steps: &[ChangeStep], mark: &str) -> Result<Scene, EngineError> {
    let (changed, summary) = scene.changed(steps, mark)?;
    tracing::debug!(mark, ?summary, "changed a scene");
    Ok(changed)
}
