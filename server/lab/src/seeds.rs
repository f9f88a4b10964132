//! What fuzzers start from where the program makes it: the smallest pack, celestial table and raster.

use crate::light_raster::LightRaster;
use serde_json::{Value, json};
use skyglow_physics::{BAND_COUNT, ELEVATION_COUNT};
use skyglow_tables::{layout::IMAGE_COUNT, resident::FREQUENCY_COUNT};

/// The description of a pack that comes with the program.
const MANIFEST: &str = include_str!("../../../precomputed/turbidity-2.50-multiple.json");

/// The description of a celestial table that comes with the program.
const CELESTIAL_MANIFEST: &str = include_str!("../../../precomputed/turbidity-2.50-celestial.json");

/// A magic, a description and its sections, as packs and celestial tables have them before their hash.
fn content_of(magic: &[u8; 8], manifest: &Value, section_bytes: &[usize]) -> Vec<u8> {
    let manifest = manifest.to_string();
    let mut content = magic.to_vec();
    content.extend((manifest.len() as u64).to_le_bytes());
    content.extend(manifest.as_bytes());
    for bytes in section_bytes {
        let packed = zstd::bulk::compress(&vec![0; *bytes], 19).unwrap_or_default();
        content.extend((packed.len() as u64).to_le_bytes());
        content.extend(packed);
    }
    content
}

/// The content of a whole celestial table with two points on each axis, all values zero; without its hash.
///
/// # Panics
/// Where the description that comes with the program cannot be read.
#[must_use]
pub fn smallest_celestial_table() -> Vec<u8> {
    let points = 2;
    let sections =
        [points * points * BAND_COUNT * points * points * 2, points * points * BAND_COUNT * 4, points * 4];
    let mut hasher = blake3::Hasher::new();
    for bytes in sections {
        hasher.update(&vec![0; bytes]);
    }
    let mut manifest: Value = serde_json::from_str(CELESTIAL_MANIFEST).unwrap_or_default();
    manifest["axes"] = json!({
        "zenith_angle_deg": [0.0, 100.0],
        "observer_altitude_m": [0.0, 4000.0],
        "elevation_deg": [0.0, 90.0],
        "azimuth_count": points,
        "direct_count": points,
    });
    manifest["checksum"] = json!(hasher.finalize().to_hex().to_string());
    content_of(b"SKYBEAM\x01", &manifest, &sections)
}

/// The content of a whole pack with one point on each axis, all values zero; without its hash.
///
/// # Panics
/// Where the description that comes with the program cannot be read.
#[must_use]
pub fn smallest_pack() -> Vec<u8> {
    let [log_scale, steps, shape, spectrum] =
        [IMAGE_COUNT * 3 * 4, IMAGE_COUNT * 3, IMAGE_COUNT * 3 * 2, ELEVATION_COUNT * FREQUENCY_COUNT * 4];
    let mut hasher = blake3::Hasher::new();
    // Steps of no coefficients say nothing, and are not among what is hashed.
    for bytes in [log_scale, shape, spectrum] {
        hasher.update(&vec![0; bytes]);
    }
    let mut manifest: Value = serde_json::from_str(MANIFEST).unwrap_or_default();
    manifest["axes"] = json!({ "distance_m": [250.0], "observer_altitude_m": [0.0], "offset_count": 3 });
    manifest["blocked"] = Value::Null;
    manifest["basis_count"] = json!(1);
    manifest["checksum"] = json!(hasher.finalize().to_hex().to_string());
    content_of(b"SKYGLOW\x01", &manifest, &[log_scale, steps, shape, spectrum])
}

/// A GeoTIFF of 8 × 8 pixels, two of them lit, that is understood.
///
/// # Panics
/// Never: it writes into memory.
#[must_use]
#[expect(clippy::panic, reason = "nothing fails in memory")]
pub fn smallest_raster() -> Vec<u8> {
    let raster = LightRaster::new((36.0, -1.0), (0.01, 0.01), (8, 8), |column, row| match (column, row) {
        (3, 3) => 12.5,
        (4, 3) => 80.0,
        _ => 0.0,
    });
    raster.to_geotiff().unwrap_or_else(|error| panic!("{error}"))
}
