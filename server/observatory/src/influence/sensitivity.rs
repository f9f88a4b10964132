//! What a change of each pack's sky does to a linear measure of the blended one.

use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, Band, ELEVATION_COUNT, LinearMeasure};
use skyglow_render::{
    taps::Taps,
    twin::{BEND_ALLOWED, BEND_SHARE_ALLOWED, DIMMEST_PACK, RADIANCE_FLOOR_W_M2_SR},
};

const DIRECTION_COUNT: usize = ELEVATION_COUNT * AZIMUTH_COUNT;

/// ∂(measure)/∂(radiance of each pack), `[pack][band][row][column]`, lm W⁻¹ times the measure's weights. `skies` are the packs' own,
/// `[band][row][column]`. Where a sky is black nothing is said: radiance is held at 0 there.
///
/// Over all packs Σ (derivative · radiance) is the measure of the blended sky.
pub(super) fn sensitivities(skies: &[Vec<f32>], taps: &Taps, measure: &LinearMeasure) -> Vec<Vec<f32>> {
    let mut of_packs = vec![vec![0f32; BAND_COUNT * DIRECTION_COUNT]; skies.len()];
    let mut radiance = vec![0f64; skies.len()];
    for band in Band::ALL {
        for (direction, weight) in measure.weights().iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
            let at = band.index() * DIRECTION_COUNT + direction;
            for (radiance, sky) in radiance.iter_mut().zip(skies) {
                *radiance = f64::from(sky[at]);
            }
            let slopes = blend_slopes(&radiance, taps);
            for (of_pack, slope) in of_packs.iter_mut().zip(slopes) {
                of_pack[at] = (weight * band.luminous_efficacy_lm_w() * slope) as f32;
            }
        }
    }
    of_packs
}

/// ∂L/∂L_p of [`blend_radiance`](skyglow_render::twin::blend_radiance), one for each pack; Σ L_p·∂L/∂L_p = L.
fn blend_slopes(radiance: &[f64], taps: &Taps) -> Vec<f64> {
    let count = radiance.len();
    if let [own] = radiance {
        return vec![if *own > 0.0 { 1.0 } else { 0.0 }];
    }
    let largest = radiance.iter().copied().fold(0.0, f64::max);
    let floor = f64::from(RADIANCE_FLOOR_W_M2_SR);
    if largest <= floor {
        return vec![0.0; count];
    }
    let around = || (0..count).filter(|&p| taps.bracket()[p] > 0.0);
    let by_radiance = |a: &usize, b: &usize| radiance[*a].total_cmp(&radiance[*b]);
    let (lowest, highest) =
        (around().min_by(by_radiance).unwrap_or_default(), around().max_by(by_radiance).unwrap_or_default());
    let least = (f64::from(DIMMEST_PACK) * radiance[highest]).max(floor);
    let log: Vec<f64> = radiance.iter().map(|value| (value.max(least) / largest).ln()).collect();
    let sum = |weights: &[f64]| -> f64 { log.iter().zip(weights).map(|(log, weight)| weight * log).sum() };
    let allowed = f64::from(BEND_ALLOWED) + f64::from(BEND_SHARE_ALLOWED) * (log[highest] - log[lowest]);
    let (line, cubic) = (sum(taps.bracket()), sum(taps.weights()));
    let bend = (cubic - line).clamp(-allowed, allowed);
    // d ln L / d ln L_p: the cubic's weights, or the line's and what its limit moves with.
    let mut shares: Vec<f64> =
        if bend == cubic - line { taps.weights().to_vec() } else { taps.bracket().to_vec() };
    if bend != cubic - line {
        let moved = bend.signum() * f64::from(BEND_SHARE_ALLOWED);
        shares[highest] += moved;
        shares[lowest] -= moved;
    }
    // What counts as a part of the brighter of the two around moves with that one.
    for p in (0..count).filter(|&p| p != highest) {
        if radiance[p] < least {
            shares[highest] += shares[p];
            shares[p] = 0.0;
        }
    }
    let blended = largest * (line + bend).exp();
    let slope = |(share, own): (&f64, &f64)| if *own < least { 0.0 } else { blended * share / own };
    shares.iter().zip(radiance).map(slope).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use skyglow_render::{taps::lagrange_taps, twin::blend_radiance};

    fn taps(x: f64) -> Taps {
        lagrange_taps(&[1.5f64.ln(), 2.5f64.ln(), 3.5f64.ln(), 4.75f64.ln()], x.ln(), 1e-9)
    }

    fn blended(radiance: [f64; 4], taps: &Taps) -> f64 {
        f64::from(blend_radiance(radiance.map(|value| value as f32), taps.weights_f32(), taps.bracket_f32()))
    }

    proptest! {
        #[test]
        fn slopes_add_up_to_the_blend_and_are_its_derivative(
            logs in prop::array::uniform4(-9.0f64..-5.0), turbidity in 1.6f64..4.7, pack in 0usize..4,
        ) {
            let (radiance, taps) = (logs.map(|log| 10f64.powf(log)), taps(turbidity));
            prop_assume!(taps.indices().len() == 4);
            let slopes = blend_slopes(&radiance, &taps);
            let whole: f64 = radiance.iter().zip(&slopes).map(|(l, slope)| l * slope).sum();
            prop_assert!((whole / blended(radiance, &taps) - 1.0).abs() < 1e-4);
            let mut more = radiance;
            more[pack] *= 1.02;
            let mut less = radiance;
            less[pack] *= 0.98;
            // At a limit the derivative jumps; on one side of it the difference is the derivative.
            let change = (blended(more, &taps) - blended(less, &taps)) / (0.04 * radiance[pack]);
            let sides = [more, less].map(|side| blend_slopes(&side, &taps)[pack]);
            let (low, high) = (sides[0].min(sides[1]).min(slopes[pack]), sides[0].max(sides[1]).max(slopes[pack]));
            let slack = 0.01 * (slopes[pack].abs() + blended(radiance, &taps) / radiance[pack]);
            prop_assert!(change > low - slack && change < high + slack, "{change} {low} {high}");
        }
    }

    #[test]
    fn one_pack_counts_as_it_is_and_a_black_sky_says_nothing() {
        assert_eq!(blend_slopes(&[3e-8], &Taps::single(0)), [1.0]);
        assert_eq!(blend_slopes(&[0.0], &Taps::single(0)), [0.0]);
        assert_eq!(blend_slopes(&[0.0; 4], &taps(2.0)), [0.0; 4]);
        // A black pack's share goes with the brighter of the two around.
        let slopes = blend_slopes(&[1e-7, 5e-8, 0.0, 2e-8], &taps(2.0));
        assert!(slopes[2] == 0.0 && slopes.iter().all(|slope| slope.is_finite()));
    }
}
