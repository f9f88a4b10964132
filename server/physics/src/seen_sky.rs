//! A sky as eyes and instruments see it: spectral kernels at the nodes turned into values of responses in every direction
//! (`docs/model.md#spectra`).

use crate::{
    bands::BAND_COUNT,
    horizon::Horizon,
    panorama::{AZIMUTH_COUNT, ELEVATION_COUNT, Panorama},
    simd::{self, exponential, logarithm, multiply_add},
    simd_dispatch,
    spectrum::{Light, Response, SpectralRule},
};
use rayon::prelude::*;
use std::{array::from_fn, borrow::Cow, sync::Arc};

const DIRECTION_COUNT: usize = ELEVATION_COUNT * AZIMUTH_COUNT;
/// Rows that one thread takes at least.
const ROWS_PER_TASK: usize = 8;
/// Least ratio of a node to the largest one, as [`SpectralRule`] has it.
const FLOOR: f32 = crate::spectrum::KERNEL_FLOOR as f32;

/// One kind of light over the sky.
#[derive(Clone, Debug)]
pub struct SkyPart {
    /// The kind.
    pub light: Arc<Light>,
    /// Σ Φ_i b_i at every node, watts that the satellite sees times m⁻² sr⁻¹; 0 where nothing is seen.
    pub kernel: Panorama,
}

/// Values of responses over the panorama grid.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenSky {
    responses: Vec<Response>,
    /// `[response][row][column]`, each in its response's unit.
    values: Vec<f32>,
}

impl SeenSky {
    /// What responses see of a sky that is the sum of its parts. Relative error below 1e-4 of [`SpectralRule::value`]. The
    /// result does not depend on the number of threads.
    pub fn of(parts: &[SkyPart], responses: &[Response]) -> Self {
        let mut values = vec![0f32; responses.len() * DIRECTION_COUNT];
        let rules: Vec<Vec<Rule>> = parts
            .iter()
            .map(|part| responses.iter().map(|of| Rule::of(&part.light.rule(of))).collect())
            .collect();
        // Each row of the sky with what every response sees of it.
        let mut rows: Vec<Vec<&mut Row>> = (0..ELEVATION_COUNT).map(|_| Vec::new()).collect();
        for plane in values.chunks_exact_mut(DIRECTION_COUNT) {
            for (row, values) in rows.iter_mut().zip(plane.as_chunks_mut::<AZIMUTH_COUNT>().0) {
                row.push(values);
            }
        }
        let is_wide = simd::is_wide();
        rows.par_iter_mut().with_min_len(ROWS_PER_TASK).enumerate().for_each(|(row, values)| {
            let add = |values: &mut [&mut Row]| {
                for (part, rules) in parts.iter().zip(&rules) {
                    let samples = part.kernel.samples();
                    let kernel = from_fn(|band| {
                        let start = Panorama::index(band, row, 0);
                        let row = samples[start..].first_chunk::<AZIMUTH_COUNT>();
                        row.copied().unwrap_or([0.0; AZIMUTH_COUNT])
                    });
                    add_row(&kernel, rules, values);
                }
            };
            if is_wide { add(values) } else { simd::with_baseline(|| add(values)) }
        });
        Self { responses: responses.to_vec(), values }
    }

    /// A sky from values, `[response][row][column]`; None unless there is one for each response and direction.
    pub fn from_values(responses: Vec<Response>, values: Vec<f32>) -> Option<Self> {
        (values.len() == responses.len() * DIRECTION_COUNT).then_some(Self { responses, values })
    }

    /// Adds what the same responses see of another sky; responses that the other lacks stay as they are.
    pub fn add(&mut self, other: &SeenSky) {
        for (response, plane) in self.responses.iter().zip(self.values.chunks_exact_mut(DIRECTION_COUNT)) {
            for (value, other) in plane.iter_mut().zip(other.seen_by(response).unwrap_or_default()) {
                *value += other;
            }
        }
    }

    /// What is there to see it with.
    pub fn responses(&self) -> &[Response] {
        &self.responses
    }

    /// Values of the response at a place in [`Self::responses`], `[row][column]`; none for other places.
    pub fn plane(&self, place: usize) -> &[f32] {
        self.values.get(place * DIRECTION_COUNT..).and_then(|rest| rest.get(..DIRECTION_COUNT)).unwrap_or(&[])
    }

    /// The same, writable.
    pub fn plane_mut(&mut self, place: usize) -> &mut [f32] {
        self.values.chunks_exact_mut(DIRECTION_COUNT).nth(place).unwrap_or_default()
    }

    /// The sky with its hidden samples filled from the lowest visible one of their column, as the lowest row holds
    /// down to an open horizon: between the profile and the first visible row the sky then has its colour, and none of
    /// the ground's darkness runs into it. Visible samples stay bit for bit.
    pub fn without_ground(&self, horizon: &Horizon) -> Cow<'_, Self> {
        if horizon.is_flat() {
            return Cow::Borrowed(self);
        }
        let mut filled = self.clone();
        for values in filled.values.chunks_exact_mut(DIRECTION_COUNT) {
            for column in 0..AZIMUTH_COUNT {
                let lowest = horizon.first_visible_row(column);
                if lowest == ELEVATION_COUNT {
                    continue;
                }
                let value = values[lowest * AZIMUTH_COUNT + column];
                (0..lowest).for_each(|row| values[row * AZIMUTH_COUNT + column] = value);
            }
        }
        Cow::Owned(filled)
    }

    /// Values of a response, `[row][column]`; None for one that is not there.
    pub fn seen_by(&self, response: &Response) -> Option<&[f32]> {
        self.responses.iter().position(|of| of == response).map(|place| self.plane(place))
    }
}

/// A rule in single precision.
struct Rule(Vec<([f32; BAND_COUNT], f32)>);

impl Rule {
    fn of(rule: &SpectralRule) -> Self {
        let point =
            |(weights, weight): &([f64; BAND_COUNT], f64)| (weights.map(|w| w as f32), *weight as f32);
        Self(rule.points().iter().map(point).collect())
    }
}

type Row = [f32; AZIMUTH_COUNT];

simd_dispatch! {
    /// Adds what every rule makes of a row of the kernel to the row of its response.
    fn add_row(kernel: &[Row; BAND_COUNT], rules: &[Rule], values: &mut [&mut Row]) = add_row_body::<FUSED>;
}

#[inline(always)]
fn add_row_body<const FUSED: bool>(kernel: &[Row; BAND_COUNT], rules: &[Rule], values: &mut [&mut Row]) {
    let mut most = [0f32; AZIMUTH_COUNT];
    for band in kernel {
        for (most, value) in most.iter_mut().zip(band) {
            *most = most.max(*value);
        }
    }
    // Where there is no light the logarithms are finite and the sum counts for nothing.
    let lit: Row = from_fn(|at| if most[at] > f32::MIN_POSITIVE { 1.0 } else { 0.0 });
    let scale: Row = from_fn(|at| if lit[at] > 0.0 { most[at] } else { 1.0 });
    let logarithms: [Row; BAND_COUNT] =
        from_fn(|band| from_fn(|at| logarithm((kernel[band][at] / scale[at]).max(FLOOR))));
    for (rule, row) in rules.iter().zip(values) {
        let mut sums = [0f32; AZIMUTH_COUNT];
        for (weights, weight) in &rule.0 {
            for at in 0..AZIMUTH_COUNT {
                let mut exponent = 0.0;
                for band in 0..BAND_COUNT {
                    exponent = multiply_add::<FUSED>(weights[band], logarithms[band][at], exponent);
                }
                sums[at] = multiply_add::<FUSED>(*weight, exponential(exponent), sums[at]);
            }
        }
        for at in 0..AZIMUTH_COUNT {
            row[at] = multiply_add::<FUSED>(lit[at] * scale[at], sums[at], row[at]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::LampPreset;
    use proptest::prelude::*;

    fn part(preset: LampPreset, kernel: Vec<f32>) -> SkyPart {
        let kernel = Panorama::from_samples(kernel).unwrap();
        SkyPart { light: Arc::clone(preset.lamp().light()), kernel }
    }

    /// A kernel whose nodes differ by direction, some of them black and some black at one node.
    fn kernel(seed: f64) -> Vec<f32> {
        let sample = |at: usize| {
            let (band, direction) = (at / DIRECTION_COUNT, at % DIRECTION_COUNT);
            let light = (-10.0 + 4.0 * (0.01 * direction as f64 + seed).sin()).exp();
            let colour = (1.5 * (band as f64 - 1.0) * (0.003 * direction as f64 + seed).cos()).exp();
            let is_black = direction % 7 == 0 || (direction % 11 == 0 && band == 0);
            if is_black { 0.0 } else { (light * colour) as f32 }
        };
        (0..Panorama::LEN).map(sample).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]

        /// What is found in single precision by rows is what the rules say direction by direction, with wide instructions and without.
        #[test]
        fn rows_are_what_the_rules_say(seed in 0.0..6.0_f64) {
            let parts = [part(LampPreset::Hps, kernel(seed)), part(LampPreset::Led5000k, kernel(seed + 1.0))];
            let responses = [Response::Photopic, Response::Scotopic, Response::CieX, Response::JohnsonB];
            let seen = SeenSky::of(&parts, &responses);
            let baseline = crate::simd::with_baseline(|| SeenSky::of(&parts, &responses));
            for (place, response) in responses.iter().enumerate() {
                for direction in (0..DIRECTION_COUNT).step_by(37) {
                    let exact: f64 = parts.iter().map(|part| {
                        let nodes = from_fn(|band| f64::from(part.kernel.samples()[band * DIRECTION_COUNT + direction]));
                        part.light.rule(response).value(nodes)
                    }).sum();
                    for seen in [&seen, &baseline] {
                        let got = f64::from(seen.plane(place)[direction]);
                        prop_assert!((got - exact).abs() <= 1e-5 * exact, "{} {}", got, exact);
                    }
                }
            }
        }
    }

    /// Two skies added are the sky of the parts of both.
    #[test]
    fn skies_add_up() {
        let parts = [part(LampPreset::Hps, kernel(1.0)), part(LampPreset::Led4000k, kernel(2.0))];
        let responses = [Response::Scotopic, Response::Photopic];
        let mut sum = SeenSky::of(&parts[..1], &responses);
        sum.add(&SeenSky::of(&parts[1..], &[Response::Photopic, Response::Scotopic]));
        let both = SeenSky::of(&parts, &responses);
        assert!(sum.values.iter().zip(&both.values).all(|(a, b)| (a - b).abs() <= 1e-6 * b));
        sum.add(&SeenSky::of(&parts, &[Response::Dnb]));
        assert!(sum.values.iter().zip(&both.values).all(|(a, b)| (a - b).abs() <= 1e-6 * b));
    }

    #[test]
    fn planes_are_found_by_their_response() {
        let parts = [part(LampPreset::Mixed, kernel(1.0))];
        let seen = SeenSky::of(&parts, &[Response::Photopic, Response::Dnb]);
        assert_eq!(seen.seen_by(&Response::Dnb), Some(seen.plane(1)));
        assert_eq!(seen.seen_by(&Response::Sqm), None);
        assert!(seen.plane(2).is_empty() && seen.plane(0).iter().any(|value| *value > 0.0));
        let none = SeenSky::of(&[], &[Response::Photopic]);
        assert!(none.plane(0).iter().all(|value| *value == 0.0));
        assert_eq!(SeenSky::from_values(vec![Response::Photopic], vec![0.0; 3]), None);
    }
}
