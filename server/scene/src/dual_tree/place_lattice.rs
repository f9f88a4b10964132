//! A lattice of places: points spread evenly over a raster.

use crate::grid::Grid;
use crate::terrain::Terrain;
use glam::DVec3;
use rayon::prelude::*;
use skyglow_physics::GeoPoint;

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
    steps: [u32; 2],
}

impl PlaceLattice {
    /// On a raster of so many pixels, a place for each where those are `max_places` at most, else for blocks of the smallest
    /// power of two that makes it so.
    pub fn within(width: u32, height: u32, max_places: usize) -> Self {
        let mut step = 1u32;
        while (width / step).max(1) as usize * (height / step).max(1) as usize > max_places.max(1) {
            step *= 2;
        }
        let steps = [step.min(width), step.min(height)];
        Self { step, columns: (width / step).max(1), rows: (height / step).max(1), steps }
    }

    /// How many places there are.
    pub fn len(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Whether there are none, which no lattice has.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The geotransform of a raster with a pixel for each place, from that of the scene's raster.
    pub(crate) fn geotransform(&self, pixels: [f64; 6]) -> [f64; 6] {
        let [across, down] = self.steps.map(f64::from);
        let [x, x_column, x_row, y, y_column, y_row] = pixels;
        [x, x_column * across, x_row * down, y, y_column * across, y_row * down]
    }

    /// Pixel coordinates of a place by its column and row, which may lie between places.
    pub(super) fn position(&self, column: f64, row: f64) -> (f64, f64) {
        let [across, down] = self.steps.map(f64::from);
        ((column + 0.5) * across, (row + 0.5) * down)
    }

    /// Column and row of pixel coordinates, which may lie between places.
    pub(super) fn place_at(&self, x: f64, y: f64) -> (f64, f64) {
        let [across, down] = self.steps.map(f64::from);
        (x / across - 0.5, y / down - 0.5)
    }

    pub(crate) fn point(&self, grid: &Grid, column: f64, row: f64) -> DVec3 {
        let (x, y) = self.position(column, row);
        grid.point(x, y)
    }
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
}
