//! Mesopic photometry between the day's cones and the night's rods: MES-2 (CIE 191:2010).

/// What both kinds of receptors see together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mesopic {
    /// Mesopic luminance, cd m⁻².
    pub luminance_cd_m2: f64,
    /// m, the part of the cones: 0 in scotopic vision, 1 in photopic vision.
    pub cone_share: f64,
}

/// V′(555 nm), what 1 lm of that light is to the rods: 683/1699.
const SCOTOPIC_AT_555_NM: f64 = 683.0 / 1699.0;

/// MES-2: m = 0.7670 + 0.3334·log₁₀ L_mes, 0..=1, and L_mes = (m·L + (1 − m)·L′·V′(λ₀)) / (m + (1 − m)·V′(λ₀)), solved by
/// iteration from m = ½. Luminances are at least 0.
pub fn mesopic(photopic_cd_m2: f64, scotopic_cd_m2: f64) -> Mesopic {
    let mut cone_share = 0.5;
    let mut luminance_cd_m2 = 0.0;
    for _ in 0..60 {
        let rods = (1.0 - cone_share) * SCOTOPIC_AT_555_NM;
        luminance_cd_m2 = (cone_share * photopic_cd_m2 + rods * scotopic_cd_m2) / (cone_share + rods);
        let next = if luminance_cd_m2 > 0.0 {
            (0.7670 + 0.3334 * luminance_cd_m2.log10()).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let change: f64 = next - cone_share;
        cone_share = next;
        if change.abs() < 1e-9 {
            break;
        }
    }
    Mesopic { luminance_cd_m2, cone_share }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Values that the standard's formula gives, from photopic luminance and the ratio of both.
    #[test]
    fn values_are_those_of_the_standard() {
        for (photopic, ratio, expected) in
            [(0.1, 1.35, 0.1115), (0.1, 2.05, 0.1324), (1.0, 1.35, 1.0371), (0.01, 2.05, 0.0169)]
        {
            let found = mesopic(photopic, ratio * photopic).luminance_cd_m2;
            assert!((found / expected - 1.0).abs() < 4e-3, "{photopic} {ratio}: {found}");
        }
    }

    #[test]
    fn day_is_photopic_and_night_scotopic() {
        assert_eq!(mesopic(100.0, 250.0), Mesopic { luminance_cd_m2: 100.0, cone_share: 1.0 });
        let night = mesopic(1e-4, 3e-4);
        assert!(night.cone_share == 0.0 && (night.luminance_cd_m2 / 3e-4 - 1.0).abs() < 1e-12);
        assert_eq!(mesopic(0.0, 0.0).luminance_cd_m2, 0.0);
    }

    proptest! {
        /// Mesopic luminance lies between both, and more light is never darker.
        #[test]
        fn more_light_is_brighter(exponent in -6.0..3.0_f64, ratio in 0.3..3.0_f64, more in 1.0..2.0_f64) {
            let photopic = 10f64.powf(exponent);
            let found = mesopic(photopic, ratio * photopic).luminance_cd_m2;
            let (low, high) = (photopic * ratio.min(1.0), photopic * ratio.max(1.0));
            prop_assert!((low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(&found));
            prop_assert!(mesopic(more * photopic, more * ratio * photopic).luminance_cd_m2 >= found * (1.0 - 1e-6));
        }
    }
}
