//! `skyglow landscape`: a place as a landscape of Stellarium.

use crate::{
    failure::Failure,
    flags::ProgramFlags,
    query::{self, QueryFlags},
    render,
};
use clap::Args;
use skyglow_app::{horizon_file::stellarium_landscape, parameters::LandscapeParameters, request};
use skyglow_scene::SceneId;
use std::path::PathBuf;

/// Write a landscape for Stellarium, a zip archive to install as it is: horizon, position, artificial light and extinction
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow landscape --scene demo --lat 46.53 --lon 8.61 -o valley.zip")]
pub(crate) struct Landscape {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    /// File to write
    #[arg(short, long, env = "SKYGLOW_OUTPUT", value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    query: QueryFlags<LandscapeParameters>,
    #[command(flatten)]
    program: ProgramFlags,
}

impl Landscape {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let failure = |error| query::failure(&error);
        let read = |facts: &_| {
            request::landscape(Some(self.query.query()), self.scene.clone(), facts).map_err(failure)
        };
        read(&self.program.facts())?;
        let source = self.program.source()?;
        let request = read(source.facts())?;
        let view = source.view(&request.scene, request.scenario.as_ref()).map_err(failure)?;
        request::check_terrain(view.metadata()).map_err(failure)?;
        let place = request.place;
        let (assumptions, sky) = render::rendered(source.as_ref(), request)?;
        for warning in &assumptions.warnings {
            tracing::warn!("{warning}");
        }
        let archive = stellarium_landscape(view.metadata(), place, &sky).map_err(Failure::work)?;
        std::fs::write(&self.output, archive).map_err(|error| Failure::file(&self.output, error))
    }
}
