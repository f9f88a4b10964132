//! How a command ends when it does not succeed.

use std::process::ExitCode;

/// Why a command did not do its work; its text is the one line that the user reads.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// What was asked for makes no sense: exit status 2.
    #[error("{0}")]
    Usage(String),
    /// What was asked for could not be done: exit status 1.
    #[error("{0}")]
    Work(String),
}

impl Failure {
    /// The exit status.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Failure::Usage(_) => ExitCode::from(2),
            Failure::Work(_) => ExitCode::from(1),
        }
    }

    /// The work failed with this error.
    pub(crate) fn work(error: impl std::fmt::Display) -> Self {
        Failure::Work(error.to_string())
    }

    /// The work failed with this error on this file.
    pub(crate) fn file(path: &std::path::Path, error: impl std::fmt::Display) -> Self {
        Failure::Work(format!("{}: {error}", path.display()))
    }
}
