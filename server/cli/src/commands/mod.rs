//! One file a command.

mod atlas;
mod bench;
mod compare;
mod config;
mod darker;
mod horizon;
mod influence;
mod ingest;
mod kept;
mod landscape;
mod night;
mod nights;
mod packs;
mod panorama;
mod plan;
mod precompute;
mod prepare;
mod push;
mod reference;
mod scenario;
mod scenes;
mod serve;
mod shares;
mod skies;
mod sky;

use crate::failure::Failure;
use clap::Subcommand;

/// A command of the command line.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Serve(Box<serve::Serve>),
    Ingest(Box<ingest::Ingest>),
    Prepare(prepare::Prepare),
    Push(push::Push),
    Scenes(scenes::Scenes),
    Precompute(precompute::Precompute),
    Packs(packs::Packs),
    Panorama(panorama::Panorama),
    Sky(sky::Sky),
    Skies(skies::Skies),
    Compare(Box<compare::Compare>),
    Night(Box<night::Night>),
    Nights(nights::Nights),
    Influence(influence::Influence),
    Shares(shares::Shares),
    Darker(darker::Darker),
    Horizon(horizon::Horizon),
    Landscape(landscape::Landscape),
    Plan(plan::Plan),
    Scenario(scenario::Scenario),
    Kept(kept::Kept),
    Atlas(atlas::Atlas),
    Reference(reference::Reference),
    Bench(bench::Bench),
    Config(config::Config),
}

impl Command {
    /// Runs it.
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self {
            Command::Serve(command) => command.run(),
            Command::Ingest(command) => command.run(),
            Command::Prepare(command) => command.run(),
            Command::Push(command) => command.run(),
            Command::Scenes(command) => command.run(),
            Command::Precompute(command) => command.run(),
            Command::Packs(command) => command.run(),
            Command::Panorama(command) => command.run(),
            Command::Sky(command) => command.run(),
            Command::Skies(command) => command.run(),
            Command::Compare(command) => command.run(),
            Command::Night(command) => command.run(),
            Command::Nights(command) => command.run(),
            Command::Influence(command) => command.run(),
            Command::Shares(command) => command.run(),
            Command::Darker(command) => command.run(),
            Command::Horizon(command) => command.run(),
            Command::Landscape(command) => command.run(),
            Command::Plan(command) => command.run(),
            Command::Scenario(command) => command.run(),
            Command::Kept(command) => command.run(),
            Command::Atlas(command) => command.run(),
            Command::Reference(command) => command.run(),
            Command::Bench(command) => command.run(),
            Command::Config(command) => command.run(),
        }
    }

    /// What is logged when nobody says: long work tells what it does, the rest only what is odd.
    pub(crate) fn default_log_level(&self) -> &'static str {
        match self {
            Command::Serve(_)
            | Command::Precompute(_)
            | Command::Reference(_)
            | Command::Bench(_)
            | Command::Atlas(_) => "info",
            _ => "warn",
        }
    }
}
