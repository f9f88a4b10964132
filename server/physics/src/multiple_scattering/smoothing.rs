//! The source function far from the source as a smooth curve over the distance.
//!
//! Orders are followed in a fixed set of directions. Ten kilometres from a source and farther, the haze that glows over it is
//! a strip of a degree or two in the sky of every place, and what a set of directions makes of a strip goes up and down by some
//! per cent from one ring to the next, as they happen to lie: the same in every band, lobe and layer. Light itself is smooth
//! there. So ln of the mean over directions, and the moments over it, are taken from the cubic of least squares through the
//! rings around, a Savitzky–Golay filter over the rings, which are even in their coordinate.

use super::{grid::FieldGrid, harmonics::pair_count, lanes::Lanes, source_function::SourceFunction};
use rayon::prelude::*;

/// How far the rings reach on each side that a cubic is laid through, in the coordinate of the rings: light falls by about a
/// factor e over it.
const REACH: f64 = 0.8;
/// Rings from the second distance on are smooth in full, and those nearer than the first stay as they are, metres.
const FROM_M: [f64; 2] = [6_000.0, 12_000.0];

/// Weights of the rings from −`half` to `half` in the cubic through them, at the middle one.
fn weights(half: usize) -> Vec<f64> {
    let m = half as f64;
    let norm = (2.0 * m + 3.0) * (2.0 * m + 1.0) * (2.0 * m - 1.0) / 3.0;
    let weight = |i: f64| (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * i * i) / norm;
    (0..=2 * half).map(|i| weight(i as f64 - m)).collect()
}

/// Share of the smooth curve on a ring.
fn share(distance_m: f64) -> f64 {
    ((distance_m / FROM_M[0]).ln() / (FROM_M[1] / FROM_M[0]).ln()).clamp(0.0, 1.0)
}

impl SourceFunction {
    /// The same, smooth along the rings far from the source; the outermost rings, beyond every sky's sources, stay as they are.
    pub(super) fn smooth_over_rings(&self, grid: &FieldGrid) -> Self {
        let half = (REACH / grid.ring_step()).round() as usize;
        let weights = weights(half);
        let smooth = |values: &[Lanes], per_point: usize| -> Vec<Lanes> {
            let rings = grid.ring_count();
            let of_point = |point: usize| -> Vec<Lanes> {
                let here = &values[point * per_point..(point + 1) * per_point];
                let (ring, share) = (point % rings, share(grid.place_m(point).0));
                if share == 0.0 || ring < half || ring + half >= rings {
                    return here.to_vec();
                }
                let from = |k: usize, value: usize| &values[(point + k - half) * per_point + value];
                let of_value = |value: usize| -> Lanes {
                    std::array::from_fn(|lane| {
                        let terms = weights.iter().enumerate();
                        let smooth: f64 = terms.map(|(k, w)| w * f64::from(from(k, value)[lane])).sum();
                        ((1.0 - share) * f64::from(here[value][lane]) + share * smooth) as f32
                    })
                };
                (0..per_point).map(of_value).collect()
            };
            (0..grid.point_count()).into_par_iter().flat_map_iter(of_point).collect()
        };
        let shape = smooth(&self.shape, pair_count(self.degree));
        Self { degree: self.degree, ln_mean: smooth(&self.ln_mean, 1), shape }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Turbidity,
        atmosphere::Atmosphere,
        multiple_scattering::{
            Resolution, SourceField, SourceSetting, ViewRow, lanes::LANES, source_function::Moments,
        },
    };
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn cubics_pass_and_noise_is_halved() {
        for half in [0, 1, 2, 4, 7] {
            let weights = weights(half);
            for degree in 0..4 {
                let moment: f64 =
                    weights.iter().enumerate().map(|(k, w)| w * (k as f64 - half as f64).powi(degree)).sum();
                assert!((moment - f64::from(u8::from(degree == 0))).abs() < 1e-12, "{half} {degree}");
            }
        }
        let kept = |half: usize| weights(half).iter().map(|w| w * w).sum::<f64>().sqrt();
        assert!(kept(1) == 1.0 && kept(4) < 0.51 && kept(7) < 0.4);
    }

    #[test]
    fn rings_near_the_source_and_the_outermost_stay_and_others_lose_what_only_one_has() {
        let grid = FieldGrid::new(0.0, 0.0, None, 0.2, 1);
        let (rings, degree) = (grid.ring_count(), 1);
        let pairs = pair_count(degree);
        let bump = |point: usize| {
            if grid.place_m(point).0 > 5_000.0 && point.is_multiple_of(5) { 1.05 } else { 1.0 }
        };
        let values = (0..grid.point_count()).flat_map(|point| {
            let fall = (-f64::from(point as u32 % rings as u32) * 0.2).exp() as f32;
            (0..pairs).map(move |pair| [fall * bump(point) * (1.0 + pair as f32); LANES])
        });
        let before = SourceFunction::new(&Moments { degree, values: values.collect() });
        let after = before.smooth_over_rings(&grid);
        let (mut changed, mut most) = (0, 0f32);
        for point in 0..grid.point_count() {
            let (ring, distance_m) = (point % rings, grid.place_m(point).0);
            if distance_m <= FROM_M[0] || ring + 4 >= rings {
                assert_eq!(before.ln_mean[point], after.ln_mean[point]);
            } else if distance_m > FROM_M[1] {
                let even = |function: &SourceFunction| function.ln_mean[point][0] + 0.2 * ring as f32;
                let mean = even(&before) - f32::ln(bump(point));
                changed += usize::from(after.ln_mean[point] != before.ln_mean[point]);
                most = most.max((even(&after) - mean).abs());
                // Moments over the mean are the same everywhere.
                assert!((after.shape[point * pairs + 1][0] / before.shape[1][0] - 1.0).abs() < 1e-5);
            }
        }
        assert!(changed > 100 && most < 0.03, "{changed} {most}");
    }

    /// ln of the zenith's light at distances as far apart as rings.
    fn zenith(field: &SourceField) -> Vec<f64> {
        let row = ViewRow::new(field, 2.0, FRAC_PI_2).unwrap();
        (0..24)
            .map(|k| row.radiance_per_watt(14_000.0 * (0.11 * f64::from(k)).exp(), 0.0)[1][0].ln())
            .collect()
    }

    /// Root mean square of what third differences say one value is off.
    fn roughness(values: &[f64]) -> f64 {
        let third: f64 = values.windows(4).map(|v| (v[3] - 3.0 * v[2] + 3.0 * v[1] - v[0]).powi(2)).sum();
        (third / (20 * (values.len() - 3)) as f64).sqrt()
    }

    #[test]
    fn in_thick_haze_the_zenith_falls_evenly_with_the_distance() {
        let atmosphere = Atmosphere::new(Turbidity::new(6.0).unwrap());
        let setting = SourceSetting::new(atmosphere, 0.0, 0.0, 0.15).unwrap();
        let mut field =
            SourceField::as_followed(setting, &Resolution { most_orders: 3, ..Resolution::table() });
        let followed = zenith(&field);
        field.source = field.source.smooth_over_rings(&field.grid);
        let smooth = zenith(&field);
        let rough = [roughness(&followed), roughness(&smooth)];
        assert!(rough[0] > 0.007 && rough[1] < 0.0025, "{rough:?}");
        // And it is the same light.
        let off = followed.iter().zip(&smooth).map(|(a, b)| a - b).sum::<f64>() / followed.len() as f64;
        assert!(off.abs() < 0.004, "{off}");
    }
}
