//! Savitzky–Golay smoothing (Savitzky and Golay 1964) of light over the distance, far from the source.
//!
//! Orders are followed in a fixed set of directions. Ten kilometres from a source and farther, the haze that glows over it is
//! a strip of a degree or two in the sky of every place, and what a set of directions samples of a strip oscillates by some
//! per cent from one ring to the next: the same in every band, lobe and layer. Light itself is smooth
//! there. So the source function of every order is taken from the least-squares cubic through the rings around, which are
//! even in their coordinate; below a cloud, where a lobe lights a disc with a sharp
//! edge, that of all orders alone.
//!
//! The curve is fitted to logarithms, and then raised to the mean of the light over it: a field is sampled in logarithms, and
//! the mean of a logarithm is less than the logarithm of the mean, by half the variance. Over the orders that took 2 to 3 %
//! of the zenith 20 to 300 km away in thick haze.

use super::{
    grid::FieldGrid,
    harmonics::pair_count,
    lanes::{LANES, Lanes},
    source_function::SourceFunction,
};
use rayon::prelude::*;

/// Half width of the window of the cubic, in the coordinate of the rings: light falls by about a factor e over it.
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

/// Cubics along the rings of a grid.
struct Curves<'a> {
    grid: &'a FieldGrid,
    half: usize,
    weights: Vec<f64>,
}

/// Light along the rings of one layer.
struct SmoothLight {
    /// Its logarithm, smooth, `[ring]`.
    ln: Vec<Lanes>,
    /// Excess of each ring over the curve through the logarithms, `[ring]`.
    over: Vec<Lanes>,
    /// The smooth curve of that, `[ring]`.
    mean_over: Vec<[f64; LANES]>,
}

/// Largest raise of a curve, and the range of the light around a ring over it: at the edge of a shadow no curve is smooth.
const MAX_RAISED: f64 = 0.5;
const OVER: [f64; 2] = [0.5, 2.0];

impl<'a> Curves<'a> {
    fn new(grid: &'a FieldGrid) -> Self {
        let half = (REACH / grid.ring_step()).round() as usize;
        Self { grid, half, weights: weights(half) }
    }

    /// Share of the cubic at a ring, 0..=1; the outermost rings, beyond every sky's sources, have none.
    fn share(&self, ring: usize) -> f64 {
        if ring < self.half || ring + self.half >= self.grid.ring_count() {
            return 0.0;
        }
        share(self.grid.place_m(ring).0)
    }

    /// The cubic at a ring, from what each ring has.
    fn at(&self, ring: usize, of_ring: impl Fn(usize) -> f64) -> f64 {
        self.weights.iter().enumerate().map(|(k, weight)| weight * of_ring(ring + k - self.half)).sum()
    }

    /// Light from its logarithm, `ln[ring]` of one layer.
    fn smooth(&self, ln: &[Lanes]) -> SmoothLight {
        let rings = || 0..ln.len();
        let curve_at = |ring: usize| -> Lanes {
            let share = self.share(ring);
            if share == 0.0 {
                return ln[ring];
            }
            std::array::from_fn(|lane| {
                let curve = self.at(ring, |ring| f64::from(ln[ring][lane]));
                ((1.0 - share) * f64::from(ln[ring][lane]) + share * curve) as f32
            })
        };
        let curve: Vec<Lanes> = rings().map(curve_at).collect();
        let over: Vec<Lanes> =
            rings().map(|ring| std::array::from_fn(|l| (ln[ring][l] - curve[ring][l]).exp())).collect();
        let mean_at = |ring: usize| -> [f64; LANES] {
            if self.share(ring) == 0.0 {
                return [1.0; LANES];
            }
            let mean = |lane: usize| self.at(ring, |ring| f64::from(over[ring][lane]));
            std::array::from_fn(|lane| mean(lane).clamp(OVER[0], OVER[1]))
        };
        let mean_over: Vec<[f64; LANES]> = rings().map(mean_at).collect();
        // e^r − 1 − r in the mean of the rings, r the logarithm over the curve: the curve alone would take r in again.
        let raised = |ring: usize| -> Lanes {
            let share = self.share(ring);
            if share == 0.0 {
                return curve[ring];
            }
            std::array::from_fn(|lane| {
                let around = ring - self.half..=ring + self.half;
                let excess =
                    |ring: usize| f64::from(over[ring][lane] - 1.0 - (ln[ring][lane] - curve[ring][lane]));
                let mean = around.map(excess).sum::<f64>() / self.weights.len() as f64;
                curve[ring][lane] + (share * mean.min(MAX_RAISED).ln_1p()) as f32
            })
        };
        SmoothLight { ln: rings().map(raised).collect(), over, mean_over }
    }
}

impl SourceFunction {
    /// The same, smooth along the rings far from the source; the outermost rings stay as they are.
    pub(super) fn smooth_over_rings(&self, grid: &FieldGrid) -> Self {
        let (curves, rings, pairs) = (Curves::new(grid), grid.ring_count(), pair_count(self.degree));
        let of_layer = |layer: usize| -> (Vec<Lanes>, Vec<Lanes>) {
            let first = layer * rings;
            let light = curves.smooth(&self.ln_mean[first..first + rings]);
            let shape = |ring: usize, pair: usize| &self.shape[(first + ring) * pairs + pair];
            // Moments are smooth as the light in them is, and then taken over its mean again.
            let of_pair = |ring: usize, pair: usize| -> Lanes {
                let share = curves.share(ring);
                if share == 0.0 {
                    return *shape(ring, pair);
                }
                std::array::from_fn(|lane| {
                    let of_ring =
                        |ring: usize| f64::from(light.over[ring][lane]) * f64::from(shape(ring, pair)[lane]);
                    let smooth = curves.at(ring, of_ring) / light.mean_over[ring][lane];
                    ((1.0 - share) * f64::from(shape(ring, pair)[lane]) + share * smooth) as f32
                })
            };
            let shapes = (0..rings).flat_map(|ring| (0..pairs).map(move |pair| (ring, pair)));
            (light.ln, shapes.map(|(ring, pair)| of_pair(ring, pair)).collect())
        };
        let layers: Vec<_> = (0..grid.layer_count()).into_par_iter().map(of_layer).collect();
        let (ln_mean, shape): (Vec<_>, Vec<_>) = layers.into_iter().unzip();
        Self { degree: self.degree, ln_mean: ln_mean.concat(), shape: shape.concat() }
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

    /// Rings near the source and the outermost ring stay, and others lose what only one ring has.
    #[test]
    fn smoothing_removes_single_rings() {
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

    /// In thick haze the zenith falls evenly with the distance.
    #[test]
    #[ignore = "slow: `make check` leaves it to `make test`"]
    fn zenith_falls_evenly_in_thick_haze() {
        let atmosphere = Atmosphere::new(Turbidity::new(6.0).unwrap());
        let setting = SourceSetting::new(atmosphere, 0.0, 0.0, 0.15).unwrap();
        let resolution = Resolution { max_orders: 3, ..Resolution::table() };
        let followed = zenith(&SourceField::as_followed(setting, &resolution));
        let smooth = zenith(&SourceField::solve(setting, &resolution));
        let rough = [roughness(&followed), roughness(&smooth)];
        assert!(rough[0] > 0.007 && rough[1] < 0.0025, "{rough:?}");
        // Logarithms of what goes up and down are too dark, order upon order; three times as many directions hardly go up and down.
        let finer = zenith(&SourceField::as_followed(
            setting,
            &Resolution { polar_per_hemisphere: 48, ..resolution },
        ));
        let off = |light: &[f64]| -> f64 {
            light.iter().zip(&finer).map(|(a, b)| a - b).sum::<f64>() / light.len() as f64
        };
        let off = [off(&followed), off(&smooth)];
        assert!(off[0] < -0.01 && off[1].abs() < 0.5 * off[0].abs(), "{off:?}");
    }
}
