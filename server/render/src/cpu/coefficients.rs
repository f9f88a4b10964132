//! H_k per azimuth column: the weighted sum of shapes over its lit cells.

use super::{
    lanes::Aligned,
    layout::{BLOCK, CellWeights, ColumnBlock, MixedNode},
    work::for_each_part,
};
use crate::prepare::{LitColumn, Prepared, PreparedCell};
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, simd::multiply_add, simd_dispatch};

/// Azimuths that a task sums.
const AZIMUTHS_PER_TASK: usize = 16;

/// H, `[block of functions][azimuth]`; azimuths without light are 0. `mixed` is `[block][node]`.
pub fn coefficients(
    request: &Prepared,
    mixed: &[MixedNode],
    weights: &[CellWeights],
    side_by_side: bool,
    columns: &mut Vec<ColumnBlock>,
) {
    let node_count = request.nodes.len();
    let dark = Aligned([[0.0; BLOCK]; BAND_COUNT]);
    columns.clear();
    columns.resize(mixed.len() / node_count.max(1) * AZIMUTH_COUNT, dark);
    for_each_part(side_by_side, columns, AZIMUTHS_PER_TASK, |task, columns| {
        let first = task * AZIMUTHS_PER_TASK;
        let (block, first) = (first / AZIMUTH_COUNT, (first % AZIMUTH_COUNT) as u32);
        let lit = request.columns.partition_point(|lit| lit.azimuth < first);
        let end = request.columns.partition_point(|lit| lit.azimuth < first + AZIMUTHS_PER_TASK as u32);
        let nodes = &mixed[block * node_count..][..node_count];
        let lit = &request.columns[lit..end];
        if request.lit_bands().all(|is_lit| is_lit) {
            sum_cells(lit, &request.cells, weights, nodes, first, columns);
            return;
        }
        for (band, _) in request.lit_bands().enumerate().filter(|(_, is_lit)| *is_lit) {
            sum_cells_in_band(lit, &request.cells, weights, nodes, first, band, columns);
        }
    });
}

simd_dispatch! {
    /// Adds up the cells of lit columns in one block of functions; `sums` are the azimuths from `first` on.
    fn sum_cells(
        lit: &[LitColumn],
        cells: &[PreparedCell],
        weights: &[CellWeights],
        nodes: &[MixedNode],
        first: u32,
        sums: &mut [ColumnBlock],
    ) = sum_cells_body::<FUSED>;
}

#[inline(always)]
fn sum_cells_body<const FUSED: bool>(
    lit: &[LitColumn],
    cells: &[PreparedCell],
    weights: &[CellWeights],
    nodes: &[MixedNode],
    first: u32,
    sums: &mut [ColumnBlock],
) {
    for lit in lit {
        let range = lit.first_cell as usize..lit.end_cell as usize;
        let mut sum = [[0f32; BLOCK]; BAND_COUNT];
        for (cell, weights) in cells[range.clone()].iter().zip(&weights[range]) {
            let (lower, upper) = (&nodes[cell.lower_node as usize].0, &nodes[cell.upper_node() as usize].0);
            for band in 0..BAND_COUNT {
                let (to_lower, to_upper) = (weights[0][band], weights[1][band]);
                for k in 0..BLOCK {
                    let with_lower = multiply_add::<FUSED>(to_lower, lower[band][k], sum[band][k]);
                    sum[band][k] = multiply_add::<FUSED>(to_upper, upper[band][k], with_lower);
                }
            }
        }
        sums[(lit.azimuth - first) as usize] = Aligned(sum);
    }
}

simd_dispatch! {
    /// The same in one band alone, bit for bit.
    fn sum_cells_in_band(
        lit: &[LitColumn],
        cells: &[PreparedCell],
        weights: &[CellWeights],
        nodes: &[MixedNode],
        first: u32,
        band: usize,
        sums: &mut [ColumnBlock],
    ) = sum_cells_in_band_body::<FUSED>;
}

#[inline(always)]
fn sum_cells_in_band_body<const FUSED: bool>(
    lit: &[LitColumn],
    cells: &[PreparedCell],
    weights: &[CellWeights],
    nodes: &[MixedNode],
    first: u32,
    band: usize,
    sums: &mut [ColumnBlock],
) {
    for lit in lit {
        let range = lit.first_cell as usize..lit.end_cell as usize;
        let mut sum = [0f32; BLOCK];
        for (cell, weights) in cells[range.clone()].iter().zip(&weights[range]) {
            let lower = &nodes[cell.lower_node as usize].0[band];
            let upper = &nodes[cell.upper_node() as usize].0[band];
            for k in 0..BLOCK {
                let with_lower = multiply_add::<FUSED>(weights[0][band], lower[k], sum[k]);
                sum[k] = multiply_add::<FUSED>(weights[1][band], upper[k], with_lower);
            }
        }
        sums[(lit.azimuth - first) as usize].0[band] = sum;
    }
}
