//! Why a bench cannot be run.

use skyglow_physics::PhysicsError;
use skyglow_render::RenderError;
use skyglow_scene::SceneError;
use std::path::{Path, PathBuf};

/// Why a bench cannot be run, in one line.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// Nothing to render from.
    #[error("there are no table packs of a clear sky: `skyglow precompute` makes them")]
    NoClearPacks,
    /// No executor could be timed.
    #[error("nothing renders here: {reason}")]
    NothingRenders {
        /// What each of them said.
        reason: String,
    },
    /// The engine refuses or fails.
    #[error(transparent)]
    Engine(#[from] RenderError),
    /// The demo cannot be made or opened.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A quantity out of range.
    #[error(transparent)]
    Physics(#[from] PhysicsError),
    /// A file that cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A reference file that is none.
    #[error("{path}: {reason}")]
    Reference {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A plot that cannot be drawn.
    #[error("{path}: the plot cannot be drawn: {reason}")]
    Plot {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

impl BenchError {
    /// For `map_err` on work with a file.
    pub(crate) fn file(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        move |source| Self::File { path: path.to_owned(), source }
    }
}
