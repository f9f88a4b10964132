//! Log-space cubic Lagrange interpolation between packs of different turbidity, its deviation from the line limited
//! (`docs/model.md#turbidity`).

use super::elementary::Real;
use std::array::from_ref;

/// Radiance below which a sample counts as this much before the logarithm, W m⁻² sr⁻¹: about 3e-7 of the natural
/// sky.
pub const RADIANCE_FLOOR_W_M2_SR: f32 = 1e-13;

/// How far the cubic may leave the line between the two packs around, in the logarithm, besides [`MAX_DEVIATION_SHARE`] of
/// what lies between those two. A fall as exp(−kT), the steepest that there is, leaves it by 0.06 of that. Chosen by whole
/// skies of the first order at turbidity 2 (packs 1.5, 2.5, 3.5, 4.75) against the direct sum: worst mean of 15 places
/// 9.6 % without a limit, 5.6, 2.7, 1.5, 1.25 and 1.1 % with 0.05 + 0.25, 0.12, 0.08 and 0.1 + 0.06, 0.04.
pub const MAX_DEVIATION: f32 = 0.1;
/// See [`MAX_DEVIATION`].
pub const MAX_DEVIATION_SHARE: f32 = 0.06;

/// Smallest radiance of a pack in a direction, over that of the brighter one of the two around: a dimmer one counts as this.
/// Where the functions of a basis cancel, a sample is nothing but rounding, and its logarithm can be anything: between a lit pack
/// and a black one two executors were 5 % of the row's brightest apart. Between neighbouring packs air dims no visible
/// direction by that much.
pub const MIN_PACK_RATIO: f32 = 1e-3;

/// One sample of the sky between packs: exp Σ_p weight_p · ln max(radiance_p, floor), over the packs with weight (they
/// sum to 1); 0 where that is at or below the floor, give or take rounding. `linear` are the weights of linear
/// interpolation between the two packs around. [`Blend`] has the rule.
#[inline(always)]
pub fn blend_radiance<R: Real>(radiance_w_m2_sr: [R; 4], weight: [R; 4], linear: [R; 4]) -> R {
    let [blended] = Blend::of(radiance_w_m2_sr.each_ref().map(from_ref), weight, linear).radiance_w_m2_sr();
    blended
}

/// The blend of `N` samples of four packs, step by step: the compiler makes vectors of simple loops alone.
///
/// Logarithms are taken over the largest sample, which keeps them small; [`MIN_PACK_RATIO`] says where they end. Where a
/// basis leaves a dim direction of one of the outer packs black, its logarithm is a deep pit, and the cubic through it
/// overshoots elsewhere, by hundreds: so the cubic is kept near the line between the two packs around.
#[derive(Clone, Copy, Debug)]
pub struct Blend<R, const N: usize> {
    /// The largest sample of all packs.
    pub largest_w_m2_sr: [R; N],
    /// ln(sample/largest), `[pack][sample]`.
    pub log_ratio: [[R; N]; 4],
    /// The interpolated logarithm on the line between the two packs around.
    pub line: [R; N],
    /// The same of the cubic.
    pub cubic: [R; N],
    /// How far the cubic may leave the line.
    pub max_deviation: [R; N],
}

impl<R: Real, const N: usize> Blend<R, N> {
    /// Of packs with cubic and linear weights.
    #[inline(always)]
    pub fn of(radiance_w_m2_sr: [&[R; N]; 4], weight: [R; 4], linear: [R; 4]) -> Self {
        let (zero, floor) = (R::from(0.0), R::from(RADIANCE_FLOOR_W_M2_SR));
        let (mut largest, mut brighter) = ([floor; N], [floor; N]);
        for (samples, linear) in radiance_w_m2_sr.iter().zip(linear) {
            for lane in 0..N {
                largest[lane] = samples[lane].maximum(largest[lane]);
            }
            if linear > zero {
                for lane in 0..N {
                    brighter[lane] = samples[lane].maximum(brighter[lane]);
                }
            }
        }
        let mut log_ratio = [[zero; N]; 4];
        // Logarithms are not above 0.
        let (mut low, mut high) = ([zero; N], [R::from(-1e30); N]);
        for ((log_ratio, samples), linear) in log_ratio.iter_mut().zip(radiance_w_m2_sr).zip(linear) {
            for lane in 0..N {
                let floored = samples[lane].maximum(floor).maximum(R::from(MIN_PACK_RATIO) * brighter[lane]);
                log_ratio[lane] = (floored / largest[lane]).natural_log();
            }
            if linear > zero {
                for lane in 0..N {
                    low[lane] = log_ratio[lane].minimum(low[lane]);
                    high[lane] = log_ratio[lane].maximum(high[lane]);
                }
            }
        }
        let (mut line, mut cubic, mut max_deviation) = ([zero; N], [zero; N], [zero; N]);
        for lane in 0..N {
            let sum = |weight: [R; 4]| {
                weight[0] * log_ratio[0][lane]
                    + weight[1] * log_ratio[1][lane]
                    + weight[2] * log_ratio[2][lane]
                    + weight[3] * log_ratio[3][lane]
            };
            (line[lane], cubic[lane]) = (sum(linear), sum(weight));
            max_deviation[lane] =
                R::from(MAX_DEVIATION) + R::from(MAX_DEVIATION_SHARE) * (high[lane] - low[lane]);
        }
        Self { largest_w_m2_sr: largest, log_ratio, line, cubic, max_deviation }
    }

    /// How far a sample's logarithm is from the line.
    #[inline(always)]
    pub fn deviation(&self, lane: usize) -> R {
        let limit = self.max_deviation[lane];
        (self.cubic[lane] - self.line[lane]).maximum(-limit).minimum(limit)
    }

    /// A sample between the packs, before what is at the floor counts as 0.
    #[inline(always)]
    pub fn floored_w_m2_sr(&self, lane: usize) -> R {
        self.largest_w_m2_sr[lane] * (self.line[lane] + self.deviation(lane)).natural_exp()
    }

    /// The samples between the packs.
    #[inline(always)]
    pub fn radiance_w_m2_sr(&self) -> [R; N] {
        let (zero, floor) = (R::from(0.0), R::from(1.00001 * RADIANCE_FLOOR_W_M2_SR));
        let mut blended: [R; N] = std::array::from_fn(|lane| self.floored_w_m2_sr(lane));
        for blended in &mut blended {
            *blended = if *blended <= floor { zero } else { *blended };
        }
        blended
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIDDLE: [f32; 4] = [0.0, 0.5, 0.5, 0.0];

    #[test]
    fn equal_samples_come_out_as_they_are() {
        let blended = blend_radiance([2e-6; 4], [-0.1, 0.6, 0.6, -0.1], MIDDLE);
        assert!((blended / 2e-6 - 1.0).abs() < 2e-6);
    }

    #[test]
    fn samples_at_or_below_the_floor_are_dark() {
        assert_eq!(blend_radiance([0.0; 4], [-0.1, 0.6, 0.6, -0.1], MIDDLE), 0.0);
        assert_eq!(blend_radiance([RADIANCE_FLOOR_W_M2_SR; 4], [0.25; 4], MIDDLE), 0.0);
        assert!(blend_radiance([1e-9; 4], [0.25; 4], MIDDLE) > 0.0);
    }

    #[test]
    fn the_blend_is_geometric() {
        let half = [0.5f32, 0.5, 0.0, 0.0];
        let blended = blend_radiance([1e-6, 1e-8, 0.0, 0.0], half, half);
        assert!((blended / 1e-7 - 1.0).abs() < 3e-6);
    }

    /// What rounding leaves of a black pack does not show.
    #[test]
    fn rounding_in_a_black_pack_does_not_show() {
        let half = [0.5f32, 0.5, 0.0, 0.0];
        let blended = |black: f32| blend_radiance([1e-6, black, 0.0, 0.0], half, half);
        // A rounding error of 1e-7 of the row, either way.
        assert_eq!(blended(0.0), blended(1e-13));
        assert!((blended(0.0) / 1e-6 - 1e-3f32.sqrt()).abs() < 1e-5);
        // Above the least it counts.
        assert!(blended(4e-9) > 1.9 * blended(0.0));
        // A pack beyond, however bright, makes none of the two around black.
        let weight = [-0.1, 0.6, 0.6, -0.1];
        assert!(blend_radiance([1.0, 1e-8, 2e-8, 1e-9], weight, MIDDLE) < 2e-8);
    }

    /// A black direction of a pack beyond does not light up the sky between two others.
    #[test]
    fn a_black_outer_pack_does_not_overshoot() {
        // The weights of turbidity 2 on 1.5, 2.5, 3.5, 4.75.
        let (weight, linear) = ([0.216f32, 1.262, -0.637, 0.159], [0.437, 0.563, 0.0, 0.0]);
        let seen = [2e-8, 1e-8, 4e-9, 1.5e-9];
        let whole = blend_radiance(seen, weight, linear);
        assert!(whole > 1e-8 && whole < 2e-8, "{whole:e}");
        // Where nothing is black the cubic is what it was.
        let cubic: f32 = seen.iter().zip(weight).map(|(x, w)| w * x.ln()).sum();
        assert!((whole / cubic.exp() - 1.0).abs() < 1e-4, "{whole:e} {:e}", cubic.exp());
        let pit = blend_radiance([seen[0], seen[1], 0.0, seen[3]], weight, linear);
        assert!((pit / whole - 1.0).abs() < 0.3, "{pit:e} {whole:e}");
        // Unlimited it would be a thousand times too bright.
        let leap: f32 = [seen[0], seen[1], 1e-13, seen[3]].iter().zip(weight).map(|(x, w)| w * x.ln()).sum();
        assert!(leap.exp() > 100.0 * whole);
    }
}
