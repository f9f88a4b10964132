//! Linear measures of a sky: Σ weight · value over the directions of the panorama grid (`docs/model.md#influence`).
//!
//! What is linear in what a response sees adds up over the sources, so each source has a share of it. All measures are of the
//! visible sky, as [`SkyQuantities`](crate::SkyQuantities) does: hidden directions weigh nothing, and means are over those that
//! are seen.

use crate::{
    horizon::Horizon,
    panorama::{
        AZIMUTH_COUNT, ELEVATION_COUNT, azimuth_rad, cos_sr, elevation_rad, projected_sr, solid_angle_sr,
    },
    sky_curve::SkyCurve,
    sky_quantities::ZENITH_CAP_RAD,
};
use std::f64::consts::{FRAC_PI_2, PI};

/// A weight for every direction of the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearMeasure {
    /// `[row][column]`; sums to 1 for means (to 0 where nothing is seen of them), in sr for illuminance.
    weights: Vec<f64>,
}

impl LinearMeasure {
    /// Mean luminance of the visible directions within 5° of the zenith, weighted by solid angle, cd m⁻².
    pub fn zenith(horizon: &Horizon) -> Self {
        Self::mean_over(horizon, |row, _| FRAC_PI_2 - elevation_rad(row) <= ZENITH_CAP_RAD)
    }

    /// Mean luminance of the visible sky, cd m⁻².
    pub fn mean(horizon: &Horizon) -> Self {
        Self::mean_over(horizon, |_, _| true)
    }

    /// Mean luminance of the visible directions inside a closed curve (paper Eq. 13–14), cd m⁻².
    pub fn region(curve: &SkyCurve, horizon: &Horizon) -> Self {
        let inside = curve.directions_inside();
        Self::mean_over(horizon, |row, column| inside[row * AZIMUTH_COUNT + column])
    }

    /// Horizontal illuminance E = ∫ L sin φ dΩ of the visible sky, lux.
    pub fn horizontal(horizon: &Horizon) -> Self {
        Self::of_weights(
            |row, column| {
                if horizon.hides_sample(row, column) { 0.0 } else { projected_sr(row) }
            },
        )
    }

    /// Cylindrical illuminance (1/π) ∫ L cos φ dΩ of the visible sky, lux.
    pub fn cylindrical(horizon: &Horizon) -> Self {
        Self::of_weights(|row, column| if horizon.hides_sample(row, column) { 0.0 } else { cos_sr(row) / PI })
    }

    /// Spherical illuminance ¼ ∫ L dΩ of the visible sky, lux.
    pub fn spherical(horizon: &Horizon) -> Self {
        Self::of_weights(
            |row, column| {
                if horizon.hides_sample(row, column) { 0.0 } else { 0.25 * solid_angle_sr(row) }
            },
        )
    }

    /// ∫ L cos φ (1 + cos(m(θ − θ₀))) dΩ of the open sky for an order m, lux: what the waves by azimuth of the light on walls are told
    /// from without a weight below 0.
    pub fn wall_wave(order: u8, first_azimuth_rad: f64) -> Self {
        let order = f64::from(order);
        Self::of_weights(|row, column| {
            cos_sr(row) * (1.0 + (order * (azimuth_rad(column) - first_azimuth_rad)).cos()).max(0.0)
        })
    }

    fn mean_over(horizon: &Horizon, counts: impl Fn(usize, usize) -> bool) -> Self {
        let mut measure = Self::of_weights(|row, column| {
            if counts(row, column) && !horizon.hides_sample(row, column) { solid_angle_sr(row) } else { 0.0 }
        });
        let sum: f64 = measure.weights.iter().sum();
        if sum > 0.0 {
            measure.weights.iter_mut().for_each(|weight| *weight /= sum);
        }
        measure
    }

    fn of_weights(weight: impl Fn(usize, usize) -> f64) -> Self {
        let weight = &weight;
        let rows =
            (0..ELEVATION_COUNT).flat_map(|row| (0..AZIMUTH_COUNT).map(move |column| weight(row, column)));
        Self { weights: rows.collect() }
    }

    /// The weights, `[row][column]`, none below 0.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Whether no direction counts: the curve holds no grid direction, or terrain hides all of them.
    pub fn is_empty(&self) -> bool {
        self.weights.iter().all(|weight| *weight == 0.0)
    }

    /// Solid angle of the directions that count, sr.
    pub fn solid_angle_sr(&self) -> f64 {
        let counting = self.weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
        counting.map(|(at, _)| solid_angle_sr(at / AZIMUTH_COUNT)).sum()
    }

    /// The measure of values over the grid, `[row][column]`, of artificial light.
    pub fn of(&self, values: &[f32]) -> f64 {
        let weighed = self.weights.iter().zip(values).filter(|(weight, _)| **weight > 0.0);
        weighed.map(|(weight, value)| weight * f64::from(*value)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Lamp, Panorama, Response, SeenSky, SkyPart, panorama::Direction, sky_quantities::quantities_over,
    };
    use proptest::prelude::*;
    use std::{f64::consts::TAU, sync::Arc};

    /// A sky of the default lamp.
    fn sky(seed: u32) -> SkyPart {
        let sample =
            |i: usize| ((i as u32).wrapping_mul(2_654_435_761).wrapping_add(seed) >> 8) as f32 * 1e-13 + 1e-9;
        let kernel = Panorama::from_samples((0..Panorama::LEN).map(sample).collect()).unwrap();
        SkyPart { light: Arc::clone(Lamp::default().light()), kernel }
    }

    fn values(seed: u32) -> Vec<f32> {
        SeenSky::of(&[sky(seed)], &[Response::Photopic]).plane(0).to_vec()
    }

    fn hills() -> Horizon {
        let elevation = |column: usize| (column as f64 * 0.11).sin().max(0.0) * 0.6;
        Horizon::new((0..AZIMUTH_COUNT).map(elevation).collect()).unwrap()
    }

    #[test]
    fn measures_are_the_quantities_that_are_reported() {
        for horizon in [Horizon::flat(), hills()] {
            let mut part = sky(5);
            horizon.darken(&mut part.kernel);
            let values = SeenSky::of(std::slice::from_ref(&part), &[Response::Photopic]).plane(0).to_vec();
            let reported = quantities_over(&[part], &horizon);
            for (measure, value) in [
                (LinearMeasure::zenith(&horizon), reported.zenith_luminance_cd_m2),
                (LinearMeasure::mean(&horizon), reported.mean_luminance_cd_m2),
                (LinearMeasure::horizontal(&horizon), reported.horizontal_illuminance_lx),
            ] {
                assert!((measure.of(&values) / value - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_sky_all_hidden_has_no_measure() {
        let walls = Horizon::new(vec![FRAC_PI_2; AZIMUTH_COUNT]).unwrap();
        assert!(LinearMeasure::mean(&walls).is_empty() && LinearMeasure::zenith(&walls).is_empty());
        assert_eq!(LinearMeasure::mean(&walls).of(&values(1)), 0.0);
        assert!(!LinearMeasure::mean(&hills()).is_empty());
        assert!((LinearMeasure::mean(&Horizon::flat()).solid_angle_sr() / TAU - 1.0).abs() < 1e-12);
    }

    proptest! {
        /// Measures are linear, and a uniform sky has its own luminance.
        #[test]
        fn measures_are_linear(
            seeds in prop::array::uniform2(any::<u32>()), factor in 0.1f32..10.0, east in 0.2f64..6.0,
        ) {
            let curve = SkyCurve::new(
                [(0.0, 0.1), (0.3, 0.1), (0.3, 0.9), (0.0, 0.9)]
                    .map(|(azimuth, elevation_rad)| Direction { azimuth_rad: east + azimuth, elevation_rad })
                    .to_vec(),
            )
            .unwrap();
            let measure = LinearMeasure::region(&curve, &Horizon::flat());
            let [a, b] = seeds.map(values);
            let mut sum = a.clone();
            for (sum, other) in sum.iter_mut().zip(&b) {
                *sum += factor * other;
            }
            let wanted = measure.of(&a) + f64::from(factor) * measure.of(&b);
            prop_assert!((measure.of(&sum) / wanted - 1.0).abs() < 1e-6);
            let uniform = vec![1e-3; ELEVATION_COUNT * AZIMUTH_COUNT];
            prop_assert!((measure.of(&uniform) / f64::from(1e-3_f32) - 1.0).abs() < 1e-9);
        }
    }
}
