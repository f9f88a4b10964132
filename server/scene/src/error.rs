//! Errors of this crate. Every message is one sentence that a user can act on.

use std::path::PathBuf;

/// An error of this crate.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A scene id that is not `[a-z0-9-]{1,64}`.
    #[error("\"{id}\" is no scene id: 1 to 64 of the characters a-z, 0-9 and - are allowed")]
    InvalidId {
        /// The text given.
        id: String,
    },
    /// No scene of that id is stored.
    #[error("there is no scene \"{id}\"")]
    UnknownScene {
        /// The id asked for.
        id: String,
    },
    /// Ingest into an id that is taken.
    #[error("scene \"{id}\" exists already; give another --id, or --replace to overwrite it")]
    SceneExists {
        /// The id wanted.
        id: String,
    },
    /// A file that is no raster, or ends too early.
    #[error("{} cannot be read as a raster: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the reader met.
        reason: String,
    },
    /// A raster that can be read and cannot be meant.
    #[error("{}: {reason}", path.display())]
    Refused {
        /// The file.
        path: PathBuf,
        /// Why, and what would help.
        reason: String,
    },
    /// A wrong option of an ingest.
    #[error("{option}: {reason}")]
    InvalidOption {
        /// The option as the command line spells it.
        option: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// A stored scene that takes more memory than there is for one.
    #[error(
        "scene \"{scene}\" needs {} of memory, and there are {} for open scenes; give it more, or ingest less light: a masked product, a \
         floor, a region",
        crate::memory::gigabytes(*needed_bytes), crate::memory::gigabytes(*limit_bytes)
    )]
    TooLarge {
        /// The scene's id.
        scene: String,
        /// Bytes that it needs.
        needed_bytes: u64,
        /// Bytes that it may take.
        limit_bytes: u64,
    },
    /// A map of all of a scene whose skylines take more memory than there is.
    #[error(
        "a map of all of scene \"{scene}\" needs the skylines of its {lights} lights at once, some {} of memory where there are {}; ask for a \
         part of it (`skyglow atlas --bounds`), or for an open terrain",
        crate::memory::gigabytes(*needed_bytes), crate::memory::gigabytes(*limit_bytes)
    )]
    MapTooLarge {
        /// The scene's id.
        scene: String,
        /// Its lit pixels.
        lights: u64,
        /// Bytes that their skylines take.
        needed_bytes: u64,
        /// Bytes that they may take.
        limit_bytes: u64,
    },
    /// A stored scene that is truncated, altered or of another format.
    #[error("scene \"{scene}\": {file} {reason}; ingest the scene again")]
    Damaged {
        /// The scene's id.
        scene: String,
        /// The file inside the scene's folder.
        file: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The skylines of the lights around a place are being found, which goes on.
    #[error("the skylines of the lights around are being found: {:.0} % are there; ask again in {left_s:.0} s", 100.0 * progress)]
    SkylinesBeingFound {
        /// The part of the lights that have theirs, 0 to 1.
        progress: f64,
        /// Seconds until all have, about.
        left_s: f64,
    },
    /// A map tile that does not exist at its zoom level, or of an absurd size.
    #[error("tile {z}/{x}/{y} of {size_px} pixels does not exist: {reason}")]
    InvalidTile {
        /// Zoom level.
        z: u8,
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// Pixels a side.
        size_px: u32,
        /// Which limit it breaks.
        reason: &'static str,
    },
    /// The store that servers share does not answer.
    #[error("the store of scenes does not answer as it should: {reason}")]
    StoreAway {
        /// What happened.
        reason: String,
    },
    /// A scene that was replaced while it was put into a store.
    #[error("scene \"{id}\" was replaced while it was put into the store; put it there again")]
    ReplacedMeanwhile {
        /// The scene's id.
        id: String,
    },
    /// A scene of the store that servers share would replace one that is no copy.
    #[error(
        "scene \"{id}\" of the store is not copied: this server has another of its own by that name; remove one of them, or put this one \
         there with `skyglow push`"
    )]
    OwnScene {
        /// The scene's id.
        id: String,
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

impl SceneError {
    /// Wraps an I/O error with the path that it happened on.
    pub(crate) fn io(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, source }
    }
}
