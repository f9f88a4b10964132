//! What the accumulation must do first at a new place: from images on the pack's own axes to those of this observer.
//!
//! A table of images that serves every observer and every emission has the axes of the pack: observer altitude and lobe
//! beside ring and source altitude. For each node that the lit cells touch, the images of the altitudes around the
//! observer's and of the lobes in use are weighted as the engine weights their coefficients, and summed:
//! I = Σ_lobe share · Σ_altitude w · I(altitude, lobe, node).

use crate::images::{ImageTable, TASK_COUNT, TASK_LEN, TASKS_PER_BAND, add_scaled_body};
use rayon::prelude::*;
use skyglow_physics::{BAND_COUNT, LOBE_COUNT, Panorama, simd_dispatch};
use skyglow_render::prepare::{MixNode, Prepared};
use skyglow_tables::ResidentTables;

/// Images on the pack's axes around some nodes of a request under an open sky.
#[derive(Clone, Debug)]
pub struct StoredImages {
    stored: ImageTable,
    node_count: usize,
    /// Altitudes times lobes in use.
    part_count: usize,
    /// `[band][node][part]`.
    weights: Vec<f32>,
}

impl StoredImages {
    /// Around at most `max_nodes` of the request's nodes, evenly chosen.
    pub fn of(request: &Prepared, tables: &ResidentTables, max_nodes: usize) -> Self {
        let stride = request.nodes.len().div_ceil(max_nodes.max(1)).max(1);
        let nodes: Vec<MixNode> = request.nodes.iter().step_by(stride).copied().collect();
        let lobes: Vec<usize> = (0..LOBE_COUNT).filter(|&lobe| request.emission[lobe] > 0.0).collect();
        let altitudes = request.altitude_stencil;
        let basis_count = request.basis_count.min(tables.basis_count);
        let mut weights = Vec::new();
        let mut shape = Vec::new();
        for band in 0..BAND_COUNT {
            for node in &nodes {
                let (ring, offset) = (node.ring as usize, node.offset as usize);
                let shares = shares(request, &lobes, &|altitude, lobe| {
                    f64::from(tables.log_scale[tables.scale_index(altitude, lobe, band, ring, offset)])
                });
                for (&lobe, share) in lobes.iter().zip(shares) {
                    for (altitude, weight) in altitudes {
                        weights.push((share * weight) as f32);
                        let image = tables.shape_index(altitude, lobe, band, ring, offset);
                        let start = image * tables.basis_count;
                        let coefficients = &tables.shape[start..start + basis_count];
                        shape.push(coefficients.iter().map(|value| value.to_f32()).collect());
                    }
                }
            }
        }
        Self {
            stored: ImageTable::expand(tables, &shape),
            node_count: nodes.len(),
            part_count: lobes.len() * altitudes.nodes().len(),
            weights,
        }
    }

    /// Nodes that are mixed.
    pub fn node_count(&self) -> usize {
        self.node_count
    }

    /// Bytes of the stored images.
    pub fn bytes(&self) -> u64 {
        self.stored.bytes()
    }

    /// A buffer for the mixed images: made before the time is taken.
    pub fn buffer(&self) -> Vec<f32> {
        vec![0.0; self.node_count * Panorama::LEN]
    }

    /// Mixes the image of every node into `mixed`, `[task][node][row in task][column]`, of [`Self::buffer`].
    pub fn mix(&self, mixed: &mut [f32]) {
        let of_band = self.node_count * self.part_count;
        mixed.par_chunks_mut((self.node_count * TASK_LEN).max(1)).take(TASK_COUNT).enumerate().for_each(
            |(task, mixed)| {
                let weights = &self.weights[task / TASKS_PER_BAND * of_band..][..of_band];
                mix_rows(self.stored.of_task(task), weights, self.part_count, mixed);
            },
        );
    }
}

/// Shares of the lobes in use in the light of one node, summing to 1.
fn shares(request: &Prepared, lobes: &[usize], log_scale: &dyn Fn(usize, usize) -> f64) -> Vec<f64> {
    let altitudes = request.altitude_stencil;
    let of_lobe = |&lobe: &usize| {
        let log = altitudes.sum(|altitude| log_scale(altitude, lobe));
        f64::from(request.emission[lobe]).ln() + log
    };
    let logs: Vec<f64> = lobes.iter().map(of_lobe).collect();
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = logs.iter().map(|log| (log - largest).exp()).sum();
    logs.into_iter().map(|log| (log - largest).exp() / sum).collect()
}

simd_dispatch! {
    /// Mixes some rows of every node's image.
    fn mix_rows(
        stored: &[f32],
        weights: &[f32],
        part_count: usize,
        mixed: &mut [f32],
    ) = mix_rows_body::<FUSED>;
}

#[inline(always)]
fn mix_rows_body<const FUSED: bool>(stored: &[f32], weights: &[f32], part_count: usize, mixed: &mut [f32]) {
    let parts = stored.chunks_exact(part_count * TASK_LEN).zip(weights.chunks_exact(part_count));
    for (target, (stored, weights)) in mixed.chunks_exact_mut(TASK_LEN).zip(parts) {
        target.fill(0.0);
        for (image, &weight) in stored.chunks_exact(TASK_LEN).zip(weights) {
            add_scaled_body::<FUSED>(image, weight, target);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{executors, scenes::LitScene};
    use skyglow_physics::Turbidity;
    use skyglow_render::reference::mixed_node;

    /// Mixed images are those of the engine's mixed coefficients and those of another observer are not.
    #[test]
    fn mixed_images_equal_mixed_coefficients() {
        let setting = crate::run::tests::setting(12);
        let scene = LitScene::of_cells(30);
        let tables = &setting.set.tables()[0];
        let prepared = |observer_altitude_m| {
            let turbidity = Turbidity::new(2.0).unwrap();
            let request = executors::request(&setting, &scene.polar, observer_altitude_m, turbidity, 12);
            Prepared::new(&request, &setting.set).unwrap()
        };
        let here = prepared(scene.observer_altitude_m);
        let stored = StoredImages::of(&here, tables, usize::MAX);
        assert_eq!(stored.part_count, 8);
        let mut mixed = stored.buffer();
        stored.mix(&mut mixed);
        let difference = |request: &Prepared| {
            let shape: Vec<Vec<f32>> = (0..BAND_COUNT)
                .flat_map(|band| here.nodes.iter().map(move |node| (band, node)))
                .map(|(band, node)| {
                    let shape = mixed_node(request, tables, band, node, 12).shape;
                    shape.into_iter().map(|value| value as f32).collect()
                })
                .collect();
            let expected = ImageTable::expand(tables, &shape);
            let of_task = (0..TASK_COUNT).flat_map(|task| expected.of_task(task));
            of_task.zip(&mixed).map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max)
        };
        let brightest = mixed.iter().copied().fold(0.0, f32::max);
        assert!(difference(&here) < 1e-5 * f64::from(brightest), "{}", difference(&here));
        assert!(difference(&prepared(1_500.0)) > 1e-3 * f64::from(brightest));
    }
}
