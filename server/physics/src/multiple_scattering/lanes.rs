//! Outputs side by side: bands by lobes, padded to whole vectors.
//!
//! f32 holds them: relative rounding of 1e-7 a step against errors of 1e-3 and more of everything around it;
//! amplitudes are stored as logarithms, so nothing under- or overflows.

use crate::{bands::BAND_COUNT, emission::LOBE_COUNT, simd::exponential, single_source::RadiancePerWatt};

/// Outputs, and the padding: vectors of four.
pub(super) const LANES: usize = (BAND_COUNT * LOBE_COUNT).next_multiple_of(4);
/// One value for each output, at `band · LOBE_COUNT + lobe`.
pub(super) type Lanes = [f32; LANES];

/// Lanes in the first of two vectors.
const FIRST: usize = 8;

/// sum += a·x + b·y. Eight lanes and the others by themselves: the compiler does not vectorise one loop over twelve well.
#[inline(always)]
pub(super) fn add_two(sum: &mut Lanes, (a, x): (f32, &Lanes), (b, y): (f32, &Lanes)) {
    for lane in 0..FIRST {
        sum[lane] += a * x[lane] + b * y[lane];
    }
    for lane in FIRST..LANES {
        sum[lane] += a * x[lane] + b * y[lane];
    }
}

/// One value a band, spread over its lobes.
pub(super) fn lanes_from_bands(values: [f64; BAND_COUNT]) -> Lanes {
    std::array::from_fn(|lane| values.get(lane / LOBE_COUNT).map_or(0.0, |&value| value as f32))
}

/// The outputs as `[band][lobe]`.
pub(super) fn outputs_from_lanes(lanes: &[f64; LANES]) -> RadiancePerWatt {
    std::array::from_fn(|band| std::array::from_fn(|lobe| lanes[band * LOBE_COUNT + lobe]))
}

/// e^x of each, by [`exponential`].
#[inline(always)]
pub(super) fn exp_lanes(x: &Lanes) -> Lanes {
    let mut result = [0.0; LANES];
    for lane in 0..LANES {
        result[lane] = exponential(x[lane]);
    }
    result
}

/// arccos to 7e-5 (Abramowitz and Stegun 4.4.45), 0..=π.
#[inline(always)]
pub(super) fn arccos(cosine: f32) -> f32 {
    let x = cosine.abs().min(1.0);
    let angle = (1.0 - x).sqrt() * (1.570_728_8 + x * (-0.212_114_4 + x * (0.074_261 - 0.018_729_3 * x)));
    if cosine < 0.0 { std::f32::consts::PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fast_arc_cosine_keeps_its_tolerance() {
        for i in -1_000..=1_000 {
            let c = i as f32 / 1_000.0;
            assert!((arccos(c) - c.acos()).abs() < 1e-4, "{c}");
        }
    }
}
