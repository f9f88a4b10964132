//! The sky where no time is given: no Moon and no twilight, a mean solar flux, and zodiacal light and starlight in the mean over
//! the half of the sphere that lies above 30° of ecliptic and of galactic latitude (`docs/model.md#dark-reference`).

use crate::{
    airglow,
    components::Component,
    heavens::DEFAULT_SOLAR_FLUX_SFU,
    magnitudes::{ARCSEC2_SR, ZERO_MAGNITUDE_LX},
    starlight, zodiacal_light,
};
use skyglow_physics::{Response, spectrum::NODE_COUNT};
use std::sync::LazyLock;

/// Means that stand for every direction, S10 in the components' units.
struct Means {
    starlight_s10: f64,
    zodiacal_light_s10: f64,
}

static MEANS: LazyLock<Means> = LazyLock::new(|| Means {
    starlight_s10: geometric_mean(0.0, starlight::table_s10),
    // Overhead by night are directions far from the Sun.
    zodiacal_light_s10: geometric_mean(90.0, zodiacal_light::table_s10),
});

/// Lowest latitude of the means, degrees: half of the sphere lies above it.
const FROM_LATITUDE_DEG: i32 = 30;

/// The mean magnitude, as a brightness: exp of the mean of ln, over latitudes from 30° to the poles and longitudes from so many degrees
/// to as many before 360.
fn geometric_mean(from_longitude_deg: f64, value: impl Fn(f64, f64) -> f64) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for latitude in FROM_LATITUDE_DEG..90 {
        let latitude_deg = f64::from(latitude) + 0.5;
        let weight = latitude_deg.to_radians().cos();
        for longitude in 0..180 {
            let longitude_deg = f64::from(longitude) * 2.0 + 1.0;
            if (from_longitude_deg..360.0 - from_longitude_deg).contains(&longitude_deg) {
                sum +=
                    weight * (value(longitude_deg, latitude_deg) * value(longitude_deg, -latitude_deg)).ln();
                weights += 2.0 * weight;
            }
        }
    }
    (sum / weights).exp()
}

/// Radiance outside the air at every node, in the component's unit: the same in every azimuth, and but for airglow in every direction.
/// 0 for Sun, Moon, planets and stars. `sin_elevation` −1..=1, the observer's altitude in m.
pub fn radiance_outside(component: Component, sin_elevation: f64, altitude_m: f64) -> [f64; NODE_COUNT] {
    let s10 = match component {
        Component::Starlight => MEANS.starlight_s10,
        Component::ZodiacalLight => MEANS.zodiacal_light_s10,
        Component::Airglow => {
            airglow::zenith_s10(DEFAULT_SOLAR_FLUX_SFU) * airglow::van_rhijn(sin_elevation, altitude_m)
        }
        Component::Sun | Component::Moon | Component::Planets | Component::Stars => 0.0,
    };
    [s10; NODE_COUNT]
}

/// V of a component at the zenith outside the air, mag arcsec⁻²; None for those without.
pub fn zenith_magnitude_v(component: Component) -> Option<f64> {
    let [s10, ..] = radiance_outside(component, 1.0, 0.0);
    magnitude_v(s10 * Response::JohnsonV.value_of(component.light().spectrum()))
}

/// V of all components at the zenith outside the air, mag arcsec⁻².
pub fn total_zenith_magnitude_v() -> Option<f64> {
    let total = Component::EXTENDED.into_iter().fold(0.0, |sum, component| {
        let [s10, ..] = radiance_outside(component, 1.0, 0.0);
        sum + s10 * Response::JohnsonV.value_of(component.light().spectrum())
    });
    magnitude_v(total)
}

/// V of a luminance on the scale of magnitudes, cd m⁻².
fn magnitude_v(luminance_cd_m2: f64) -> Option<f64> {
    (luminance_cd_m2 > 0.0).then(|| -2.5 * (luminance_cd_m2 * ARCSEC2_SR / ZERO_MAGNITUDE_LX).log10())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dark sky is 21.6 to 22.1, more than half of it airglow.
    #[test]
    fn the_reference_is_a_dark_sky() {
        let total = total_zenith_magnitude_v().unwrap();
        assert!((21.6..22.1).contains(&total), "{total:.3}");
        let [starlight, zodiacal_light, airglow] =
            Component::EXTENDED.map(|component| zenith_magnitude_v(component).unwrap());
        for (found, expected) in [(starlight, 23.56), (zodiacal_light, 23.11), (airglow, 22.47)] {
            assert!(
                (found - expected).abs() < 0.02,
                "{starlight:.3} {zodiacal_light:.3} {airglow:.3} {total:.3}"
            );
        }
        assert_eq!(zenith_magnitude_v(Component::Moon), None);
    }
}
