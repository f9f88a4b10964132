//! H_k per azimuth column: the sum over its lit cells.

use super::{
    accumulate::dispatch_avx2,
    mix::{BLOCK, MixedShape, Scales},
};
use crate::{
    prepare::{Prepared, PreparedCell},
    twin::cell_weights,
};
use rayon::prelude::*;
use skyglow_physics::BAND_COUNT;

/// `[band][cell]` weights of a cell's lower and upper node.
pub(crate) type CellWeights = Vec<[f32; 2]>;

/// Weights of every cell in every band.
pub(crate) fn weigh_cells(request: &Prepared, scales: &Scales) -> CellWeights {
    let (cell_count, node_count) = (request.cells.len(), request.nodes.len());
    let mut weights = vec![[0.0; 2]; BAND_COUNT * cell_count];
    weights.par_chunks_mut(cell_count.max(1)).enumerate().for_each(|(band, weights)| {
        let scales = &scales[band * node_count..][..node_count];
        weigh_band(&request.cells, scales, request.flux_per_dnb_flux[band], weights);
    });
    weights
}

dispatch_avx2!(
    /// Weights of the cells in one band whose lamps have `flux_per_dnb_flux`.
    weigh_band, weigh_band_avx2, weigh_band_body,
    (cells: &[PreparedCell], scales: &[[f32; 4]], flux_per_dnb_flux: f32, weights: &mut [[f32; 2]])
);

#[inline(always)]
fn weigh_band_body(
    cells: &[PreparedCell],
    scales: &[[f32; 4]],
    flux_per_dnb_flux: f32,
    weights: &mut [[f32; 2]],
) {
    for (cell, weights) in cells.iter().zip(weights) {
        *weights = cell_weights(
            cell.flux_dnb_w * flux_per_dnb_flux,
            scales[cell.lower_node as usize][3],
            scales[cell.upper_node as usize][3],
            cell.upper_weight,
        );
    }
}

/// H for the lit columns, `[column slot][band][padded function]`.
pub(crate) fn sum_columns(request: &Prepared, mixed: &MixedShape, weights: &CellWeights) -> Vec<f32> {
    let padded = mixed.padded_count;
    let (cell_count, node_count) = (request.cells.len(), request.nodes.len());
    let mut columns = vec![0.0; request.columns.len() * BAND_COUNT * padded];
    columns.par_chunks_mut(BAND_COUNT * padded).zip(&request.columns).for_each(|(column, lit)| {
        let range = lit.first_cell as usize..lit.end_cell as usize;
        let cells = &request.cells[range.clone()];
        for (band, sums) in column.chunks_exact_mut(padded).enumerate() {
            let weights = &weights[band * cell_count..][range.clone()];
            let shape = &mixed.shape[band * node_count * padded..][..node_count * padded];
            sum_cells(cells, weights, shape, sums);
        }
    });
    columns
}

dispatch_avx2!(
    /// Adds up one column's cells in one band; `shape` is `[node][function]`, `sums` one value a function.
    sum_cells, sum_cells_avx2, sum_cells_body,
    (cells: &[PreparedCell], weights: &[[f32; 2]], shape: &[f32], sums: &mut [f32])
);

#[inline(always)]
fn sum_cells_body(cells: &[PreparedCell], weights: &[[f32; 2]], shape: &[f32], sums: &mut [f32]) {
    let padded = sums.len();
    let (nodes, _) = shape.as_chunks::<BLOCK>();
    let blocks_per_node = padded / BLOCK;
    for (block, sums) in sums.as_chunks_mut::<BLOCK>().0.iter_mut().enumerate() {
        let mut sum = [0.0; BLOCK];
        for (cell, &[lower_weight, upper_weight]) in cells.iter().zip(weights) {
            let lower = &nodes[cell.lower_node as usize * blocks_per_node + block];
            let upper = &nodes[cell.upper_node as usize * blocks_per_node + block];
            for lane in 0..BLOCK {
                sum[lane] += lower_weight * lower[lane] + upper_weight * upper[lane];
            }
        }
        *sums = sum;
    }
}
