//! Synthetic terrain for tests.

use super::raster::{TerrainRaster, TerrainRasterBuilder};
use crate::grid::{GeographicAxes, Grid};
use skyglow_physics::GeoPoint;

/// Degrees from sample to sample.
pub(super) const STEP_DEG: f64 = 0.01;

/// A grid of `size` × `size` samples of 0.01° from a corner in the north-west.
pub(super) fn grid(west_deg: f64, north_deg: f64, size: u32) -> Grid {
    let axes = GeographicAxes {
        first_longitude_deg: west_deg,
        first_latitude_deg: north_deg,
        longitude_step_deg: STEP_DEG,
        latitude_step_deg: -STEP_DEG,
    };
    Grid::geographic(axes, size, size)
}

/// Terrain of one layer: metres by column and row, NaN is void.
pub(super) fn layer(grid: Grid, height_m: impl Fn(u32, u32) -> f32) -> TerrainRaster {
    let (width, height) = (grid.width, grid.height);
    let mut builder = TerrainRasterBuilder::new(grid);
    for row in 0..height {
        let line: Vec<f32> = (0..width).map(|column| height_m(column, row)).collect();
        builder.push_row(&line).unwrap();
    }
    builder.finish().unwrap()
}

pub(super) fn place(latitude_deg: f64, longitude_deg: f64) -> GeoPoint {
    GeoPoint::from_deg(latitude_deg, longitude_deg).unwrap()
}

/// A number in 0..1 for a pixel, without pattern.
pub(super) fn noise(column: u32, row: u32, seed: u32) -> f32 {
    let mut x =
        column.wrapping_mul(0x9e37_79b9) ^ row.wrapping_mul(0x85eb_ca6b) ^ seed.wrapping_mul(0xc2b2_ae35);
    x = (x ^ (x >> 15)).wrapping_mul(0x2c1b_3c6d);
    x = (x ^ (x >> 12)).wrapping_mul(0x297a_2d39);
    (x >> 8) as f32 / 16_777_216.0
}

/// Hills of several sizes, metres.
pub(super) fn hills_m(column: u32, row: u32, seed: u32) -> f32 {
    let smooth = |size: u32| {
        let (c, r) = (column / size, row / size);
        let (s, t) = ((column % size) as f32 / size as f32, (row % size) as f32 / size as f32);
        let at = |dc, dr| noise(c + dc, r + dr, seed ^ size);
        (at(0, 0) * (1.0 - s) + at(1, 0) * s) * (1.0 - t) + (at(0, 1) * (1.0 - s) + at(1, 1) * s) * t
    };
    300.0 + 2500.0 * smooth(40) + 600.0 * smooth(7) + 60.0 * noise(column, row, seed)
}
