//! `skyglow influence`: which lights cause the sky of a place, to a file.

use crate::{
    failure::Failure,
    flags::ProgramFlags,
    query::{self, QueryFlags},
};
use clap::Args;
use serde_json::json;
use skyglow_app::{
    accept::InfluenceFormat,
    answers::Assumptions,
    facts::SourceFacts,
    influence_file::encode_influences,
    parameters::InfluenceParameters,
    request::{self, InfluenceListRequest},
};
use skyglow_scene::SceneId;
use std::path::PathBuf;

/// Find which lights cause the sky of a place and write them as raster, points or table
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  skyglow influence --scene demo --lat 46.17 --lon 8.79 --measure zenith -o influence.tif"
)]
pub(crate) struct Influence {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    /// File to write; its ending says the format: .tif for all pixels, .json, .geojson or .csv for the most influential
    #[arg(short, long, env = "SKYGLOW_OUTPUT", value_name = "FILE", value_parser = output)]
    output: Output,
    /// GeoJSON file of an area: the .json says how much comes from inside it
    #[arg(long, env = "SKYGLOW_BOUNDARY", value_name = "FILE")]
    boundary: Option<PathBuf>,
    #[command(flatten)]
    query: QueryFlags<InfluenceParameters>,
    #[command(flatten)]
    program: ProgramFlags,
}

/// A file of pixels.
#[derive(Clone, Debug)]
pub(super) struct Output {
    pub(super) path: PathBuf,
    pub(super) format: InfluenceFormat,
}

/// A file by its name, whose ending is that of a format.
pub(super) fn output(text: &str) -> Result<Output, String> {
    let path = PathBuf::from(text);
    let format = match path.extension().and_then(|extension| extension.to_str()) {
        Some("json") => InfluenceFormat::Json,
        Some("tif" | "tiff") => InfluenceFormat::Tiff,
        Some("geojson") => InfluenceFormat::GeoJson,
        Some("csv") => InfluenceFormat::Csv,
        _ => return Err("the ending must be .json, .tif, .geojson or .csv".to_owned()),
    };
    Ok(Output { path, format })
}

impl Influence {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let body = self.body()?;
        self.request(body.as_deref(), &self.program.facts())?;
        let source = self.program.source()?;
        let request = self.request(body.as_deref(), source.facts())?;
        let (of_sky, failure) = (&request.request.sky, |error| query::failure(&error));
        let view = source.view(&of_sky.scene, of_sky.scenario.as_ref()).map_err(failure)?;
        if let Some(area) = &request.boundary {
            area.check_within(view.metadata().bounds).map_err(failure)?;
        }
        let map = source.influence(&request.request, &view, &|_| true).map_err(failure)?;
        let assumptions = Assumptions::of_influences(&request.request, &map, source.facts());
        // A raster or a table is not read for them.
        for warning in &assumptions.warnings {
            tracing::warn!("{warning}");
        }
        let bytes =
            encode_influences(assumptions, &map, &request, self.output.format).map_err(Failure::work)?;
        let path = &self.output.path;
        std::fs::write(path, bytes).map_err(|error| Failure::file(path, error))
    }

    fn request(&self, body: Option<&[u8]>, facts: &SourceFacts) -> Result<InfluenceListRequest, Failure> {
        let (query, scene) = (Some(self.query.query()), self.scene.clone());
        request::influence(query, body, scene, facts, self.output.format).map_err(|e| query::failure(&e))
    }

    /// The boundary as the API's body has it.
    fn body(&self) -> Result<Option<Vec<u8>>, Failure> {
        let Some(path) = &self.boundary else { return Ok(None) };
        let bytes = std::fs::read(path).map_err(|error| Failure::file(path, error))?;
        let boundary: serde_json::Value = serde_json::from_slice(request::without_byte_order_mark(&bytes))
            .map_err(|error| {
                let reason = request::other_format(&bytes).unwrap_or_else(|| error.to_string());
                Failure::Usage(format!("{}: {reason}", path.display()))
            })?;
        serde_json::to_vec(&json!({ "boundary": boundary })).map(Some).map_err(Failure::work)
    }
}
