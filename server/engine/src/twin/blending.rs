//! Interpolation between packs of different turbidity.

use super::elementary::{natural_exp, natural_log};

/// Radiance below which a sample counts as this much before the logarithm, W m⁻² sr⁻¹: about 3e-7 of the natural
/// sky.
pub const RADIANCE_FLOOR_W_M2_SR: f32 = 1e-13;

/// exp Σ_p weight_p · ln max(radiance_p, floor), over the packs with weight; 0 where that is at or below the
/// floor. A sum of logarithms over equal floors is the floor itself but for rounding, so the comparison is in
/// the logarithm with that much room.
#[inline(always)]
pub fn blend_radiance(radiance_w_m2_sr: [f32; 4], weight: [f32; 4]) -> f32 {
    let log_floor = natural_log(RADIANCE_FLOOR_W_M2_SR);
    let above = |pack: usize| natural_log(radiance_w_m2_sr[pack].max(RADIANCE_FLOOR_W_M2_SR)) - log_floor;
    let log_ratio = weight[0] * above(0) + weight[1] * above(1) + weight[2] * above(2) + weight[3] * above(3);
    if log_ratio <= 0.0 { 0.0 } else { natural_exp(log_floor + log_ratio) }
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
