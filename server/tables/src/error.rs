//! What can go wrong with packs.

use std::path::PathBuf;
use thiserror::Error;

/// Errors of precompute and of reading packs; each names the file or parameter.
#[derive(Debug, Error)]
pub enum TablesError {
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A pack that is truncated, altered, or not a pack.
    #[error("{}: refused: {reason}", path.display())]
    Refused {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The manifest could not be written or read.
    #[error("{}: manifest: {reason}", path.display())]
    Manifest {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A turbidity by which the file names of two packs would not differ.
    #[error("turbidity is {turbidity}; allowed are two decimals at most, since packs are named by them")]
    TooManyDecimals {
        /// The turbidity.
        turbidity: f64,
    },
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] skyglow_physics::PhysicsError),
    /// The least-squares fit broke down.
    #[error("the basis fit broke down at {stage}: {reason}")]
    Fit {
        /// Step of the fit.
        stage: &'static str,
        /// What failed.
        reason: String,
    },
}

impl TablesError {
    /// The name of the file that is refused; None where it is no file's fault.
    pub fn file_name(&self) -> Option<String> {
        let (Self::Io { path, .. } | Self::Refused { path, .. } | Self::Manifest { path, .. }) = self else {
            return None;
        };
        Some(path.file_name()?.to_string_lossy().into_owned())
    }

    pub(crate) fn io(path: &std::path::Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, source }
    }
}
