//! How a night goes over a place of a scene.

use super::Assumptions;
use serde::Serialize;
use skyglow_celestial::{Instant, Night, answers::Daylight};
use skyglow_observatory::SkyAtTime;
use skyglow_physics::photometry::brightness_mag_arcsec2;
use utoipa::ToSchema;

/// The sky at an hour of a night: all light, artificial and natural.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct NightHourAnswer {
    /// When.
    pub time: Instant,
    /// True altitude of the Sun's middle, degrees.
    pub sun_altitude_deg: f64,
    /// True altitude of the Moon's middle, degrees.
    pub moon_altitude_deg: f64,
    /// Day, twilight or night.
    pub daylight: Daylight,
    /// Mean within 5° of the zenith, cd m⁻².
    pub zenith_total_luminance_cd_m2: f64,
    /// The same, mag arcsec⁻².
    pub zenith_total_brightness_mag_arcsec2: Option<f64>,
    /// What a Sky Quality Meter at the zenith reads, mag arcsec⁻².
    pub sqm_total_brightness_mag_arcsec2: Option<f64>,
    /// Mean of the visible sky below 10° of elevation, cd m⁻²; null where ground hides all of it.
    pub horizon_total_luminance_cd_m2: Option<f64>,
    /// The same, mag arcsec⁻².
    pub horizon_total_brightness_mag_arcsec2: Option<f64>,
    /// Natural luminance at the zenith, cd m⁻².
    pub zenith_natural_luminance_cd_m2: f64,
    /// Naked-eye limiting magnitude at the zenith.
    pub naked_eye_limit_mag: Option<f64>,
}

impl From<&SkyAtTime> for NightHourAnswer {
    fn from(sky: &SkyAtTime) -> Self {
        let (bodies, quantities) = (&sky.bodies, &sky.quantities);
        Self {
            time: bodies.time,
            sun_altitude_deg: bodies.sun.place.true_altitude_deg,
            moon_altitude_deg: bodies.moon.place.true_altitude_deg,
            daylight: bodies.sun.daylight,
            zenith_total_luminance_cd_m2: quantities.zenith_total_luminance_cd_m2,
            zenith_total_brightness_mag_arcsec2: quantities.zenith_total_brightness_mag_arcsec2,
            sqm_total_brightness_mag_arcsec2: quantities.sqm_total_brightness_mag_arcsec2,
            horizon_total_luminance_cd_m2: sky.horizon_luminance_cd_m2,
            horizon_total_brightness_mag_arcsec2: sky
                .horizon_luminance_cd_m2
                .and_then(brightness_mag_arcsec2),
            zenith_natural_luminance_cd_m2: quantities.zenith_total_luminance_cd_m2
                - quantities.zenith_luminance_cd_m2,
            naked_eye_limit_mag: quantities.naked_eye_limit_mag,
        }
    }
}

/// A night over a place of a scene, hour by hour.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct NightHoursAnswer {
    /// What its light depends on.
    #[serde(flatten)]
    pub assumptions: Assumptions,
    /// When it is dark, as without a scene.
    pub night: Night,
    /// The hours of UTC from noon to noon.
    pub hours: Vec<NightHourAnswer>,
    /// The one with the darkest zenith, the earlier of two that are alike.
    pub best_hour: Option<Instant>,
}

impl NightHoursAnswer {
    /// Of skies at the hours of a night.
    pub fn new(mut assumptions: Assumptions, night: Night, solar_flux_sfu: f64, skies: &[SkyAtTime]) -> Self {
        assumptions.solar_flux_sfu = Some(solar_flux_sfu);
        let hours: Vec<NightHourAnswer> = skies.iter().map(NightHourAnswer::from).collect();
        let darkest = hours
            .iter()
            .min_by(|a, b| a.zenith_total_luminance_cd_m2.total_cmp(&b.zenith_total_luminance_cd_m2));
        let best_hour = darkest.map(|hour| hour.time);
        Self { assumptions, night, hours, best_hour }
    }
}
