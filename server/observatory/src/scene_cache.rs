//! Open scenes, with and without changes, least recently used out first.

use crate::{
    cache_sizes::CacheSizes,
    error::ObservatoryError,
    scene_health::{SceneHealth, Stamp},
    scene_view::SceneView,
};
use moka::{policy::EvictionPolicy, sync::Cache};
use skyglow_scene::{
    ChangeError, ChangeId, ChangeStep, ChangeStore, ChangeStoreError, ChangeSummary, MAX_CHANGE_DEPTH, Scene,
    SceneError, SceneId, SceneMetadata, SceneStore,
};
use std::{
    collections::BTreeMap,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

/// Scenes of fewer bytes than this part of those of all are opened beside others; larger ones one after another.
const SMALL_PART: u64 = 8;
/// A cache weighs in this many bytes, for weights of 32 bits.
const WEIGHT_BYTES: u64 = 1 << 10;
/// How long a changed scene is stored that nobody asks for: it holds the scene, which may be gone from disk.
const TIME_TO_IDLE: Duration = Duration::from_secs(600);

/// A scene with changes, and what they did.
pub(crate) type Changed = (Arc<Scene>, Arc<ChangeSummary>);

/// The scenes that were used last, open. A scene that changed on disk is opened again.
#[derive(Debug)]
pub(crate) struct SceneCache {
    store: SceneStore,
    changes: ChangeStore,
    /// Scenes with changes, by id and the version of the scene that was changed; each is made once for all who ask.
    changed: Cache<(ChangeId, String), Changed>,
    /// Scenes as they are, by id and the state of their folder; each is opened once for all who ask.
    open: Cache<(SceneId, Stamp), Arc<Scene>>,
    /// Which of them are damaged.
    health: SceneHealth,
    /// Whether large scenes are opened before the file of their lights is checked.
    opens_first: bool,
    /// Of scenes whose file of lights was read through: in which state, and whether it was whole.
    lights_seen: Mutex<BTreeMap<SceneId, (Stamp, bool)>>,
    /// Bytes that they may take together, and each of them alone.
    most_bytes: u64,
    /// What one counts at least in `open`.
    least_weight: u64,
    /// Held while a large one is opened.
    opening_large: Mutex<()>,
    /// How often a scene was read from disk.
    opened: AtomicUsize,
}

impl SceneCache {
    /// A cache of at most `capacity` scenes, at least one, that they and what is made of them take so many bytes in.
    pub(crate) fn new(store: SceneStore, changes: ChangeStore, capacity: usize, sizes: &CacheSizes) -> Self {
        let most_bytes = sizes.scenes_bytes;
        let most_weight = most_bytes / WEIGHT_BYTES;
        // So many of the lightest fill it.
        let least = most_weight.div_ceil(capacity.max(1) as u64);
        let weigh_open = move |_: &(SceneId, Stamp), scene: &Arc<Scene>| {
            u32::try_from((scene.byte_count() / WEIGHT_BYTES).min(most_weight).max(least)).unwrap_or(u32::MAX)
        };
        let weigh = |_: &(ChangeId, String), changed: &Changed| {
            u32::try_from(4096 + changed.0.unshared_bytes()).unwrap_or(u32::MAX)
        };
        Self {
            store,
            changes,
            changed: Cache::builder()
                .max_capacity(sizes.changed_scenes_bytes)
                .weigher(weigh)
                .time_to_idle(TIME_TO_IDLE)
                .build(),
            open: Cache::builder()
                .max_capacity(least * capacity.max(1) as u64)
                .weigher(weigh_open)
                .eviction_policy(EvictionPolicy::lru())
                .build(),
            health: SceneHealth::default(),
            opens_first: false,
            lights_seen: Mutex::default(),
            most_bytes,
            least_weight: least,
            opening_large: Mutex::new(()),
            opened: AtomicUsize::new(0),
        }
    }

    /// The same, which opens large scenes before it has checked them: by [`Self::check_lights`].
    pub(crate) fn with_lights_checked_later(self) -> Self {
        Self { opens_first: true, ..self }
    }

    /// Where scenarios and plans are stored.
    pub(crate) fn changes(&self) -> &ChangeStore {
        &self.changes
    }

    /// A scene with the changes of a scenario or plan, or as it is.
    ///
    /// # Errors
    /// As [`Self::scene`], [`ObservatoryError::ChangeStore`], [`ObservatoryError::Change`].
    pub(crate) fn view(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
    ) -> Result<SceneView, ObservatoryError> {
        let base = self.scene(id)?;
        let scene = match scenario {
            None => Arc::clone(&base),
            Some(scenario) => self.changed(&base, scenario)?.0,
        };
        Ok(SceneView::new(base, scene))
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
        self.apply(scene, id, &steps)
    }

    /// The same of steps that are known, and not stored yet maybe.
    ///
    /// # Errors
    /// [`ObservatoryError::Change`].
    pub(crate) fn apply(
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
    /// * `base`: without the changes.
    ///
    /// # Errors
    /// [`ObservatoryError::ChangeStore`], [`ObservatoryError::Change`].
    pub(crate) fn with_step(
        &self,
        base: &Scene,
        scenario: Option<&ChangeId>,
        step: ChangeStep,
        mark: &str,
    ) -> Result<Scene, ObservatoryError> {
        let SceneMetadata { id, version, .. } = base.metadata();
        let mut steps = match scenario {
            Some(scenario) => self.changes.steps(scenario, id, version)?,
            None => Vec::new(),
        };
        steps.push(step);
        if let Some(scenario) = scenario
            && steps.len() > MAX_CHANGE_DEPTH
        {
            return Err(ChangeStoreError::TooDeep { id: scenario.clone() }.into());
        }
        Ok(base.changed(&steps, mark)?.0)
    }

    /// Where the scenes are stored.
    pub(crate) fn store(&self) -> &SceneStore {
        &self.store
    }

    /// Number of scenes open.
    pub(crate) fn len(&self) -> usize {
        self.open.run_pending_tasks();
        self.open.entry_count() as usize
    }

    /// A scene, from the cache if it is unchanged on disk. Were it replaced while it is read, it is read again for the next.
    ///
    /// # Errors
    /// As [`SceneStore::open`].
    pub(crate) fn scene(&self, id: &SceneId) -> Result<Arc<Scene>, ObservatoryError> {
        let stamp = self.stamp(id).inspect_err(|_| self.forget_all_but(id, None))?;
        if let Some(damage) = self.health.damage(id, stamp) {
            return Err(damage.into());
        }
        let open = || {
            self.opened.fetch_add(1, Ordering::Relaxed);
            self.open_within(id).map(Arc::new)
        };
        match self.open.entry((id.clone(), stamp)).or_try_insert_with(open) {
            Ok(entry) => {
                if entry.is_fresh() {
                    // It may have been removed or replaced meanwhile.
                    let now = self.stamp(id).ok();
                    self.forget_all_but(id, now.filter(|now| *now == stamp));
                    self.health.note(id, stamp, Ok(()));
                }
                Ok(entry.into_value())
            }
            Err(error) => {
                self.health.note::<()>(id, stamp, Err(&error));
                match self.health.damage(id, stamp) {
                    Some(damage) => Err(damage.into()),
                    // All who asked share the error, which has one owner: each sees for itself.
                    None => Ok(Arc::new(self.open_within(id)?)),
                }
            }
        }
    }

    /// Reads every scene through that was not yet, or is damaged, and notes which are. Those that were found sound now.
    pub(crate) fn check_all(&self) -> Result<Vec<SceneId>, SceneError> {
        let list = self.store.list()?;
        let damaged = list.damaged.iter().filter_map(|error| match error {
            SceneError::Damaged { scene, .. } => SceneId::parse(scene).ok(),
            _ => None,
        });
        let ids = list.scenes.into_iter().map(|scene| scene.id).chain(damaged);
        let there: Vec<_> = ids.filter_map(|id| self.stamp(&id).ok().map(|stamp| (id, stamp))).collect();
        self.health.begin(&there);
        let mut sound = Vec::new();
        for (id, stamp) in there {
            if !self.health.is_sound(&id, stamp) {
                self.health.note(&id, stamp, self.store.verify(&id).as_ref());
                sound.extend(self.health.is_sound(&id, stamp).then_some(id));
            }
        }
        Ok(sound)
    }

    /// Opens scenes while half of the room for open ones is free: who asks first then does not wait for that.
    pub(crate) fn open_ahead(&self, ids: &[SceneId]) {
        for id in ids.iter().filter(|id| self.has_half_for(id)) {
            // Whoever asks for it is told what is wrong.
            let _best_effort = self.scene(id);
        }
    }

    /// Reads the files through that lights of large scenes stay in, those that were not yet. A scene with a damaged one is opened anew, which
    /// makes the file again where it can be written, and is checked by who opens it from then on.
    ///
    /// # Errors
    /// As [`SceneStore::list`].
    pub(crate) fn check_lights(&self) -> Result<(), SceneError> {
        for id in self.store.list()?.scenes.into_iter().map(|scene| scene.id) {
            let Ok(stamp) = self.stamp(&id) else { continue };
            if self.lights_seen().get(&id).is_some_and(|(of, _)| *of == stamp) {
                continue;
            }
            let is_whole = self.store.verify_lights(&id);
            self.lights_seen().insert(id.clone(), (stamp, is_whole));
            if !is_whole {
                tracing::warn!(scene = %id, "the file of its lights was altered (its checksum is wrong): the lights are read anew");
                self.forget(&id);
            }
        }
        Ok(())
    }

    fn lights_seen(&self) -> MutexGuard<'_, BTreeMap<SceneId, (Stamp, bool)>> {
        self.lights_seen.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a scene fits into half of the room for open ones, beside those that are.
    fn has_half_for(&self, id: &SceneId) -> bool {
        self.open.run_pending_tasks();
        let most = self.open.policy().max_capacity().unwrap_or(0) / 2;
        let weight = self.store.scene_bytes(id).map_or(u64::MAX, |bytes| bytes / WEIGHT_BYTES);
        weight.max(self.least_weight).saturating_add(self.open.weighted_size()) <= most
    }

    /// Whether a scene is known to be damaged as it is now.
    pub(crate) fn is_damaged(&self, id: &SceneId) -> bool {
        self.stamp(id).is_ok_and(|stamp| self.health.damage(id, stamp).is_some())
    }

    /// The damaged scenes that are there, and the number of the others.
    pub(crate) fn damaged(&self) -> (Vec<SceneId>, usize) {
        let (mut damaged, others) = self.health.damaged();
        damaged.retain(|id| self.is_damaged(id));
        (damaged, others)
    }

    /// Opens a scene where it fits. Before a large one others are let go, so that those that are open and the new one together
    /// take no more than they may.
    fn open_within(&self, id: &SceneId) -> Result<Scene, SceneError> {
        let bytes = self.store.scene_bytes(id)?;
        let _one_by_one = (bytes > self.most_bytes / SMALL_PART).then(|| {
            let lock = self.opening_large.lock().unwrap_or_else(PoisonError::into_inner);
            self.open.run_pending_tasks();
            let mut taken = self.open.weighted_size() * WEIGHT_BYTES;
            for (key, scene) in &self.open {
                if taken + bytes <= self.most_bytes {
                    break;
                }
                self.open.invalidate(&*key);
                taken = taken.saturating_sub(scene.byte_count());
            }
            self.open.run_pending_tasks();
            lock
        });
        let was_damaged = self.lights_seen().get(id).is_some_and(|(_, is_whole)| !is_whole);
        match self.opens_first && !was_damaged {
            true => self.store.open_unchecked(id, self.most_bytes),
            false => self.store.open_within(id, self.most_bytes),
        }
    }

    /// Bytes that one open scene may take.
    pub(crate) fn most_bytes(&self) -> u64 {
        self.most_bytes
    }

    /// Lets go of a scene and of what was made of it: it was removed or replaced. Requests under way keep it.
    pub(crate) fn forget(&self, id: &SceneId) {
        self.forget_all_but(id, None);
        for (key, changed) in &self.changed {
            if changed.0.metadata().id == *id {
                self.changed.invalidate(&*key);
            }
        }
        self.changed.run_pending_tasks();
    }

    /// Forgets a scene as it was in other states of its folder.
    fn forget_all_but(&self, id: &SceneId, stamp: Option<Stamp>) {
        for (key, _) in &self.open {
            if key.0 == *id && Some(key.1) != stamp {
                self.open.invalidate(&*key);
            }
        }
        self.open.run_pending_tasks();
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
#[path = "scene_cache_tests.rs"]
mod tests;
