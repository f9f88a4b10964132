//! What the server holds and how it is: packs, map tiles, health.

use serde::Serialize;
use utoipa::ToSchema;

/// A resident table pack.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AtmosphereAnswer {
    /// Its turbidity.
    pub turbidity: f64,
    /// `single`: first order alone; `multiple`: all orders, with light that the ground sends back.
    pub scattering: String,
    /// Lambertian albedo of that ground; null where scattering is single.
    pub ground_albedo: Option<f64>,
    /// Base of the closed layer of cloud above sea level, metres; null under a clear sky.
    pub cloud_base_m: Option<u32>,
    /// Albedo of that base from below, of light that goes straight up; null under a clear sky.
    pub cloud_albedo: Option<f64>,
    /// Wavelengths of the bands, nm.
    pub bands_nm: Vec<f64>,
    /// Lowest and highest observer altitude, metres.
    pub observer_altitude_m: [f64; 2],
    /// Lowest and highest source altitude, metres.
    pub source_altitude_m: [f64; 2],
    /// Nearest and farthest source, metres.
    pub distance_m: [f64; 2],
    /// Basis functions.
    pub basis_count: usize,
    /// Checksum of the pack.
    pub checksum: String,
    /// Measured relative error of the images of single sources.
    #[schema(value_type = Option<Object>)]
    pub measured_error: Option<serde_json::Value>,
}

/// TileJSON 3.0.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct TileJson {
    /// `3.0.0`.
    pub tilejson: String,
    /// The layer.
    pub name: String,
    /// What the colours mean.
    pub description: String,
    /// Whom to credit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub attribution: Option<String>,
    /// The scene's version.
    pub version: String,
    /// `xyz`.
    pub scheme: String,
    /// Unit of what the colours stand for.
    pub unit: String,
    /// What the darkest and the brightest colour stand for, logarithmic between; null where colours are tints.
    pub range: Option<[f64; 2]>,
    /// Of `brightness`, what the response sees of the dark reference outside the air, which its colours go by; absent for other layers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub natural: Option<f64>,
    /// Whether tiles are answered at once; until then they wait for what they show to be found. Ask again to know.
    pub ready: bool,
    /// The part that is found, 0 to 1, where tiles are not ready.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub progress: Option<f64>,
    /// URL templates with `{z}`, `{x}`, `{y}`.
    pub tiles: Vec<String>,
    /// Pixels a side of these tiles; `{y}@2x` in place of `{y}` gives twice as many.
    #[serde(rename = "tileSize")]
    pub tile_size: u32,
    /// Lowest zoom level.
    pub minzoom: u8,
    /// Highest zoom level with detail of its own.
    pub maxzoom: u8,
    /// West, south, east, north, degrees.
    pub bounds: [f64; 4],
    /// Longitude, latitude and zoom level to start at.
    pub center: [f64; 3],
}

/// Whether the server lives or is ready.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct HealthAnswer {
    /// `ok`, or `starting` while tables or device are not ready.
    pub status: String,
    /// What renders: `gpu`, `lavapipe` or `cpu`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub executor: Option<String>,
    /// File names of table packs that are left out because they are damaged.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub packs_left_out: Vec<String>,
    /// Ids of scenes that are left out because they are damaged.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scenes_left_out: Vec<String>,
}
