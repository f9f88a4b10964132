//! The rows of the sky in which near lights may be visible, and how large their part of it must be.

use skyglow_physics::{AZIMUTH_COUNT, ELEVATION_COUNT, panorama::elevation_rad};
use std::{f32::consts::TAU, sync::LazyLock};

/// A light's peak counts in full from twice this part of the sky's radiance on, and not at all below it.
pub(crate) const MIN_SHARE: f32 = 0.002;
/// Lights this many rows up (45°) count for nothing: no ridge stands there.
pub(crate) const MAX_ROW: f32 = 32.0;
/// Rows in which lights may be visible.
pub(crate) const LOW_ROWS: usize = MAX_ROW as usize + 2;

/// Columns a radian: which column a light is in must be one number everywhere.
pub(crate) const PER_COLUMN: f32 = AZIMUTH_COUNT as f32 / TAU;

/// Sine and cosine of the elevation of every row.
pub(crate) static ROWS: LazyLock<[[f32; 2]; ELEVATION_COUNT]> = LazyLock::new(|| {
    std::array::from_fn(|row| {
        let (sin, cos) = elevation_rad(row).sin_cos();
        [sin as f32, cos as f32]
    })
});
