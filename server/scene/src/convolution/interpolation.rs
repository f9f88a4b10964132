//! From sums at cells to sums at places: cubics between cells, linear between layers of altitude.

use super::band_sum::{BandSum, TargetRange};
use super::bands::cubic_weights;
use crate::dual_tree::PlaceLattice;
use rayon::prelude::*;
use std::ops::Range;

/// Cells before and after a place that its sum is made of.
const BEFORE: usize = 1;
const AFTER: usize = 2;

/// Where places lie between the cells of a band along one axis: the first of four cells, and their weights.
type Along = Vec<(usize, [f32; 4])>;

/// A band's sums at some places.
pub(super) struct Interpolation<'a> {
    band: &'a BandSum,
    strip: &'a TargetRange,
    across: Along,
    down: Along,
    cells: TargetRange,
}

impl<'a> Interpolation<'a> {
    pub(super) fn new(band: &'a BandSum, lattice: PlaceLattice, strip: &'a TargetRange) -> Self {
        let at = |position: f64, axis: usize| {
            let place = (position - band.targets.first[axis]) / band.targets.step;
            (place.floor() as usize - BEFORE, cubic_weights(place - place.floor()))
        };
        let across: Along =
            strip.columns.clone().map(|column| at(lattice.position(column as f64, 0.0).0, 0)).collect();
        let down: Along = strip.rows.clone().map(|row| at(lattice.position(0.0, row as f64).1, 1)).collect();
        let all = |along: &Along| along[0].0..along[along.len() - 1].0 + BEFORE + AFTER + 1;
        let cells = TargetRange { columns: all(&across), rows: all(&down) };
        Self { band, strip, across, down, cells }
    }

    /// Adds them, row by row.
    ///
    /// * `altitudes_m`: of the places.
    /// * `range_m`: lowest and highest altitude of some places.
    pub(super) fn add(
        &self,
        altitudes_m: &[f32],
        range_m: impl Fn(&TargetRange) -> Option<[f32; 2]> + Sync,
        sums: &mut [f32],
    ) {
        let width = self.cells.columns.len();
        let places = |along: &Along, cells: &Range<usize>, first: usize| {
            let before = along.partition_point(|(cell, _)| cell + BEFORE + AFTER < cells.start);
            first + before..first + along.partition_point(|(cell, _)| *cell < cells.end)
        };
        let wanted_m = |tile: &TargetRange| {
            range_m(&TargetRange {
                columns: places(&self.across, &tile.columns, self.strip.columns.start),
                rows: places(&self.down, &tile.rows, self.strip.rows.start),
            })
        };
        let lanes = self.band.lanes(
            &self.cells,
            &wanted_m,
            &|lane| (lane.rows.len(), vec![Vec::new(); self.band.altitudes.count]),
            &|(_, layers): &mut (usize, Vec<Vec<f32>>), lane, layer, [row, column], added| {
                if layers[layer].is_empty() {
                    layers[layer] = vec![0.0; lane.rows.len() * width];
                }
                layers[layer][row * width + column..][..added.len()].copy_from_slice(added);
            },
        );
        // By layer and row of cells; none where nothing is known, which is dark.
        let mut rows: Vec<Vec<Option<&[f32]>>> = vec![Vec::new(); self.band.altitudes.count];
        for (lane_rows, layers) in &lanes {
            for (rows, values) in rows.iter_mut().zip(layers) {
                match values.is_empty() {
                    true => rows.extend(std::iter::repeat_n(None, *lane_rows)),
                    false => rows.extend(values.chunks_exact(width).map(Some)),
                }
            }
        }
        let columns = self.strip.columns.len();
        let of_rows = sums.par_chunks_mut(columns).zip(altitudes_m.par_chunks(columns)).zip(&self.down);
        of_rows.for_each(|((sums, altitudes_m), (first_row, down))| {
            for ((sum, altitude_m), (first_column, across)) in
                sums.iter_mut().zip(altitudes_m).zip(&self.across)
            {
                if !altitude_m.is_finite() {
                    continue;
                }
                let (below, up) = self.band.altitudes.position(*altitude_m);
                for (layer, part) in [(below, 1.0 - up), (below + 1, up)] {
                    if part == 0.0 {
                        continue;
                    }
                    let column = first_column - self.cells.columns.start;
                    let rows = &rows[layer][first_row - self.cells.rows.start..];
                    for (row, down) in rows.iter().zip(down) {
                        let Some(row) = row else { continue };
                        let values = row[column..].iter().zip(across);
                        *sum += part * down * values.map(|(value, weight)| value * weight).sum::<f32>();
                    }
                }
            }
        });
    }
}
