//! What a response sees of a light behind a sky that is known at four wavelengths: Gauss rules in ln λ of the weight Q·S.

use super::{NODE_COUNT, STEP_NM, Spectrum, gauss, lagrange, nodes_nm, through_ozone, wavelength_nm};

/// A kernel below this part of the largest node counts as this: redder or bluer skies than that are rounding, and a polynomial through
/// their logarithms would overshoot.
pub(crate) const FLOOR: f64 = 1e-5;
/// Fewest and most points of a rule.
const POINTS: std::ops::RangeInclusive<usize> = 3..=6;
/// A rule is fine enough when it is this near to the 5 nm sum for every trial sky.
const TOLERANCE: f64 = 5e-4;

/// How the logarithm of a kernel goes between and beyond the nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum KernelShape {
    /// A polynomial in ln λ.
    #[default]
    Polynomial,
    /// The same with ozone's absorption in the place of the highest power: sunlight, which in twilight comes from below.
    ThroughOzone,
}

impl KernelShape {
    /// Weights of the nodes' logarithms at a wavelength, nm.
    fn weights(self, wavelength_nm: f64) -> [f64; NODE_COUNT] {
        match self {
            KernelShape::Polynomial => lagrange(wavelength_nm),
            KernelShape::ThroughOzone => through_ozone(wavelength_nm),
        }
    }
}

/// ∫ Q S K dλ from K at the nodes, where ln K is a polynomial in ln λ: Σ_j q_j · exp(Σ_n ℓ_n(λ_j) ln K_n).
///
/// As Σ_n ℓ_n = 1 it is homogeneous of degree one, so that parts of a sky add up with [`Self::gradient`] (Euler).
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralRule {
    /// Weights of the nodes' logarithms at each point, and the point's weight.
    points: Vec<([f64; NODE_COUNT], f64)>,
}

impl SpectralRule {
    /// The rule of a light and a response: as few points as keep within 0.05 % of the 5 nm sum for skies as red and as blue as
    /// there are.
    pub fn new(light: &Spectrum, response: &Spectrum) -> Self {
        Self::of_shape(light, response, KernelShape::Polynomial)
    }

    /// The same for kernels of a shape.
    pub fn of_shape(light: &Spectrum, response: &Spectrum, shape: KernelShape) -> Self {
        let exact = Self::exact_of_shape(light, response, shape);
        let trials: Vec<_> =
            trial_kernels().into_iter().map(|kernel| (kernel, exact.value(kernel))).collect();
        let mut rule = Self { points: Vec::new() };
        for count in POINTS {
            rule = Self::of_points(light, response, shape, count);
            let is_fine =
                trials.iter().all(|(kernel, exact)| (rule.value(*kernel) - exact).abs() <= TOLERANCE * exact);
            if is_fine {
                break;
            }
        }
        rule
    }

    /// The 5 nm sum over all wavelengths: what rules are judged by.
    pub fn exact(light: &Spectrum, response: &Spectrum) -> Self {
        Self::exact_of_shape(light, response, KernelShape::Polynomial)
    }

    fn exact_of_shape(light: &Spectrum, response: &Spectrum, shape: KernelShape) -> Self {
        let weight = light.product(response).scaled(STEP_NM);
        let points = weight
            .0
            .iter()
            .enumerate()
            .filter(|(_, weight)| **weight > 0.0)
            .map(|(sample, weight)| (shape.weights(wavelength_nm(sample)), *weight))
            .collect();
        Self { points }
    }

    fn of_points(light: &Spectrum, response: &Spectrum, shape: KernelShape, count: usize) -> Self {
        let weight = light.product(response).scaled(STEP_NM);
        let places: Vec<f64> = (0..weight.0.len()).map(|sample| wavelength_nm(sample).ln()).collect();
        let points = gauss::rule(&places, &weight.0, count)
            .into_iter()
            .map(|(at, weight)| (shape.weights(at.exp()), weight))
            .collect();
        Self { points }
    }

    /// Number of points: exponentials for a direction.
    pub fn point_count(&self) -> usize {
        self.points.len()
    }

    /// The integral for a kernel at the nodes; 0 for no light.
    pub fn value(&self, kernel: [f64; NODE_COUNT]) -> f64 {
        let Some(logarithms) = logarithms(kernel) else { return 0.0 };
        // Not `sum`, which makes −0 of nothing.
        self.points.iter().fold(0.0, |sum, point| sum + term(point, &logarithms))
    }

    /// Weights of the nodes' logarithms at each point, and the point's weight.
    pub fn points(&self) -> &[([f64; NODE_COUNT], f64)] {
        &self.points
    }

    /// The rule of `factor` times the response.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.points.iter_mut().for_each(|point| point.1 *= factor);
        self
    }

    /// ∂value/∂K_n; Σ_n K_n·∂value/∂K_n is the value itself.
    pub fn gradient(&self, kernel: [f64; NODE_COUNT]) -> [f64; NODE_COUNT] {
        let Some(logarithms) = logarithms(kernel) else { return [0.0; NODE_COUNT] };
        let mut shares = [0.0; NODE_COUNT];
        for point in &self.points {
            let term = term(point, &logarithms);
            shares.iter_mut().zip(point.0).for_each(|(share, weight)| *share += term * weight);
        }
        // What counts as a part of the largest moves with that one.
        let largest = (0..NODE_COUNT).max_by(|a, b| kernel[*a].total_cmp(&kernel[*b])).unwrap_or_default();
        for node in 0..NODE_COUNT {
            if kernel[node] < FLOOR * kernel[largest] {
                shares[largest] += shares[node];
                shares[node] = 0.0;
            }
        }
        std::array::from_fn(|node| if shares[node] == 0.0 { 0.0 } else { shares[node] / kernel[node] })
    }
}

/// ln K_n, none below the floor; None without light.
fn logarithms(kernel: [f64; NODE_COUNT]) -> Option<[f64; NODE_COUNT]> {
    let most = kernel.into_iter().fold(0.0, f64::max);
    (most > 0.0).then(|| kernel.map(|value| value.max(FLOOR * most).ln()))
}

/// A point's part.
fn term((weights, weight): &([f64; NODE_COUNT], f64), logarithms: &[f64; NODE_COUNT]) -> f64 {
    let exponent: f64 = weights.iter().zip(logarithms).map(|(weight, logarithm)| weight * logarithm).sum();
    weight * exponent.exp()
}

/// Kernels of trial skies: from λ⁻⁴ of clean air nearby to λ⁴ of light from far away, straight and bent by as much as an octave of
/// wavelength changes the slope.
fn trial_kernels() -> Vec<[f64; NODE_COUNT]> {
    let mut kernels = Vec::new();
    for slope in [-4.0, -2.0, 0.0, 2.0, 4.0] {
        for curvature in [-4.0, 0.0, 4.0] {
            kernels.push(nodes_nm().map(|nm| {
                let x = (nm / 550.0).ln();
                (slope * x + curvature * x * x).exp()
            }));
        }
    }
    kernels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{LampPreset, Response};
    use proptest::prelude::*;

    /// Every lamp as every response sees it, behind skies whose optical depth and scattering follow the laws of clean air and
    /// haze, against the 5 nm integral of the sky itself, which no polynomial knows: with four nodes within 0.5 %, and within 1.2 %
    /// for responses to light beyond the first and the last node; with three within four times as much. Of lamps with light beyond
    /// 780 nm such responses are within 2.5 %, of an incandescent lamp, a third of which lies there, within 5 %: the polynomial goes on
    /// from 680 nm to 900.
    #[test]
    fn rules_are_near_the_full_integral() {
        let mut missed = Vec::new();
        for lamp in LampPreset::ALL {
            let light = lamp.spectrum();
            for response in Response::ALL {
                let curve = response.curve();
                if light.integral_with(&curve) <= 1e-6 * light.0.iter().sum::<f64>() {
                    continue;
                }
                let rule = SpectralRule::new(&light, &curve);
                assert!(POINTS.contains(&rule.point_count()) || rule.point_count() <= 2);
                for path in [0.3, 2.0, 6.0] {
                    let sky = |nm: f64| {
                        let molecules = 0.0973 * (550.0 / nm).powf(4.05);
                        let haze = 0.15 * (550.0 / nm).powf(1.3);
                        (molecules + haze) * (-path * (molecules + haze)).exp()
                    };
                    let exact = light.product(&curve).integral_with(&Spectrum::from_fn(sky));
                    let found = rule.value(nodes_nm().map(sky));
                    let error = found / exact - 1.0;
                    let reaches_far = !matches!(
                        response,
                        Response::Photopic | Response::Scotopic | Response::JohnsonV | Response::Melanopic
                    );
                    let few = if NODE_COUNT < 4 { 4.2 } else { 1.0 };
                    let limit = few
                        * match lamp {
                            _ if !reaches_far => 5e-3,
                            LampPreset::Incandescent => 5e-2,
                            LampPreset::Hps | LampPreset::HpsColourEnhanced | LampPreset::Mercury => 2.5e-2,
                            _ => 1.2e-2,
                        };
                    if error.abs() > limit {
                        missed.push(format!("{} {}: {error:.5}", lamp.name(), response.name()));
                    }
                }
            }
        }
        assert_eq!(missed, Vec::<String>::new());
    }

    /// Sunlight that went through fifty times the usual ozone, as the zenith of deep twilight has it: every response is within 15 % of the
    /// 5 nm integral, where a cubic sees a hundred times too much beyond 680 nm.
    #[test]
    fn twilight_is_not_a_flood_of_red() {
        let light = Spectrum::from_fn(|_| 1.0);
        let sky = |nm: f64| {
            let x = (nm / 550.0).ln();
            (-4.0 * x - 15.0 * crate::beam::ozone::absorption_per_atm_cm(nm)).exp()
        };
        for response in Response::ALL {
            let curve = response.curve();
            let exact = light.product(&curve).integral_with(&Spectrum::from_fn(sky));
            let kernel = nodes_nm().map(sky);
            let [through_ozone, polynomial] = [KernelShape::ThroughOzone, KernelShape::Polynomial]
                .map(|shape| SpectralRule::of_shape(&light, &curve, shape).value(kernel) / exact);
            assert!((through_ozone - 1.0).abs() < 0.15, "{}: {through_ozone}", response.name());
            if response == Response::Dnb {
                assert!(polynomial > 100.0, "{polynomial}");
            }
        }
    }

    proptest! {
        /// Twice the light is twice the value, and parts add up by the gradient.
        #[test]
        fn values_are_homogeneous(kernel in prop::array::uniform::<_, NODE_COUNT>(1e-9..1.0_f64), factor in 1e-6..1e6_f64) {
            let rule = SpectralRule::new(&LampPreset::Led4000k.spectrum(), &Response::Scotopic.curve());
            let value = rule.value(kernel);
            prop_assert!((rule.value(kernel.map(|k| k * factor)) / (factor * value) - 1.0).abs() < 1e-10);
            let euler: f64 = rule.gradient(kernel).iter().zip(kernel).map(|(slope, k)| slope * k).sum();
            prop_assert!((euler / value - 1.0).abs() < 1e-10);
        }
    }

    #[test]
    fn no_light_is_no_value() {
        let rule = SpectralRule::new(&LampPreset::Lps.spectrum(), &Response::Photopic.curve());
        assert_eq!(rule.value([0.0; NODE_COUNT]), 0.0);
        assert_eq!(rule.gradient([0.0; NODE_COUNT]), [0.0; NODE_COUNT]);
        assert!(rule.value(std::array::from_fn(|node| f64::from(u8::from(node == 1)))).is_finite());
        let blind = SpectralRule::new(&LampPreset::Lps.spectrum(), &Spectrum::from_fn(|_| 0.0));
        assert!(blind.value([1.0; NODE_COUNT]) == 0.0 && blind.value([1.0; NODE_COUNT]).is_sign_positive());
    }
}
