//! Looking around from each lit pixel for terrain that hides its light.

use super::options::{IngestProgress, IngestStage};
use crate::grid::Grid;
use crate::lit_pixels::LitPixels;
use crate::morton;
use crate::skylines::{OPEN_TANGENT, SKYLINE_AZIMUTH_COUNT, SKYLINE_REACHES_M, Skyline, Skylines, code_of};
use crate::terrain::{Terrain, nearest_wall_m};
use rayon::prelude::*;
use skyglow_physics::GeoPoint;
use std::f64::consts::TAU;

/// Pixels between two reports of progress.
const PIXELS_AT_ONCE: usize = 4_096;

/// The skyline of each lit pixel, from its centre at its altitude; None without terrain. On as many threads as there
/// are cores.
pub(super) fn of_lights(
    terrain: &Terrain,
    grid: &Grid,
    pixels: &LitPixels,
    progress: &mut dyn FnMut(IngestProgress),
) -> Option<Skylines> {
    if terrain.is_empty() {
        return None;
    }
    let total = pixels.len();
    let mut skylines = Skylines::default();
    for first in (0..total).step_by(PIXELS_AT_ONCE) {
        progress(IngestProgress { stage: IngestStage::Skyline, done: first as u64, total: total as u64 });
        let end = (first + PIXELS_AT_ONCE).min(total);
        let found: Vec<Skyline> =
            (first..end).into_par_iter().map(|index| skyline(terrain, grid, pixels, index)).collect();
        found.iter().for_each(|skyline| skylines.push(skyline));
    }
    progress(IngestProgress { stage: IngestStage::Skyline, done: total as u64, total: total as u64 });
    Some(skylines)
}

fn skyline(terrain: &Terrain, grid: &Grid, pixels: &LitPixels, index: usize) -> Skyline {
    let (column, row) = morton::decode(pixels.codes[index]);
    let place = GeoPoint::from_vector(grid.center(column, row));
    let nearest_m = nearest_wall_m(grid.area_m2(column, row).sqrt());
    let sight = terrain.around_source(place, f64::from(pixels.altitude_m[index]), nearest_m).hasty();
    let mut skyline = Skyline::default();
    // Where the ground is unknown the light was put at sea level, and the edge of the terrain would be a wall to it.
    let is_known = terrain.ground(place).known_altitude_m().is_some();
    if is_known && !sight.is_open() {
        for (number, codes) in skyline.iter_mut().enumerate() {
            let azimuth_rad = number as f64 * TAU / SKYLINE_AZIMUTH_COUNT as f64;
            *codes = sight.tangents(azimuth_rad, OPEN_TANGENT, &SKYLINE_REACHES_M).map(code_of);
        }
    }
    skyline
}
