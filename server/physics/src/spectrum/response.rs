//! Responses of eyes and instruments, in energy: what each makes of a spectral radiance.

use super::{Spectrum, response_tables as tables, wavelength_nm};

/// What weighs a spectrum: an eye, an animal's, a meter, a satellite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Response {
    /// The light-adapted eye, CIE 1924.
    Photopic,
    /// The dark-adapted eye, CIE 1951.
    Scotopic,
    /// B of Johnson and Cousins (Bessell 1990).
    JohnsonB,
    /// V of Johnson and Cousins (Bessell 1990).
    JohnsonV,
    /// R of Johnson and Cousins (Bessell 1990).
    JohnsonR,
    /// The Sky Quality Meter (Cinzano 2005).
    Sqm,
    /// Melanopsin: body clocks of mammals, CIE S 026:2018.
    Melanopic,
    /// The day/night band of VIIRS.
    Dnb,
}

/// What a response gives, and in which unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// A luminance: K_m, lm W⁻¹, times the integral of the curve.
    Luminance {
        /// Largest luminous efficacy, lm W⁻¹.
        max_efficacy_lm_w: f64,
    },
    /// A magnitude arcsec⁻²: the radiance per nm, weighted by the curve, that 0 mag has.
    Magnitude {
        /// W m⁻² nm⁻¹ of 0 mag.
        zero_w_m2_nm: f64,
    },
    /// A radiance, W m⁻² sr⁻¹: the integral as it is.
    Radiance,
}

/// Solid angle of a square arcsecond, sr.
const ARCSEC2_SR: f64 = 2.350_443_053_909_789e-11;

/// Photopic luminous efficacy at 555 nm, lm W⁻¹.
pub(super) const PHOTOPIC_LM_W: f64 = 683.0;
/// Scotopic luminous efficacy at 507 nm, lm W⁻¹.
pub(super) const SCOTOPIC_LM_W: f64 = 1700.0;

impl Response {
    /// All, in the order of the model's table.
    pub const ALL: [Response; 8] = [
        Response::Photopic,
        Response::Scotopic,
        Response::JohnsonB,
        Response::JohnsonV,
        Response::JohnsonR,
        Response::Sqm,
        Response::Melanopic,
        Response::Dnb,
    ];

    /// The name in requests and answers.
    pub const fn name(self) -> &'static str {
        match self {
            Response::Photopic => "photopic",
            Response::Scotopic => "scotopic",
            Response::JohnsonB => "johnson_b",
            Response::JohnsonV => "johnson_v",
            Response::JohnsonR => "johnson_r",
            Response::Sqm => "sqm",
            Response::Melanopic => "melanopic",
            Response::Dnb => "dnb",
        }
    }

    /// The response of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|response| response.name() == name)
    }

    /// The curve per energy. Those of filters count photons, so they are multiplied by λ and brought to 1 at their largest.
    pub fn curve(self) -> Spectrum {
        match self {
            Response::Photopic => Spectrum::from_samples(&tables::PHOTOPIC),
            Response::Scotopic => Spectrum::from_samples(&tables::SCOTOPIC),
            Response::JohnsonB => per_energy(&tables::JOHNSON_B),
            Response::JohnsonV => per_energy(&tables::JOHNSON_V),
            Response::JohnsonR => per_energy(&tables::JOHNSON_R),
            Response::Sqm => Spectrum::from_samples(&tables::SQM),
            Response::Melanopic => Spectrum::from_samples(&tables::MELANOPIC),
            Response::Dnb => Spectrum::from_samples(&tables::DNB),
        }
    }

    /// What it gives. Zero points of B, V and R are those of Bessell, Castelli and Plez 1998, table A2; that of the SQM makes light
    /// of the Sun's colour (5 772 K) as bright in it as in V.
    pub fn quantity(self) -> Quantity {
        match self {
            Response::Photopic => Quantity::Luminance { max_efficacy_lm_w: PHOTOPIC_LM_W },
            Response::Scotopic => Quantity::Luminance { max_efficacy_lm_w: SCOTOPIC_LM_W },
            Response::JohnsonB => Quantity::Magnitude { zero_w_m2_nm: 6.320e-11 },
            Response::JohnsonV => Quantity::Magnitude { zero_w_m2_nm: V_ZERO_W_M2_NM },
            Response::JohnsonR => Quantity::Magnitude { zero_w_m2_nm: 2.177e-11 },
            Response::Sqm => {
                let sun = Spectrum::from_fn(|nm| planck(nm, 5_772.0));
                let mean = |response: Response| mean(&response.curve(), &sun);
                Quantity::Magnitude {
                    zero_w_m2_nm: V_ZERO_W_M2_NM * mean(Response::Sqm) / mean(Response::JohnsonV),
                }
            }
            Response::Melanopic | Response::Dnb => Quantity::Radiance,
        }
    }

    /// Magnitude arcsec⁻² of ∫ L(λ) curve(λ) dλ, W m⁻² sr⁻¹; None where the response gives no magnitude or there is no light.
    pub fn magnitude_arcsec2(self, weighted_w_m2_sr: f64) -> Option<f64> {
        let Quantity::Magnitude { zero_w_m2_nm } = self.quantity() else { return None };
        let width_nm = self.curve().0.iter().sum::<f64>() * super::STEP_NM;
        let per_arcsec2 = weighted_w_m2_sr * ARCSEC2_SR / width_nm;
        (per_arcsec2 > 0.0).then(|| -2.5 * (per_arcsec2 / zero_w_m2_nm).log10())
    }
}

/// Zero point of V, W m⁻² nm⁻¹ (363.1e-11 erg cm⁻² s⁻¹ Å⁻¹).
const V_ZERO_W_M2_NM: f64 = 3.631e-11;

/// A photon response per energy.
fn per_energy(photon: &[f64]) -> Spectrum {
    let mut curve = Spectrum::from_samples(photon);
    for (sample, value) in curve.0.iter_mut().enumerate() {
        *value *= wavelength_nm(sample);
    }
    let most = curve.0.iter().copied().fold(0.0, f64::max);
    curve.scaled(1.0 / most)
}

/// ∫ curve·spectrum dλ / ∫ curve dλ.
fn mean(curve: &Spectrum, spectrum: &Spectrum) -> f64 {
    curve.integral_with(spectrum) / (curve.0.iter().sum::<f64>() * super::STEP_NM)
}

/// Planck's law by wavelength, in any unit.
pub(super) fn planck(wavelength_nm: f64, temperature_k: f64) -> f64 {
    const SECOND_CONSTANT_NM_K: f64 = 1.438_776_877e7;
    (560.0 / wavelength_nm).powi(5) / (SECOND_CONSTANT_NM_K / (wavelength_nm * temperature_k)).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Peaks and values that are published beside the curves.
    #[test]
    fn curves_peak_where_they_are_known_to() {
        for (response, peak_nm) in [
            (Response::Photopic, 555.0),
            (Response::Scotopic, 505.0),
            (Response::Melanopic, 490.0),
            (Response::JohnsonV, 530.0),
            (Response::JohnsonB, 420.0),
            (Response::Dnb, 700.0),
        ] {
            let curve = response.curve();
            let (at, most) = (0..super::super::SAMPLE_COUNT)
                .map(|sample| (wavelength_nm(sample), curve.0[sample]))
                .fold((0.0, 0.0), |most, next| if next.1 > most.1 { next } else { most });
            assert!((at - peak_nm).abs() <= 10.0, "{}: {at}", response.name());
            assert!((most - 1.0).abs() < 0.01, "{}: {most}", response.name());
            assert_eq!(Response::from_name(response.name()), Some(response));
        }
    }

    /// ∫ V dλ = 106.86 nm (CIE), and the Sun's colour is as bright in the SQM as in V.
    #[test]
    fn integrals_are_the_published_ones() {
        let width = Response::Photopic.curve().0.iter().sum::<f64>() * super::super::STEP_NM;
        assert!((width - 106.86).abs() < 0.05, "{width}");
        let sun = Spectrum::from_fn(|nm| 1e-7 * planck(nm, 5_772.0));
        let of =
            |response: Response| response.magnitude_arcsec2(response.curve().integral_with(&sun)).unwrap();
        assert!((of(Response::Sqm) - of(Response::JohnsonV)).abs() < 1e-12);
        assert_eq!(Response::Photopic.magnitude_arcsec2(1.0), None);
        assert_eq!(Response::JohnsonV.magnitude_arcsec2(0.0), None);
    }

    /// Light of the Sun's colour: 0 mag arcsec⁻² in V is 1.08e5 cd m⁻² within four per cent.
    #[test]
    fn zero_magnitude_is_the_known_luminance() {
        let sun = Spectrum::from_fn(|nm| planck(nm, 5_772.0));
        let v = Response::JohnsonV;
        let magnitude = v.magnitude_arcsec2(v.curve().integral_with(&sun)).unwrap();
        let luminance = PHOTOPIC_LM_W * Response::Photopic.curve().integral_with(&sun);
        let zero_point = luminance * 10f64.powf(0.4 * magnitude);
        assert!((zero_point / 1.08e5 - 1.0).abs() < 0.06, "{zero_point}");
    }
}
