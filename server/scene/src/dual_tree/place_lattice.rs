//! A lattice of places: points spread evenly over a raster.

use crate::grid::Grid;
use crate::terrain::Terrain;
use glam::DVec3;
use rayon::prelude::*;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};
use std::f64::consts::PI;

/// Places on a scene's raster: the middles of blocks of `step` × `step` pixels, of less where the raster has less. What is left of
/// the raster beyond the last whole block has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlaceLattice {
    /// Pixels from one place to the next.
    pub step: u32,
    /// Places from west to east (along the raster's rows).
    pub columns: u32,
    /// Places from north to south (along the raster's columns).
    pub rows: u32,
    /// Pixels from one place to the next along either axis.
    pub(super) steps: [u32; 2],
    /// Column and row of the first pixel of the first block.
    pub(super) first: [u32; 2],
}

/// Places of a window at most: more pixels share one.
const MAX_WINDOW_PLACES: usize = 40_000;

impl PlaceLattice {
    /// On a raster of so many pixels, a place for each where those are `max_places` at most, else for blocks of the smallest
    /// power of two that makes it so.
    pub fn within(width: u32, height: u32, max_places: usize) -> Self {
        let mut step = 1u32;
        while (width / step).max(1) as usize * (height / step).max(1) as usize > max_places.max(1) {
            step *= 2;
        }
        let steps = [step.min(width), step.min(height)];
        let (columns, rows) = ((width / step).max(1), (height / step).max(1));
        Self { step, columns, rows, steps, first: [0, 0] }
    }

    /// On the part of a raster that lies within reach of a place, with about so many metres from one to the next, or more where that
    /// would be too many; None where the place is off the raster.
    pub(crate) fn around(grid: &Grid, place: GeoPoint, reach_m: f64, step_m: f64) -> Option<Self> {
        let (x, y) = grid.position_of(place)?;
        // Pixels of a geographic grid get narrower towards the poles.
        let ends = [0.0, PI].map(|azimuth_rad| place.destination(azimuth_rad, reach_m));
        let positions = ends.iter().filter_map(|end| grid.position_of(*end)).chain([(x, y)]);
        let across_m = positions.map(|(x, y)| pixel_m(grid, x, y)[0]).fold(f64::INFINITY, f64::min);
        let [here_m, down_m] = pixel_m(grid, x, y);
        let within = |at: f64, length: u32, pixel_m: f64| {
            let reach = reach_m / pixel_m + 1.0;
            let (first, last) = ((at - reach).max(0.0) as u32, ((at + reach) as u32).min(length - 1));
            (first, last - first + 1)
        };
        let ((left, width), (top, height)) =
            (within(x, grid.width, across_m), within(y, grid.height, down_m));
        let mut step = ((step_m / (here_m * down_m).sqrt()).round() as u32).max(1);
        let count = |length: u32, step: u32| (length / step).max(1);
        while count(width, step) as usize * count(height, step) as usize > MAX_WINDOW_PLACES {
            step += step.div_ceil(4);
        }
        let (columns, rows) = (count(width, step), count(height, step));
        Some(Self { step, columns, rows, steps: [step.min(width), step.min(height)], first: [left, top] })
    }

    /// How many places there are.
    pub fn len(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Whether there are none, which no lattice has.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Column and row of the first block, counted in whole blocks.
    pub(crate) fn first_block(&self) -> [u32; 2] {
        self.first.map(|pixels| pixels / self.step)
    }

    /// Whether places are as many pixels apart along either axis.
    pub(crate) fn is_even(&self) -> bool {
        self.steps == [self.step; 2]
    }

    /// The geotransform of a raster with a pixel for each place, from that of the scene's raster.
    pub(crate) fn geotransform(&self, pixels: [f64; 6]) -> [f64; 6] {
        let [across, down] = self.steps.map(f64::from);
        let [x, x_column, x_row, y, y_column, y_row] = pixels;
        let [left, top] = self.first.map(f64::from);
        let (x, y) = (x + left * x_column + top * x_row, y + left * y_column + top * y_row);
        [x, x_column * across, x_row * down, y, y_column * across, y_row * down]
    }

    /// Pixel coordinates of a place by its column and row, which may lie between places.
    pub(crate) fn position(&self, column: f64, row: f64) -> (f64, f64) {
        let [across, down] = self.steps.map(f64::from);
        let [left, top] = self.first.map(f64::from);
        (left + (column + 0.5) * across, top + (row + 0.5) * down)
    }

    /// Column and row of pixel coordinates, which may lie between places.
    pub(super) fn place_at(&self, x: f64, y: f64) -> (f64, f64) {
        let [across, down] = self.steps.map(f64::from);
        let [left, top] = self.first.map(f64::from);
        ((x - left) / across - 0.5, (y - top) / down - 0.5)
    }

    pub(crate) fn point(&self, grid: &Grid, column: f64, row: f64) -> DVec3 {
        let (x, y) = self.position(column, row);
        grid.point(x, y)
    }
}

/// Width and height of a pixel at pixel coordinates, metres.
fn pixel_m(grid: &Grid, x: f64, y: f64) -> [f64; 2] {
    let middle = grid.point(x, y);
    [grid.point(x + 1.0, y), grid.point(x, y + 1.0)].map(|next| EARTH_RADIUS_M * middle.distance(next))
}

/// Altitude of the ground at every place of a lattice, metres above sea level, at least 0, row by row from the north; NaN off
/// the world.
pub(crate) fn ground_altitudes_m(lattice: PlaceLattice, grid: &Grid, terrain: &Terrain) -> Vec<f32> {
    let mut altitudes = vec![0f32; lattice.len()];
    if terrain.is_empty() && grid.axes().is_some() {
        return altitudes;
    }
    altitudes.par_chunks_mut(lattice.columns as usize).enumerate().for_each(|(row, altitudes)| {
        for (column, altitude_m) in altitudes.iter_mut().enumerate() {
            let point = lattice.point(grid, column as f64, row as f64);
            *altitude_m = if point.is_finite() {
                terrain.ground(GeoPoint::from_vector(point)).altitude_m() as f32
            } else {
                f32::NAN
            };
        }
    });
    altitudes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GeographicAxes;
    use std::f64::consts::TAU;

    /// A lattice has at most the allowed number of places and lies on the raster.
    #[test]
    fn lattices_respect_the_limit_and_the_raster() {
        for (width, height, max_places, step) in
            [(10, 7, 70, 1), (10, 7, 69, 2), (1, 1, 1, 1), (1000, 3, 130, 8), (5, 5, 0, 4)]
        {
            let lattice = PlaceLattice::within(width, height, max_places);
            assert_eq!(lattice.step, step, "{width} {height} {max_places}");
            assert!(lattice.len() <= max_places.max(1));
            let (x, y) = lattice.position(f64::from(lattice.columns - 1), f64::from(lattice.rows - 1));
            assert!(x < f64::from(width) && y < f64::from(height));
        }
    }

    /// A window holds every pixel within reach, lies on the raster, and has as many places as asked for or fewer.
    #[test]
    fn a_window_holds_all_within_reach() {
        let axes = GeographicAxes {
            first_longitude_deg: 10.0,
            first_latitude_deg: 75.0,
            longitude_step_deg: 0.01,
            latitude_step_deg: -0.01,
        };
        let grid = Grid::geographic(axes, 2000, 1500);
        for (latitude_deg, longitude_deg, reach_m, step_m) in [
            (66.0, 20.0, 60e3, 1e3),
            (74.9, 10.02, 60e3, 1e3),
            (66.0, 20.0, 60e3, 10.0),
            (60.01, 29.99, 1e3, 5e3),
        ] {
            let place = GeoPoint::from_deg(latitude_deg, longitude_deg).unwrap();
            let window = PlaceLattice::around(&grid, place, reach_m, step_m).unwrap();
            assert!(window.len() <= MAX_WINDOW_PLACES, "{window:?}");
            let last = window.position(f64::from(window.columns) - 0.5, f64::from(window.rows) - 0.5);
            assert!(last.0 <= 2000.0 && last.1 <= 1500.0, "{window:?} {last:?}");
            for azimuth in 0..64 {
                let end = place.destination(TAU * f64::from(azimuth) / 64.0, 0.999 * reach_m);
                let Some((x, y)) = grid.position_of(end) else { continue };
                let (column, row) = window.place_at(x, y);
                // What is left beyond the last whole block is less than a block.
                let fits = |at: f64, count: u32| (-1.0..f64::from(count) + 0.5).contains(&at);
                assert!(fits(column, window.columns) && fits(row, window.rows), "{window:?} {column} {row}");
            }
        }
        assert!(PlaceLattice::around(&grid, GeoPoint::from_deg(0.0, 0.0).unwrap(), 1e4, 1e3).is_none());
    }
}
