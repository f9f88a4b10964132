//! Sums over far lights at the Chebyshev nodes of a patch, and their interpolation to its parts and places.

use super::chebyshev::NODE_COUNT;
use super::patch::{PATCH_NODES, Patch};

/// Sums over far lights at the nodes of a patch.
pub(super) struct NodeSums {
    patch: Patch,
    /// The lowest altitude of the kernels that they are known for.
    pub(super) lowest: usize,
    /// `[altitude][node row][node column]`.
    pub(super) sums: Vec<[f32; PATCH_NODES]>,
}

impl NodeSums {
    /// Those of the patch that a patch is part of, at its own nodes.
    pub(super) fn inherit(patch: Patch, (lowest, highest): (usize, usize), from: Option<&Self>) -> Self {
        let mut sums = vec![[0f32; PATCH_NODES]; highest - lowest + 1];
        if let Some(from) = from {
            let columns = patch.columns.nodes().map(|node| from.patch.columns.weights_at(node));
            let rows = patch.rows.nodes().map(|node| from.patch.rows.weights_at(node));
            for (sums, from) in sums.iter_mut().zip(&from.sums[lowest - from.lowest..]) {
                for (node, sum) in sums.iter_mut().enumerate() {
                    *sum = mix(from, &columns[node % NODE_COUNT], &rows[node / NODE_COUNT]);
                }
            }
        }
        Self { patch, lowest, sums }
    }

    /// Whether they are all 0.
    pub(super) fn is_dark(&self) -> bool {
        self.sums.iter().flatten().all(|sum| *sum == 0.0)
    }

    /// At a place of the patch and an altitude: the node below on the kernels' axis and the weight of the next.
    pub(super) fn at(&self, column: f64, row: f64, (below, up): (usize, f32)) -> f32 {
        let (columns, rows) = (self.patch.columns.weights_at(column), self.patch.rows.weights_at(row));
        let [low, high] = [0, 1].map(|step| mix(&self.sums[below - self.lowest + step], &columns, &rows));
        low + up * (high - low)
    }
}

fn mix(nodes: &[f32; PATCH_NODES], columns: &[f32; NODE_COUNT], rows: &[f32; NODE_COUNT]) -> f32 {
    let of_row = |(row, weight): (&[f32], &f32)| {
        weight * row.iter().zip(columns).map(|(value, weight)| value * weight).sum::<f32>()
    };
    nodes.chunks_exact(NODE_COUNT).zip(rows).map(of_row).sum()
}
