//! The weights of the two nodes of every lit cell, by Everett interpolation of ln of the scale (Everett 1900).

use super::{
    layout::{CellWeights, NodeScales},
    work::for_each_part,
};
use crate::{
    prepare::{Prepared, PreparedCell},
    twin::{MAX_BAND_COUNT, band_channels, log_scale_between, natural_exp},
};
use skyglow_physics::{BAND_COUNT, simd_dispatch};

/// Cells weighed side by side: enough that the compiler makes a loop of vectors of the arithmetic.
const LANES: usize = 64;
/// Cells that a task weighs.
const CELLS_PER_TASK: usize = 2048;

/// Weights of every cell.
pub fn cell_weights(
    request: &Prepared,
    scales: &[NodeScales],
    side_by_side: bool,
    weights: &mut Vec<CellWeights>,
) {
    weights.resize(request.cells.len(), [[0.0; MAX_BAND_COUNT]; 2]);
    for_each_part(side_by_side, weights, CELLS_PER_TASK, |task, weights| {
        let cells = &request.cells[task * CELLS_PER_TASK..][..weights.len()];
        weigh(cells, scales, request.flux_per_dnb_flux, weights);
    });
}

simd_dispatch! {
    /// [`crate::twin::cell_weights`] of cells whose lamps have `flux_per_dnb_flux`.
    fn weigh(
        cells: &[PreparedCell],
        scales: &[NodeScales],
        flux_per_dnb_flux: [f32; BAND_COUNT],
        weights: &mut [CellWeights],
    ) = weigh_body;
}

#[inline(always)]
fn weigh_body(
    cells: &[PreparedCell],
    scales: &[NodeScales],
    flux_per_dnb_flux: [f32; BAND_COUNT],
    weights: &mut [CellWeights],
) {
    let flux_per_dnb_flux = band_channels(flux_per_dnb_flux);
    for (cells, weights) in cells.chunks(LANES).zip(weights.chunks_mut(LANES)) {
        let mut scale = [[0f32; MAX_BAND_COUNT]; LANES];
        for (cell, scale) in cells.iter().zip(&mut scale) {
            let [lower, upper] = [cell.lower_node, cell.upper_node()].map(|node| &scales[node as usize]);
            for (band, scale) in scale.iter_mut().enumerate() {
                let log_scale = [lower.log_scale[band], upper.log_scale[band]];
                *scale = log_scale_between(
                    log_scale,
                    [lower.curvature[band], upper.curvature[band]],
                    cell.upper_weight,
                );
            }
        }
        for scale in scale.as_flattened_mut() {
            *scale = natural_exp(*scale);
        }
        for ((cell, scale), weights) in cells.iter().zip(&scale).zip(weights) {
            let mut weighed = [[0f32; MAX_BAND_COUNT]; 2];
            for band in 0..MAX_BAND_COUNT {
                let scale = cell.flux_dnb_w * flux_per_dnb_flux[band] * scale[band];
                weighed[0][band] = scale * (1.0 - cell.upper_weight);
                weighed[1][band] = scale * cell.upper_weight;
            }
            *weights = weighed;
        }
    }
}
