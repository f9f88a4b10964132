//! Mixing observer altitudes and lobes at the nodes that are needed.

use super::{
    dispatch::{Aligned, LANES, dispatch_wide, is_wide},
    work::for_each_part,
};
use crate::{node_table::NodeTable, prepare::Prepared, taps::Taps, twin::lobe_shares};
use half::f16;
use skyglow_physics::{BAND_COUNT, LOBE_COUNT};
use skyglow_tables::resident::ResidentTables;

/// Functions that one run of the coefficient kernel sums in registers.
pub(crate) const BLOCK: usize = 32;
/// Nodes that a task mixes.
const NODES_PER_TASK: usize = 64;

/// Shares of the lobes at a node, and the logarithm of its mixed scale: [`lobe_shares`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct NodeScales {
    /// ln of the mixed scale in every band, and a 0 that makes it a vector.
    pub(crate) log_scale: [f32; 4],
    /// `[band][lobe]`, summing to 1.
    pub(crate) shares: [[f32; LOBE_COUNT]; BAND_COUNT],
}

/// Shape coefficients of one node in one block of functions: `[band][function]`; functions beyond those in use are 0.
pub(crate) type MixedNode = Aligned<[[f32; BLOCK]; BAND_COUNT]>;

/// Lobe shares and mixed scale of every node.
pub(crate) fn mix_scale(
    tables: &ResidentTables,
    request: &Prepared,
    side_by_side: bool,
    scales: &mut Vec<NodeScales>,
) {
    scales.resize(request.nodes.len(), NodeScales::default());
    for_each_part(side_by_side, scales, NODES_PER_TASK, |task, scales| {
        let nodes = &request.nodes[task * NODES_PER_TASK..][..scales.len()];
        let mut log_scale = [[[0f32; NODES_PER_TASK]; LOBE_COUNT]; BAND_COUNT];
        for (lane, node) in nodes.iter().enumerate() {
            let table = NodeTable::of(tables, request, node);
            let weights = table.taps.weights_f32();
            for (band, lobes) in log_scale.iter_mut().enumerate() {
                for lobe in (0..LOBE_COUNT).filter(|&lobe| request.emission[lobe] > 0.0) {
                    let taps = table.taps.indices().iter().zip(weights);
                    lobes[lobe][lane] = taps.fold(0.0, |sum, (&tap, weight)| {
                        sum + weight * table.log_scale[table.index(tap, lobe, band)]
                    });
                }
            }
        }
        for (band, lobes) in log_scale.iter().enumerate() {
            let mut shares = [[0f32; NODES_PER_TASK]; 4];
            share_out(request.emission, lobes, &mut shares);
            for (lane, scales) in scales.iter_mut().enumerate() {
                scales.shares[band] = [shares[0][lane], shares[1][lane], shares[2][lane]];
                scales.log_scale[band] = shares[3][lane];
            }
        }
    });
}

dispatch_wide!(
    /// [`lobe_shares`] of many nodes, `[value][node]`.
    share_out, share_out_wide, share_out_body,
    (
        emission: [f32; LOBE_COUNT],
        log_scale: &[[f32; NODES_PER_TASK]; LOBE_COUNT],
        shares: &mut [[f32; NODES_PER_TASK]; 4]
    )
);

#[inline(always)]
fn share_out_body<const FUSED: bool>(
    emission: [f32; LOBE_COUNT],
    log_scale: &[[f32; NODES_PER_TASK]; LOBE_COUNT],
    shares: &mut [[f32; NODES_PER_TASK]; 4],
) {
    for lane in 0..NODES_PER_TASK {
        let [first, second, third, log_sum] =
            lobe_shares(emission, [log_scale[0][lane], log_scale[1][lane], log_scale[2][lane]]);
        shares[0][lane] = first;
        shares[1][lane] = second;
        shares[2][lane] = third;
        shares[3][lane] = log_sum;
    }
}

/// Shape coefficients of every node, `[block of functions][node]`: Σ_lobe share · Σ_tap weight · shape.
pub(crate) fn mix_shape(
    tables: &ResidentTables,
    request: &Prepared,
    scales: &[NodeScales],
    side_by_side: bool,
    mixed: &mut Vec<MixedNode>,
) {
    let basis_count = request.basis_count.min(tables.basis_count);
    let node_count = request.nodes.len();
    mixed.resize(basis_count.div_ceil(BLOCK) * node_count, Aligned([[0.0; BLOCK]; BAND_COUNT]));
    for_each_part(side_by_side, mixed, NODES_PER_TASK, |task, rows| {
        for (slot, row) in (task * NODES_PER_TASK..).zip(rows) {
            let (block, node) = (slot / node_count, slot % node_count);
            mix_node(tables, request, node, &scales[node], block * BLOCK, basis_count, row);
        }
    });
}

/// One node in the block of functions that begins at `first`.
fn mix_node(
    tables: &ResidentTables,
    request: &Prepared,
    node: usize,
    scales: &NodeScales,
    first: usize,
    basis_count: usize,
    mixed: &mut MixedNode,
) {
    let table = NodeTable::of(tables, request, &request.nodes[node]);
    let weights = table.taps.weights_f32();
    let in_use = basis_count.min(table.basis_count).saturating_sub(first).min(BLOCK);
    for ((band, sum), is_lit) in mixed.0.iter_mut().enumerate().zip(request.lit_bands()) {
        if !is_lit {
            *sum = [0.0; BLOCK];
            continue;
        }
        let mut terms: [(f32, &[f16]); LOBE_COUNT * Taps::MAX] = [(0.0, &[]); LOBE_COUNT * Taps::MAX];
        let mut count = 0;
        for lobe in (0..LOBE_COUNT).filter(|&lobe| scales.shares[band][lobe] > 0.0) {
            for (&tap, weight) in table.taps.indices().iter().zip(weights) {
                let start = table.index(tap, lobe, band) * table.basis_count + first.min(table.basis_count);
                terms[count] = (scales.shares[band][lobe] * weight, &table.shape[start..][..in_use]);
                count += 1;
            }
        }
        sum_shapes(&terms[..count], sum);
    }
}

/// sum = Σ factor · shape, all of one length; 0 beyond it.
fn sum_shapes(terms: &[(f32, &[f16])], sum: &mut [f32; BLOCK]) {
    #[cfg(target_arch = "x86_64")]
    if is_wide() {
        #[expect(unsafe_code, reason = "the processor was just asked for all that the callee needs")]
        // SAFETY: the features are there, and the function has no other precondition.
        unsafe {
            sum_shapes_wide(terms, sum)
        };
        return;
    }
    *sum = [0.0; BLOCK];
    for (factor, shape) in terms {
        for (sum, value) in sum.iter_mut().zip(*shape) {
            *sum += factor * value.to_f32();
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,f16c")]
fn sum_shapes_wide(terms: &[(f32, &[f16])], sum: &mut [f32; BLOCK]) {
    use std::arch::x86_64::{__m256, _mm256_cvtph_ps, _mm256_fmadd_ps, _mm256_set1_ps, _mm256_setzero_ps};

    let mut octets: [__m256; BLOCK / LANES] = [_mm256_setzero_ps(); BLOCK / LANES];
    for (factor, shape) in terms {
        let factor = _mm256_set1_ps(*factor);
        let (whole, rest) = shape.as_chunks::<LANES>();
        for (sum, values) in octets.iter_mut().zip(whole) {
            *sum = _mm256_fmadd_ps(factor, _mm256_cvtph_ps(bytemuck::cast(*values)), *sum);
        }
        // Packs have functions by the four.
        if let Some(sum) = octets.get_mut(whole.len()).filter(|_| !rest.is_empty()) {
            let mut values = [f16::ZERO; LANES];
            values[..rest.len()].copy_from_slice(rest);
            *sum = _mm256_fmadd_ps(factor, _mm256_cvtph_ps(bytemuck::cast(values)), *sum);
        }
    }
    *sum = bytemuck::cast(octets);
}
