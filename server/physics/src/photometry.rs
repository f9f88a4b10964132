//! Photometry: luminance, magnitudes, naked-eye limit (Crumey 2014), Bortle class (Bortle 2001).

use crate::bands::{BAND_COUNT, Band};

/// Zero point of surface brightness: luminance of 0 mag arcsec⁻², cd m⁻².
pub const ZERO_POINT_CD_M2: f64 = 1.08e5;
/// Surface brightness of a round dark sky that errors and colours are scaled by, mag arcsec⁻².
pub const NATURAL_SKY_MAG_ARCSEC2: f64 = 22.0;

/// Σ_b K_b L_b: luminance [cd m⁻²] of a radiance [W m⁻² sr⁻¹] in bands, by one efficacy a band: what errors of the engine are
/// measured in. Answers take the photopic response.
pub fn luminance_cd_m2(radiance_w_m2_sr: [f64; BAND_COUNT]) -> f64 {
    Band::ALL.iter().map(|b| b.luminous_efficacy_lm_w() * radiance_w_m2_sr[b.index()]).sum()
}

/// m = −2.5·log10(luminance / 1.08e5) mag arcsec⁻²; None for a luminance that is not positive.
pub fn brightness_mag_arcsec2(luminance_cd_m2: f64) -> Option<f64> {
    (luminance_cd_m2 > 0.0).then(|| -2.5 * (luminance_cd_m2 / ZERO_POINT_CD_M2).log10())
}

/// The inverse of [`brightness_mag_arcsec2`]: luminance, cd m⁻².
pub fn luminance_from_brightness_cd_m2(brightness_mag_arcsec2: f64) -> f64 {
    ZERO_POINT_CD_M2 * 10f64.powf(-0.4 * brightness_mag_arcsec2)
}

/// Its luminance, cd m⁻². Answers have the dark reference.
pub fn natural_sky_luminance_cd_m2() -> f64 {
    luminance_from_brightness_cd_m2(NATURAL_SKY_MAG_ARCSEC2)
}

/// Bortle class 1 (pristine) to 9 (inner city) from how many magnitudes brighter the zenith is than a natural dark sky. The ends are
/// those that are published for one of 22.0 mag arcsec⁻², as differences to it.
pub fn bortle_class(brighter_mag: f64) -> u8 {
    const BEGINS: [f64; 7] = [0.01, 0.11, 0.31, 1.51, 2.50, 3.06, 3.62];
    let passed = BEGINS.iter().filter(|&&begin| brighter_mag >= begin).count();
    1 + passed as u8 + u8::from(brighter_mag > 4.2)
}

/// Naked-eye limiting magnitude (Crumey 2014, field factor F = 2) under a total sky luminance.
/// Luminances below 1e-5 cd m⁻² count as 1e-5. The zero point −13.98 (a magnitude from lux) is the one that
/// gives the published 6.27, 5.52 and 4.99 mag at 22, 20 and 18 mag arcsec⁻²; −13.99 misses each by 0.01.
pub fn naked_eye_limit_mag(total_luminance_cd_m2: f64) -> f64 {
    const FIELD_FACTOR: f64 = 2.0;
    let [a1, a2, a3, a4, a5] = [5.949e-8, -2.389e-7, 2.459e-7, 4.120e-4, -4.225e-4];
    let b = total_luminance_cd_m2.max(1e-5);
    let root = b.sqrt();
    let fourth = root.sqrt();
    let inner = (a1 * root + a2 * root * fourth + a3 * b).max(0.0).sqrt() + a4 * fourth + a5 * root;
    -13.98 - 2.5 * (FIELD_FACTOR * inner * inner).log10()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnitude_22_is_171_microcandela() {
        assert!((natural_sky_luminance_cd_m2() * 1e6 - 171.2).abs() < 0.1);
        let back = brightness_mag_arcsec2(luminance_from_brightness_cd_m2(19.3)).unwrap();
        assert!((back - 19.3).abs() < 1e-12);
        assert_eq!(brightness_mag_arcsec2(0.0), None);
    }

    #[test]
    fn naked_eye_limits_are_those_of_the_model() {
        for (sky, limit) in [(22.0, 6.27), (20.0, 5.52), (18.0, 4.99)] {
            let got = naked_eye_limit_mag(luminance_from_brightness_cd_m2(sky));
            assert!((got - limit).abs() < 0.006, "{sky}: {got}");
        }
    }

    #[test]
    fn bortle_classes_end_where_the_model_says() {
        let cases = [
            (22.0, 1),
            (21.99, 2),
            (21.8, 3),
            (21.0, 4),
            (20.0, 5),
            (19.0, 6),
            (18.5, 7),
            (18.0, 8),
            (17.8, 8),
            (17.79, 9),
        ];
        for (mag, class) in cases {
            // Without the last digits that a difference leaves.
            let brighter_mag = ((22.0 - mag) * 1e6_f64).round() / 1e6;
            assert_eq!(bortle_class(brighter_mag), class, "{mag}");
        }
    }
}
