//! What a change of each pack's sky, and of each node in it, does to a linear measure of what a response sees of the blended one.

use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, LinearMeasure, Panorama, interpolation::Stencil,
    spectrum::SpectralRule,
};
use skyglow_render::twin::{Blend, MAX_DEVIATION_SHARE, MIN_PACK_RATIO, RADIANCE_FLOOR_W_M2_SR};
use std::array::{from_fn, from_ref};

const DIRECTION_COUNT: usize = ELEVATION_COUNT * AZIMUTH_COUNT;

/// A linear measure of what a response sees of one kind of light.
#[derive(Clone, Copy, Debug)]
pub struct SeenMeasure<'a> {
    /// Weights of directions.
    pub measure: &'a LinearMeasure,
    /// What the response makes of the light.
    pub rule: &'a SpectralRule,
    /// The sky that the kernel is a part of, where it is not all of it.
    pub within: Option<Within<'a>>,
}

/// A sky that another is a part of, as one between clouds is.
#[derive(Clone, Copy, Debug)]
pub struct Within<'a> {
    /// The whole.
    pub sky: &'a Panorama,
    /// What it changes by for a change of the part, `[band][row][column]`.
    pub slopes: &'a [f32],
}

/// ∂(measure)/∂(kernel) at the state of a sky, `[band][row][column]`: Σ weight·kernel over its own samples is its measure (Euler).
pub(super) fn spectral_weights(sky: &Panorama, seen: SeenMeasure<'_>) -> Vec<f32> {
    let SeenMeasure { measure, rule, within } = seen;
    let sky = within.map_or(sky, |within| within.sky);
    let mut weights = vec![0f32; Panorama::LEN];
    for (direction, weight) in measure.weights().iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
        let kernel = from_fn(|band| f64::from(sky.samples()[band * DIRECTION_COUNT + direction]));
        for (band, slope) in rule.gradient(kernel).into_iter().enumerate() {
            weights[band * DIRECTION_COUNT + direction] = (weight * slope) as f32;
        }
    }
    if let Some(within) = within {
        weights.iter_mut().zip(within.slopes).for_each(|(weight, slope)| *weight *= slope);
    }
    weights
}

/// ∂(measure)/∂(radiance of each pack), `[pack][band][row][column]`, given what it is of the blended sky. `skies` are the packs' own,
/// `[band][row][column]`. Where a sky is black nothing is said: radiance is held at 0 there.
///
/// Over all packs Σ (derivative · radiance) is the measure of the blended sky.
pub(super) fn sensitivities(skies: &[Vec<f32>], stencil: &Stencil, weights: &[f32]) -> Vec<Vec<f32>> {
    let mut of_packs = vec![vec![0f32; BAND_COUNT * DIRECTION_COUNT]; skies.len()];
    let mut radiance = vec![0f64; skies.len()];
    for (at, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
        for (radiance, sky) in radiance.iter_mut().zip(skies) {
            *radiance = f64::from(sky[at]);
        }
        let slopes = blend_slopes(&radiance, stencil);
        for (of_pack, slope) in of_packs.iter_mut().zip(slopes) {
            of_pack[at] = (f64::from(*weight) * slope) as f32;
        }
    }
    of_packs
}

/// ∂L/∂L_p of [`blend_radiance`](skyglow_render::twin::blend_radiance), one for each pack; Σ L_p·∂L/∂L_p = L.
fn blend_slopes(radiance: &[f64], stencil: &Stencil) -> Vec<f64> {
    let count = radiance.len();
    if let [own] = radiance {
        return vec![if *own > 0.0 { 1.0 } else { 0.0 }];
    }
    let floor = f64::from(RADIANCE_FLOOR_W_M2_SR);
    if radiance.iter().all(|own| *own <= floor) {
        return vec![0.0; count];
    }
    let [weights, linear] = [stencil.weights(), stencil.linear_weights()];
    let around = || (0..count).filter(|&p| linear[p] > 0.0);
    let by_radiance = |a: &usize, b: &usize| radiance[*a].total_cmp(&radiance[*b]);
    let (lowest, highest) =
        (around().min_by(by_radiance).unwrap_or_default(), around().max_by(by_radiance).unwrap_or_default());
    let least = (f64::from(MIN_PACK_RATIO) * radiance[highest]).max(floor);
    // A pack that is not there has no weight; any other's radiance stands in for it.
    let sources: [f64; 4] = from_fn(|p| radiance[p.min(count - 1)]);
    let [cubic, line] = [weights, linear].map(|weights| from_fn(|p| weights.get(p).copied().unwrap_or(0.0)));
    let blend = Blend::of(sources.each_ref().map(from_ref), cubic, line);
    let deviation = blend.deviation(0);
    // d ln L / d ln L_p: the cubic's weights, or the line's and what its limit moves with.
    let is_limited = deviation != blend.cubic[0] - blend.line[0];
    let mut shares = if is_limited { linear.to_vec() } else { weights.to_vec() };
    if is_limited {
        let moved = deviation.signum() * f64::from(MAX_DEVIATION_SHARE);
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
    let blended = blend.floored_w_m2_sr(0);
    let slope = |(share, own): (&f64, &f64)| if *own < least { 0.0 } else { blended * share / own };
    shares.iter().zip(radiance).map(slope).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use skyglow_render::twin::blend_radiance;

    fn stencil(x: f64) -> Stencil {
        Stencil::lagrange_or_node(&[1.5f64.ln(), 2.5f64.ln(), 3.5f64.ln(), 4.75f64.ln()], x.ln(), 1e-9)
    }

    fn blended(radiance: [f64; 4], stencil: &Stencil) -> f64 {
        f64::from(blend_radiance(
            radiance.map(|value| value as f32),
            stencil.weights_f32(),
            stencil.linear_weights_f32(),
        ))
    }

    proptest! {
        #[test]
        fn slopes_add_up_and_are_derivatives(
            logs in prop::array::uniform4(-9.0f64..-5.0), turbidity in 1.6f64..4.7, pack in 0usize..4,
        ) {
            let (radiance, stencil) = (logs.map(|log| 10f64.powf(log)), stencil(turbidity));
            prop_assume!(stencil.nodes().len() == 4);
            let slopes = blend_slopes(&radiance, &stencil);
            let whole: f64 = radiance.iter().zip(&slopes).map(|(l, slope)| l * slope).sum();
            prop_assert!((whole / blended(radiance, &stencil) - 1.0).abs() < 1e-4);
            let mut more = radiance;
            more[pack] *= 1.02;
            let mut less = radiance;
            less[pack] *= 0.98;
            // At a limit the derivative jumps; on one side of it the difference is the derivative.
            let change = (blended(more, &stencil) - blended(less, &stencil)) / (0.04 * radiance[pack]);
            let sides = [more, less].map(|side| blend_slopes(&side, &stencil)[pack]);
            let (low, high) = (sides[0].min(sides[1]).min(slopes[pack]), sides[0].max(sides[1]).max(slopes[pack]));
            let slack = 0.01 * (slopes[pack].abs() + blended(radiance, &stencil) / radiance[pack]);
            prop_assert!(change > low - slack && change < high + slack, "{change} {low} {high}");
        }
    }

    #[test]
    fn one_pack_and_black_skies() {
        assert_eq!(blend_slopes(&[3e-8], &Stencil::single(0)), [1.0]);
        assert_eq!(blend_slopes(&[0.0], &Stencil::single(0)), [0.0]);
        assert_eq!(blend_slopes(&[0.0; 4], &stencil(2.0)), [0.0; 4]);
        // A black pack's share goes with the brighter of the two around.
        let slopes = blend_slopes(&[1e-7, 5e-8, 0.0, 2e-8], &stencil(2.0));
        assert!(slopes[2] == 0.0 && slopes.iter().all(|slope| slope.is_finite()));
    }
}
