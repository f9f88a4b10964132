//! The skyline of a light, computed from the terrain around it.

use crate::grid::Grid;
use crate::lit_pixels::LitPixels;
use crate::morton;
use crate::skyline_part::{Observer, Part};
use crate::skylines::{MIN_TANGENT, SKYLINE_AZIMUTH_COUNT, Skyline, code_of};
use crate::terrain::{Terrain, min_blocking_distance_m};
use skyglow_physics::GeoPoint;
use std::f64::consts::TAU;

/// The skyline of a lit pixel by its index, from its centre at its altitude.
///
/// * `observer`: who needs a part of it; None for all of it.
pub(crate) fn skyline_of_light(
    terrain: &Terrain,
    grid: &Grid,
    pixels: &LitPixels,
    index: usize,
    observer: Option<&Observer>,
) -> Skyline {
    let (column, row) = morton::decode(pixels.codes[index]);
    let center = grid.center(column, row);
    let place = GeoPoint::from_vector(center);
    let nearest_m = min_blocking_distance_m(grid.area_m2(column, row).sqrt());
    let sight = terrain.source_horizon(place, f64::from(pixels.altitude_m[index]), nearest_m).coarse();
    let mut skyline = Skyline::default();
    // Where the ground is unknown the light was put at sea level, and the edge of the terrain would be a wall to it.
    let is_known = terrain.ground(place).known_altitude_m().is_some();
    if is_known && !sight.is_open() {
        let part = observer.map_or(Part::WHOLE, |observer| observer.part(center));
        let distances_m = part.distances_m();
        for azimuth in part.azimuths() {
            let azimuth_rad = azimuth as f64 * TAU / SKYLINE_AZIMUTH_COUNT as f64;
            skyline[azimuth] = sight.tangents(azimuth_rad, MIN_TANGENT, &distances_m).map(code_of);
        }
    }
    skyline
}
