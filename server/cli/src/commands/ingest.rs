//! `skyglow ingest`: a raster becomes a scene.

use crate::{
    failure::Failure,
    flags::{DataFlags, JsonFlags},
    progress::{self, Stages},
    report,
    table::aligned,
};
use clap::{Args, builder::BoolishValueParser};
use skyglow_scene::{IngestOptions, RadianceUnit, SceneError, SceneId, SceneStore, ingest};
use std::path::PathBuf;

/// Check a radiance raster and store it as a scene
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  skyglow ingest VNP46A4_2023.tif --terrain elevation.tif --id my-region --title 'My region'"
)]
pub(crate) struct Ingest {
    /// Upward radiance: GeoTIFF, COG, or a NASA Black Marble HDF5 granule
    radiance: PathBuf,
    /// Terrain, GeoTIFF or SRTM .hgt; may be given several times, the first that has a value wins
    #[arg(long, env = "SKYGLOW_TERRAIN", value_name = "FILE", value_delimiter = ',')]
    terrain: Vec<PathBuf>,
    /// Id of the scene, 1 to 64 of a-z, 0-9 and - [default: made from the file's name]
    #[arg(long, env = "SKYGLOW_ID", value_parser = SceneId::parse)]
    id: Option<SceneId>,
    /// Title for people [default: the id]
    #[arg(long, env = "SKYGLOW_TITLE")]
    title: Option<String>,
    /// When the radiances were taken: 2023, 2023-05, 2023-05-17, 2023-05-17T01:30:00Z, or a span such as 2023-01/2023-12
    #[arg(long, env = "SKYGLOW_DATE")]
    date: Option<String>,
    /// Whom to credit
    #[arg(long, env = "SKYGLOW_ATTRIBUTION")]
    attribution: Option<String>,
    /// Places for labels and search: GeoJSON or CSV with name, latitude, longitude and population
    #[arg(long, env = "SKYGLOW_PLACES", value_name = "FILE")]
    places: Option<PathBuf>,
    /// Subdataset or band to read, by name or number
    #[arg(long, env = "SKYGLOW_BAND", value_name = "NAME|N")]
    band: Option<String>,
    /// Factor on the stored numbers [default: the file's own]
    #[arg(long, env = "SKYGLOW_SCALE", value_name = "K", allow_negative_numbers = true)]
    scale: Option<f64>,
    /// Unit of the numbers: nw-cm2-sr or w-m2-sr [default: nw-cm2-sr]
    #[arg(long, env = "SKYGLOW_UNITS", value_name = "UNIT", value_parser = RadianceUnit::parse)]
    units: Option<RadianceUnit>,
    /// Factor on every radiance that is kept with the scene and shown with every answer
    #[arg(
        long,
        env = "SKYGLOW_CALIBRATION",
        value_name = "K",
        default_value_t = 1.0,
        allow_negative_numbers = true
    )]
    calibration: f64,
    /// Overwrite the scene of that id
    #[arg(long, env = "SKYGLOW_REPLACE", value_parser = BoolishValueParser::new())]
    replace: bool,
    #[command(flatten)]
    data: DataFlags,
    #[command(flatten)]
    json: JsonFlags,
}

impl Ingest {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let store = SceneStore::new(self.data.folder());
        let options = IngestOptions {
            radiance: self.radiance,
            terrain: self.terrain,
            id: self.id,
            title: self.title,
            date: self.date,
            attribution: self.attribution,
            places: self.places,
            band: self.band,
            scale: self.scale,
            units: self.units,
            calibration: self.calibration,
            replace: self.replace,
            max_pixels: None,
        };
        let stages = Stages::new();
        let scene = ingest(&store, &options, &mut progress::of_ingest(&stages));
        drop(stages);
        let scene = scene.map_err(|error| match error {
            SceneError::InvalidOption { .. } | SceneError::InvalidId { .. } => {
                Failure::Usage(error.to_string())
            }
            error => Failure::work(error),
        })?;
        if self.json.json {
            super::print_json(&scene)
        } else {
            super::print_line(&format!("scene {} ({})", scene.id, scene.title))?;
            super::print_line(aligned(&report::rows(&scene)).trim_end())
        }
    }
}
