//! One file a command.

mod config;
mod ingest;
mod packs;
mod precompute;
mod scenes;

use crate::failure::Failure;
use clap::Subcommand;
use serde::Serialize;
use skyglow_physics::{PhysicsError, Turbidity};
use std::io::Write;

/// A command of the command line.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Ingest(ingest::Ingest),
    Scenes(scenes::Scenes),
    Precompute(precompute::Precompute),
    Packs(packs::Packs),
    Config(config::Config),
}

impl Command {
    /// Runs it.
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self {
            Command::Ingest(command) => command.run(),
            Command::Scenes(command) => command.run(),
            Command::Precompute(command) => command.run(),
            Command::Packs(command) => command.run(),
            Command::Config(command) => command.run(),
        }
    }

    /// What is logged when nobody says: long work tells what it does, the rest only what is odd.
    pub(crate) fn default_log_level(&self) -> &'static str {
        match self {
            Command::Precompute(_) => "info",
            _ => "warn",
        }
    }
}

/// A turbidity of the model, from text.
fn turbidity(text: &str) -> Result<Turbidity, String> {
    let number: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    Turbidity::new(number).map_err(|error: PhysicsError| error.to_string())
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
