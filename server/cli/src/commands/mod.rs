//! One file a command.

mod atlas;
mod bench;
mod config;
mod influence;
mod ingest;
mod kept;
mod packs;
mod panorama;
mod plan;
mod precompute;
mod reference;
mod scenario;
mod scenes;
mod serve;
mod sky;

use crate::{failure::Failure, query};
use clap::Subcommand;
use serde::Serialize;
use skyglow_app::{
    SkySource,
    answers::Assumptions,
    source::{RenderedSky, SkyQuery},
};
use skyglow_physics::{PhysicsError, Turbidity};
use std::{
    io::{ErrorKind, Write},
    sync::Arc,
};

/// A command of the command line.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Serve(Box<serve::Serve>),
    Ingest(ingest::Ingest),
    Scenes(scenes::Scenes),
    Precompute(precompute::Precompute),
    Packs(packs::Packs),
    Panorama(panorama::Panorama),
    Sky(sky::Sky),
    Influence(influence::Influence),
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
            Command::Scenes(command) => command.run(),
            Command::Precompute(command) => command.run(),
            Command::Packs(command) => command.run(),
            Command::Panorama(command) => command.run(),
            Command::Sky(command) => command.run(),
            Command::Influence(command) => command.run(),
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

/// Renders a sky, as the API does.
fn rendered(source: &dyn SkySource, sky: SkyQuery) -> Result<(Assumptions, RenderedSky), Failure> {
    let site = source
        .site(&sky.scene, sky.scenario.as_ref(), sky.place)
        .map_err(|error| query::failure(&error.at(sky.place)))?;
    let sky = Arc::new(sky);
    let runtime = tokio::runtime::Builder::new_current_thread().build().map_err(Failure::work)?;
    let rendered =
        runtime.block_on(source.sky(sky.clone())).map_err(|error| query::failure(&error.of_sky(&sky)))?;
    Ok((Assumptions::new(&sky, &site.scene, &rendered.context, source.facts()), rendered))
}

/// A turbidity of the model, from text.
fn turbidity(text: &str) -> Result<Turbidity, String> {
    let number: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    Turbidity::new(number).map_err(|error: PhysicsError| error.to_string())
}

/// A share of light that ground sends back, from text.
fn albedo(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|albedo| (0.0..=1.0).contains(albedo)).ok_or("allowed is 0 to 1".to_owned())
}

/// Prints a value as indented JSON.
fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(Failure::work)?;
    print_line(&text)
}

/// Prints text and a line end. A reader that has gone away (`skyglow scenes | head`) has what it wanted.
fn print_line(text: &str) -> Result<(), Failure> {
    match writeln!(std::io::stdout(), "{text}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::work(error)),
        _ => Ok(()),
    }
}
