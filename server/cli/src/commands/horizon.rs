//! `skyglow horizon`: the horizon of a place for planetarium and imaging programs.

use crate::{
    failure::Failure,
    flags::ProgramFlags,
    print,
    query::{self, QueryFlags},
};
use clap::Args;
use skyglow_app::{horizon_file::horizon_text, parameters::HorizonParameters, request};
use skyglow_scene::SceneId;
use std::path::PathBuf;

/// Write the horizon of a place as Stellarium or N.I.N.A. reads it: azimuth and altitude in degrees
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  skyglow horizon --scene demo --lat 46.53 --lon 8.61 --format nina -o home.hrz"
)]
pub(crate) struct Horizon {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    /// File to write; standard output without, or for -
    #[arg(short, long, env = "SKYGLOW_OUTPUT", value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    query: QueryFlags<HorizonParameters>,
    #[command(flatten)]
    program: ProgramFlags,
}

impl Horizon {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let failure = |error| query::failure(&error);
        let read = |facts: &_| request::horizon(Some(self.query.query()), facts).map_err(failure);
        read(&self.program.facts())?;
        let source = self.program.source()?;
        let asked = read(source.facts())?;
        let view = source.view(&self.scene, None).map_err(failure)?;
        request::check_terrain(view.metadata()).map_err(failure)?;
        let ground = source.site(&view, asked.place).map_err(failure)?.ground;
        let eye_m = asked.observer_height.altitude_m(ground).max(0.0);
        let horizon = view.scene().horizon(asked.place, eye_m);
        let text = horizon_text(asked.format, view.metadata(), asked.place, eye_m, &horizon);
        match &self.output {
            Some(path) if path.as_os_str() != "-" => {
                std::fs::write(path, text).map_err(|error| Failure::file(path, error))
            }
            _ => print::print_line(text.trim_end()),
        }
    }
}
