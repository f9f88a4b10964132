//! Interpolation between the packs of a request: [`Blend`] over all samples.

use super::work::for_each_part;
use crate::twin::{Blend, blend_radiance};
use skyglow_physics::{interpolation::Stencil, simd_dispatch};

/// Samples blended side by side: enough that the compiler makes a loop of vectors of every step.
const LANES: usize = 32;
/// Samples a task blends.
const SAMPLES_PER_TASK: usize = 4096;

/// Blends up to four panoramas sample by sample with the weights of their packs.
pub fn blend(rendered: &[&[f32]], stencil: &Stencil, side_by_side: bool) -> Vec<f32> {
    let (weights, linear) = (stencil.weights_f32(), stencil.linear_weights_f32());
    let mut blended = vec![0.0; rendered[0].len()];
    for_each_part(side_by_side, &mut blended, SAMPLES_PER_TASK, |task, target| {
        let start = task * SAMPLES_PER_TASK;
        // A pack that is not there has no weight; any other's samples stand in for it.
        let sources: [&[f32]; 4] =
            std::array::from_fn(|pack| &rendered[pack.min(rendered.len() - 1)][start..start + target.len()]);
        blend_samples(sources, weights, linear, target);
    });
    blended
}

simd_dispatch! {
    /// Blends samples of four packs into `target`.
    fn blend_samples(sources: [&[f32]; 4], weights: [f32; 4], linear: [f32; 4], target: &mut [f32])
        = blend_samples_body;
}

#[inline(always)]
fn blend_samples_body(sources: [&[f32]; 4], weights: [f32; 4], linear: [f32; 4], target: &mut [f32]) {
    let chunks = sources.map(|source| source.as_chunks::<LANES>().0);
    let (whole, rest) = target.as_chunks_mut::<LANES>();
    let done = LANES * whole.len();
    for (position, target) in whole.iter_mut().enumerate() {
        *target = Blend::of(chunks.map(|source| &source[position]), weights, linear).radiance_w_m2_sr();
    }
    for (offset, target) in rest.iter_mut().enumerate() {
        *target = blend_radiance(sources.map(|source| source[done + offset]), weights, linear);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Noise;

    #[test]
    fn lanes_blend_as_samples_alone_bit_for_bit() {
        let mut noise = Noise::new(3);
        let mut sky = || -> Vec<f32> {
            // Down to below the floor, some of it black.
            (0..SAMPLES_PER_TASK + 13)
                .map(
                    |_| if noise.unit() < 0.1 { 0.0 } else { 10f64.powf(-15.0 + 11.0 * noise.unit()) as f32 },
                )
                .collect()
        };
        let skies = [sky(), sky(), sky(), sky()];
        for (count, x) in [(4, 1.3), (4, 0.2), (3, 0.7), (2, 0.5)] {
            let nodes: Vec<f64> = (0..count).map(f64::from).collect();
            let stencil = Stencil::lagrange_or_node(&nodes, x, 1e-9);
            let rendered: Vec<&[f32]> = skies[..count as usize].iter().map(Vec::as_slice).collect();
            let blended = blend(&rendered, &stencil, true);
            let differing = |turned: usize| {
                let twin = |sample: usize| {
                    let source = |pack: usize| rendered[pack.min(rendered.len() - 1)][sample];
                    let sources = [0, 1, 2, 3].map(|pack| source((pack + turned) % 4));
                    blend_radiance(sources, stencil.weights_f32(), stencil.linear_weights_f32())
                };
                (0..blended.len())
                    .filter(|&sample| blended[sample].to_bits() != twin(sample).to_bits())
                    .count()
            };
            assert_eq!(differing(0), 0, "{count} packs");
            assert!(differing(1) > blended.len() / 2, "{count} packs");
        }
    }
}
