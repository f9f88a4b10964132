//! Mixing the shapes of observer altitudes and lobes at the nodes that are needed: sums of half-precision rows.

use super::{
    lanes::{Aligned, LANES},
    layout::{BLOCK, MixedNode, NodeScales},
    work::for_each_part,
};
use crate::{node_table::NodeTable, prepare::Prepared};
use half::f16;
use skyglow_physics::{BAND_COUNT, LOBE_COUNT, interpolation::MAX_STENCIL, simd::is_wide};
use skyglow_tables::resident::ResidentTables;

/// Nodes that a task mixes.
const NODES_PER_TASK: usize = 64;
/// How many nodes ahead coefficients are prefetched.
#[cfg(target_arch = "x86_64")]
const NODES_AHEAD: usize = 2;
/// Coefficients in a cache line.
#[cfg(target_arch = "x86_64")]
const LINE: usize = 32;

/// Shape coefficients of every node, `[block of functions][node]`: Σ_lobe share · Σ_tap weight · shape.
pub fn mix_shape(
    tables: &ResidentTables,
    request: &Prepared,
    scales: &[NodeScales],
    side_by_side: bool,
    mixed: &mut Vec<MixedNode>,
) {
    let basis_count = request.basis_count.min(tables.basis_count);
    let node_count = request.nodes.len();
    mixed.resize(basis_count.div_ceil(BLOCK) * node_count, Aligned([[0.0; BLOCK]; BAND_COUNT]));
    // A node's coefficients lie together: a task has some nodes in every block.
    let mut tasks: Vec<Vec<&mut [MixedNode]>> = Vec::new();
    tasks.resize_with(node_count.div_ceil(NODES_PER_TASK), Vec::new);
    for nodes in mixed.chunks_mut(node_count.max(1)) {
        for (task, nodes) in tasks.iter_mut().zip(nodes.chunks_mut(NODES_PER_TASK)) {
            task.push(nodes);
        }
    }
    for_each_part(side_by_side, &mut tasks, 1, |task, blocks| {
        for blocks in blocks {
            mix_nodes(tables, request, scales, basis_count, task * NODES_PER_TASK, blocks);
        }
    });
}

/// The nodes from `first` on in all blocks, `[block][node]`.
fn mix_nodes(
    tables: &ResidentTables,
    request: &Prepared,
    scales: &[NodeScales],
    basis_count: usize,
    first: usize,
    blocks: &mut [&mut [MixedNode]],
) {
    #[cfg(target_arch = "x86_64")]
    if is_wide() {
        #[expect(unsafe_code, reason = "the processor was just asked for all that the callee needs")]
        // SAFETY: the features are there, and the function has no other precondition.
        unsafe {
            mix_nodes_wide(tables, request, scales, basis_count, first, blocks);
        };
        return;
    }
    let sum_shapes = |terms: &[Term<'_>], sum: &mut [f32; BLOCK]| {
        *sum = [0.0; BLOCK];
        for (factor, shape) in terms {
            for (sum, value) in sum.iter_mut().zip(*shape) {
                *sum += factor * value.to_f32();
            }
        }
    };
    mix_nodes_with(tables, request, scales, basis_count, first, blocks, sum_shapes);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,f16c")]
fn mix_nodes_wide(
    tables: &ResidentTables,
    request: &Prepared,
    scales: &[NodeScales],
    basis_count: usize,
    first: usize,
    blocks: &mut [&mut [MixedNode]],
) {
    let sum_shapes = |terms: &[Term<'_>], sum: &mut [f32; BLOCK]| sum_shapes_wide(terms, sum);
    mix_nodes_with(tables, request, scales, basis_count, first, blocks, sum_shapes);
}

/// Prefetches the coefficients of a node, whose place no processor predicts: they arrive while others are worked on, and
/// the mix takes half the time.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn prefetch(table: &NodeTable<'_>, request: &Prepared, basis_count: usize) {
    let in_use = basis_count.min(table.basis_count);
    for altitude in table.altitudes.nodes() {
        for lobe in (0..LOBE_COUNT).filter(|&lobe| request.emission[lobe] > 0.0) {
            for (band, _) in request.lit_bands().enumerate().filter(|(_, is_lit)| *is_lit) {
                let start = table.shape_index(altitude, lobe, band) * table.basis_count;
                let image = &table.shape[start..][..in_use];
                for line in image.chunks(LINE) {
                    prefetch_line(&line[0]);
                }
                // An image begins anywhere in a line and ends in one more, where a whole one's next begins.
                if in_use < table.basis_count
                    && let Some(last) = image.last()
                {
                    prefetch_line(last);
                }
            }
        }
    }
}

/// Prefetches the cache line of a value.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn prefetch_line(value: &f16) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    #[expect(unsafe_code, reason = "there is no safe way to prefetch")]
    // SAFETY: it changes nothing whatever the address, and every x86-64 has it.
    unsafe {
        _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(value).cast());
    }
}

/// A factor and coefficients.
type Term<'a> = (f32, &'a [f16]);

/// `sum_shapes` gives Σ factor · shape of coefficients of one length, and 0 beyond the first [`BLOCK`] of them.
#[inline(always)]
fn mix_nodes_with(
    tables: &ResidentTables,
    request: &Prepared,
    scales: &[NodeScales],
    basis_count: usize,
    first: usize,
    blocks: &mut [&mut [MixedNode]],
    sum_shapes: impl Fn(&[Term<'_>], &mut [f32; BLOCK]),
) {
    let count = blocks.first().map_or(0, |nodes| nodes.len());
    for (slot, (node, scales)) in request.nodes[first..].iter().zip(&scales[first..]).enumerate().take(count)
    {
        #[cfg(target_arch = "x86_64")]
        if let Some(ahead) = request.nodes[first..][..count].get(slot + NODES_AHEAD) {
            prefetch(&NodeTable::of(tables, request, ahead), request, basis_count);
        }
        let table = NodeTable::of(tables, request, node);
        let weights = table.altitudes.weights_f32();
        let basis_count = basis_count.min(table.basis_count);
        for (band, is_lit) in request.lit_bands().enumerate() {
            let mut terms: [Term<'_>; LOBE_COUNT * MAX_STENCIL] = [(0.0, &[]); LOBE_COUNT * MAX_STENCIL];
            let mut count = 0;
            for lobe in (0..LOBE_COUNT).filter(|&lobe| is_lit && scales.shares[band][lobe] > 0.0) {
                for (altitude, weight) in table.altitudes.nodes().zip(weights) {
                    let start = table.shape_index(altitude, lobe, band) * table.basis_count;
                    terms[count] = (scales.shares[band][lobe] * weight, &table.shape[start..][..basis_count]);
                    count += 1;
                }
            }
            for nodes in &mut *blocks {
                sum_shapes(&terms[..count], &mut nodes[slot].0[band]);
                for (_, shape) in &mut terms[..count] {
                    *shape = &shape[BLOCK.min(shape.len())..];
                }
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,f16c")]
#[inline]
fn sum_shapes_wide(terms: &[Term<'_>], sum: &mut [f32; BLOCK]) {
    use std::arch::x86_64::{__m256, _mm256_cvtph_ps, _mm256_fmadd_ps, _mm256_set1_ps, _mm256_setzero_ps};

    let mut octets: [__m256; BLOCK / LANES] = [_mm256_setzero_ps(); BLOCK / LANES];
    for (factor, shape) in terms {
        let factor = _mm256_set1_ps(*factor);
        if let Some(shape) = shape.first_chunk::<BLOCK>() {
            for (sum, values) in octets.iter_mut().zip(shape.as_chunks::<LANES>().0) {
                *sum = _mm256_fmadd_ps(factor, _mm256_cvtph_ps(bytemuck::cast(*values)), *sum);
            }
            continue;
        }
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
