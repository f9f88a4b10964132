//! Mixing of lobes and weighing of cells.

use super::elementary::{natural_exp, natural_log};
use skyglow_physics::LOBE_COUNT;
use skyglow_tables::curvature::MAX_CURVATURE;

/// Shares of the lobes in one node's scale, and the logarithm of the mixed scale:
/// `[share_0, share_1, share_2, ln Σ a_l]` with a_l = e_l·exp(log_scale_l), share_l = a_l / Σ a.
/// Worked out relative to the largest logarithm of a lobe in use, so that nothing underflows.
///
/// `emission` are the weights e_l ≥ 0, not all zero.
#[inline(always)]
pub fn lobe_shares(emission: [f32; LOBE_COUNT], log_scale: [f32; LOBE_COUNT]) -> [f32; 4] {
    let in_use = |lobe: usize| if emission[lobe] > 0.0 { log_scale[lobe] } else { -1.0e30 };
    let largest = in_use(0).max(in_use(1)).max(in_use(2));
    let amount = |lobe: usize| {
        if emission[lobe] > 0.0 { emission[lobe] * natural_exp(log_scale[lobe] - largest) } else { 0.0 }
    };
    let amounts = [amount(0), amount(1), amount(2)];
    let sum = amounts[0] + amounts[1] + amounts[2];
    [amounts[0] / sum, amounts[1] / sum, amounts[2] / sum, largest + natural_log(sum)]
}

/// [`skyglow_tables::curvature::mixed_curvature`] of lobes with `shares`, from ln of their scales `[node][lobe]` below, at and above.
#[inline(always)]
pub fn mixed_curvature(shares: [f32; LOBE_COUNT], log_scale: [[f32; LOBE_COUNT]; 3]) -> f32 {
    let [below, at, above] = log_scale;
    let slope = |lobe: usize| 0.5 * (above[lobe] - below[lobe]);
    let mean_slope = shares[0] * slope(0) + shares[1] * slope(1) + shares[2] * slope(2);
    let curved = |lobe: usize| {
        let apart = slope(lobe) - mean_slope;
        shares[lobe] * ((below[lobe] - at[lobe]) + (above[lobe] - at[lobe]) + apart * apart)
    };
    (curved(0) + curved(1) + curved(2)).max(-MAX_CURVATURE as f32).min(MAX_CURVATURE as f32)
}

const SIXTH: f32 = 1.0 / 6.0;

/// [`skyglow_tables::curvature::log_scale_between`] of a cell's nodes.
#[inline(always)]
pub fn log_scale_between(log_scale: [f32; 2], curvature: [f32; 2], upper_weight: f32) -> f32 {
    let curvature =
        curvature[0] + curvature[1] + curvature[0] * (1.0 - upper_weight) + curvature[1] * upper_weight;
    log_scale[0] + (log_scale[1] - log_scale[0]) * upper_weight
        - upper_weight * (1.0 - upper_weight) * curvature * SIXTH
}

/// Weights of a cell's lower and upper node: flux · exp(ln of the scale between them), divided between them.
///
/// `flux_w` is the cell's flux in one band; the answer is in the unit of flux × scale, W m⁻² sr⁻¹.
#[inline(always)]
pub fn cell_weights(flux_w: f32, log_scale: [f32; 2], curvature: [f32; 2], upper_weight: f32) -> [f32; 2] {
    let scale = flux_w * natural_exp(log_scale_between(log_scale, curvature, upper_weight));
    [scale * (1.0 - upper_weight), scale * upper_weight]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_sum_to_one_and_the_scale_is_the_sum() {
        let [a, b, c, log_sum] = lobe_shares([0.5, 0.3, 0.2], [-40.0, -41.5, -38.0]);
        assert!((a + b + c - 1.0).abs() < 1e-6);
        let exact = (0.5 * (-40f64).exp() + 0.3 * (-41.5f64).exp() + 0.2 * (-38f64).exp()).ln();
        assert!((f64::from(log_sum) - exact).abs() < 1e-5);
    }

    #[test]
    fn a_lobe_without_weight_counts_for_nothing_however_bright() {
        let shares = lobe_shares([1.0, 0.0, 0.0], [-120.0, 0.0, 60.0]);
        assert_eq!(shares, [1.0, 0.0, 0.0, -120.0]);
    }

    #[test]
    fn a_cell_on_its_lower_node_gives_it_all() {
        let [lower, upper] = cell_weights(3.0, [-2.0, 5.0], [0.3, -0.4], 0.0);
        assert!((lower - 3.0 * (-2f32).exp()).abs() < 1e-6);
        assert_eq!(upper, 0.0);
    }
}
