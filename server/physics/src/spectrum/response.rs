//! Responses of eyes and instruments, in energy: what each makes of a spectral radiance.

use super::{STEP_NM, Spectrum, response_tables as tables, wavelength_nm};
use crate::photometry::ZERO_POINT_CD_M2;
use serde::{Serialize, Serializer};
use std::{
    hash::{Hash, Hasher},
    sync::Arc,
};

/// What weighs a spectrum: an eye, an animal's, a meter, a satellite, or a curve of the user's own.
#[derive(Clone, Debug, Default)]
pub enum Response {
    /// The light-adapted eye, CIE 1924; also ȳ of CIE 1931.
    #[default]
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
    /// x̄ of the CIE 1931 standard observer.
    CieX,
    /// z̄ of the CIE 1931 standard observer.
    CieZ,
    /// 1 from `from_nm` to below `to_nm`, 0 elsewhere: the radiance in a part of the spectrum.
    Band {
        /// Shortest wavelength, nm.
        from_nm: u16,
        /// Its end, nm.
        to_nm: u16,
    },
    /// A curve of the user's own.
    Custom(Arc<Spectrum>),
}

/// The parts of the spectrum whose radiance rasters hold: R, G, B.
pub const RGB_BANDS: [Response; 3] = [
    Response::Band { from_nm: 600, to_nm: 700 },
    Response::Band { from_nm: 500, to_nm: 600 },
    Response::Band { from_nm: 400, to_nm: 500 },
];

impl Response {
    /// What tells responses apart: a number for each kind, and the samples of a curve.
    fn key(&self) -> (u8, [u16; 2], Option<&Spectrum>) {
        let number = match self {
            Response::Photopic => 0,
            Response::Scotopic => 1,
            Response::JohnsonB => 2,
            Response::JohnsonV => 3,
            Response::JohnsonR => 4,
            Response::Sqm => 5,
            Response::Melanopic => 6,
            Response::Dnb => 7,
            Response::CieX => 8,
            Response::CieZ => 9,
            Response::Band { from_nm, to_nm } => return (10, [*from_nm, *to_nm], None),
            Response::Custom(curve) => return (11, [0; 2], Some(curve)),
        };
        (number, [0; 2], None)
    }
}

impl PartialEq for Response {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

/// Samples are finite: [`Spectrum::from_csv`] refuses others.
impl Eq for Response {}

impl Hash for Response {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let (number, ends, curve) = self.key();
        (number, ends).hash(state);
        curve.into_iter().flat_map(|curve| curve.0).for_each(|sample| sample.to_bits().hash(state));
    }
}

/// By its name, or as the samples of its curve.
impl Serialize for Response {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Response::Custom(curve) => curve.0.as_slice().serialize(serializer),
            named => named.name().serialize(serializer),
        }
    }
}

/// Solid angle of a square arcsecond, sr.
const ARCSEC2_SR: f64 = 2.350_443_053_909_789e-11;

/// Photopic luminous efficacy at 555 nm, lm W⁻¹.
pub(super) const PHOTOPIC_LM_W: f64 = 683.0;
/// Scotopic luminous efficacy at 507 nm, lm W⁻¹.
pub(super) const SCOTOPIC_LM_W: f64 = 1700.0;
/// Melanopic efficacy of daylight (D65), W lm⁻¹ (CIE S 026:2018).
const MELANOPIC_DAYLIGHT_W_LM: f64 = 1.326_2e-3;
/// W m⁻² sr⁻¹ in nW cm⁻² sr⁻¹.
const NW_CM2_PER_W_M2: f64 = 1e5;

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
    pub const fn name(&self) -> &'static str {
        match self {
            Response::Photopic => "photopic",
            Response::Scotopic => "scotopic",
            Response::JohnsonB => "johnson_b",
            Response::JohnsonV => "johnson_v",
            Response::JohnsonR => "johnson_r",
            Response::Sqm => "sqm",
            Response::Melanopic => "melanopic",
            Response::Dnb => "dnb",
            Response::CieX => "cie_x",
            Response::CieZ => "cie_z",
            Response::Band { .. } => "band",
            Response::Custom(_) => "custom",
        }
    }

    /// The response of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|response| response.name() == name)
    }

    /// The curve per energy. Those of filters count photons, so they are multiplied by λ and brought to 1 at their largest.
    pub fn curve(&self) -> Spectrum {
        match self {
            Response::Photopic => Spectrum::from_samples(&tables::PHOTOPIC),
            Response::Scotopic => Spectrum::from_samples(&tables::SCOTOPIC),
            Response::JohnsonB => per_energy(&tables::JOHNSON_B),
            Response::JohnsonV => per_energy(&tables::JOHNSON_V),
            Response::JohnsonR => per_energy(&tables::JOHNSON_R),
            Response::Sqm => Spectrum::from_samples(&tables::SQM),
            Response::Melanopic => Spectrum::from_samples(&tables::MELANOPIC),
            Response::Dnb => Spectrum::from_samples(&tables::DNB),
            Response::CieX => Spectrum::from_samples(&tables::CIE_X),
            Response::CieZ => Spectrum::from_samples(&tables::CIE_Z),
            Response::Band { from_nm, to_nm } => {
                let band = f64::from(*from_nm)..f64::from(*to_nm);
                Spectrum::from_fn(|nm| f64::from(u8::from(band.contains(&nm))))
            }
            Response::Custom(curve) => curve.as_ref().clone(),
        }
    }

    /// What a value is in. Values of filters and of the SQM are the luminances that photometry gives their magnitudes.
    pub const fn unit(&self) -> &'static str {
        match self {
            Response::Photopic
            | Response::Scotopic
            | Response::JohnsonB
            | Response::JohnsonV
            | Response::JohnsonR
            | Response::Sqm
            | Response::Melanopic
            | Response::CieX
            | Response::CieZ => "cd m-2",
            Response::Dnb => "nW cm-2 sr-1",
            Response::Band { .. } | Response::Custom(_) => "W m-2 sr-1",
        }
    }

    /// Whether a value is a luminance that has a magnitude (mag arcsec⁻²) in the response's own system.
    pub const fn has_magnitude(&self) -> bool {
        matches!(
            self,
            Response::Photopic | Response::JohnsonB | Response::JohnsonV | Response::JohnsonR | Response::Sqm
        )
    }

    /// The value, in [`Self::unit`], of ∫ L(λ) curve(λ) dλ = 1 W m⁻² sr⁻¹.
    ///
    /// Melanopic luminance is that of daylight with as much of it (CIE S 026). Zero points of B, V and R are those of Bessell,
    /// Castelli and Plez 1998, table A2; that of the SQM makes light of the Sun's colour (5 772 K) as bright in it as in V.
    pub fn value_per_w_m2_sr(&self) -> f64 {
        match self {
            Response::Photopic | Response::CieX | Response::CieZ => PHOTOPIC_LM_W,
            Response::Scotopic => SCOTOPIC_LM_W,
            Response::JohnsonB => self.luminance_of_magnitude_zero(6.320e-11),
            Response::JohnsonV => self.luminance_of_magnitude_zero(V_ZERO_W_M2_NM),
            Response::JohnsonR => self.luminance_of_magnitude_zero(2.177e-11),
            Response::Sqm => {
                let sun = Spectrum::from_fn(|nm| planck(nm, 5_772.0));
                let mean = |response: Response| mean(&response.curve(), &sun);
                let ratio = mean(Response::Sqm) / mean(Response::JohnsonV);
                self.luminance_of_magnitude_zero(V_ZERO_W_M2_NM * ratio)
            }
            Response::Melanopic => 1.0 / MELANOPIC_DAYLIGHT_W_LM,
            Response::Dnb => NW_CM2_PER_W_M2,
            Response::Band { .. } | Response::Custom(_) => 1.0,
        }
    }

    /// Luminance of the magnitude that a weighted radiance of 1 W m⁻² sr⁻¹ has, given the radiance per nm of 0 mag arcsec⁻².
    fn luminance_of_magnitude_zero(&self, zero_w_m2_nm: f64) -> f64 {
        let width_nm = self.curve().0.iter().sum::<f64>() * STEP_NM;
        ZERO_POINT_CD_M2 * ARCSEC2_SR / (width_nm * zero_w_m2_nm)
    }

    /// The value of a spectral radiance, W m⁻² sr⁻¹ nm⁻¹, by the 5 nm sum.
    pub fn value_of(&self, radiance: &Spectrum) -> f64 {
        self.value_per_w_m2_sr() * self.curve().integral_with(radiance)
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
    curve.integral_with(spectrum) / (curve.0.iter().sum::<f64>() * STEP_NM)
}

/// Planck's law by wavelength, in any unit.
pub(super) fn planck(wavelength_nm: f64, temperature_k: f64) -> f64 {
    const SECOND_CONSTANT_NM_K: f64 = 1.438_776_877e7;
    (560.0 / wavelength_nm).powi(5) / (SECOND_CONSTANT_NM_K / (wavelength_nm * temperature_k)).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::{super::SAMPLE_COUNT, *};

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
            let (at, most) = (0..SAMPLE_COUNT)
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
        let width = Response::Photopic.curve().0.iter().sum::<f64>() * STEP_NM;
        assert!((width - 106.86).abs() < 0.05, "{width}");
        let sun = Spectrum::from_fn(|nm| 1e-7 * planck(nm, 5_772.0));
        let [sqm, v] = [Response::Sqm, Response::JohnsonV].map(|response| response.value_of(&sun));
        assert!((sqm / v - 1.0).abs() < 1e-12);
    }

    /// Light of the Sun's colour: V and photopic luminance agree within six per cent, the zero point being rounded.
    #[test]
    fn zero_magnitude_is_the_known_luminance() {
        let sun = Spectrum::from_fn(|nm| planck(nm, 5_772.0));
        let ratio = Response::JohnsonV.value_of(&sun) / Response::Photopic.value_of(&sun);
        assert!((ratio - 1.0).abs() < 0.06, "{ratio}");
        // Melanopic luminance of daylight is its photopic luminance; the Sun without air is close to it.
        let ratio = Response::Melanopic.value_of(&sun) / Response::Photopic.value_of(&sun);
        assert!((ratio - 1.0).abs() < 0.12, "{ratio}");
    }

    /// R, G and B side by side are all of 400 to 700 nm, and responses with other curves differ.
    #[test]
    fn bands_add_up_and_responses_differ() {
        let flat = Spectrum::from_fn(|_| 1.0);
        for band in &RGB_BANDS {
            assert!((band.value_of(&flat) - 100.0).abs() < 1e-9);
        }
        let sum = RGB_BANDS.iter().fold(Spectrum::from_fn(|_| 0.0), |sum, band| sum.sum(&band.curve()));
        assert_eq!(sum, Response::Band { from_nm: 400, to_nm: 700 }.curve());
        let custom = |value: f64| Response::Custom(Arc::new(Spectrum::from_fn(|_| value)));
        assert!(custom(1.0) == custom(1.0) && custom(1.0) != custom(2.0) && custom(1.0) != Response::Dnb);
        assert_ne!(RGB_BANDS[0], RGB_BANDS[1]);
    }
}
