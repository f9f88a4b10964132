//! The metadata of a scene: `metadata.json`, and the answer of the scenes resource.

use crate::scene_id::SceneId;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};

/// A stored scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneMetadata {
    /// Its name in URLs and on the command line.
    pub id: SceneId,
    /// Its name for people.
    pub title: String,
    /// West, south, east, north, degrees; west > east across the antimeridian.
    pub bounds: [f64; 4],
    /// The raster's own grid; exports come back on it.
    pub grid: GridMetadata,
    /// Short name of the CRS, such as `WGS 84`.
    pub crs: String,
    /// Factor on the raster's radiances, applied to every flux.
    pub calibration: f64,
    /// What the ingest saw.
    pub report: IngestReport,
    /// Side of a square with the area of the middle pixel, metres.
    pub pixel_size_m: f64,
    /// Pixels with light.
    pub lit_pixels: u64,
    /// When the radiances were taken, as given.
    pub date: Option<String>,
    /// Whom to credit, as given.
    pub attribution: Option<String>,
    /// True for synthetic light that only demonstrates the program.
    pub illustrative: bool,
    /// Whether the scene has terrain.
    pub terrain: bool,
    /// Whether it is known which lights the terrain hides: true for scenes with terrain, but for those stored before
    /// the skylines of lights were (ingest such a scene again), and false without terrain, which hides nothing.
    /// Left out where false, as in those older scenes.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub light_skylines: bool,
    /// Whether it has land cover, by which pictures light the ground. Left out where it has none.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub land_cover: bool,
    /// Number of places with names.
    pub places_count: u64,
    /// Whom to credit for the places, where the scene brought none of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub places_source: Option<String>,
    /// When it was ingested, seconds since 1970 UTC; None for the demo, which is the same whenever it is made, and for scenes that were
    /// stored before this was noted. Not in the hash.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ingested_unix_s: Option<u64>,
    /// Hash over all that the scene holds; changes when anything of it does.
    pub version: String,
}

/// Whether bounds hold a place: west, south, east, north, degrees; west > east across the antimeridian.
pub fn is_within([west, south, east, north]: [f64; 4], latitude_deg: f64, longitude_deg: f64) -> bool {
    let is_between = if west <= east {
        (west..=east).contains(&longitude_deg)
    } else {
        longitude_deg >= west || longitude_deg <= east
    };
    is_between && (south..=north).contains(&latitude_deg)
}

/// Whether a direction lies within bounds in degrees, as for [`is_within`], or not farther than so many metres from them.
pub(crate) fn is_within_margin(
    [west, south, east, north]: [f64; 4],
    direction: DVec3,
    margin_m: f64,
) -> bool {
    let place = GeoPoint::from_vector(direction);
    let margin_deg = (margin_m / EARTH_RADIUS_M).to_degrees();
    let highest_deg = place.latitude_deg().abs() + margin_deg;
    // Meridians converge: around a pole the margin is all of them.
    let along_deg = if highest_deg < 89.0 { margin_deg / highest_deg.to_radians().cos() } else { 180.0 };
    let span_deg = if west <= east { east - west } else { east - west + 360.0 };
    let from_west_deg = (place.longitude_deg() - (west - along_deg)).rem_euclid(360.0);
    let is_between = span_deg + 2.0 * along_deg >= 360.0 || from_west_deg <= span_deg + 2.0 * along_deg;
    is_between && (south - margin_deg..=north + margin_deg).contains(&place.latitude_deg())
}

/// The raster's own grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GridMetadata {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// GDAL's six coefficients: x = g0 + column·g1 + row·g2, y = g3 + column·g4 + row·g5.
    pub geotransform: [f64; 6],
    /// The CRS as WKT.
    pub crs_wkt: String,
}

/// What an ingest saw in the radiance raster.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct IngestReport {
    /// Pixels in the raster.
    pub pixels: u64,
    /// Pixels with light.
    pub lit: PixelCount,
    /// Pixels that are exactly zero.
    pub zero: PixelCount,
    /// Pixels below zero: no light.
    pub negative: PixelCount,
    /// Pixels that are NaN though the raster's no-data value is another: no light, no data.
    pub nan: PixelCount,
    /// Pixels that are infinite, or too large for a float: no light, no data. Left out where there are none,
    /// as in scenes that were stored before these were counted apart.
    #[serde(default, skip_serializing_if = "PixelCount::is_none")]
    pub infinite: PixelCount,
    /// Pixels at the raster's no-data value or masked.
    pub no_data: PixelCount,
    /// Pixels with a value that fills gaps though nobody declares it: no light, no data.
    #[serde(default, skip_serializing_if = "PixelCount::is_none")]
    pub fill: PixelCount,
    /// Pixels that a quality or observation layer refuses: no light, no data.
    #[serde(default, skip_serializing_if = "PixelCount::is_none")]
    pub rejected: PixelCount,
    /// Pixels at exactly the largest value, where those are suspiciously many.
    pub capped: PixelCount,
    /// Lit pixels that have no place on Earth in the raster's CRS: left out.
    pub outside_world: PixelCount,
    /// Smallest measured value, nW cm⁻² sr⁻¹.
    pub minimum_nw_cm2_sr: f64,
    /// Largest measured value, nW cm⁻² sr⁻¹.
    pub maximum_nw_cm2_sr: f64,
    /// Mean over the lit pixels, nW cm⁻² sr⁻¹.
    pub lit_mean_nw_cm2_sr: f64,
    /// Upward flux of all lit pixels, DNB watts, calibration included.
    pub flux_dnb_w: f64,
    /// The part of the file that was read: subdataset or band.
    pub band: String,
    /// Factor from stored numbers to nW cm⁻² sr⁻¹.
    pub scale: f64,
    /// Added after the factor, nW cm⁻² sr⁻¹.
    pub offset_nw_cm2_sr: f64,
    /// Terrain under the lit pixels; none without terrain files.
    pub terrain: Option<TerrainReport>,
    /// Radiance rasters that the scene is made of; left out where it is one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<String>,
    /// What was recognised of the files, and how sure that is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub recognised: Vec<Recognition>,
    /// Noise around zero and what became of it; none where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<NoiseReport>,
    /// What looks wrong without being a reason to refuse, one sentence each.
    pub warnings: Vec<String>,
}

/// Something that was recognised of a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recognition {
    /// What: `product`, `unit`, `scale`, `date` and the like.
    pub what: String,
    /// As what, and by what.
    pub value: String,
    /// How sure that is.
    pub confidence: Confidence,
}

/// How sure something that was recognised is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Confidence {
    /// The file says it.
    Certain,
    /// The file's name or its numbers say it.
    Likely,
    /// Nothing says otherwise.
    Assumed,
}

impl Recognition {
    /// What the file says itself.
    pub(crate) fn certain(what: &str, value: String) -> Self {
        Self { what: what.to_owned(), value, confidence: Confidence::Certain }
    }

    /// What the file's name or its numbers say.
    pub(crate) fn likely(what: &str, value: String) -> Self {
        Self { what: what.to_owned(), value, confidence: Confidence::Likely }
    }

    /// What nothing contradicts.
    pub(crate) fn assumed(what: &str, value: String) -> Self {
        Self { what: what.to_owned(), value, confidence: Confidence::Assumed }
    }
}

/// Noise around zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseReport {
    /// Standard deviation by the negative values, nW cm⁻² sr⁻¹.
    pub deviation_nw_cm2_sr: f64,
    /// By how much the light of all pixels together would be too bright were negative values cut alone, as a factor.
    pub bias: f64,
    /// Whether negative values were balanced against the faintest pixels around them.
    pub balanced: bool,
    /// Pixels that became dark by that.
    pub darkened: u64,
}

/// A number of pixels, and where the first few of them are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PixelCount {
    /// How many.
    pub count: u64,
    /// Centres of a few of them, spread over the raster.
    pub examples: Vec<ExamplePlace>,
}

impl SceneMetadata {
    /// Whether the terrain may block lights and their skylines are missing: the scene is of format 1 and has to be ingested
    /// again.
    pub fn lacks_light_skylines(&self) -> bool {
        self.terrain && !self.light_skylines
    }
}

impl PixelCount {
    /// Whether there are no such pixels.
    fn is_none(&self) -> bool {
        self.count == 0
    }
}

/// Centre of a pixel named as an example.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExamplePlace {
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
}

/// Terrain at the lit pixels.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TerrainReport {
    /// Terrain files read.
    pub files: u64,
    /// Units of files that are not in metres; left out where all are.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub units: Vec<String>,
    /// Lit pixels with terrain at their centre.
    pub covered: u64,
    /// Lit pixels that took the nearest valid elevation within 5 km.
    pub nearest: PixelCount,
    /// Lit pixels without terrain within 5 km: taken at sea level.
    pub missing: PixelCount,
    /// Lit pixels below sea level: taken at sea level.
    pub below_sea_level: u64,
    /// Void samples in the terrain files.
    pub void_samples: u64,
    /// Lowest elevation in the terrain files, metres.
    pub minimum_m: f64,
    /// Highest elevation in the terrain files, metres.
    pub maximum_m: f64,
}

/// A named place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema), schema(as = PlaceAnswer))]
pub struct NamedPlace {
    /// Its name.
    pub name: String,
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east, −180..180.
    pub longitude_deg: f64,
    /// Inhabitants, where known.
    pub population: Option<u64>,
}
