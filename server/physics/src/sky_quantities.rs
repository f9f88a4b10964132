//! The numbers reported for a panorama: artificial light alone, and with the natural sky (`docs/model.md#quantities`).

use crate::{
    horizon::Horizon,
    panorama::{
        AZIMUTH_COUNT, Direction, ELEVATION_COUNT, Panorama, azimuth_rad, elevation_rad, projected_sr,
        solid_angle_sr,
    },
    photometry::{
        bortle_class, brightness_mag_arcsec2, luminance_cd_m2, naked_eye_limit_mag,
        natural_sky_luminance_cd_m2,
    },
};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Radius of the cap that "the zenith" means, radians (5°).
pub const ZENITH_CAP_RAD: f64 = 5.0 * PI / 180.0;
/// Full width at half maximum of a Sky Quality Meter's response, radians (20°).
pub const SQM_FWHM_RAD: f64 = 20.0 * PI / 180.0;

/// The numbers of a sky. Luminances are artificial light alone unless the name says `total`, which adds a
/// uniform natural sky of 22.0 mag arcsec⁻². Magnitudes are null for a sky without light. Where terrain hides part of
/// the sky, all are of the visible part. Nothing natural comes through clouds: under them totals are artificial light
/// alone, and what speaks of stars is null.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema), schema(as = QuantitiesAnswer))]
pub struct SkyQuantities {
    /// Mean within 5° of the zenith, cd m⁻².
    pub zenith_luminance_cd_m2: f64,
    /// The same, mag arcsec⁻².
    pub zenith_brightness_mag_arcsec2: Option<f64>,
    /// With the natural sky, cd m⁻².
    pub zenith_total_luminance_cd_m2: f64,
    /// With the natural sky, mag arcsec⁻².
    pub zenith_total_brightness_mag_arcsec2: Option<f64>,
    /// Artificial luminance at the zenith over the natural one of a clear sky.
    pub ratio_to_natural: f64,
    /// As a Sky Quality Meter at the zenith sees it (Gaussian, FWHM 20°), cd m⁻².
    pub sqm_luminance_cd_m2: f64,
    /// What such a meter reads with the natural sky, mag arcsec⁻².
    pub sqm_total_brightness_mag_arcsec2: Option<f64>,
    /// Mean over the visible sky, cd m⁻².
    pub mean_luminance_cd_m2: f64,
    /// Horizontal illuminance by the visible sky, lx.
    pub horizontal_illuminance_lx: f64,
    /// With the natural sky, lx.
    pub horizontal_total_illuminance_lx: f64,
    /// Largest visible luminance, cd m⁻².
    pub brightest_luminance_cd_m2: f64,
    /// Its azimuth, degrees clockwise from north.
    pub brightest_azimuth_deg: f64,
    /// Its elevation, degrees.
    pub brightest_elevation_deg: f64,
    /// Bortle class of the total at the zenith, 1..=9; null under clouds.
    pub bortle_class: Option<u8>,
    /// Naked-eye limiting magnitude at the zenith (Crumey 2014, F = 2); null under clouds.
    pub naked_eye_limit_mag: Option<f64>,
    /// Radiance at the zenith in R, G, B, W m⁻² sr⁻¹.
    pub zenith_radiance_w_m2_sr: [f64; 3],
}

/// Mean radiance over the visible directions of a panorama whose hidden samples are 0, in R, G, B, W m⁻² sr⁻¹;
/// `weight` of a grid direction, given its angle to the zenith [rad]. 0 where nothing with a weight is visible.
fn weighted_mean_radiance(panorama: &Panorama, horizon: &Horizon, weight: impl Fn(f64) -> f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut total = 0.0;
    for row in 0..ELEVATION_COUNT {
        let w = weight(PI / 2.0 - elevation_rad(row)) * solid_angle_sr(row);
        if w > 0.0 {
            total += w * visible_columns(horizon, row) as f64;
            for (band, sum) in sum.iter_mut().enumerate() {
                let start = Panorama::index(band, row, 0);
                let row_sum: f64 =
                    panorama.samples()[start..start + AZIMUTH_COUNT].iter().map(|&l| f64::from(l)).sum();
                *sum += w * row_sum;
            }
        }
    }
    if total > 0.0 { sum.map(|s| s / total) } else { [0.0; 3] }
}

/// Number of columns whose sample in a row is sky.
fn visible_columns(horizon: &Horizon, row: usize) -> usize {
    (0..AZIMUTH_COUNT).filter(|&column| !horizon.hides_sample(row, column)).count()
}

/// Illuminance [lx] on a vertical surface facing `facing_azimuth_rad`: ∫ L max(0, n·v) dΩ over the sky.
pub fn vertical_illuminance_lx(panorama: &Panorama, facing_azimuth_rad: f64) -> f64 {
    let facing = Direction { azimuth_rad: facing_azimuth_rad, elevation_rad: 0.0 }.enu();
    let mut sum = 0.0;
    for row in 0..ELEVATION_COUNT {
        for column in 0..AZIMUTH_COUNT {
            let v = Direction { azimuth_rad: azimuth_rad(column), elevation_rad: elevation_rad(row) }.enu();
            sum += panorama.luminance_cd_m2(row, column) * v.dot(facing).max(0.0) * solid_angle_sr(row);
        }
    }
    sum
}

/// Whether the natural sky is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SkyCover {
    /// No cloud: a natural sky of 22.0 mag arcsec⁻², and stars.
    Clear,
    /// A closed layer of cloud that lets nothing natural through.
    Overcast,
}

impl SkyCover {
    /// Overcast where there are clouds.
    pub fn with_clouds(are_there: bool) -> Self {
        if are_there { Self::Overcast } else { Self::Clear }
    }
}

impl SkyQuantities {
    /// All quantities of a panorama of artificial light that nothing hides.
    pub fn of(panorama: &Panorama) -> Self {
        Self::of_visible(panorama, &Horizon::flat())
    }

    /// All quantities of the clear sky above a horizon, as [`Self::under`] gives them.
    pub fn of_visible(panorama: &Panorama, horizon: &Horizon) -> Self {
        Self::under(SkyCover::Clear, panorama, horizon)
    }

    /// All quantities of the sky above a horizon. `panorama` is artificial light with its hidden samples 0, as
    /// [`Horizon::darken`] leaves it.
    pub fn under(cover: SkyCover, panorama: &Panorama, horizon: &Horizon) -> Self {
        if cover == SkyCover::Overcast {
            return Self::with_natural(panorama, horizon, 0.0);
        }
        let quantities = Self::with_natural(panorama, horizon, natural_sky_luminance_cd_m2());
        let total = quantities.zenith_total_luminance_cd_m2;
        Self {
            bortle_class: quantities.zenith_total_brightness_mag_arcsec2.map(bortle_class),
            naked_eye_limit_mag: Some(naked_eye_limit_mag(total)),
            ..quantities
        }
    }

    /// All but quantities of stars, with a uniform natural sky of `natural` cd m⁻².
    fn with_natural(panorama: &Panorama, horizon: &Horizon, natural: f64) -> Self {
        let zenith_radiance_w_m2_sr =
            weighted_mean_radiance(
                panorama,
                horizon,
                |angle| if angle <= ZENITH_CAP_RAD { 1.0 } else { 0.0 },
            );
        let zenith = luminance_cd_m2(zenith_radiance_w_m2_sr);
        let sigma = SQM_FWHM_RAD / (8.0 * std::f64::consts::LN_2).sqrt();
        let sqm = luminance_cd_m2(weighted_mean_radiance(panorama, horizon, |angle| {
            (-0.5 * (angle / sigma) * (angle / sigma)).exp()
        }));
        let mean = luminance_cd_m2(weighted_mean_radiance(panorama, horizon, |_| 1.0));
        let mut horizontal = 0.0;
        // What is hidden is taken from π, so that an open sky gives π itself.
        let mut hidden_projected_sr = 0.0;
        let mut brightest = (0.0, horizon.first_visible_row(0).min(ELEVATION_COUNT - 1), 0);
        for row in 0..ELEVATION_COUNT {
            let projected_sr = projected_sr(row);
            for column in 0..AZIMUTH_COUNT {
                if horizon.hides_sample(row, column) {
                    hidden_projected_sr += projected_sr;
                    continue;
                }
                let luminance = panorama.luminance_cd_m2(row, column);
                horizontal += luminance * projected_sr;
                if luminance > brightest.0 {
                    brightest = (luminance, row, column);
                }
            }
        }
        let total_brightness = |luminance: f64| brightness_mag_arcsec2(luminance.max(0.0) + natural);
        Self {
            zenith_luminance_cd_m2: zenith,
            zenith_brightness_mag_arcsec2: brightness_mag_arcsec2(zenith),
            zenith_total_luminance_cd_m2: zenith + natural,
            zenith_total_brightness_mag_arcsec2: total_brightness(zenith),
            ratio_to_natural: zenith / natural_sky_luminance_cd_m2(),
            sqm_luminance_cd_m2: sqm,
            sqm_total_brightness_mag_arcsec2: total_brightness(sqm),
            mean_luminance_cd_m2: mean,
            horizontal_illuminance_lx: horizontal,
            horizontal_total_illuminance_lx: horizontal + (PI - hidden_projected_sr) * natural,
            brightest_luminance_cd_m2: brightest.0,
            brightest_azimuth_deg: azimuth_rad(brightest.2).to_degrees(),
            brightest_elevation_deg: elevation_rad(brightest.1).to_degrees(),
            bortle_class: None,
            naked_eye_limit_mag: None,
            zenith_radiance_w_m2_sr,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uniform(radiance: f32) -> Panorama {
        Panorama::from_samples(vec![radiance; Panorama::LEN]).unwrap()
    }

    /// A uniform sky gives πL on the ground and half of it on a wall.
    #[test]
    fn a_uniform_sky_gives_pi_l() {
        let panorama = uniform(1e-6);
        let luminance = luminance_cd_m2([f64::from(1e-6f32); 3]);
        let quantities = SkyQuantities::of(&panorama);
        assert!((quantities.horizontal_illuminance_lx / (PI * luminance) - 1.0).abs() < 1e-9);
        assert!((vertical_illuminance_lx(&panorama, 0.3) / (PI * luminance / 2.0) - 1.0).abs() < 1e-3);
        for value in [
            quantities.zenith_luminance_cd_m2,
            quantities.sqm_luminance_cd_m2,
            quantities.mean_luminance_cd_m2,
            quantities.brightest_luminance_cd_m2,
        ] {
            assert!((value / luminance - 1.0).abs() < 1e-9);
        }
    }

    /// A dark sky is natural and has no artificial magnitude.
    #[test]
    fn a_dark_sky_is_natural() {
        let quantities = SkyQuantities::of(&Panorama::dark());
        assert_eq!(quantities.zenith_brightness_mag_arcsec2, None);
        assert!((quantities.zenith_total_brightness_mag_arcsec2.unwrap() - 22.0).abs() < 1e-9);
        assert_eq!(quantities.bortle_class, Some(1));
        assert!((quantities.naked_eye_limit_mag.unwrap() - 6.27).abs() < 0.01);
    }

    /// Under clouds totals are artificial light alone, and there are no stars.
    #[test]
    fn overcast_totals_are_artificial_light() {
        let (panorama, open) = (uniform(1e-6), Horizon::flat());
        let (clear, cloudy) =
            (SkyQuantities::of(&panorama), SkyQuantities::under(SkyCover::Overcast, &panorama, &open));
        assert_eq!(cloudy.zenith_total_luminance_cd_m2, cloudy.zenith_luminance_cd_m2);
        assert_eq!(cloudy.zenith_total_brightness_mag_arcsec2, cloudy.zenith_brightness_mag_arcsec2);
        assert_eq!(cloudy.horizontal_total_illuminance_lx, cloudy.horizontal_illuminance_lx);
        assert_eq!((cloudy.bortle_class, cloudy.naked_eye_limit_mag), (None, None));
        assert_eq!(cloudy.ratio_to_natural, clear.ratio_to_natural);
        assert!(clear.horizontal_total_illuminance_lx > 1.0001 * cloudy.horizontal_total_illuminance_lx);
        let dark = SkyQuantities::under(SkyCover::Overcast, &Panorama::dark(), &open);
        assert_eq!(dark.zenith_total_brightness_mag_arcsec2, None);
    }

    #[test]
    fn the_brightest_direction_is_found_where_it_is() {
        let mut panorama = uniform(1e-9);
        panorama.samples_mut()[Panorama::index(1, 3, 64)] = 1.0;
        let quantities = SkyQuantities::of(&panorama);
        assert!((quantities.brightest_azimuth_deg - 90.0).abs() < 1e-9);
        assert!((quantities.brightest_elevation_deg - 3.5 * 90.0 / 64.0).abs() < 1e-9);
    }
}
