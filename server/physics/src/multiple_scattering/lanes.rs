//! Outputs side by side: bands by lobes, padded to whole vectors.
//!
//! f32 holds them: relative rounding of 1e-7 a step against errors of 1e-3 and more of everything around it;
//! amplitudes are stored as logarithms, so nothing under- or overflows.

use crate::{bands::BAND_COUNT, emission::LOBE_COUNT, single_source::RadiancePerWatt};

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

/// eˣ to 2e-7 for −87 < x < 88, 0 below; without branches, so that all at once are vector code.
#[inline(always)]
pub(super) fn exp_lanes(x: &Lanes) -> Lanes {
    // 2^t with t = n + r: adding 1.5·2²³ rounds t to the integer n and leaves it in the low bits.
    const ROUND: f32 = 12_582_912.0;
    let mut result = [0.0; LANES];
    for lane in 0..LANES {
        let t = (x[lane] * std::f32::consts::LOG2_E).clamp(-125.0, 126.0);
        let rounded = t + ROUND;
        let r = (t - (rounded - ROUND)) * std::f32::consts::LN_2;
        let power = f32::from_bits((rounded.to_bits() << 23).wrapping_add(127 << 23));
        let series =
            1.0 + r * (1.0 + r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r / 720.0)))));
        result[lane] = power * series;
    }
    result
}

/// ln x to 1e-6 for normal x > 0.
#[inline(always)]
pub(super) fn fast_ln(x: f32) -> f32 {
    // x = 2ⁿ·m with m between √½ and √2; ln m = 2·artanh(s), s = (m − 1)/(m + 1).
    const SQRT_HALF_BITS: u32 = 0x3f35_04f3;
    let shifted = x.to_bits().wrapping_sub(SQRT_HALF_BITS);
    let exponent = (shifted as i32) >> 23;
    let m = f32::from_bits((shifted & 0x007f_ffff) + SQRT_HALF_BITS);
    let s = (m - 1.0) / (m + 1.0);
    let s2 = s * s;
    let series = 2.0 * s * (1.0 + s2 * (1.0 / 3.0 + s2 * (0.2 + s2 * (1.0 / 7.0 + s2 / 9.0))));
    exponent as f32 * std::f32::consts::LN_2 + series
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

    /// The fast exponential, logarithm and arc cosine are as accurate as they state.
    #[test]
    fn fast_functions_keep_their_tolerance() {
        for i in 0..2_000 {
            let x = 1.013f32.powi(i) * 1e-3;
            assert!((fast_ln(x) - x.ln()).abs() < 2e-6 + 1e-7 * x.ln().abs(), "{x}");
        }
        for i in -800..800 {
            let x = i as f32 * 0.1;
            let got = exp_lanes(&[x; LANES])[7];
            assert!(
                (f64::from(got) / f64::from(x).exp() - 1.0).abs() < 1e-6 * (1.0 + f64::from(x).abs()),
                "{x}"
            );
        }
        for i in -1_000..=1_000 {
            let c = i as f32 / 1_000.0;
            assert!((arccos(c) - c.acos()).abs() < 1e-4, "{c}");
        }
    }
}
