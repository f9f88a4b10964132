//! Fraction of the 300 km disc around a place for which the raster has data, by a golden-angle spiral of equal-area samples
//! (Fibonacci lattice; Swinbank & Purser 2006).

use crate::grid::Grid;
use crate::mask::ValidMask;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::source_pixel::MAX_SOURCE_DISTANCE_M;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};
use std::sync::OnceLock;

/// Places looked at. Spread evenly over the disc, they give the fraction to about 0.002 for outlines of
/// the kind that rasters have.
const SAMPLE_COUNT: u32 = 4096;
/// The golden angle, radians: successive points of the spiral never line up.
const GOLDEN_ANGLE_RAD: f64 = 2.399_963_229_728_653;

/// A sample place of the disc in the frame of its centre.
struct Sample {
    up: f64,
    north: f64,
    east: f64,
}

/// All sample places, the same for every disc.
fn samples() -> &'static [Sample] {
    static SAMPLES: OnceLock<Vec<Sample>> = OnceLock::new();
    SAMPLES.get_or_init(|| {
        // Equal steps in 1 − cos(arc) are equal areas of the cap.
        let cap = 1.0 - (MAX_SOURCE_DISTANCE_M / EARTH_RADIUS_M).cos();
        let sample = |index: u32| {
            let drop = cap * (f64::from(index) + 0.5) / f64::from(SAMPLE_COUNT);
            let (sin_azimuth, cos_azimuth) = (f64::from(index) * GOLDEN_ANGLE_RAD).sin_cos();
            let sine = (drop * (2.0 - drop)).sqrt();
            Sample { up: 1.0 - drop, north: cos_azimuth * sine, east: sin_azimuth * sine }
        };
        (0..SAMPLE_COUNT).map(sample).collect()
    })
}

/// Covered fraction, 0..=1, by an equal-area spiral of sample places.
pub(crate) fn covered_fraction(grid: &Grid, mask: &ValidMask, place: GeoPoint) -> f64 {
    let frame = LocalFrame::at(place);
    let is_covered = |sample: &&Sample| {
        let direction = frame.up * sample.up + frame.north * sample.north + frame.east * sample.east;
        let pixel = grid.pixel_at(GeoPoint::from_vector(direction));
        pixel.is_some_and(|(column, row)| mask.is_valid(column, row))
    };
    samples().iter().filter(is_covered).count() as f64 / f64::from(SAMPLE_COUNT)
}
