//! Mixing of lobes, Everett interpolation of ln of the scale (Everett 1900), weighing of cells.

use super::elementary::Real;
use skyglow_physics::LOBE_COUNT;
use skyglow_tables::curvature::MAX_CURVATURE;

/// Shares of the lobes in one node's scale, and the logarithm of the mixed scale:
/// `[share_0, share_1, share_2, ln Σ a_l]` with a_l = e_l·exp(log_scale_l), share_l = a_l / Σ a.
/// Worked out relative to the largest logarithm of a lobe in use (log-sum-exp), so that nothing underflows.
///
/// `emission` are the weights e_l ≥ 0, not all zero.
#[inline(always)]
pub fn lobe_shares<R: Real>(emission: [R; LOBE_COUNT], log_scale: [R; LOBE_COUNT]) -> [R; 4] {
    let zero = R::from(0.0);
    let in_use = |lobe: usize| if emission[lobe] > zero { log_scale[lobe] } else { R::from(-1.0e30) };
    let largest = in_use(0).maximum(in_use(1)).maximum(in_use(2));
    let amount = |lobe: usize| {
        if emission[lobe] > zero { emission[lobe] * (log_scale[lobe] - largest).natural_exp() } else { zero }
    };
    let amounts = [amount(0), amount(1), amount(2)];
    let sum = amounts[0] + amounts[1] + amounts[2];
    [amounts[0] / sum, amounts[1] / sum, amounts[2] / sum, largest + sum.natural_log()]
}

/// [`skyglow_tables::curvature::mixed_curvature`] of lobes with `shares`, from ln of their scales `[node][lobe]` below, at and above.
#[inline(always)]
pub fn mixed_curvature<R: Real>(shares: [R; LOBE_COUNT], log_scale: [[R; LOBE_COUNT]; 3]) -> R {
    let [below, at, above] = log_scale;
    let slope = |lobe: usize| R::from(0.5) * (above[lobe] - below[lobe]);
    let mean_slope = shares[0] * slope(0) + shares[1] * slope(1) + shares[2] * slope(2);
    let curved = |lobe: usize| {
        let apart = slope(lobe) - mean_slope;
        shares[lobe] * ((below[lobe] - at[lobe]) + (above[lobe] - at[lobe]) + apart * apart)
    };
    let limit = R::from(MAX_CURVATURE as f32);
    (curved(0) + curved(1) + curved(2)).maximum(-limit).minimum(limit)
}

/// [`skyglow_tables::curvature::log_scale_between`] of a cell's nodes.
#[inline(always)]
pub fn log_scale_between<R: Real>(log_scale: [R; 2], curvature: [R; 2], upper_weight: R) -> R {
    let lower_weight = R::from(1.0) - upper_weight;
    let curvature = curvature[0] + curvature[1] + curvature[0] * lower_weight + curvature[1] * upper_weight;
    let sixth = R::from(1.0) / R::from(6.0);
    log_scale[0] + (log_scale[1] - log_scale[0]) * upper_weight
        - upper_weight * lower_weight * curvature * sixth
}

/// Weights of a cell's lower and upper node: flux · exp(ln of the scale between them), divided between them.
///
/// `flux_w` is the cell's flux in one band; the answer is in the unit of flux × scale, W m⁻² sr⁻¹.
#[inline(always)]
pub fn cell_weights<R: Real>(flux_w: R, log_scale: [R; 2], curvature: [R; 2], upper_weight: R) -> [R; 2] {
    let scale = flux_w * log_scale_between(log_scale, curvature, upper_weight).natural_exp();
    [scale * (R::from(1.0) - upper_weight), scale * upper_weight]
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_tables::curvature as tables;

    #[test]
    fn shares_sum_to_one_and_the_scale_is_the_sum() {
        let [a, b, c, log_sum] = lobe_shares([0.5f32, 0.3, 0.2], [-40.0, -41.5, -38.0]);
        assert!((a + b + c - 1.0).abs() < 1e-6);
        let exact = (0.5 * (-40f64).exp() + 0.3 * (-41.5f64).exp() + 0.2 * (-38f64).exp()).ln();
        assert!((f64::from(log_sum) - exact).abs() < 1e-5);
    }

    /// A lobe without weight counts for nothing however bright.
    #[test]
    fn a_lobe_without_weight_counts_for_nothing() {
        let shares = lobe_shares([1f32, 0.0, 0.0], [-120.0, 0.0, 60.0]);
        assert_eq!(shares, [1.0, 0.0, 0.0, -120.0]);
    }

    #[test]
    fn a_cell_on_its_lower_node_gives_it_all() {
        let [lower, upper] = cell_weights(3f32, [-2.0, 5.0], [0.3, -0.4], 0.0);
        assert!((lower - 3.0 * (-2f32).exp()).abs() < 1e-6);
        assert_eq!(upper, 0.0);
    }

    /// In f64 they are the functions that the tables themselves are read with.
    #[test]
    fn curvatures_are_those_of_the_tables() {
        let shares = [0.5, 0.3, 0.2];
        let lobes = [[-40.0, -40.3, -40.9], [-41.0, -41.2, -41.1], [-38.0, -38.4, -38.9]];
        let nodes = [0, 1, 2].map(|node| lobes.map(|lobe: [f64; 3]| lobe[node]));
        let exact = tables::mixed_curvature(shares, lobes);
        assert!((mixed_curvature(shares, nodes) - exact).abs() < 1e-13 && exact.abs() > 0.01);
        for weight in [0.0, 0.3, 1.0] {
            let [ours, theirs] = [log_scale_between, tables::log_scale_between].map(
                |between: fn([f64; 2], [f64; 2], f64) -> f64| between([-40.0, -42.0], [0.4, -0.3], weight),
            );
            assert!((ours - theirs).abs() < 1e-13, "{ours} {theirs}");
        }
    }
}
