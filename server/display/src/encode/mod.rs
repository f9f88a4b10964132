//! Bytes of pictures and rasters. All lossless; the same input gives the same bytes.

mod exr_format;
mod hdr_format;
mod png_format;
mod sky_format;
mod tiff_format;
mod webp_format;

pub use exr_format::encode_exr;
pub use hdr_format::encode_hdr_png;
pub use png_format::{encode_png, encode_png_rgba};
pub use sky_format::{LogPlane, PointTable, STEPS_PER_E, encode_sky};
pub use tiff_format::encode_tiff;
pub use webp_format::encode_webp;

use crate::raster::FloatRaster;

/// Unit of every sample of a raster.
const RADIANCE_UNIT: &str = "W m-2 sr-1";
/// What the samples of a raster are.
const SAMPLES: &str = "Spectral-band radiance in W m-2 sr-1: R 600-700, G 500-600, B 400-500 nm; zenith at the top; \
                       0 where terrain hides the sky";
/// What the bands R, G, B of a raster hold.
const BAND_NAMES: [&str; 3] =
    ["radiance red 600-700 nm", "radiance green 500-600 nm", "radiance blue 400-500 nm"];

/// The bands of a raster, each what it holds and its unit: R, G, B, and what a response sees where one was asked for.
fn bands_of(raster: &FloatRaster<'_>) -> Vec<(String, &'static str)> {
    let colours = BAND_NAMES.iter().map(|name| (name.to_string(), RADIANCE_UNIT));
    let seen = raster.response().map(|response| (format!("seen by {}", response.name()), response.unit()));
    colours.chain(seen).collect()
}

/// What the samples of a raster are, in a sentence.
fn samples_of(raster: &FloatRaster<'_>) -> String {
    match raster.response() {
        None => SAMPLES.to_owned(),
        Some(response) => format!("{SAMPLES}; then what {} sees in {}", response.name(), response.unit()),
    }
}
