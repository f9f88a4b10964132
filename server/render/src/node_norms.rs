//! Norms of the truncation remainder of each node's image, from the Gram matrix of the basis, and integrals of the whole image.

use half::f16;
use rayon::prelude::*;

/// Basis sizes tried are multiples of this many functions.
pub(crate) const FUNCTIONS_PER_STEP: usize = 8;

/// Norms and integrals of the nodes of one table.
#[derive(Debug)]
pub(crate) struct NodeNorms {
    /// `[node][M/8 − 1]`: ‖Σ_{k≥M} c_k·B_k‖.
    remainders: Vec<f32>,
    /// Basis sizes M.
    steps: usize,
    /// ∫Σ_k c_k·B_k dΩ of every node.
    integrals: Vec<f32>,
}

/// Nodes that a task works on.
const NODES_PER_TASK: usize = 512;

impl NodeNorms {
    /// Of coefficients `[node][function]` over a basis with the products `gram`, `[k][l]`, of all functions of the pack,
    /// and their integrals.
    pub(crate) fn of(shape: &[f16], basis_count: usize, gram: &[f64], integrals_sr: &[f64]) -> Self {
        let nodes = shape.len() / basis_count;
        let steps = integrals_sr.len().div_ceil(FUNCTIONS_PER_STEP) - 1;
        let mut remainders = vec![0f32; nodes * steps];
        let mut integrals = vec![0f32; nodes];
        let tasks = remainders.par_chunks_mut((NODES_PER_TASK * steps).max(1));
        tasks.zip(shape.par_chunks(NODES_PER_TASK * basis_count)).for_each(|(norms, shape)| {
            let mut coefficients = vec![0f64; basis_count];
            for (norms, shape) in norms.chunks_exact_mut(steps).zip(shape.chunks_exact(basis_count)) {
                for (value, half) in coefficients.iter_mut().zip(shape) {
                    *value = f64::from(*half);
                }
                put_norms(&coefficients, gram, integrals_sr.len(), norms);
            }
        });
        integrals.par_iter_mut().zip(shape.par_chunks(basis_count)).for_each(|(integral, shape)| {
            let terms = shape.iter().zip(integrals_sr).map(|(value, integral)| f64::from(*value) * integral);
            *integral = terms.sum::<f64>() as f32;
        });
        Self { remainders, steps, integrals }
    }

    /// Norms of what is left out of a node's image, by basis size.
    pub(crate) fn remainders(&self, node: usize) -> &[f32] {
        &self.remainders[node * self.steps..][..self.steps]
    }

    /// Integral of a node's whole image, sr.
    pub(crate) fn integral(&self, node: usize) -> f64 {
        f64::from(self.integrals[node])
    }
}

/// Puts the norms of one node: with g = Gram matrix, the square grows from size M + 8 to M by
/// Σ_{M≤k<M+8} c_k·(Σ_{l<M+8} g_kl·c_l + 2·Σ_{l≥M+8} g_kl·c_l).
fn put_norms(coefficients: &[f64], gram: &[f64], stride: usize, norms: &mut [f32]) {
    let count = coefficients.len();
    let mut square = 0.0;
    for step in (0..norms.len()).rev() {
        let first = (step + 1) * FUNCTIONS_PER_STEP;
        let end = (first + FUNCTIONS_PER_STEP).min(count);
        for k in first..end {
            let row = &gram[k * stride..][..count];
            let within: f64 = row[first..end].iter().zip(&coefficients[first..end]).map(|(g, c)| g * c).sum();
            let beyond: f64 = row[end..].iter().zip(&coefficients[end..]).map(|(g, c)| g * c).sum();
            square += coefficients[k] * (within + 2.0 * beyond);
        }
        // Rounded up, so that it stays a bound.
        norms[step] = (square.max(0.0).sqrt() * (1.0 + 1e-6)) as f32;
    }
}
