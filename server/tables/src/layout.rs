//! Memory layout of images of single sources.

use skyglow_physics::{BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT};

/// Columns computed of an image: azimuths 0..=180° from the source; the other half mirrors them.
pub const HALF_COLUMN_COUNT: usize = 129;
/// Samples of an image, `[row][column]`.
pub const PIXEL_COUNT: usize = ELEVATION_COUNT * HALF_COLUMN_COUNT;
/// Images of one geometry, `[lobe][band]`.
pub const IMAGE_COUNT: usize = LOBE_COUNT * BAND_COUNT;
/// Position of an image in `[lobe][band]` order.
pub const fn image_index(lobe: usize, band: usize) -> usize {
    lobe * BAND_COUNT + band
}
