//! What the natural sky of a time is made of.

use serde::Serialize;
use skyglow_celestial::{
    Component, Planet,
    ephemeris::{Topocentric, refraction_deg},
};
use skyglow_observatory::{ComponentSky, NightSky, RenderedSky, night_sky::DirectionLimit};
use skyglow_physics::{Response, photometry::brightness_mag_arcsec2};
use utoipa::ToSchema;

/// One component of the natural sky.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ComponentAnswer {
    /// Which.
    pub component: Component,
    /// Mean luminance within 5° of the zenith, cd m⁻²: light that the air scatters, and of starlight, zodiacal light and airglow what
    /// comes through it. Discs and stars themselves are not in it.
    pub zenith_luminance_cd_m2: f64,
    /// The same, mag arcsec⁻²; null without light.
    pub zenith_brightness_mag_arcsec2: Option<f64>,
    /// Mean luminance over the visible sky, cd m⁻².
    pub mean_luminance_cd_m2: f64,
    /// The same, mag arcsec⁻²; null without light.
    pub mean_brightness_mag_arcsec2: Option<f64>,
    /// Illuminance by its discs or points above the horizon, each across its beam, lx.
    pub direct_illuminance_lx: f64,
}

/// The Sun.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SunAnswer {
    /// Degrees above the horizontal plane, as seen: with refraction.
    pub altitude_deg: f64,
    /// The same without refraction: twilights are told by it.
    pub true_altitude_deg: f64,
    /// Degrees clockwise from north.
    pub azimuth_deg: f64,
}

/// The Moon.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct MoonAnswer {
    /// Degrees above the horizontal plane, as seen: with refraction.
    pub altitude_deg: f64,
    /// The same without refraction.
    pub true_altitude_deg: f64,
    /// Degrees clockwise from north.
    pub azimuth_deg: f64,
    /// Lit part of the disc, 0 to 1.
    pub illuminated_fraction: f64,
    /// Angle Sun–Moon–observer, degrees: 0 at full Moon.
    pub phase_angle_deg: f64,
    /// Whether the lit part grows.
    pub is_waxing: bool,
    /// Angle between Moon and Sun, degrees.
    pub separation_from_sun_deg: f64,
    /// V outside the air.
    pub magnitude_v: f64,
}

/// A planet.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PlanetSeenAnswer {
    /// Which.
    pub planet: Planet,
    /// Degrees above the horizontal plane, as seen: with refraction.
    pub altitude_deg: f64,
    /// Degrees clockwise from north.
    pub azimuth_deg: f64,
    /// V outside the air.
    pub magnitude_v: f64,
}

/// The faintest star of a direction.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct DirectionLimitAnswer {
    /// Degrees clockwise from north.
    pub azimuth_deg: f64,
    /// Degrees.
    pub elevation_deg: f64,
    /// Luminance of all light there, cd m⁻².
    pub luminance_cd_m2: f64,
    /// V outside the air of the faintest star that the naked eye sees there; null where terrain hides the sky.
    pub naked_eye_limit_mag: Option<f64>,
}

impl From<&DirectionLimit> for DirectionLimitAnswer {
    fn from(limit: &DirectionLimit) -> Self {
        Self {
            azimuth_deg: limit.azimuth_deg,
            elevation_deg: limit.elevation_deg,
            luminance_cd_m2: limit.luminance_cd_m2,
            naked_eye_limit_mag: limit.limit_mag,
        }
    }
}

/// What the natural sky of a time is made of, and what is seen of the stars.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct NightSkyAnswer {
    /// Components that count: by day the Sun alone, and no Moon while it is more than 12° down.
    pub components: Vec<ComponentAnswer>,
    /// The Sun.
    pub sun: SunAnswer,
    /// The Moon.
    pub moon: MoonAnswer,
    /// The planets, outwards, below the horizon too.
    pub planets: Vec<PlanetSeenAnswer>,
    /// Stars to V = 6.5 above the horizon and the terrain.
    pub stars_above_horizon: usize,
    /// Of them not fainter than the limit of their own direction.
    pub stars_visible: usize,
    /// Faintest stars at the zenith and at eight azimuths in three elevations: Crumey 2014, F = 2, with all light there, less what
    /// the air takes more than at the zenith.
    pub limits: Vec<DirectionLimitAnswer>,
    /// Largest share of all luminance that the Milky Way's starlight has, 20° up and higher; null where starlight does not count.
    pub milky_way_contrast: Option<f64>,
}

/// Altitude as seen, true altitude and azimuth, degrees.
fn place(position: &Topocentric) -> (f64, f64, f64) {
    let true_deg = position.true_altitude_deg();
    (true_deg + refraction_deg(true_deg), true_deg, position.direction().azimuth_rad.to_degrees())
}

impl From<&ComponentSky> for ComponentAnswer {
    fn from(sky: &ComponentSky) -> Self {
        Self {
            component: sky.component,
            zenith_luminance_cd_m2: sky.zenith_luminance_cd_m2,
            zenith_brightness_mag_arcsec2: brightness_mag_arcsec2(sky.zenith_luminance_cd_m2),
            mean_luminance_cd_m2: sky.mean_luminance_cd_m2,
            mean_brightness_mag_arcsec2: brightness_mag_arcsec2(sky.mean_luminance_cd_m2),
            direct_illuminance_lx: sky.direct_illuminance_lx,
        }
    }
}

impl NightSkyAnswer {
    /// Of a rendered sky; None where it has none.
    pub fn of(sky: &RenderedSky) -> Option<Self> {
        let (night, total) = (sky.night.as_ref()?, sky.seen_with_night()?);
        let stars = night.visible_stars(total.seen_by(&Response::Photopic).unwrap_or_default(), &sky.horizon);
        Some(Self {
            components: night.components().iter().map(ComponentAnswer::from).collect(),
            stars_above_horizon: stars.stars.above_horizon,
            stars_visible: stars.stars.visible,
            limits: stars.limits.iter().map(DirectionLimitAnswer::from).collect(),
            milky_way_contrast: stars.milky_way_contrast,
            ..Self::bodies(night)
        })
    }

    fn bodies(night: &NightSky) -> Self {
        let heavens = night.heavens();
        let (altitude_deg, true_altitude_deg, azimuth_deg) = place(&heavens.sun().position);
        let sun = SunAnswer { altitude_deg, true_altitude_deg, azimuth_deg };
        let moon = heavens.moon();
        let (altitude_deg, true_altitude_deg, azimuth_deg) = place(&moon.position);
        let moon = MoonAnswer {
            altitude_deg,
            true_altitude_deg,
            azimuth_deg,
            illuminated_fraction: moon.illuminated_fraction,
            phase_angle_deg: moon.phase_angle_rad.to_degrees(),
            is_waxing: moon.is_waxing,
            separation_from_sun_deg: moon.elongation_rad.to_degrees(),
            magnitude_v: moon.magnitude_v,
        };
        let planets = heavens.planets().iter().map(|seen| {
            let (altitude_deg, _, azimuth_deg) = place(&seen.position);
            PlanetSeenAnswer {
                planet: seen.planet,
                altitude_deg,
                azimuth_deg,
                magnitude_v: seen.magnitude_v,
            }
        });
        Self {
            components: Vec::new(),
            sun,
            moon,
            planets: planets.collect(),
            stars_above_horizon: 0,
            stars_visible: 0,
            limits: Vec::new(),
            milky_way_contrast: None,
        }
    }
}
