//! Chromaticity and correlated colour temperature (CIE 015:2018: least distance to Planck's curve in the u′, 2⁄3 v′ diagram).

use super::{
    Spectrum,
    response::{PHOTOPIC_LM_W, SCOTOPIC_LM_W, planck},
    response_tables as tables,
};
use std::sync::LazyLock;

/// Distance from Planck's curve from which on a temperature has no meaning (CIE 015).
const MAX_DISTANCE: f64 = 0.05;

/// The colour of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// Tristimulus values X, Y, Z of the CIE 1931 observer, in units of ∫ ȳ S dλ.
    pub xyz: [f64; 3],
    /// Chromaticity x, y.
    pub chromaticity: [f64; 2],
    /// Correlated colour temperature, K, 1 000 to 25 000; None farther than 0.05 from Planck's curve, where it has no meaning.
    pub temperature_k: Option<f64>,
    /// Scotopic over photopic luminous flux.
    pub scotopic_photopic_ratio: f64,
}

impl Colour {
    /// The colour of a spectrum; None without visible light.
    pub fn of(spectrum: &Spectrum) -> Option<Self> {
        let xyz = tristimulus(spectrum);
        let (chromaticity, temperature_k) = Self::of_tristimulus(xyz)?;
        let scotopic = Spectrum::from_samples(&tables::SCOTOPIC).integral_with(spectrum);
        Some(Self {
            xyz,
            chromaticity,
            temperature_k,
            scotopic_photopic_ratio: SCOTOPIC_LM_W * scotopic / (PHOTOPIC_LM_W * xyz[1]),
        })
    }
}

impl Colour {
    /// Chromaticity x, y and correlated colour temperature, K, of X, Y, Z in any unit; None without light.
    pub fn of_tristimulus(xyz: [f64; 3]) -> Option<([f64; 2], Option<f64>)> {
        let total: f64 = xyz.iter().sum();
        let has_light = total > 0.0 && xyz[1] > 0.0;
        has_light.then(|| ([xyz[0] / total, xyz[1] / total], temperature_k(uv(xyz))))
    }
}

/// X, Y, Z.
fn tristimulus(spectrum: &Spectrum) -> [f64; 3] {
    [&tables::CIE_X, &tables::PHOTOPIC, &tables::CIE_Z]
        .map(|curve| Spectrum::from_samples(curve).integral_with(spectrum))
}

/// Coordinates in the uniform diagram of CIE 1960.
fn uv([x, y, z]: [f64; 3]) -> [f64; 2] {
    let total = x + 15.0 * y + 3.0 * z;
    [4.0 * x / total, 6.0 * y / total]
}

/// Reciprocal temperatures that are looked through, MK⁻¹, and the step between them.
const MIREDS: (f64, f64) = (40.0, 1_000.0);
const STEP_MIRED: f64 = 5.0;

/// Black bodies every [`STEP_MIRED`].
static LOCUS: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| {
    let count = ((MIREDS.1 - MIREDS.0) / STEP_MIRED) as usize + 1;
    (0..count).map(|at| black_body_uv(MIREDS.0 + STEP_MIRED * at as f64)).collect()
});

fn black_body_uv(mired: f64) -> [f64; 2] {
    uv(tristimulus(&Spectrum::from_fn(|nm| planck(nm, 1e6 / mired))))
}

/// The temperature whose black body is nearest.
fn temperature_k([u, v]: [f64; 2]) -> Option<f64> {
    let square = |[own_u, own_v]: [f64; 2]| (own_u - u).powi(2) + (own_v - v).powi(2);
    let nearest = (0..LOCUS.len()).min_by(|a, b| square(LOCUS[*a]).total_cmp(&square(LOCUS[*b])))?;
    let mut mired = MIREDS.0 + STEP_MIRED * nearest as f64;
    // The squared distance is a parabola, the better the nearer its least value is.
    for step in [0.5 * STEP_MIRED, 0.02 * STEP_MIRED, 2e-4 * STEP_MIRED] {
        let [below, here, above] = [-step, 0.0, step].map(|by| square(black_body_uv(mired + by)));
        let bend = below - 2.0 * here + above;
        if bend > 0.0 {
            mired += (0.5 * step * (below - above) / bend).clamp(-STEP_MIRED, STEP_MIRED);
        }
    }
    let mired = mired.clamp(MIREDS.0, MIREDS.1);
    (square(black_body_uv(mired)) < MAX_DISTANCE * MAX_DISTANCE).then_some(1e6 / mired)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_bodies_have_their_temperature() {
        for temperature in [1_500.0, 2_856.0, 6_500.0, 12_000.0] {
            let colour = Colour::of(&Spectrum::from_fn(|nm| planck(nm, temperature))).unwrap();
            assert!((colour.temperature_k.unwrap() / temperature - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn far_from_white_there_is_no_temperature() {
        let green = Spectrum::from_fn(|nm| if (510.0..530.0).contains(&nm) { 1.0 } else { 0.0 });
        assert_eq!(Colour::of(&green).unwrap().temperature_k, None);
        assert_eq!(Colour::of(&Spectrum::from_fn(|_| 0.0)), None);
    }
}
