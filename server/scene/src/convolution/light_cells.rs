//! The lights of a raster as cells: its pixels, and coarser levels onto which lights are spread by cubics and altitudes linearly.

use super::bands::{Band, cubic_weights};
use crate::grid::Grid;
use crate::light_tree::LightTree;
use crate::morton;
use crate::place_kernel::UniformAxis;
use std::sync::Arc;

/// Cells that a coarse level has beyond each end of the raster.
const RIM_CELLS: usize = 2;

/// A light on the raster, which goes on beyond its sides where it spans the Earth.
#[derive(Clone, Copy, Debug)]
struct Light {
    column: usize,
    row: usize,
    flux_dnb_w: f32,
    altitude_m: f32,
}

/// All lights of one kind on the pixels of a raster.
pub(super) struct Pixels {
    lights: Vec<Light>,
    columns: usize,
    rows: usize,
    /// Columns before the raster's first.
    before: usize,
    /// Flux and altitude by pixel, DNB watts and metres.
    cells: Vec<[f32; 2]>,
}

impl Pixels {
    /// * `around`: columns that it goes on beyond either side, of a raster that spans so much of the Earth that lights there are near.
    pub(super) fn new<'a>(
        grid: &Grid,
        trees: impl Iterator<Item = &'a LightTree<'a>>,
        around: usize,
    ) -> Self {
        let (width, rows) = (grid.width as usize, grid.height as usize);
        let columns = width + 2 * around;
        let turn = grid.turn_columns().map_or(0, |turn| turn.round() as i64);
        let mut lights = Vec::new();
        for tree in trees {
            for (index, &code) in tree.pixels.codes.iter().enumerate() {
                if tree.removed.is_some_and(|removed| removed.is_removed(index)) {
                    continue;
                }
                let (column, row) = morton::decode(code);
                let flux_dnb_w = tree.pixels.flux_dnb_w(grid, tree.calibration, index) as f32;
                let altitude_m = tree.pixels.altitude_m[index];
                let turns = if around > 0 { -1..=1 } else { 0..=0 };
                let at = turns.map(|turns| i64::from(column) + around as i64 + turns * turn);
                lights.extend(at.filter(|at| (0..columns as i64).contains(at)).map(|column| Light {
                    column: column as usize,
                    row: row as usize,
                    flux_dnb_w,
                    altitude_m,
                }));
            }
        }
        let mut cells = vec![[0f32; 2]; columns * rows];
        for light in &lights {
            let [flux_dnb_w, altitude_m] = &mut cells[light.row * columns + light.column];
            // Lights of one pixel stand on the same ground.
            *flux_dnb_w += light.flux_dnb_w;
            *altitude_m = light.altitude_m;
        }
        Self { lights, columns, rows, before: around, cells }
    }

    /// Lowest and highest altitude of its lights, metres.
    pub(super) fn altitude_range_m(&self) -> [f64; 2] {
        let altitudes = self.lights.iter().map(|light| f64::from(light.altitude_m));
        let range = altitudes.fold([f64::INFINITY, f64::NEG_INFINITY], |[lowest, highest], at| {
            [at.min(lowest), at.max(highest)]
        });
        if self.lights.is_empty() { [0.0; 2] } else { range }
    }
}

/// The lights of a band by layers of altitude.
pub(super) struct LightCells {
    pixels: Arc<Pixels>,
    pub(super) altitudes: UniformAxis,
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// Pixel coordinates of the middle of its first cell, and from one to the next.
    pub(super) first: [f64; 2],
    pub(super) cell_pixels: f64,
    /// By layer; empty at the level of pixels.
    layers: Vec<Vec<f32>>,
}

impl LightCells {
    pub(super) fn new(pixels: &Arc<Pixels>, band: &Band) -> Self {
        let [lowest_m, highest_m] = pixels.altitude_range_m();
        let altitudes = UniformAxis::between(lowest_m, highest_m, band.steps_m()[1], usize::MAX);
        let size = band.cell_pixels() as usize;
        let middle = [0.5 - pixels.before as f64, 0.5];
        let cell_pixels = size as f64;
        let (columns, rows) = (pixels.columns, pixels.rows);
        if band.level == 0 {
            let pixels = Arc::clone(pixels);
            return Self { pixels, altitudes, columns, rows, first: middle, cell_pixels, layers: Vec::new() };
        }
        let count = |pixels: usize| (pixels - 1) / size + 2 + 2 * RIM_CELLS;
        let (columns, rows) = (count(columns), count(rows));
        let first = middle.map(|at| at - RIM_CELLS as f64 * cell_pixels);
        let mut layers = vec![vec![0f32; columns * rows]; altitudes.count];
        let weights: Vec<[f32; 4]> = (0..size).map(|at| cubic_weights(at as f64 / cell_pixels)).collect();
        for light in &pixels.lights {
            let (below, up) = altitudes.position(light.altitude_m);
            let (across, down) = (weights[light.column % size], weights[light.row % size]);
            let (column, row) = (light.column / size + RIM_CELLS - 1, light.row / size + RIM_CELLS - 1);
            for (layer, part) in [(below, 1.0 - up), (below + 1, up)] {
                if part == 0.0 {
                    continue;
                }
                for (row, down) in (row..).zip(down) {
                    let flux_dnb_w = part * down * light.flux_dnb_w;
                    let cells = &mut layers[layer][row * columns + column..][..4];
                    cells.iter_mut().zip(across).for_each(|(cell, across)| *cell += across * flux_dnb_w);
                }
            }
        }
        Self { pixels: Arc::clone(pixels), altitudes, columns, rows, first, cell_pixels, layers }
    }

    /// Calls `visit` with layer, column, row and flux of every lit cell of a rectangle, which may reach beyond the cells.
    pub(super) fn for_each_lit(
        &self,
        [first_column, first_row]: [i64; 2],
        [columns, rows]: [usize; 2],
        mut visit: impl FnMut(usize, usize, usize, f32),
    ) {
        let within = |first: i64, count: usize, all: usize| {
            let from = first.clamp(0, all as i64);
            from as usize..(first + count as i64).clamp(from, all as i64) as usize
        };
        let columns = within(first_column, columns, self.columns);
        for row in within(first_row, rows, self.rows) {
            let to_row = (row as i64 - first_row) as usize;
            let to_column = |column: usize| (column as i64 - first_column) as usize;
            let cells = row * self.columns + columns.start..row * self.columns + columns.end;
            if self.layers.is_empty() {
                for (column, &[flux_dnb_w, altitude_m]) in columns.clone().zip(&self.pixels.cells[cells]) {
                    if flux_dnb_w > 0.0 {
                        let (below, up) = self.altitudes.position(altitude_m);
                        visit(below, to_column(column), to_row, (1.0 - up) * flux_dnb_w);
                        if up > 0.0 {
                            visit(below + 1, to_column(column), to_row, up * flux_dnb_w);
                        }
                    }
                }
                continue;
            }
            for (layer, values) in self.layers.iter().enumerate() {
                for (column, &flux_dnb_w) in columns.clone().zip(&values[cells.clone()]) {
                    if flux_dnb_w != 0.0 {
                        visit(layer, to_column(column), to_row, flux_dnb_w);
                    }
                }
            }
        }
    }
}
