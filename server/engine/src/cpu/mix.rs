//! Mixing observer altitudes and lobes at the nodes that are needed.

use crate::{node_table::NodeTable, prepare::Prepared, twin::lobe_shares};
use half::slice::HalfFloatSliceExt;
use rayon::prelude::*;
use skyglow_physics::{BAND_COUNT, LOBE_COUNT};
use skyglow_tables::resident::ResidentTables;

/// Functions that one run of the coefficient kernel sums in registers.
pub(crate) const BLOCK: usize = 32;
/// Nodes a task mixes at once.
const NODES_PER_TASK: usize = 32;

/// `[band][node]` of [`lobe_shares`]: shares of the lobes and the logarithm of the mixed scale.
pub(crate) type Scales = Vec<[f32; 4]>;

/// Shape coefficients at the request's nodes.
pub(crate) struct MixedShape {
    /// Functions in use.
    pub(crate) basis_count: usize,
    /// The same rounded up to whole blocks; functions beyond are 0.
    pub(crate) padded_count: usize,
    /// `[band][node][function]`.
    pub(crate) shape: Vec<f32>,
}

/// Lobe shares and mixed scale of every node.
pub(crate) fn mix_scale(tables: &ResidentTables, request: &Prepared) -> Scales {
    let mut scales = Vec::with_capacity(BAND_COUNT * request.nodes.len());
    for band in 0..BAND_COUNT {
        for node in &request.nodes {
            let table = NodeTable::of(tables, request, node);
            let weights = table.taps.weights_f32();
            let log_scale = std::array::from_fn(|lobe| {
                table.taps.indices().iter().zip(weights).fold(0.0, |sum, (&tap, weight)| {
                    sum + weight * table.log_scale[table.index(tap, lobe, band)]
                })
            });
            scales.push(lobe_shares(request.emission, log_scale));
        }
    }
    scales
}

/// Shape coefficients of every node: Σ_lobe share · Σ_tap weight · shape.
pub(crate) fn mix_shape(tables: &ResidentTables, request: &Prepared, scales: &Scales) -> MixedShape {
    let basis_count = request.basis_count.min(tables.basis_count);
    let padded_count = basis_count.next_multiple_of(BLOCK);
    let node_count = request.nodes.len();
    let mut shape = vec![0.0; BAND_COUNT * node_count * padded_count];
    shape.par_chunks_mut(NODES_PER_TASK * padded_count).enumerate().for_each(|(task, rows)| {
        let mut decoded = vec![0f32; basis_count];
        for (offset, row) in rows.chunks_exact_mut(padded_count).enumerate() {
            let slot = task * NODES_PER_TASK + offset;
            let (band, node) = (slot / node_count, &request.nodes[slot % node_count]);
            let table = NodeTable::of(tables, request, node);
            let weights = table.taps.weights_f32();
            let in_use = basis_count.min(table.basis_count);
            for lobe in (0..LOBE_COUNT).filter(|&lobe| scales[slot][lobe] > 0.0) {
                for (&tap, weight) in table.taps.indices().iter().zip(weights) {
                    let position = table.index(tap, lobe, band) * table.basis_count;
                    table.shape[position..position + in_use].convert_to_f32_slice(&mut decoded[..in_use]);
                    let factor = scales[slot][lobe] * weight;
                    for (sum, value) in row.iter_mut().zip(&decoded[..in_use]) {
                        *sum += factor * value;
                    }
                }
            }
        }
    });
    MixedShape { basis_count, padded_count, shape }
}
