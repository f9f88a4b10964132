//! What the natural sky of a time is made of.

use crate::sky_bodies::discs_of;
use serde::Serialize;
use skyglow_celestial::{
    BodiesAnswer, Component, limiting_magnitude::VisibleStars, milky_way::MilkyWayContrast,
};
use skyglow_display::Behind;
use skyglow_observatory::{ComponentSky, RenderedSky, night_sky::DirectionLimit};
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
    /// Sun, Moon and planets.
    #[serde(flatten)]
    pub bodies: BodiesAnswer,
    /// Components that count: by day the Sun alone, and no Moon while it is more than 12° down.
    pub components: Vec<ComponentAnswer>,
    /// Stars that the naked eye sees, each against the sky of its own direction behind the veil that the eye makes of Moon, Sun and sky.
    pub stars: VisibleStars,
    /// Faintest stars at the zenith and at eight azimuths in three elevations: Crumey 2014, F = 2, with all light there and the
    /// veil over it, less what the air takes more than at the zenith.
    pub limits: Vec<DirectionLimitAnswer>,
    /// Where the Milky Way stands out most; null where starlight does not count, or no part of the band is 15° up.
    pub milky_way: Option<MilkyWayContrast>,
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
    /// Of a rendered sky; None where it has none, and under clouds, which hide stars or not.
    pub fn of(sky: &RenderedSky) -> Option<Self> {
        if sky.gaps.is_some() {
            return None;
        }
        let (night, total) = (sky.night.as_ref()?, sky.seen_in_total());
        let behind = Behind::of(&total, &discs_of(night), &sky.horizon)?;
        let background = |direction, luminance_cd_m2: f64| {
            behind.background_cd_m2(direction).map_or(luminance_cd_m2, |found| luminance_cd_m2.max(found))
        };
        let stars = night.seen_stars(total.seen_by(&Response::Photopic)?, &sky.horizon, background);
        Some(Self {
            bodies: BodiesAnswer::of(night.heavens()),
            components: night.components().iter().map(ComponentAnswer::from).collect(),
            stars: stars.count,
            limits: stars.limits.iter().map(DirectionLimitAnswer::from).collect(),
            milky_way: stars.milky_way,
        })
    }
}
