//! Interpolation between the packs of a request.

use super::{dispatch::dispatch_wide, work::for_each_part};
use crate::{
    taps::Taps,
    twin::{
        BEND_ALLOWED, BEND_SHARE_ALLOWED, DIMMEST_PACK, RADIANCE_FLOOR_W_M2_SR, blend_radiance, natural_exp,
        natural_log,
    },
};

/// Samples blended side by side: enough that the compiler makes a loop of vectors of every step.
const LANES: usize = 64;
/// Samples a task blends.
const SAMPLES_PER_TASK: usize = 4096;

/// Blends up to four panoramas sample by sample with the weights of their packs.
pub fn blend(rendered: &[&[f32]], taps: &Taps, side_by_side: bool) -> Vec<f32> {
    let (weights, bracket) = (taps.weights_f32(), taps.bracket_f32());
    let mut blended = vec![0.0; rendered[0].len()];
    for_each_part(side_by_side, &mut blended, SAMPLES_PER_TASK, |task, target| {
        let start = task * SAMPLES_PER_TASK;
        // A pack that is not there has no weight; any other's samples stand in for it.
        let sources: [&[f32]; 4] =
            std::array::from_fn(|pack| &rendered[pack.min(rendered.len() - 1)][start..start + target.len()]);
        blend_samples(sources, weights, bracket, target);
    });
    blended
}

dispatch_wide!(
    /// Blends samples of four packs into `target`.
    blend_samples, blend_samples_wide, blend_samples_body,
    (sources: [&[f32]; 4], weights: [f32; 4], bracket: [f32; 4], target: &mut [f32])
);

#[inline(always)]
fn blend_samples_body<const FUSED: bool>(
    sources: [&[f32]; 4],
    weights: [f32; 4],
    bracket: [f32; 4],
    target: &mut [f32],
) {
    let chunks = sources.map(|source| source.as_chunks::<LANES>().0);
    let (whole, rest) = target.as_chunks_mut::<LANES>();
    let done = LANES * whole.len();
    for (position, target) in whole.iter_mut().enumerate() {
        *target = blend_lanes(chunks.map(|source| &source[position]), weights, bracket);
    }
    for (offset, target) in rest.iter_mut().enumerate() {
        *target = blend_radiance(sources.map(|source| source[done + offset]), weights, bracket);
    }
}

/// [`blend_radiance`] in every lane, step by step, for the compiler makes vectors of simple loops alone.
#[inline(always)]
fn blend_lanes(radiance_w_m2_sr: [&[f32; LANES]; 4], weight: [f32; 4], bracket: [f32; 4]) -> [f32; LANES] {
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let smaller = |a: f32, b: f32| if a < b { a } else { b };
    let mut log = [[0f32; LANES]; 4];
    let mut largest = [RADIANCE_FLOOR_W_M2_SR; LANES];
    for samples in radiance_w_m2_sr {
        for lane in 0..LANES {
            largest[lane] = larger(samples[lane], largest[lane]);
        }
    }
    let mut brighter = [RADIANCE_FLOOR_W_M2_SR; LANES];
    for (samples, _) in radiance_w_m2_sr.iter().zip(bracket).filter(|(_, bracket)| *bracket > 0.0) {
        for lane in 0..LANES {
            brighter[lane] = larger(samples[lane], brighter[lane]);
        }
    }
    for (log, samples) in log.iter_mut().zip(radiance_w_m2_sr) {
        for lane in 0..LANES {
            let floored = larger(samples[lane], RADIANCE_FLOOR_W_M2_SR);
            log[lane] = natural_log(larger(floored, DIMMEST_PACK * brighter[lane]) / largest[lane]);
        }
    }
    let (mut low, mut high) = ([0f32; LANES], [-1e30f32; LANES]);
    for (log, _) in log.iter().zip(bracket).filter(|(_, bracket)| *bracket > 0.0) {
        for lane in 0..LANES {
            low[lane] = smaller(log[lane], low[lane]);
            high[lane] = larger(log[lane], high[lane]);
        }
    }
    let mut blended = [0f32; LANES];
    for lane in 0..LANES {
        let sum = |weight: [f32; 4]| {
            weight[0] * log[0][lane]
                + weight[1] * log[1][lane]
                + weight[2] * log[2][lane]
                + weight[3] * log[3][lane]
        };
        let allowed = BEND_ALLOWED + BEND_SHARE_ALLOWED * (high[lane] - low[lane]);
        let line = sum(bracket);
        let log_ratio = line + smaller(larger(sum(weight) - line, -allowed), allowed);
        blended[lane] = largest[lane] * natural_exp(log_ratio);
    }
    for blended in &mut blended {
        *blended = if *blended <= 1.00001 * RADIANCE_FLOOR_W_M2_SR { 0.0 } else { *blended };
    }
    blended
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{synthetic::Noise, taps::lagrange_taps};

    #[test]
    fn samples_side_by_side_are_those_of_the_twin_bit_for_bit() {
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
            let taps = lagrange_taps(&nodes, x, 1e-9);
            let rendered: Vec<&[f32]> = skies[..count as usize].iter().map(Vec::as_slice).collect();
            let blended = blend(&rendered, &taps, true);
            let differing = |turned: usize| {
                let twin = |sample: usize| {
                    let source = |pack: usize| rendered[pack.min(rendered.len() - 1)][sample];
                    let sources = [0, 1, 2, 3].map(|pack| source((pack + turned) % 4));
                    blend_radiance(sources, taps.weights_f32(), taps.bracket_f32())
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
