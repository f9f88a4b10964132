//! The natural sky: uniform, 22.0 mag arcsec⁻², as much light at every wavelength.

use crate::{
    photometry::natural_sky_luminance_cd_m2,
    spectrum::{Response, Spectrum},
};

/// What a response sees of the natural sky, in the response's unit: as much light at every wavelength, with the luminance above.
pub fn natural_sky_value(response: &Response) -> f64 {
    let flat = Spectrum::from_fn(|_| 1.0);
    natural_sky_luminance_cd_m2() * response.value_of(&flat) / Response::Photopic.value_of(&flat)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eye_sees_22_magnitudes_of_it() {
        assert!((natural_sky_value(&Response::Photopic) / natural_sky_luminance_cd_m2() - 1.0).abs() < 1e-12);
        // Light of equal energy is bluer than the Sun's.
        let of = |response: Response| natural_sky_value(&response) / natural_sky_luminance_cd_m2();
        assert!(of(Response::JohnsonB) < of(Response::JohnsonR) && of(Response::Scotopic) > 2.0);
    }
}
