//! Interpolation between the packs of a request.

use super::accumulate::dispatch_avx2;
use crate::{taps::Taps, twin::blend_radiance};
use rayon::prelude::*;

/// Samples a task blends.
const SAMPLES_PER_TASK: usize = 4096;

/// Blends up to four panoramas sample by sample with the weights of their packs.
pub(crate) fn blend(rendered: &[Vec<f32>], taps: &Taps) -> Vec<f32> {
    let (weights, bracket) = (taps.weights_f32(), taps.bracket_f32());
    let mut blended = vec![0.0; rendered[0].len()];
    blended.par_chunks_mut(SAMPLES_PER_TASK).enumerate().for_each(|(task, target)| {
        let start = task * SAMPLES_PER_TASK;
        // A pack that is not there has no weight; any other's samples stand in for it.
        let sources: [&[f32]; 4] =
            std::array::from_fn(|pack| &rendered[pack.min(rendered.len() - 1)][start..start + target.len()]);
        blend_samples(sources, weights, bracket, target);
    });
    blended
}

dispatch_avx2!(
    /// Blends samples of four packs into `target`.
    blend_samples, blend_samples_avx2, blend_samples_body,
    (sources: [&[f32]; 4], weights: [f32; 4], bracket: [f32; 4], target: &mut [f32])
);

#[inline(always)]
fn blend_samples_body(sources: [&[f32]; 4], weights: [f32; 4], bracket: [f32; 4], target: &mut [f32]) {
    let [a, b, c, d] = sources;
    for ((((target, a), b), c), d) in target.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        *target = blend_radiance([*a, *b, *c, *d], weights, bracket);
    }
}
