//! Interpolation between packs of different turbidity.

use super::elementary::{natural_exp, natural_log};

/// Radiance below which a sample counts as this much before the logarithm, W m⁻² sr⁻¹: about 3e-7 of the natural
/// sky.
pub const RADIANCE_FLOOR_W_M2_SR: f32 = 1e-13;

/// exp Σ_p weight_p · ln max(radiance_p, floor), over the packs with weight (they sum to 1); 0 where that is at or
/// below the floor, give or take rounding. Logarithms are taken over the largest sample, which keeps them small.
#[inline(always)]
pub fn blend_radiance(radiance_w_m2_sr: [f32; 4], weight: [f32; 4]) -> f32 {
    let floored = radiance_w_m2_sr.map(|radiance| radiance.max(RADIANCE_FLOOR_W_M2_SR));
    let largest = floored[0].max(floored[1]).max(floored[2].max(floored[3]));
    let log = |pack: usize| natural_log(floored[pack] / largest);
    let log_ratio = weight[0] * log(0) + weight[1] * log(1) + weight[2] * log(2) + weight[3] * log(3);
    let blended = largest * natural_exp(log_ratio);
    if blended <= 1.00001 * RADIANCE_FLOOR_W_M2_SR { 0.0 } else { blended }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_samples_come_out_as_they_are() {
        let blended = blend_radiance([2e-6; 4], [-0.1, 0.6, 0.6, -0.1]);
        assert!((blended / 2e-6 - 1.0).abs() < 2e-6);
    }

    #[test]
    fn samples_at_or_below_the_floor_are_dark() {
        assert_eq!(blend_radiance([0.0; 4], [-0.1, 0.6, 0.6, -0.1]), 0.0);
        assert_eq!(blend_radiance([RADIANCE_FLOOR_W_M2_SR; 4], [0.25; 4]), 0.0);
        assert!(blend_radiance([1e-9; 4], [0.25; 4]) > 0.0);
    }

    #[test]
    fn the_blend_is_geometric() {
        let blended = blend_radiance([1e-6, 1e-8, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0]);
        assert!((blended / 1e-7 - 1.0).abs() < 3e-6);
    }
}
