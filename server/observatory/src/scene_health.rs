//! Which stored scenes are damaged: each is read through once, and again after it changed.

use skyglow_scene::{SceneError, SceneId};
use std::{
    collections::BTreeMap,
    sync::{Mutex, MutexGuard, PoisonError},
    time::SystemTime,
};

/// Tells one state of a scene's folder from the next without reading it.
pub(crate) type Stamp = (SystemTime, u64);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Health {
    Unread,
    Sound,
    Damaged { file: String, reason: String },
}

/// What is known of the scenes, each in one state of its folder.
#[derive(Debug, Default)]
pub(crate) struct SceneHealth(Mutex<BTreeMap<SceneId, (Stamp, Health)>>);

impl SceneHealth {
    fn known(&self) -> MutexGuard<'_, BTreeMap<SceneId, (Stamp, Health)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes the scenes that there are; others are forgotten.
    pub(crate) fn begin(&self, there: &[(SceneId, Stamp)]) {
        let mut known = self.known();
        known.retain(|id, _| there.iter().any(|(other, _)| other == id));
        for (id, stamp) in there {
            if known.get(id).is_none_or(|(of, _)| of != stamp) {
                known.insert(id.clone(), (*stamp, Health::Unread));
            }
        }
    }

    /// Whether a scene was read through in this state and is sound.
    pub(crate) fn is_sound(&self, id: &SceneId, stamp: Stamp) -> bool {
        self.known().get(id) == Some(&(stamp, Health::Sound))
    }

    /// Takes what came of reading a scene; what is damaged is logged once.
    pub(crate) fn note<T>(&self, id: &SceneId, stamp: Stamp, read: Result<T, &SceneError>) {
        let health = match read {
            Ok(_) => Health::Sound,
            Err(SceneError::Damaged { file, reason, .. }) => {
                Health::Damaged { file: file.clone(), reason: reason.clone() }
            }
            // What the disk does not give now it may give later.
            Err(_) => return,
        };
        let now = (stamp, health);
        let before = self.known().insert(id.clone(), now.clone());
        match (&now.1, before) {
            (Health::Damaged { file, reason }, before) if before.as_ref() != Some(&now) => {
                tracing::warn!(scene = %id, "a damaged scene is left out: its {file} {reason}");
            }
            (Health::Sound, Some((_, Health::Damaged { .. }))) => {
                tracing::info!(scene = %id, "the scene is whole again");
            }
            _ => {}
        }
    }

    /// What is wrong with a scene in this state of its folder.
    pub(crate) fn damage(&self, id: &SceneId, stamp: Stamp) -> Option<SceneError> {
        match self.known().get(id) {
            Some((of, Health::Damaged { file, reason })) if *of == stamp => Some(SceneError::Damaged {
                scene: id.to_string(),
                file: file.clone(),
                reason: reason.clone(),
            }),
            _ => None,
        }
    }

    /// The damaged scenes, and the number of the others.
    pub(crate) fn damaged(&self) -> (Vec<SceneId>, usize) {
        let known = self.known();
        let is_damaged = |(_, health): &&(Stamp, Health)| matches!(health, Health::Damaged { .. });
        let damaged = known.iter().filter(|(_, state)| is_damaged(state)).map(|(id, _)| id.clone());
        let damaged: Vec<SceneId> = damaged.collect();
        let others = known.len() - damaged.len();
        (damaged, others)
    }
}
