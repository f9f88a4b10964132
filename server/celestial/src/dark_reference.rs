//! The sky where no time is given: no Moon and no twilight, a mean solar flux, and zodiacal light and starlight in the mean over
//! the half of the sphere that lies above 30° of ecliptic and of galactic latitude (`docs/model.md#dark-reference`).

use crate::{
    airglow,
    components::Component,
    ephemeris::galactic_from_icrs,
    heavens::DEFAULT_SOLAR_FLUX_SFU,
    irradiance_grid::{AIRGLOW_STEP_RAD, cell_rad},
    magnitudes::{ARCSEC2_SR, ZERO_MAGNITUDE_LX},
    starlight, stars, zodiacal_light,
};
use skyglow_physics::{Response, spectrum::NODE_COUNT};
use std::{
    f64::consts::{FRAC_PI_2, PI, TAU},
    sync::LazyLock,
};

/// Parts of the dark reference: the Sun, the Moon and planets are none.
pub const COMPONENTS: [Component; 4] =
    [Component::Stars, Component::Starlight, Component::ZodiacalLight, Component::Airglow];

/// Means that stand for every direction, S10 in the components' units, and of stars as a radiance.
struct Means {
    stars: [f64; NODE_COUNT],
    starlight_s10: f64,
    zodiacal_light_s10: f64,
}

static MEANS: LazyLock<Means> = LazyLock::new(|| Means {
    stars: mean_of_stars(),
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

/// Light of all stars above so much latitude over the solid angle there, per sr: of points, whose mean counts each by its light.
fn mean_of_stars() -> [f64; NODE_COUNT] {
    let galactic = galactic_from_icrs();
    let sin_latitude = f64::from(FROM_LATITUDE_DEG).to_radians().sin();
    let solid_angle_sr = 2.0 * TAU * (1.0 - sin_latitude);
    let mut mean = [0.0; NODE_COUNT];
    for star in stars::stars() {
        if (galactic * star.direction_j2000).z.abs() >= sin_latitude {
            mean.iter_mut().zip(star.irradiance).for_each(|(mean, value)| *mean += value / solid_angle_sr);
        }
    }
    mean
}

/// Radiance outside the air at every node, in the component's unit: the same in every azimuth, and but for airglow in every direction.
/// Of stars it is the mean of points. 0 for Sun, Moon and planets. `sin_elevation` −1..=1, the observer's altitude in m.
pub fn radiance_outside(component: Component, sin_elevation: f64, altitude_m: f64) -> [f64; NODE_COUNT] {
    let s10 = match component {
        Component::Stars => return MEANS.stars,
        Component::Starlight => MEANS.starlight_s10,
        Component::ZodiacalLight => MEANS.zodiacal_light_s10,
        Component::Airglow => {
            airglow::zenith_s10(DEFAULT_SOLAR_FLUX_SFU) * airglow::van_rhijn(sin_elevation, altitude_m)
        }
        Component::Sun | Component::Moon | Component::Planets => 0.0,
    };
    [s10; NODE_COUNT]
}

/// Irradiance across beams from all azimuths together, by zenith angle, rad, each with the light of its cell as in
/// [`IrradianceGrid`](crate::IrradianceGrid).
pub fn irradiance_of_rings(
    component: Component,
    zenith_angles_rad: &[f64],
    altitude_m: f64,
) -> Vec<[f64; NODE_COUNT]> {
    (0..zenith_angles_rad.len())
        .map(|row| {
            let (begin, cell_end) = cell_rad(zenith_angles_rad, row);
            // Airglow ends at the horizon, where it is brightest.
            let last = if component == Component::Airglow { FRAC_PI_2.max(begin) } else { PI };
            let end = cell_end.min(last);
            let count = ((end - begin) / AIRGLOW_STEP_RAD).ceil().max(1.0);
            let step = (end - begin) / count;
            let mut ring = [0.0; NODE_COUNT];
            for part in 0..count as usize {
                let top = begin + step * part as f64;
                let solid_angle_sr = TAU * (top.cos() - (top + step).cos());
                let radiance = radiance_outside(component, (top + 0.5 * step).cos(), altitude_m);
                ring.iter_mut().zip(radiance).for_each(|(sum, value)| *sum += solid_angle_sr * value);
            }
            ring
        })
        .collect()
}

/// V of a component at the zenith outside the air, mag arcsec⁻²; None for those without.
pub fn zenith_magnitude_v(component: Component) -> Option<f64> {
    let [s10, ..] = radiance_outside(component, 1.0, 0.0);
    magnitude_v(s10 * Response::JohnsonV.value_of(component.light().spectrum()))
}

/// V of all components at the zenith outside the air, between the stars, mag arcsec⁻².
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
        // All stars to V = 6.5 are 23 S10 in the mean over the sphere, fewer away from the Milky Way.
        let stars = zenith_magnitude_v(Component::Stars).unwrap();
        let s10 = 10f64.powf(-0.4 * (stars - crate::magnitudes::S10_MAG_ARCSEC2));
        assert!((13.0..22.0).contains(&s10), "{s10:.2}");
    }

    /// Rings hold the light of the half sphere that they cover, airglow's to the horizon.
    #[test]
    fn rings_hold_their_light() {
        let angles: Vec<f64> = (0..46).map(|step| f64::from(step) * TAU / 180.0).collect();
        let total = |component: Component| -> f64 {
            irradiance_of_rings(component, &angles, 0.0).iter().map(|ring| ring[0]).sum()
        };
        // The last cell reaches a degree below the horizon.
        let beyond_sr = TAU * 1f64.to_radians().sin();
        let even = radiance_outside(Component::Starlight, 1.0, 0.0)[0];
        assert!((total(Component::Starlight) / (even * (TAU + beyond_sr)) - 1.0).abs() < 1e-4);
        let steps = 20_000;
        let exact: f64 = (0..steps)
            .map(|step| (f64::from(step) + 0.5) / f64::from(steps))
            .map(|sin| TAU / f64::from(steps) * radiance_outside(Component::Airglow, sin, 0.0)[0])
            .sum();
        assert!((total(Component::Airglow) / exact - 1.0).abs() < 2e-3);
    }
}
