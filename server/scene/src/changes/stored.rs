//! The documents of a [`ChangeStore`](super::store::ChangeStore), its limits and its errors.

use super::change_id::ChangeId;
use super::edits::{Edit, PixelFactors};
use crate::scene_id::SceneId;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::Duration;
use thiserror::Error;

/// The store does not answer, or refuses.
#[derive(Clone, Debug, Error)]
#[error("the store of what is kept does not answer as it should: {reason}")]
pub struct StoreAway {
    /// What it said, for the log.
    pub reason: String,
}

/// Maximum length of a chain of changes based on each other.
pub const MAX_CHANGE_DEPTH: usize = 16;

/// What was painted over a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scenario {
    /// The scene.
    pub scene: SceneId,
    /// Its name for people.
    pub title: Option<String>,
    /// The scenario or plan that it is based on; None for the scene itself.
    pub base: Option<ChangeId>,
    /// The edits, in order.
    pub edits: Vec<Edit>,
}

/// A reduction plan as it is stored.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredPlan {
    /// The scene.
    pub scene: SceneId,
    /// Its version: pixels are of its raster.
    pub scene_version: String,
    /// The scenario or plan that it dims; None for the scene itself.
    pub base: Option<ChangeId>,
    /// Its answer document, opaque to the store.
    pub answer: serde_json::Value,
    /// What is left of each pixel that is dimmed.
    pub factors: PixelFactors,
    /// In parallel, the contribution of each to the effect of the plan.
    pub effects: Vec<f32>,
}

/// Limits of a store, for scenarios and for plans each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChangeLimits {
    /// Most of them; the oldest of whoever has the most stored go first.
    pub count: usize,
    /// Bytes that they take on disk together, the newest excepted.
    pub bytes: u64,
    /// Older ones go.
    pub age: Duration,
    /// Bytes of memory of draft plans together, the newest excepted.
    pub draft_bytes: u64,
}

/// Bytes of memory that draft plans have unless told otherwise.
pub const MAX_DRAFT_BYTES: u64 = 128 << 20;

impl Default for ChangeLimits {
    fn default() -> Self {
        Self {
            count: 5_000,
            bytes: 1 << 30,
            age: Duration::from_secs(90 * 86_400),
            draft_bytes: MAX_DRAFT_BYTES,
        }
    }
}

impl ChangeLimits {
    /// Whether these are [`Self::none`].
    pub fn is_none(&self) -> bool {
        *self == Self::none()
    }

    /// No limits: for command-line programs beside a server, which applies its own.
    pub fn none() -> Self {
        Self { count: usize::MAX, bytes: u64::MAX, age: Duration::MAX, draft_bytes: u64::MAX }
    }
}

/// Why a scenario or plan cannot be read or stored.
#[derive(Debug, Error)]
pub enum ChangeStoreError {
    /// None of that id.
    #[error("there is no scenario or plan \"{id}\"; those that are old or too many are not kept")]
    Unknown {
        /// The id.
        id: ChangeId,
    },
    /// It belongs to another scene.
    #[error("\"{id}\" belongs to scene \"{scene}\"")]
    OtherScene {
        /// The id.
        id: ChangeId,
        /// Its scene.
        scene: SceneId,
    },
    /// The scene was ingested again since.
    #[error("plan \"{id}\" is for the pixels of scene \"{scene}\" as it was before it was ingested again")]
    Stale {
        /// The id.
        id: ChangeId,
        /// Its scene.
        scene: SceneId,
    },
    /// Too many, one upon the other.
    #[error("\"{id}\" goes on from more than {MAX_CHANGE_DEPTH} others, one upon the other")]
    TooDeep {
        /// The id.
        id: ChangeId,
    },
    /// Only held for some minutes.
    #[error(
        "plan \"{id}\" is not kept, so nothing that is kept can go on from it; ask for it again with keep=on first"
    )]
    Draft {
        /// The id.
        id: ChangeId,
    },
    /// Somebody else's.
    #[error("\"{id}\" belongs to somebody else")]
    NotOwner {
        /// The id.
        id: ChangeId,
    },
    /// As much is pinned as may be.
    #[error("as much is pinned as may be: half of what is kept")]
    PinsFull,
    /// What is stored is still being looked through after the start.
    #[error("what is kept is being looked through; try again soon")]
    Reading,
    /// The object store that servers share does not answer.
    #[error(transparent)]
    Away(#[from] StoreAway),
    /// A file that is truncated, altered or of another format.
    #[error("{}: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The file system failed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}
