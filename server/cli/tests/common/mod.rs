//! The built program from outside: command line, rasters to feed it, a running server.
#![allow(dead_code, reason = "each test file uses a part of this")]

pub(crate) mod geotiff;
pub(crate) mod server;

use std::{path::Path, process::Command};

/// What a finished command left.
#[derive(Debug)]
pub(crate) struct Finished {
    /// Exit status.
    pub status: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

/// The program, with none of the caller's settings.
pub(crate) fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_skyglow"));
    for (name, _) in std::env::vars_os() {
        if name.to_string_lossy().starts_with("SKYGLOW_") {
            command.env_remove(name);
        }
    }
    command.env_remove("RUST_LOG");
    command
}

/// Runs the program to its end.
pub(crate) fn skyglow(arguments: &[&str]) -> Finished {
    let output = command().args(arguments).output().unwrap();
    Finished {
        status: output.status.code().expect("ended by a signal"),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

impl Finished {
    /// Panics with all output unless the status is the one given.
    pub(crate) fn expect_status(self, status: i32) -> Self {
        assert_eq!(self.status, status, "{self:?}");
        self
    }

    /// Standard output as JSON.
    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|e| panic!("{e}: {self:?}"))
    }
}

/// A path as an argument.
pub(crate) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}
