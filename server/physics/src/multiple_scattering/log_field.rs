//! A positive field between the points of the grid: bilinear interpolation of its logarithm.

use super::{
    grid::{FieldGrid, LinearStencil},
    lanes::LANES,
};

/// Interpolates the logarithm of a field between grid points.
pub(super) struct LogField<'a> {
    grid: &'a FieldGrid,
    ln: Vec<[f64; LANES]>,
}

impl<'a> LogField<'a> {
    pub(super) fn new(grid: &'a FieldGrid, values: impl Iterator<Item = [f64; LANES]>) -> Self {
        Self { grid, ln: values.map(|value| value.map(|v| v.max(1e-300).ln())).collect() }
    }

    pub(super) fn at(&self, ring: LinearStencil, layer: LinearStencil) -> [f64; LANES] {
        let first = layer.lower * self.grid.ring_count() + ring.lower;
        let above = if layer.upper_weight > 0.0 { first + self.grid.ring_count() } else { first };
        std::array::from_fn(|lane| {
            let row =
                |p: usize| self.ln[p][lane] + ring.upper_weight * (self.ln[p + 1][lane] - self.ln[p][lane]);
            (row(first) + layer.upper_weight * (row(above) - row(first))).exp()
        })
    }
}
