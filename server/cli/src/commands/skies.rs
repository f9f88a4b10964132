//! `skyglow skies`: the numbers of the skies of many places.

use crate::{
    failure::Failure,
    flags::ProgramFlags,
    query::{self, QueryFlags},
};
use clap::Args;
use skyglow_app::{
    parameters::SkiesParameters,
    request,
    sky_lines::{SkyTable, each_sky_line},
};
use skyglow_scene::SceneId;
use std::{
    io::{ErrorKind, Write},
    path::PathBuf,
};

/// Compute the numbers of the skies of up to 1000 places: a line of JSON for each
#[derive(Debug, Args)]
#[command(
    after_help = "Example, with {\"places\": [{\"name\": \"Locarno\", \"lat\": 46.17, \"lon\": 8.79}]} in places.json:\n  skyglow skies --scene demo --places places.json -o skies.jsonl"
)]
pub(crate) struct Skies {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    /// JSON file of the places, and perhaps times, as the API's body has them
    #[arg(long, env = "SKYGLOW_PLACES", value_name = "FILE")]
    places: PathBuf,
    /// File to write, a table where it ends with .parquet; standard output without
    #[arg(short, long, env = "SKYGLOW_OUTPUT", value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    query: QueryFlags<SkiesParameters>,
    #[command(flatten)]
    program: ProgramFlags,
}

impl Skies {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let failure = |error| query::failure(&error);
        let body = std::fs::read(&self.places).map_err(|error| Failure::file(&self.places, error))?;
        let read = |facts: &_| {
            request::skies(Some(self.query.query()), &body, self.scene.clone(), facts).map_err(failure)
        };
        read(&self.program.facts())?;
        let source = self.program.source()?;
        let asked = read(source.facts())?;
        let view = source.view(&self.scene, asked.scenario.as_ref()).map_err(failure)?;
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_time().build().map_err(Failure::work)?;
        if let Some(path) =
            self.output.as_ref().filter(|path| path.extension().is_some_and(|e| e == "parquet"))
        {
            let mut table = SkyTable::default();
            let add = async |_: f64, line: Vec<u8>| table.add(&line);
            runtime
                .block_on(each_sky_line(&source, &view, &self.scene, asked.skies, add))
                .map_err(failure)?;
            let bytes = table.encode().map_err(Failure::work)?;
            return std::fs::write(path, bytes).map_err(|error| Failure::file(path, error));
        }
        let mut output: Box<dyn Write> = match &self.output {
            Some(path) => Box::new(std::fs::File::create(path).map_err(|error| Failure::file(path, error))?),
            None => Box::new(std::io::stdout()),
        };
        let mut written = Ok(());
        let write = async |_: f64, line: Vec<u8>| {
            written = output.write_all(&line);
            written.is_ok()
        };
        let lines = each_sky_line(&source, &view, &self.scene, asked.skies, write);
        runtime.block_on(lines).map_err(failure)?;
        match written {
            // A reader that has gone away has what it wanted.
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            written => written.map_err(Failure::work),
        }
    }
}
