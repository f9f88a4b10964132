//! `skyglow panorama`: the sky of a place, to a file.

use crate::{
    failure::Failure,
    flags::ProgramFlags,
    query::{self, QueryFlags},
    render::{self, Rendered},
};
use clap::Args;
use skyglow_app::{accept::Format, drawing::draw, parameters::PanoramaParameters, request};
use skyglow_scene::SceneId;
use std::path::PathBuf;

/// Compute the sky of a place and write it as picture, raster or JSON
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  skyglow panorama --scene demo --lat 46.17 --lon 8.79 --projection fisheye -o sky.png"
)]
pub(crate) struct Panorama {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    /// File to write; its ending says the format: .png, .webp, .exr, .tif, .json or .sky
    #[arg(short, long, env = "SKYGLOW_OUTPUT", value_name = "FILE", value_parser = output)]
    output: Output,
    #[command(flatten)]
    query: QueryFlags<PanoramaParameters>,
    #[command(flatten)]
    program: ProgramFlags,
}

#[derive(Clone, Debug)]
struct Output {
    path: PathBuf,
    format: Format,
}

fn output(text: &str) -> Result<Output, String> {
    let path = PathBuf::from(text);
    let format = match path.extension().and_then(|extension| extension.to_str()) {
        Some("png") => Format::Png,
        Some("webp") => Format::WebP,
        Some("exr") => Format::Exr,
        Some("tif" | "tiff") => Format::Tiff,
        Some("json") => Format::Json,
        Some("sky") => Format::Sky,
        _ => return Err("the ending must be .png, .webp, .exr, .tif, .json or .sky".to_owned()),
    };
    Ok(Output { path, format })
}

impl Panorama {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let read = |facts: &_| {
            request::panorama(Some(self.query.query()), self.scene.clone(), facts, self.output.format)
                .map_err(|e| query::failure(&e))
        };
        read(&self.program.facts())?;
        let source = self.program.source()?;
        let (request, picture) = read(source.facts())?;
        let Rendered { request, view, assumptions, sky } =
            render::rendered_of_scene(source.as_ref(), request)?;
        // A picture cannot say it.
        for warning in &assumptions.warnings {
            tracing::warn!("{warning}");
        }
        let bytes = draw(assumptions, (&request, &view), &sky, &picture, self.output.format)
            .map_err(Failure::work)?;
        let path = &self.output.path;
        std::fs::write(path, bytes).map_err(|error| Failure::file(path, error))
    }
}
