//! Scenes kept open.

use crate::error::ObservatoryError;
use moka::sync::Cache;
use skyglow_scene::{
    ChangeError, ChangeId, ChangeStep, ChangeStore, ChangeStoreError, ChangeSummary, MAX_CHANGE_DEPTH, Scene,
    SceneError, SceneId, SceneMetadata, SceneStore,
};
use std::{
    collections::VecDeque,
    hash::{DefaultHasher, Hash, Hasher},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, SystemTime},
};

/// Tells one state of a scene's folder from the next without reading it.
type Stamp = (SystemTime, u64);

/// Bytes of changed scenes that are kept, beside what they share with the scene itself.
const CHANGED_BYTES: u64 = 512 << 20;
/// How long a changed scene is kept that nobody asks for: it holds the scene, which may be gone from disk.
const KEPT_WHILE_IDLE: Duration = Duration::from_secs(600);

/// Scenes that can be read from disk at a time, at most.
const GATES: usize = 16;

/// A scene with changes, and what they did.
pub(crate) type Changed = (Arc<Scene>, Arc<ChangeSummary>);

/// The scenes that were used last, open. A scene that changed on disk is opened again.
#[derive(Debug)]
pub(crate) struct SceneCache {
    store: SceneStore,
    changes: ChangeStore,
    capacity: usize,
    /// Scenes with changes, by id and the version of the scene that was changed; each is made once for all who ask.
    changed: Cache<(ChangeId, String), Changed>,
    /// The one used last is at the front.
    open: Mutex<VecDeque<(SceneId, Stamp, Arc<Scene>)>>,
    /// Who opens a scene holds one of these, found by its id.
    gates: [Mutex<()>; GATES],
    /// How often a scene was read from disk.
    opened: AtomicUsize,
}

impl SceneCache {
    /// A shelf for at most `capacity` scenes, at least one.
    pub(crate) fn new(store: SceneStore, changes: ChangeStore, capacity: usize) -> Self {
        let weigh = |_: &(ChangeId, String), changed: &Changed| {
            u32::try_from(4096 + changed.0.unshared_bytes()).unwrap_or(u32::MAX)
        };
        let changed =
            Cache::builder().max_capacity(CHANGED_BYTES).weigher(weigh).time_to_idle(KEPT_WHILE_IDLE).build();
        Self {
            store,
            changes,
            capacity: capacity.max(1),
            open: Mutex::default(),
            changed,
            gates: Default::default(),
            opened: AtomicUsize::new(0),
        }
    }

    /// Where scenarios and plans are stored.
    pub(crate) fn changes(&self) -> &ChangeStore {
        &self.changes
    }

    /// A scene with the changes of a scenario or plan, or as it is.
    ///
    /// # Errors
    /// As [`Self::scene`], [`ObservatoryError::ChangeStore`], [`ObservatoryError::Change`].
    pub(crate) fn changed_scene(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
    ) -> Result<Arc<Scene>, ObservatoryError> {
        let scene = self.scene(id)?;
        match scenario {
            None => Ok(scene),
            Some(scenario) => Ok(self.changed(&scene, scenario)?.0),
        }
    }

    /// A scene with the changes of a scenario or plan, and what those did.
    ///
    /// # Errors
    /// [`ObservatoryError::ChangeStore`], [`ObservatoryError::Change`].
    pub(crate) fn changed(&self, scene: &Arc<Scene>, id: &ChangeId) -> Result<Changed, ObservatoryError> {
        let SceneMetadata { id: scene_id, version, .. } = scene.metadata();
        // An id is made from its content and a version from its scene's: what was made once need not be read again, only to
        // be there still.
        if let Some(changed) = self.changed.get(&(id.clone(), version.clone()))
            && self.changes.is_there(id)
        {
            return Ok(changed);
        }
        let steps = self.changes.steps(id, scene_id, version)?;
        self.made(scene, id, &steps)
    }

    /// The same of steps that are known, and not kept yet maybe.
    ///
    /// # Errors
    /// [`ObservatoryError::Change`].
    pub(crate) fn made(
        &self,
        scene: &Arc<Scene>,
        id: &ChangeId,
        steps: &[ChangeStep],
    ) -> Result<Changed, ObservatoryError> {
        let key = (id.clone(), scene.metadata().version.clone());
        let make = || -> Result<Changed, ChangeError> {
            let (changed, summary) = scene.changed(steps, id.as_str())?;
            tracing::debug!(%id, ?summary, "changed a scene");
            Ok((Arc::new(changed), Arc::new(summary)))
        };
        Ok(self.changed.try_get_with(key, make).map_err(|error| ChangeError::clone(&error))?)
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
    ) -> Result<Arc<Scene>, ObservatoryError> {
        let scene = self.scene(id)?;
        let mut steps = match scenario {
            Some(scenario) => self.changes.steps(scenario, id, &scene.metadata().version)?,
            None => Vec::new(),
        };
        steps.push(step);
        if let Some(scenario) = scenario
            && steps.len() > MAX_CHANGE_DEPTH
        {
            return Err(ChangeStoreError::TooDeep { id: scenario.clone() }.into());
        }
        Ok(Arc::new(scene.changed(&steps, mark)?.0))
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
    pub(crate) fn scene(&self, id: &SceneId) -> Result<Arc<Scene>, ObservatoryError> {
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
        // Opened without the lock on the shelf: the callers of open scenes go on meanwhile, and those of this one wait for the one
        // that opens it.
        let _opening = self.gate(id).lock().unwrap_or_else(PoisonError::into_inner);
        // It may have been replaced while this waited. Were it so while it is read, it is read again for the next.
        let stamp = self.stamp(id)?;
        if let Some(scene) = self.fetch(id, stamp) {
            return Ok(scene);
        }
        self.opened.fetch_add(1, Ordering::Relaxed);
        let scene = Arc::new(self.store.open(id)?);
        self.forget(id);
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.push_front((id.clone(), stamp, Arc::clone(&scene)));
        open.truncate(self.capacity);
        Ok(scene)
    }

    fn gate(&self, id: &SceneId) -> &Mutex<()> {
        let mut hasher = DefaultHasher::new();
        id.as_str().hash(&mut hasher);
        &self.gates[hasher.finish() as usize % GATES]
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

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_scene::{ChangeLimits, IngestOptions, ingest};
    use std::path::Path;

    /// Stores a scene of two lights.
    fn store_lights(data: &Path) -> (SceneStore, SceneId) {
        let raster = data.join("light.tif");
        std::fs::write(&raster, include_bytes!("../../../tests/fuzz/seeds/raster/smallest")).unwrap();
        let store = SceneStore::new(data);
        let id = ingest(&store, &IngestOptions::new(raster), &mut |_| {}).unwrap().id;
        (store, id)
    }

    #[test]
    fn a_scene_that_many_ask_for_at_once_is_opened_once() {
        let data = tempfile::tempdir().unwrap();
        let (store, id) = store_lights(data.path());
        let shelf = SceneCache::new(store, ChangeStore::new(data.path(), ChangeLimits::none()), 4);
        let start = std::sync::Barrier::new(8);
        let scenes: Vec<Arc<Scene>> = std::thread::scope(|scope| {
            let ask = || {
                start.wait();
                shelf.scene(&id).unwrap()
            };
            let asking: Vec<_> = (0..8).map(|_| scope.spawn(ask)).collect();
            asking.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        assert_eq!(shelf.opened.load(Ordering::Relaxed), 1);
        assert!(scenes.iter().all(|scene| Arc::ptr_eq(scene, &scenes[0])));
        // What changed on disk is opened again, once.
        let metadata = shelf.store().scenes_dir().join(id.as_str()).join("metadata.json");
        let later = std::fs::metadata(&metadata).unwrap().modified().unwrap() + Duration::from_secs(5);
        std::fs::File::options().write(true).open(&metadata).unwrap().set_modified(later).unwrap();
        assert!(!Arc::ptr_eq(&shelf.scene(&id).unwrap(), &scenes[0]));
        assert!(shelf.scene(&id).is_ok());
        assert_eq!(shelf.opened.load(Ordering::Relaxed), 2);
    }
}
