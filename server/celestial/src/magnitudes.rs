//! Magnitudes of irradiances: zero points, the unit S10, black bodies of a magnitude.

use skyglow_physics::{Response, photometry::ZERO_POINT_CD_M2, spectrum::Spectrum};

/// Solid angle of a square degree, sr.
pub(crate) const DEG2_SR: f64 = (std::f64::consts::PI / 180.0) * (std::f64::consts::PI / 180.0);
/// Solid angle of a square arcsecond, sr.
pub(crate) const ARCSEC2_SR: f64 = DEG2_SR / (3_600.0 * 3_600.0);
/// Illuminance of V = 0 on the scale of magnitudes, lx: 2.54e-6.
pub const ZERO_MAGNITUDE_LX: f64 = ZERO_POINT_CD_M2 * ARCSEC2_SR;
/// V in mag arcsec⁻² of 1 S10: one star of the tenth magnitude a square degree.
pub const S10_MAG_ARCSEC2: f64 = 27.781_5;

/// V magnitude of an irradiance, W m⁻² nm⁻¹.
pub fn magnitude_v(irradiance: &Spectrum) -> f64 {
    -2.5 * (Response::JohnsonV.value_of(irradiance) / ZERO_MAGNITUDE_LX).log10()
}

/// The shape brought to a V magnitude: an irradiance, W m⁻² nm⁻¹.
pub fn with_magnitude_v(shape: &Spectrum, magnitude: f64) -> Spectrum {
    shape.scaled(10f64.powf(-0.4 * (magnitude - magnitude_v(shape))))
}

/// Planck's law by wavelength, relative.
pub(crate) fn black_body(wavelength_nm: f64, temperature_k: f64) -> f64 {
    const SECOND_CONSTANT_NM_K: f64 = 1.438_776_877e7;
    (550.0 / wavelength_nm).powi(5) / (SECOND_CONSTANT_NM_K / (wavelength_nm * temperature_k)).exp_m1()
}
