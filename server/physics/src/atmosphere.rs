//! The model atmosphere: molecules and aerosol, each exponential in altitude (Garstang 1986), the aerosol by turbidity
//! (Preetham et al. 1999; `docs/model.md#atmosphere`).

use crate::{
    bands::{BAND_COUNT, Band},
    cloud::CloudBase,
    error::{PhysicsError, check_range},
};
use serde::Serialize;

/// Scale height of the molecules, metres: vertical optical depth over extinction at sea level (Bucholtz 1995, US Standard).
pub const MOLECULE_SCALE_HEIGHT_M: f64 = 8_430.0;
/// Scale height of the aerosol, metres.
pub const AEROSOL_SCALE_HEIGHT_M: f64 = 1_200.0;
/// Molecular extinction at z = 0 and 550 nm, m⁻¹ (Bucholtz 1995): 0.0973 vertically.
pub const MOLECULE_EXTINCTION_550_PER_M: f64 = 1.154e-5;
/// Power of the wavelength that molecular extinction falls with (Bucholtz 1995).
pub const MOLECULE_WAVELENGTH_POWER: f64 = 4.05;
/// Single-scattering albedo of the aerosol (of the molecules it is 1).
pub const AEROSOL_ALBEDO: f64 = 0.9;

/// Turbidity at sea level (Preetham et al. 1999): vertical optical thickness of air plus haze over that of
/// air alone, at 550 nm. 1 is clean air.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize)]
pub struct Turbidity(f64);

impl Turbidity {
    /// Smallest turbidity the model has.
    pub const MINIMUM: f64 = 1.0;
    /// Largest turbidity the model has.
    pub const MAXIMUM: f64 = 20.0;

    /// Checks `MINIMUM..=MAXIMUM`; resident packs narrow the range further.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming `turbidity`.
    pub fn new(turbidity: f64) -> Result<Self, PhysicsError> {
        check_range("turbidity", turbidity, Self::MINIMUM, Self::MAXIMUM, "").map(Self)
    }

    /// The number.
    pub fn value(self) -> f64 {
        self.0
    }
}

impl Default for Turbidity {
    /// 2.5, a clear night: zenith extinction 0.26 mag.
    fn default() -> Self {
        Self(2.5)
    }
}

/// Extinction and scattering of the two species at one turbidity, and the cloud base that closes the sky, if any.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Atmosphere {
    turbidity: Turbidity,
    molecule_extinction_per_m: [f64; BAND_COUNT],
    aerosol_extinction_per_m: [f64; BAND_COUNT],
    cloud: Option<CloudBase>,
}

impl Atmosphere {
    /// The atmosphere at a turbidity under a clear sky: β_m(λ) = β_m(550)·(550/λ)^4.05,
    /// β_a(λ) = (T − 1)·β_m(550)·(8.43/1.2)·(550/λ)^1.3.
    pub fn new(turbidity: Turbidity) -> Self {
        Self::at(turbidity, Band::ALL.map(Band::wavelength_nm))
    }

    /// The same at other wavelengths, nm, in the place of the bands': for what judges the spectrum between those. They are to be as long,
    /// one beside the other, as the bands' are: the solver's steps are by the shortest.
    pub fn at(turbidity: Turbidity, wavelengths_nm: [f64; BAND_COUNT]) -> Self {
        let relative = |wavelength_nm: f64, power: f64| (550.0 / wavelength_nm).powf(power);
        let aerosol_550 = (turbidity.value() - 1.0)
            * MOLECULE_EXTINCTION_550_PER_M
            * (MOLECULE_SCALE_HEIGHT_M / AEROSOL_SCALE_HEIGHT_M);
        Self {
            turbidity,
            molecule_extinction_per_m: wavelengths_nm
                .map(|nm| MOLECULE_EXTINCTION_550_PER_M * relative(nm, MOLECULE_WAVELENGTH_POWER)),
            aerosol_extinction_per_m: wavelengths_nm.map(|nm| aerosol_550 * relative(nm, 1.3)),
            cloud: None,
        }
    }

    /// The same air under a closed layer of cloud, or under a clear sky (None).
    pub fn under(self, cloud: Option<CloudBase>) -> Self {
        Self { cloud, ..self }
    }

    /// The layer of cloud that closes the sky; None for a clear one.
    pub fn cloud(&self) -> Option<CloudBase> {
        self.cloud
    }

    /// The turbidity this was made for.
    pub fn turbidity(&self) -> Turbidity {
        self.turbidity
    }

    /// Extinction (all of it scattering) of molecules at z = 0, m⁻¹, per band.
    pub fn molecule_extinction_per_m(&self) -> [f64; BAND_COUNT] {
        self.molecule_extinction_per_m
    }

    /// Extinction of aerosol at z = 0, m⁻¹, per band; [`AEROSOL_ALBEDO`] of it is scattering.
    pub fn aerosol_extinction_per_m(&self) -> [f64; BAND_COUNT] {
        self.aerosol_extinction_per_m
    }

    /// Vertical optical depth above `altitude_m`, per band.
    pub fn vertical_optical_depth(&self, altitude_m: f64) -> [f64; BAND_COUNT] {
        std::array::from_fn(|b| {
            self.molecule_extinction_per_m[b]
                * MOLECULE_SCALE_HEIGHT_M
                * (-altitude_m / MOLECULE_SCALE_HEIGHT_M).exp()
                + self.aerosol_extinction_per_m[b]
                    * AEROSOL_SCALE_HEIGHT_M
                    * (-altitude_m / AEROSOL_SCALE_HEIGHT_M).exp()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Turbidity is the ratio of vertical optical depths at 550 nm.
    #[test]
    fn turbidity_is_a_ratio_of_optical_depths() {
        for t in [1.0, 1.5, 2.5, 6.0] {
            let depth = Atmosphere::new(Turbidity::new(t).unwrap()).vertical_optical_depth(0.0);
            let clean = Atmosphere::new(Turbidity::new(1.0).unwrap()).vertical_optical_depth(0.0);
            for band in Band::ALL {
                let haze = (550.0 / band.wavelength_nm()).powf(1.3 - MOLECULE_WAVELENGTH_POWER) * (t - 1.0);
                assert!((depth[band.index()] / clean[band.index()] - (1.0 + haze)).abs() < 1e-12);
            }
        }
    }

    /// A clear night costs 0.26 magnitudes at the zenith.
    #[test]
    fn clear_zenith_extinction_is_0_26_mag() {
        let air = Atmosphere::new(Turbidity::default());
        let [molecules, aerosol] =
            [(air.molecule_extinction_per_m, MOLECULE_WAVELENGTH_POWER), (air.aerosol_extinction_per_m, 1.3)]
                .map(|(per_m, power)| per_m[1] * (Band::ALL[1].wavelength_nm() / 550.0).powf(power));
        let depth = molecules * MOLECULE_SCALE_HEIGHT_M + aerosol * AEROSOL_SCALE_HEIGHT_M;
        assert!((depth * 1.0857 - 0.264).abs() < 0.006, "{}", depth * 1.0857);
    }

    /// Turbidities 0 and 100 are refused with the range.
    #[test]
    fn turbidity_out_of_range_is_refused() {
        for bad in [0.0, 100.0, f64::NAN] {
            let message = Turbidity::new(bad).unwrap_err().to_string();
            assert!(message.contains("turbidity is") && message.contains("1 to 20"), "{message}");
        }
    }
}
