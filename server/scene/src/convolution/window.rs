//! The light cells around some targets, by layers of altitude, and the innermost loop over them.

use super::light_cells::LightCells;
use super::stencil::{Stencil, StencilRow};

/// Targets side by side that are summed at once.
pub(super) const TILE_COLUMNS: usize = 32;

/// The cells of one layer of altitude around some targets.
#[derive(Clone, Default)]
struct Window {
    /// `[row][phase][column]`: cells that neighbouring targets see at the same place lie side by side.
    cells: Vec<f32>,
    /// First and last lit column of each row and phase; the first after the last where none is lit.
    lit: Vec<[u32; 2]>,
    is_lit: bool,
}

/// The cells of all layers around some rows of targets.
pub(super) struct Windows<'a> {
    stencil: &'a Stencil,
    target_rows: usize,
    /// Cells from one target to the next.
    stride: usize,
    first_column: i64,
    columns: usize,
    rows: usize,
    phase_columns: usize,
    windows: Vec<Window>,
}

const UNLIT: [u32; 2] = [u32::MAX, 0];

impl<'a> Windows<'a> {
    pub(super) fn new(stencil: &'a Stencil, target_rows: usize, stride: usize, layers: usize) -> Self {
        let [first_column, last_column] = stencil.columns();
        let reach = (last_column - first_column) as usize;
        Self {
            stencil,
            target_rows,
            stride,
            first_column,
            columns: reach + 1 + stride * (TILE_COLUMNS - 1),
            rows: stencil.rows.len() + stride * (target_rows - 1),
            phase_columns: reach / stride + TILE_COLUMNS,
            windows: vec![Window::default(); layers],
        }
    }

    /// Takes the cells around targets of which the first lies in a cell; false where none is lit.
    pub(super) fn fill(&mut self, light: &LightCells, [column, row]: [i64; 2]) -> bool {
        let (stride, phase_columns) = (self.stride, self.phase_columns);
        let size = self.rows * stride * phase_columns;
        for window in self.windows.iter_mut().filter(|window| window.is_lit) {
            window.cells.fill(0.0);
            window.lit.fill(UNLIT);
            window.is_lit = false;
        }
        let first = [column + self.first_column, row + self.stencil.first_row];
        let mut is_lit = false;
        light.for_each_lit(first, [self.columns, self.rows], |layer, column, row, flux_dnb_w| {
            let window = &mut self.windows[layer];
            if window.cells.is_empty() {
                window.cells = vec![0.0; size];
                window.lit = vec![UNLIT; self.rows * stride];
            }
            let (line, column) = (row * stride + column % stride, column / stride);
            window.cells[line * phase_columns + column] += flux_dnb_w;
            let [first, last] = &mut window.lit[line];
            (*first, *last) = ((*first).min(column as u32), (*last).max(column as u32));
            (window.is_lit, is_lit) = (true, true);
        });
        is_lit
    }

    /// The layers of which some cell is lit.
    pub(super) fn lit_layers(&self) -> impl Iterator<Item = usize> {
        (0..).zip(&self.windows).filter(|(_, window)| window.is_lit).map(|(layer, _)| layer)
    }

    /// The sums at each row of targets.
    ///
    /// * `weights`: of the stencil's cells for a layer of lights.
    pub(super) fn sums<'w>(&self, weights: impl Fn(usize) -> &'w [f32]) -> Vec<[f32; TILE_COLUMNS]> {
        let mut sums = vec![[0f32; TILE_COLUMNS]; self.target_rows];
        for layer in self.lit_layers() {
            let (window, weights) = (&self.windows[layer], weights(layer));
            for (target, sums) in sums.iter_mut().enumerate() {
                let mut weights = weights;
                for (row, cells) in self.stencil.rows.iter().enumerate() {
                    let of_row;
                    (of_row, weights) = weights.split_at(cells.count);
                    self.add_row(window, target * self.stride + row, cells, of_row, sums);
                }
            }
        }
        sums
    }

    fn add_row(
        &self,
        window: &Window,
        row: usize,
        cells: &StencilRow,
        weights: &[f32],
        sums: &mut [f32; TILE_COLUMNS],
    ) {
        if cells.count == 0 {
            return;
        }
        let stride = self.stride;
        let before = (cells.first - self.first_column) as usize;
        let mut added = *sums;
        for phase in 0..stride {
            let line = row * stride + phase;
            let [first_lit, last_lit] = window.lit[line];
            if first_lit > last_lit {
                continue;
            }
            let line = &window.cells[line * self.phase_columns..][..self.phase_columns];
            // The first cell of the row in this phase, and its column there.
            let skipped = (phase + stride - before % stride) % stride;
            let column = (before + skipped) / stride;
            let dark = (first_lit as usize + 1).saturating_sub(TILE_COLUMNS).saturating_sub(column);
            let weights = weights.iter().skip(skipped + dark * stride).step_by(stride);
            let lines = line.windows(TILE_COLUMNS).take(last_lit as usize + 1).skip(column + dark);
            for (&weight, line) in weights.zip(lines) {
                for (sum, cell) in added.iter_mut().zip(line) {
                    *sum += weight * cell;
                }
            }
        }
        *sums = added;
    }
}
