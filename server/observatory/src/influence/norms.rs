//! Norms of cells: √(cᵀ·gram·c), for no azimuth matters.

use super::scales::{Slope, scales_of, steps_around};
use skyglow_physics::{BAND_COUNT, simd::multiply_add, simd_dispatch, spectrum::SpectralRule};
use skyglow_render::{
    cpu::layout::{BLOCK, MixedNode, NodeScales},
    prepare::{Prepared, PreparedCell},
};

/// What the norms of cells in one pack are computed from.
pub(super) struct NormsOfPack<'a> {
    pub(super) request: &'a Prepared,
    /// What sees the light of the cells.
    pub(super) rule: &'a SpectralRule,
    pub(super) scales: &'a [NodeScales],
    pub(super) mixed: &'a [MixedNode],
    /// `[function][function]`, `stride` to a row.
    pub(super) gram: &'a [f32],
    pub(super) stride: usize,
    pub(super) basis_count: usize,
}

/// Most functions that a pack may have.
const MAX_FUNCTIONS: usize = 256;
/// Coefficients of luminance, those beyond the basis 0.
type Coefficients = [f32; MAX_FUNCTIONS];

impl NormsOfPack<'_> {
    /// √(cᵀ·gram·c) of a cell, and how it changes with its place on the offset axis: (gram·c)·dc/norm.
    pub(super) fn norm(&self, cell: &PreparedCell) -> Slope {
        let (mut here, mut times) = ([0f32; MAX_FUNCTIONS], [0f32; MAX_FUNCTIONS]);
        self.coefficients(cell, cell.upper_weight, &mut here);
        times_gram(self.gram, self.stride, self.basis_count, &here, &mut times);
        let dot = |other: &Coefficients| -> f64 {
            let products = times[..self.basis_count].iter().zip(other);
            products.map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
        };
        let norm = dot(&here).max(0.0).sqrt();
        let mut slope = 0.0;
        if let Some((low, high)) = steps_around(cell.upper_weight)
            && norm > 0.0
        {
            let (mut below, mut above) = ([0f32; MAX_FUNCTIONS], [0f32; MAX_FUNCTIONS]);
            self.coefficients(cell, low, &mut below);
            self.coefficients(cell, high, &mut above);
            slope = (dot(&above) - dot(&below)) / (f64::from(high - low) * norm);
        }
        Slope { value: norm, slope }
    }

    fn coefficients(&self, cell: &PreparedCell, upper_weight: f32, coefficients: &mut Coefficients) {
        let nodes = self.request.nodes.len();
        // A light's own sky has much the same colour everywhere: that of its scales, at which the response is taken as linear.
        let scale = scales_of(cell, self.scales).scale(self.request.flux_per_dnb_flux, upper_weight);
        let slopes = self.rule.gradient(scale.map(f64::from));
        let factors: [f32; BAND_COUNT] = std::array::from_fn(|band| slopes[band] as f32 * scale[band]);
        let ends = [cell.lower_node, cell.upper_node()].map(|node| node as usize);
        let blocks = coefficients[..self.basis_count].chunks_mut(BLOCK);
        for (nodes, coefficients) in self.mixed.chunks_exact(nodes).zip(blocks) {
            for (b, factor) in factors.into_iter().enumerate() {
                let factors = [factor * (1.0 - upper_weight), factor * upper_weight];
                let [lower, upper] = ends.map(|end| &nodes[end].0[b]);
                for ((sum, lower), upper) in coefficients.iter_mut().zip(lower).zip(upper) {
                    *sum += factors[0] * lower + factors[1] * upper;
                }
            }
        }
    }
}

simd_dispatch! {
    /// gram·c.
    fn times_gram(
        gram: &[f32],
        stride: usize,
        basis_count: usize,
        coefficients: &Coefficients,
        product: &mut Coefficients,
    ) = times_gram_body::<FUSED>;
}

#[inline(always)]
fn times_gram_body<const FUSED: bool>(
    gram: &[f32],
    stride: usize,
    basis_count: usize,
    coefficients: &Coefficients,
    product: &mut Coefficients,
) {
    // It is symmetric: rows are columns, and a few functions at a time stay in registers.
    for first in (0..basis_count).step_by(BLOCK) {
        let mut sums = [0f32; BLOCK];
        let width = BLOCK.min(stride - first);
        for (row, coefficient) in gram.chunks_exact(stride).zip(&coefficients[..basis_count]) {
            let row = &row[first..];
            // Whole blocks are of a length that the compiler knows.
            match row.first_chunk::<BLOCK>() {
                Some(whole) => add_row::<FUSED>(*coefficient, whole, &mut sums),
                None => add_row::<FUSED>(*coefficient, row, &mut sums),
            }
        }
        product[first..first + width].copy_from_slice(&sums[..width]);
    }
}

#[inline(always)]
fn add_row<const FUSED: bool>(coefficient: f32, row: &[f32], sums: &mut [f32; BLOCK]) {
    for (sum, value) in sums.iter_mut().zip(row) {
        *sum = multiply_add::<FUSED>(coefficient, *value, *sum);
    }
}
