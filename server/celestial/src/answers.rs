//! Sun, Moon and planets of an instant as answers have them: degrees, magnitudes, words.

use crate::{
    bodies::{Moon, PlanetSeen, Sun},
    ephemeris::{AU_M, Planet, Topocentric},
    heavens::Heavens,
    night::TwilightKind,
    phase::MoonPhase,
    site::Site,
    time::Instant,
};
use serde::Serialize;
use skyglow_physics::beam::apparent_altitude_rad;

/// Where a body is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct BodyPlace {
    /// Clockwise from true north, degrees.
    pub azimuth_deg: f64,
    /// Above the horizontal plane without refraction, degrees.
    pub true_altitude_deg: f64,
    /// With the refraction of a standard air, degrees; none from 5° below the horizontal plane down, where nobody sees it.
    pub apparent_altitude_deg: f64,
    /// Distance, km.
    pub distance_km: f64,
    /// V outside the air.
    pub magnitude_v: f64,
}

impl BodyPlace {
    fn new(site: Site, position: &Topocentric, magnitude_v: f64) -> Self {
        let true_altitude_deg = position.true_altitude_deg();
        Self {
            azimuth_deg: position.direction().azimuth_rad.to_degrees(),
            true_altitude_deg,
            apparent_altitude_deg: apparent_altitude_rad(true_altitude_deg.to_radians(), site.altitude_m())
                .to_degrees(),
            distance_km: position.distance_au() * AU_M / 1_000.0,
            magnitude_v,
        }
    }
}

/// What the Sun makes of the hour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub enum Daylight {
    /// The Sun is up.
    Day,
    /// Its middle is above −6°.
    CivilTwilight,
    /// Above −12°.
    NauticalTwilight,
    /// Above −18°.
    AstronomicalTwilight,
    /// Below.
    Night,
}

impl Daylight {
    /// By the true altitude of the Sun's middle, degrees.
    pub fn of(sun_altitude_deg: f64) -> Self {
        const RISES_DEG: f64 = -0.833;
        let above = |kind: TwilightKind| sun_altitude_deg > kind.sun_altitude_deg();
        match () {
            () if sun_altitude_deg > RISES_DEG => Daylight::Day,
            () if above(TwilightKind::Civil) => Daylight::CivilTwilight,
            () if above(TwilightKind::Nautical) => Daylight::NauticalTwilight,
            () if above(TwilightKind::Astronomical) => Daylight::AstronomicalTwilight,
            () => Daylight::Night,
        }
    }
}

/// The Sun.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct SunAnswer {
    /// Where it is.
    #[serde(flatten)]
    pub place: BodyPlace,
    /// Across its disc, degrees.
    pub diameter_deg: f64,
    /// Day, twilight or night.
    pub daylight: Daylight,
}

/// The Moon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct MoonAnswer {
    /// Where it is.
    #[serde(flatten)]
    pub place: BodyPlace,
    /// Across its disc, degrees.
    pub diameter_deg: f64,
    /// Its phase.
    pub phase: MoonPhase,
    /// Lit part of the disc, 0..=1.
    pub illuminated_fraction: f64,
    /// Sun–Moon–observer angle, degrees: 0 at full Moon.
    pub phase_angle_deg: f64,
    /// Whether the lit part grows.
    pub is_waxing: bool,
    /// Between Moon and Sun, degrees.
    pub separation_from_sun_deg: f64,
    /// From the Moon's middle to that of its bright limb, counterclockwise from the zenith as the observer sees it, degrees.
    pub bright_limb_from_zenith_deg: f64,
    /// The same from celestial north to the east.
    pub bright_limb_from_north_deg: f64,
}

/// A planet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct PlanetAnswer {
    /// Which.
    pub planet: Planet,
    /// Where it is.
    #[serde(flatten)]
    pub place: BodyPlace,
}

/// Sun, Moon and planets over a site at an instant.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct BodiesAnswer {
    /// When.
    pub time: Instant,
    /// The Sun.
    pub sun: SunAnswer,
    /// The Moon.
    pub moon: MoonAnswer,
    /// Mercury to Neptune.
    pub planets: Vec<PlanetAnswer>,
}

impl BodiesAnswer {
    /// Of the heavens.
    pub fn of(heavens: &Heavens) -> Self {
        let site = heavens.site();
        Self {
            time: heavens.instant(),
            sun: sun_answer(site, heavens.sun()),
            moon: moon_answer(site, heavens.instant(), heavens.moon()),
            planets: heavens.planets().iter().map(|seen| planet_answer(site, seen)).collect(),
        }
    }
}

fn sun_answer(site: Site, sun: &Sun) -> SunAnswer {
    let place = BodyPlace::new(site, &sun.position, sun.magnitude_v);
    SunAnswer {
        place,
        diameter_deg: sun.diameter_rad.to_degrees(),
        daylight: Daylight::of(place.true_altitude_deg),
    }
}

fn moon_answer(site: Site, instant: Instant, moon: &Moon) -> MoonAnswer {
    MoonAnswer {
        place: BodyPlace::new(site, &moon.position, moon.magnitude_v),
        diameter_deg: moon.diameter_rad.to_degrees(),
        phase: MoonPhase::of(instant),
        illuminated_fraction: moon.illuminated_fraction,
        phase_angle_deg: moon.phase_angle_rad.to_degrees(),
        is_waxing: moon.is_waxing,
        separation_from_sun_deg: moon.elongation_rad.to_degrees(),
        bright_limb_from_zenith_deg: moon.bright_limb_from_zenith_rad.to_degrees(),
        bright_limb_from_north_deg: moon.bright_limb_from_north_rad.to_degrees(),
    }
}

fn planet_answer(site: Site, seen: &PlanetSeen) -> PlanetAnswer {
    PlanetAnswer { planet: seen.planet, place: BodyPlace::new(site, &seen.position, seen.magnitude_v) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_have_degrees_and_words() {
        let site = Site::new(41.38, 2.17, 0.0).unwrap();
        let at = Instant::parse("2026-08-20T23:16:00Z").unwrap();
        let answer = BodiesAnswer::of(&Heavens::new(site, at, 100.0).unwrap());
        let json = serde_json::to_value(&answer).unwrap();
        assert_eq!(json["time"], "2026-08-20T23:16:00Z");
        assert_eq!(json["sun"]["daylight"], "night");
        assert_eq!(json["moon"]["phase"], "first_quarter");
        assert!((json["moon"]["azimuth_deg"].as_f64().unwrap() - 240.95).abs() < 0.01);
        assert_eq!(json["planets"][3]["planet"], "jupiter");
        assert!((answer.moon.separation_from_sun_deg - 98.8).abs() < 0.5);
        for (altitude_deg, daylight) in [
            (0.0, Daylight::Day),
            (-1.0, Daylight::CivilTwilight),
            (-7.0, Daylight::NauticalTwilight),
            (-13.0, Daylight::AstronomicalTwilight),
            (-19.0, Daylight::Night),
        ] {
            assert_eq!(Daylight::of(altitude_deg), daylight);
        }
    }
}
