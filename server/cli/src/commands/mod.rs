//! One file a command.

mod config;

use crate::failure::Failure;
use clap::Subcommand;
use serde::Serialize;
use std::io::Write;

/// A command of the command line.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Config(config::Config),
}

impl Command {
    /// Runs it.
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self {
            Command::Config(command) => command.run(),
        }
    }

    /// What is logged when nobody says: a server tells what it does, a command only what is odd.
    pub(crate) fn default_log_level(&self) -> &'static str {
        match self {
            _ => "warn",
        }
    }
}

/// Prints a value as indented JSON.
fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(Failure::work)?;
    print_line(&text)
}

/// Prints text and a line end; an error where standard output is gone (a closed pipe).
fn print_line(text: &str) -> Result<(), Failure> {
    writeln!(std::io::stdout(), "{text}").map_err(Failure::work)
}
