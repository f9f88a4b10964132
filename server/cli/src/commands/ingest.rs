//! `skyglow ingest`: a raster becomes a scene.

use crate::{
    failure::Failure,
    flags::{DataFlags, JsonFlags},
    print,
    progress::{self, Stages},
    report,
    table::aligned,
};
use clap::{Args, builder::BoolishValueParser};
use skyglow_scene::{
    IngestOptions, LandClasses, NoisePolicy, OverlapRule, RadianceUnit, SceneError, SceneId, SceneStore,
    SkylineTime, ingest,
};
use std::path::PathBuf;

/// Check radiance rasters and store them as a scene
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  skyglow ingest VNP46A4_2023.tif --terrain elevation.tif --id my-region --title 'My region'\n  skyglow ingest VNP46A4.A2023001.h2*v0*.h5 --id east-africa --quality 0"
)]
pub(crate) struct Ingest {
    /// Upward radiance: GeoTIFF, COG or NASA Black Marble HDF5 granules, plain or in gzip or zip; several on one grid make one scene
    /// (--overlap says what counts where several measured); also a folder, a list (.txt) or a virtual raster (.vrt) of such files
    #[arg(required = true, value_name = "FILE")]
    radiance: Vec<PathBuf>,
    /// Where several rasters have measured a pixel: first (in the order given), mean, max, or newest (by the dates in the files' names)
    /// [default: first]
    #[arg(long, env = "SKYGLOW_OVERLAP", value_name = "RULE", value_parser = OverlapRule::parse)]
    overlap: Option<OverlapRule>,
    /// Terrain, GeoTIFF or SRTM .hgt; may be given several times, the first that has a value wins
    #[arg(long, env = "SKYGLOW_TERRAIN", value_name = "FILE", value_delimiter = ',')]
    terrain: Vec<PathBuf>,
    /// Classes of land cover, GeoTIFF or COG, by which pictures light the ground; may be given several times, the first that knows a
    /// place counts
    #[arg(long = "land-cover", env = "SKYGLOW_LAND_COVER", value_name = "FILE", value_delimiter = ',')]
    land_cover: Vec<PathBuf>,
    /// Whose classes: worldcover, cci, corine or igbp [default: worldcover, where there are no others]
    #[arg(
        long,
        env = "SKYGLOW_LAND_COVER_CLASSES",
        value_name = "NAME",
        value_parser = LandClasses::parse,
        requires = "land_cover"
    )]
    land_cover_classes: Option<LandClasses>,
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
    /// Places for labels and search: GeoJSON or CSV with name, latitude, longitude and population [default: those of GeoNames]
    #[arg(long, env = "SKYGLOW_PLACES", value_name = "FILE")]
    places: Option<PathBuf>,
    /// Subdataset or band to read, by name or number
    #[arg(long, env = "SKYGLOW_BAND", value_name = "NAME|N")]
    band: Option<String>,
    /// Factor on the stored numbers [default: the file's own]
    #[arg(long, env = "SKYGLOW_SCALE", value_name = "K", allow_negative_numbers = true)]
    scale: Option<f64>,
    /// Unit of the numbers: nw-cm2-sr, uw-cm2-sr, w-cm2-sr, uw-m2-sr, mw-m2-sr or w-m2-sr [default: what the file says, else nw-cm2-sr]
    #[arg(long, env = "SKYGLOW_UNITS", value_name = "UNIT", value_parser = RadianceUnit::parse)]
    units: Option<RadianceUnit>,
    /// Stored values that are no data, beside those that the file declares
    #[arg(
        long = "nodata",
        env = "SKYGLOW_NODATA",
        value_name = "N",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    no_data: Vec<f64>,
    /// Zero is dark ground though the file declares it no data
    #[arg(long, env = "SKYGLOW_ZERO_IS_DARK", value_parser = BoolishValueParser::new())]
    zero_is_dark: bool,
    /// Radiances below this are dark, nW cm-2 sr-1
    #[arg(long = "floor", env = "SKYGLOW_FLOOR", value_name = "L", allow_negative_numbers = true)]
    floor_nw_cm2_sr: Option<f64>,
    /// Radiances above this count as this, nW cm-2 sr-1
    #[arg(long = "cap", env = "SKYGLOW_CAP", value_name = "L", allow_negative_numbers = true)]
    cap_nw_cm2_sr: Option<f64>,
    /// Raster on the radiances' grid that is 0 where what is measured is no light; one for each FILE
    #[arg(long = "mask", env = "SKYGLOW_MASK", value_name = "FILE", value_delimiter = ',')]
    masks: Vec<PathBuf>,
    /// Values of the quality layer that are taken, such as 0,1; pixels of others are no data [default: all]
    #[arg(long, env = "SKYGLOW_QUALITY", value_name = "N", value_delimiter = ',')]
    quality: Option<Vec<i64>>,
    /// Quality layer on the radiances' grid, where the granule has none of its own; one for each FILE
    #[arg(long = "quality-file", env = "SKYGLOW_QUALITY_FILE", value_name = "FILE", value_delimiter = ',')]
    quality_files: Vec<PathBuf>,
    /// Pixels with fewer observations are no data
    #[arg(long, env = "SKYGLOW_MIN_OBSERVATIONS", value_name = "N")]
    min_observations: Option<u32>,
    /// Numbers of observations on the radiances' grid, where the granule has none of its own; one for each FILE
    #[arg(
        long = "observations-file",
        env = "SKYGLOW_OBSERVATIONS_FILE",
        value_name = "FILE",
        value_delimiter = ','
    )]
    observation_files: Vec<PathBuf>,
    /// Noise around zero: balance (negative values take their part from the faintest pixels around them) or cut [default: balance]
    #[arg(long, env = "SKYGLOW_NOISE", value_name = "HOW", value_parser = NoisePolicy::parse)]
    noise: Option<NoisePolicy>,
    /// When it is found what terrain hides of each light: ingest, or need (where a place first needs it, or by `skyglow prepare`)
    /// [default: ingest, and need beyond 500 000 lights]
    #[arg(long, env = "SKYGLOW_SKYLINES", value_name = "WHEN", value_parser = SkylineTime::parse)]
    skylines: Option<SkylineTime>,
    /// Unit of the terrain, such as m or ft [default: what each file says, else m]
    #[arg(long, env = "SKYGLOW_TERRAIN_UNITS", value_name = "UNIT")]
    terrain_units: Option<String>,
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
            overlap: self.overlap.unwrap_or_default(),
            terrain: self.terrain,
            land_cover: self.land_cover,
            land_cover_classes: self.land_cover_classes,
            id: self.id,
            title: self.title,
            date: self.date,
            attribution: self.attribution,
            places: self.places,
            band: self.band,
            scale: self.scale,
            units: self.units,
            no_data: self.no_data,
            zero_is_dark: self.zero_is_dark,
            floor_nw_cm2_sr: self.floor_nw_cm2_sr,
            cap_nw_cm2_sr: self.cap_nw_cm2_sr,
            masks: self.masks,
            quality: self.quality,
            quality_files: self.quality_files,
            min_observations: self.min_observations,
            observation_files: self.observation_files,
            noise: self.noise.unwrap_or_default(),
            skylines: self.skylines,
            terrain_units: self.terrain_units,
            calibration: self.calibration,
            replace: self.replace,
            max_pixels: None,
            memory_bytes: None,
            max_scene_bytes: None,
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
        // The scene is there without: who opens it first makes it then.
        if let Err(error) = store.store_lights(&scene.id) {
            tracing::warn!("the file that its lights stay in could not be made: {error}");
        }
        if self.json.json {
            print::print_json(&scene)
        } else {
            print::print_line(&format!("scene {} ({})", scene.id, scene.title))?;
            print::print_line(aligned(&report::rows(&scene)).trim_end())
        }
    }
}
