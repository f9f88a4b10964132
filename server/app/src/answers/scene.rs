//! Scenes and their places.

use crate::format::rfc3339;
use serde::Serialize;
use skyglow_scene::SceneMetadata;
use utoipa::ToSchema;

/// A scene.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SceneAnswer {
    /// Its name in URLs.
    pub id: String,
    /// Its name for people.
    pub title: String,
    /// West, south, east, north, degrees; west > east across the antimeridian.
    pub bounds: [f64; 4],
    /// The raster's own grid.
    pub grid: GridAnswer,
    /// Short name of the CRS.
    pub crs: String,
    /// Factor on the raster's radiances.
    pub calibration: f64,
    /// What the ingest saw: counts of lit, zero, negative, NaN, infinite, no-data and capped pixels with examples,
    /// the range, terrain under the lights, warnings.
    #[schema(value_type = Object)]
    pub report: serde_json::Value,
    /// Side of a square with the area of the middle pixel, metres.
    pub pixel_size_m: f64,
    /// Pixels with light.
    pub lit_pixels: u64,
    /// When the radiances were taken.
    pub date: Option<String>,
    /// Whom to credit.
    pub attribution: Option<String>,
    /// True for made-up light that only shows what the program does.
    pub illustrative: bool,
    /// Whether the scene has terrain.
    pub terrain: bool,
    /// Whether it is known what covers the ground; pictures light it by that.
    pub land_cover: bool,
    /// Number of named places.
    pub places_count: u64,
    /// Whom to credit for the places, where the scene brought none of its own.
    pub places_source: Option<String>,
    /// When it was ingested, RFC 3339 UTC; null for the demo and for scenes stored before this was noted.
    pub ingested: Option<String>,
    /// Hash over all that the scene holds.
    pub version: String,
}

/// A raster's grid.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct GridAnswer {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// GDAL's six coefficients.
    pub geotransform: [f64; 6],
    /// The CRS as WKT.
    pub crs_wkt: String,
}

impl From<SceneMetadata> for SceneAnswer {
    fn from(scene: SceneMetadata) -> Self {
        Self {
            id: scene.id.into(),
            title: scene.title,
            bounds: scene.bounds,
            grid: GridAnswer {
                width: scene.grid.width,
                height: scene.grid.height,
                geotransform: scene.grid.geotransform,
                crs_wkt: scene.grid.crs_wkt,
            },
            crs: scene.crs,
            calibration: scene.calibration,
            report: serde_json::to_value(scene.report).unwrap_or_default(),
            pixel_size_m: scene.pixel_size_m,
            lit_pixels: scene.lit_pixels,
            date: scene.date,
            attribution: scene.attribution,
            illustrative: scene.illustrative,
            terrain: scene.terrain,
            land_cover: scene.land_cover,
            places_count: scene.places_count,
            places_source: scene.places_source,
            ingested: scene.ingested_unix_s.map(rfc3339),
            version: scene.version,
        }
    }
}

/// The scene that an answer was made from.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SceneReference {
    /// Its name in URLs.
    pub id: String,
    /// Hash over all that it holds.
    pub version: String,
    /// True for made-up light.
    pub illustrative: bool,
    /// Whom to credit.
    pub attribution: Option<String>,
}

impl From<&SceneMetadata> for SceneReference {
    fn from(scene: &SceneMetadata) -> Self {
        Self {
            id: scene.id.to_string(),
            version: scene.version.clone(),
            illustrative: scene.illustrative,
            attribution: scene.attribution.clone(),
        }
    }
}
