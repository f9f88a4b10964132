//! Interpolation between packs of different turbidity (`docs/model.md#turbidity`).

use super::elementary::{natural_exp, natural_log};

/// Radiance below which a sample counts as this much before the logarithm, W m⁻² sr⁻¹: about 3e-7 of the natural
/// sky.
pub const RADIANCE_FLOOR_W_M2_SR: f32 = 1e-13;

/// How far a cubic may leave the line between the two packs around, in the logarithm, besides [`BEND_SHARE_ALLOWED`] of
/// what lies between those two. A fall as exp(−kT), the steepest that there is, leaves it by 0.06 of that. Chosen by whole
/// skies of the first order at turbidity 2 (packs 1.5, 2.5, 3.5, 4.75) against the direct sum: worst mean of 15 places
/// 9.6 % without a limit, 5.6, 2.7, 1.5, 1.25 and 1.1 % with 0.05 + 0.25, 0.12, 0.08 and 0.1 + 0.06, 0.04.
pub const BEND_ALLOWED: f32 = 0.1;
/// See [`BEND_ALLOWED`].
pub const BEND_SHARE_ALLOWED: f32 = 0.06;

/// Least radiance of a pack in a direction, over that of the brighter one of the two around: a dimmer one counts as this. Where
/// the functions of a basis cancel a sample is nothing but rounding, of which a logarithm makes anything: between a lit pack and
/// a black one two executors were 5 % of the row's brightest apart. Between neighbouring packs air dims no visible
/// direction by that much.
pub const DIMMEST_PACK: f32 = 1e-3;

/// exp Σ_p weight_p · ln max(radiance_p, floor), over the packs with weight (they sum to 1); 0 where that is at or
/// below the floor, give or take rounding. Logarithms are taken over the largest sample, which keeps them small;
/// [`DIMMEST_PACK`] says where they end.
///
/// `bracket` holds the weights of linear interpolation between the two packs around. Where a basis leaves a dim
/// direction of one of the others black, its logarithm is a pit, and the cubic through it leaps elsewhere, by hundreds:
/// so the cubic is kept near the line between those two.
#[inline(always)]
pub fn blend_radiance(radiance_w_m2_sr: [f32; 4], weight: [f32; 4], bracket: [f32; 4]) -> f32 {
    let floored = radiance_w_m2_sr.map(|radiance| radiance.max(RADIANCE_FLOOR_W_M2_SR));
    let largest = floored[0].max(floored[1]).max(floored[2].max(floored[3]));
    let around = |pack: usize| if bracket[pack] > 0.0 { floored[pack] } else { 0.0 };
    let brighter = around(0).max(around(1)).max(around(2).max(around(3)));
    let least = DIMMEST_PACK * brighter;
    let log = [0, 1, 2, 3].map(|pack: usize| natural_log(floored[pack].max(least) / largest));
    let sum =
        |weight: [f32; 4]| weight[0] * log[0] + weight[1] * log[1] + weight[2] * log[2] + weight[3] * log[3];
    let (mut low, mut high) = (0.0f32, -1e30f32);
    for pack in 0..4 {
        let is_around = bracket[pack] > 0.0;
        low = low.min(if is_around { log[pack] } else { low });
        high = high.max(if is_around { log[pack] } else { high });
    }
    let allowed = BEND_ALLOWED + BEND_SHARE_ALLOWED * (high - low);
    let line = sum(bracket);
    let log_ratio = line + (sum(weight) - line).max(-allowed).min(allowed);
    let blended = largest * natural_exp(log_ratio);
    if blended <= 1.00001 * RADIANCE_FLOOR_W_M2_SR { 0.0 } else { blended }
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
        let half = [0.5, 0.5, 0.0, 0.0];
        let blended = blend_radiance([1e-6, 1e-8, 0.0, 0.0], half, half);
        assert!((blended / 1e-7 - 1.0).abs() < 3e-6);
    }

    #[test]
    fn what_rounding_leaves_of_a_black_pack_does_not_show() {
        let half = [0.5, 0.5, 0.0, 0.0];
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

    #[test]
    fn a_black_direction_of_a_pack_beyond_does_not_light_up_the_sky_between_two_others() {
        // The weights of turbidity 2 on 1.5, 2.5, 3.5, 4.75.
        let (weight, bracket) = ([0.216, 1.262, -0.637, 0.159], [0.437, 0.563, 0.0, 0.0]);
        let seen = [2e-8, 1e-8, 4e-9, 1.5e-9];
        let whole = blend_radiance(seen, weight, bracket);
        assert!(whole > 1e-8 && whole < 2e-8, "{whole:e}");
        // Where nothing is black the cubic is what it was.
        let cubic: f32 = seen.iter().zip(weight).map(|(x, w)| w * x.ln()).sum();
        assert!((whole / cubic.exp() - 1.0).abs() < 1e-4, "{whole:e} {:e}", cubic.exp());
        let pit = blend_radiance([seen[0], seen[1], 0.0, seen[3]], weight, bracket);
        assert!((pit / whole - 1.0).abs() < 0.3, "{pit:e} {whole:e}");
        // Unlimited it would be a thousand times too bright.
        let leap: f32 = [seen[0], seen[1], 1e-13, seen[3]].iter().zip(weight).map(|(x, w)| w * x.ln()).sum();
        assert!(leap.exp() > 100.0 * whole);
    }
}
