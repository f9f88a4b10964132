//! Airglow: a thin layer at 90 km (van Rhijn 1921) whose brightness goes with the Sun's radio flux (Leinert et al. 1998, section 6).

use crate::magnitudes::S10_MAG_ARCSEC2;
use skyglow_physics::{
    EARTH_RADIUS_M, Response,
    photometry::luminance_from_brightness_cd_m2,
    spectrum::{STEP_NM, Spectrum, wavelength_nm},
};

/// Height of the layer above sea level, m.
pub const LAYER_HEIGHT_M: f64 = 90_000.0;

/// Brightness at the zenith outside the lower air, S10 in V, for a solar radio flux at 10.7 cm, solar flux units.
pub fn zenith_s10(solar_flux_sfu: f64) -> f64 {
    90.0 + 0.43 * solar_flux_sfu
}

/// van Rhijn's factor: brightness over that of the zenith, for an observer so high, m. 0 below the horizontal plane, since a layer
/// near the Earth has no beam from there.
pub fn van_rhijn(sin_elevation: f64, altitude_m: f64) -> f64 {
    if sin_elevation < 0.0 {
        return 0.0;
    }
    let ratio = (EARTH_RADIUS_M + altitude_m) / (EARTH_RADIUS_M + LAYER_HEIGHT_M);
    let sin2_zenith = (1.0 - sin_elevation * sin_elevation).max(0.0);
    (1.0 - ratio * ratio * sin2_zenith).sqrt().recip()
}

/// A line or band: its middle and its full width, nm, and its intensity, rayleigh.
type Feature = (f64, f64, f64);

/// Round values of the airglow over Cerro Paranal at 130 solar flux units (Noll et al. 2012, by ESO's SkyCalc). Lines: oxygen 557.7,
/// 630.0 and 636.4 nm, sodium 589.3 nm. Bands: OH, each in the 20 nm around it, and at 864.5 nm molecular oxygen.
const FEATURES: [Feature; 20] = [
    (557.7, 0.0, 220.0),
    (589.3, 0.0, 55.0),
    (630.0, 0.0, 165.0),
    (636.4, 0.0, 55.0),
    (592.0, 20.0, 27.0),
    (610.0, 20.0, 14.0),
    (627.0, 20.0, 67.0),
    (650.0, 20.0, 69.0),
    (690.0, 20.0, 150.0),
    (710.0, 20.0, 36.0),
    (729.0, 20.0, 380.0),
    (748.0, 20.0, 190.0),
    (772.0, 20.0, 400.0),
    (789.0, 20.0, 700.0),
    (808.0, 20.0, 170.0),
    (832.0, 20.0, 560.0),
    (849.0, 20.0, 640.0),
    (864.5, 10.0, 330.0),
    (870.0, 20.0, 470.0),
    (888.0, 20.0, 1_400.0),
];

/// The continuum of the same with faint lines, rayleigh nm⁻¹, linear between wavelengths, nm: NO₂ and FeO make it broadest around 590 nm.
const CONTINUUM: [(f64, f64); 13] = [
    (380.0, 5.6),
    (400.0, 4.8),
    (425.0, 4.1),
    (500.0, 4.1),
    (535.0, 4.9),
    (590.0, 6.6),
    (640.0, 5.4),
    (690.0, 5.4),
    (740.0, 6.7),
    (780.0, 9.5),
    (820.0, 11.7),
    (860.0, 16.0),
    (900.0, 17.0),
];

fn continuum_r_nm(wavelength_nm: f64) -> f64 {
    let after = CONTINUUM.partition_point(|(nm, _)| *nm < wavelength_nm).clamp(1, CONTINUUM.len() - 1);
    let ((low_nm, low), (high_nm, high)) = (CONTINUUM[after - 1], CONTINUUM[after]);
    low + (high - low) * (wavelength_nm - low_nm) / (high_nm - low_nm)
}

/// Spectral radiance of airglow of 1 S10 in V, W m⁻² sr⁻¹ nm⁻¹. A line stands in the two samples beside it.
pub fn spectrum_s10() -> Spectrum {
    let mut photons = Spectrum::from_fn(continuum_r_nm);
    for (middle_nm, width_nm, rayleigh) in FEATURES {
        // Triangles, none narrower than what two samples make of a line.
        let half_nm = (0.5 * width_nm).max(STEP_NM);
        let shape = Spectrum::from_fn(|nm| (1.0 - (nm - middle_nm).abs() / half_nm).max(0.0));
        let sum_nm: f64 = shape.0.iter().sum::<f64>() * STEP_NM;
        photons = photons.sum(&shape.scaled(rayleigh / sum_nm));
    }
    // Energy of a photon goes with 1/λ.
    for (sample, value) in photons.0.iter_mut().enumerate() {
        *value /= wavelength_nm(sample);
    }
    let luminance = luminance_from_brightness_cd_m2(S10_MAG_ARCSEC2);
    photons.scaled(luminance / Response::JohnsonV.value_of(&photons))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// 1 at the zenith, 3.5 at 15° and 6 on the horizon for a layer at 90 km.
    #[test]
    fn the_layer_brightens_to_the_horizon() {
        assert!((van_rhijn(1.0, 0.0) - 1.0).abs() < 1e-15);
        for (elevation_deg, factor) in [(45.0_f64, 1.39), (30.0, 1.92), (15.0, 3.28), (0.0, 6.03)] {
            let found = van_rhijn(elevation_deg.to_radians().sin(), 0.0);
            assert!((found / factor - 1.0).abs() < 0.01, "{elevation_deg}: {found}");
        }
        assert_eq!(van_rhijn(-1e-9, 2_000.0), 0.0);
    }

    /// The intensities as they stand are 198 S10 in V (the model itself has 199), a third more than the layer has at that solar flux.
    #[test]
    fn intensities_fit_the_brightness() {
        let at_nm = 450.0;
        let per_s10 = spectrum_s10().0[((at_nm - 380.0) / STEP_NM) as usize];
        // Rayleigh to W m⁻² sr⁻¹: 10¹⁰/4π photons of hc/λ.
        let photons = continuum_r_nm(at_nm) * 1e10 / (4.0 * std::f64::consts::PI);
        let s10 = photons * 1.986_445_86e-25 / (at_nm * 1e-9) / per_s10;
        assert!((s10 / 198.0 - 1.0).abs() < 0.02 && s10 < 1.4 * zenith_s10(130.0), "{s10}");
    }

    proptest! {
        #[test]
        fn the_layer_is_monotonous(low in 0.0..1.0_f64, high in 0.0..1.0_f64, altitude_m in 0.0..9_000.0_f64) {
            prop_assume!(low < high);
            prop_assert!(van_rhijn(low, altitude_m) >= van_rhijn(high, altitude_m));
            prop_assert!(van_rhijn(low, altitude_m + 10.0) >= van_rhijn(low, altitude_m));
        }
    }
}
