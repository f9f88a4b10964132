//! How bright Sun, Moon and planets are and how they look: the Moon by Krisciunas and Schaefer 1991, planets by Mallama and
//! Hilton 2018.

use crate::{
    eclipse::{MOON_RADIUS_M, SUN_RADIUS_M, moon_lit, sun_uncovered},
    ephemeris::{AU_M, Body, Planet, Positions, Topocentric},
    lights::{FULL_MOON_MAGNITUDE_V, SUN_MAGNITUDE_V},
    moon_orientation::moon_from_gcrs,
};
use glam::{DMat3, DVec3};

/// Mean distance of the Moon that its magnitude is given for, m.
const MOON_MEAN_DISTANCE_M: f64 = 3.844e8;
/// Faintest light of an eclipsed Sun that a magnitude is given for: its corona.
const CORONA: f64 = 1e-6;

/// The Sun for an observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Where it is.
    pub position: Topocentric,
    /// V outside the air.
    pub magnitude_v: f64,
    /// Angle across the disc, rad.
    pub diameter_rad: f64,
    /// Part of the disc that the Moon does not cover, 0..=1; in totality the corona has a millionth of the light.
    pub uncovered_part: f64,
}

/// The Moon for an observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moon {
    /// Where it is.
    pub position: Topocentric,
    /// V outside the air.
    pub magnitude_v: f64,
    /// Angle across the disc, rad.
    pub diameter_rad: f64,
    /// Sun–Moon–observer angle, rad: 0 at full Moon.
    pub phase_angle_rad: f64,
    /// Lit part of the disc, 0..=1.
    pub illuminated_fraction: f64,
    /// Whether the lit part grows.
    pub is_waxing: bool,
    /// From the Moon's middle towards that of the bright limb, counted from celestial north to the east, −π..=π.
    pub bright_limb_from_north_rad: f64,
    /// The same counted from the zenith, counterclockwise as the observer sees it.
    pub bright_limb_from_zenith_rad: f64,
    /// Angle between Moon and Sun, rad.
    pub elongation_rad: f64,
    /// Part of its light that the Earth's shadow leaves, 0..=1.
    pub uneclipsed_part: f64,
    /// V outside the air of the light that the Earth throws on it, over its whole disc.
    pub earthshine_magnitude_v: f64,
    /// Turns the Moon's own axes (x to longitude and latitude 0, z to its north pole) into east, north, up.
    pub enu_from_moon: DMat3,
}

/// A planet for an observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanetSeen {
    /// Which.
    pub planet: Planet,
    /// Where it is.
    pub position: Topocentric,
    /// V outside the air.
    pub magnitude_v: f64,
    /// Sun–planet–observer angle, rad.
    pub phase_angle_rad: f64,
}

impl Sun {
    /// At an instant over a site.
    pub fn of(positions: &Positions) -> Self {
        let [position, moon] = [Body::Sun, Body::Moon].map(|body| positions.of(body));
        let distance_au = position.distance_au();
        let uncovered_part = sun_uncovered(position.enu_au, moon.enu_au);
        Self {
            position,
            magnitude_v: SUN_MAGNITUDE_V + 5.0 * distance_au.log10()
                - 2.5 * uncovered_part.max(CORONA).log10(),
            diameter_rad: 2.0 * (SUN_RADIUS_M / (distance_au * AU_M)).asin(),
            uncovered_part,
        }
    }
}

impl Moon {
    /// At an instant over a site.
    pub fn of(positions: &Positions) -> Self {
        let [position, sun] = [Body::Moon, Body::Sun].map(|body| positions.of(body));
        let to_sun = sun.enu_au - position.enu_au;
        let phase_angle_rad = to_sun.angle_between(-position.enu_au);
        let distance_m = position.distance_au() * AU_M;
        let celestial_north = positions.stand.enu_from_cirs * DVec3::Z;
        // Seen from above its orbit the Moon is east of the Sun while it waxes.
        let pole = positions.ecliptic_from_enu().transpose() * DVec3::Z;
        let [sun_from_earth, moon_from_earth] =
            [Body::Sun, Body::Moon].map(|body| positions.epoch.geocentric_au(body));
        let uneclipsed_part = moon_lit(sun_from_earth, moon_from_earth);
        let phase_angle_deg = phase_angle_rad.to_degrees();
        let magnitude_v = moon_magnitude_v(phase_angle_deg, distance_m, to_sun.length());
        let gcrs_from_enu = (positions.stand.enu_from_cirs * positions.epoch.cirs_from_gcrs()).transpose();
        let days = positions.epoch.instant().days_since_j2000();
        Self {
            position,
            magnitude_v: magnitude_v - 2.5 * uneclipsed_part.log10(),
            diameter_rad: 2.0 * (MOON_RADIUS_M / distance_m).asin(),
            phase_angle_rad,
            illuminated_fraction: 0.5 * (1.0 + phase_angle_rad.cos()),
            is_waxing: sun.enu_au.cross(position.enu_au).dot(pole) > 0.0,
            bright_limb_from_north_rad: position_angle(position.enu_au, sun.enu_au, celestial_north),
            bright_limb_from_zenith_rad: position_angle(position.enu_au, sun.enu_au, DVec3::Z),
            elongation_rad: position.enu_au.angle_between(sun.enu_au),
            uneclipsed_part,
            earthshine_magnitude_v: earthshine_magnitude_v(phase_angle_deg, distance_m, to_sun.length()),
            enu_from_moon: (moon_from_gcrs(days) * gcrs_from_enu).transpose(),
        }
    }
}

impl PlanetSeen {
    /// All at an instant over a site.
    pub fn all(positions: &Positions) -> [Self; Planet::ALL.len()] {
        let sun = positions.of(Body::Sun);
        let saturn_pole = positions.stand.enu_from_cirs * (positions.epoch.cirs_from_gcrs() * SATURN_POLE);
        Planet::ALL.map(|planet| {
            let position = positions.of(Body::Planet(planet));
            let from_sun = position.enu_au - sun.enu_au;
            let phase_angle_rad = from_sun.angle_between(position.enu_au);
            let ring_tilt_rad = ring_tilt_rad(saturn_pole, from_sun, position.enu_au);
            let absolute = planet_magnitude_v(planet, phase_angle_rad.to_degrees(), ring_tilt_rad);
            let distances = 5.0 * (from_sun.length() * position.distance_au()).log10();
            Self { planet, position, magnitude_v: absolute + distances, phase_angle_rad }
        })
    }
}

/// V of the Moon by its phase angle, degrees, its distance, m, and the Sun's distance from it, au:
/// −12.73 + 0.026 α + 4e-9 α⁴, and below 7° the opposition surge, 1.35 − 0.05 α.
pub fn moon_magnitude_v(phase_angle_deg: f64, distance_m: f64, sun_distance_au: f64) -> f64 {
    let phase_deg = phase_angle_deg.abs();
    let surge = (1.35 - 0.05 * phase_deg).max(1.0);
    let distances = 5.0 * (distance_m / MOON_MEAN_DISTANCE_M * sun_distance_au).log10();
    FULL_MOON_MAGNITUDE_V + 0.026 * phase_deg + 4e-9 * phase_deg.powi(4) - 2.5 * surge.log10() + distances
}

/// V of the Moon's disc in the light of the Earth alone: the Earth's V from there by its own phase (Mallama, Hilton 2018), which the Moon
/// throws back as it does the Sun's at full Moon.
fn earthshine_magnitude_v(moon_phase_angle_deg: f64, distance_m: f64, sun_distance_au: f64) -> f64 {
    let earth_phase_deg = 180.0 - moon_phase_angle_deg;
    let distances = 5.0 * (distance_m / AU_M * sun_distance_au).log10();
    let earth_v = -3.99 - 1.060e-3 * earth_phase_deg + 2.054e-4 * earth_phase_deg.powi(2) + distances;
    let full_moon_v = FULL_MOON_MAGNITUDE_V + 5.0 * (distance_m / MOON_MEAN_DISTANCE_M).log10();
    full_moon_v + earth_v - SUN_MAGNITUDE_V
}

/// North pole of Saturn and its rings in GCRS (IAU: right ascension 40.6°, declination 83.5°).
const SATURN_POLE: DVec3 = DVec3::new(0.085_478_83, 0.073_235_76, 0.993_644_75);

/// Tilt that the rings are lit and seen with: the geometric mean of both, 0 where one side is lit and the other seen.
fn ring_tilt_rad(pole: DVec3, from_sun: DVec3, from_observer: DVec3) -> f64 {
    let [lit, seen] = [from_sun, from_observer].map(|from| (-pole.dot(from.normalize())).asin());
    (lit * seen).max(0.0).sqrt()
}

/// V at 1 au from Sun and observer, by phase angle, degrees; Mars without what its turn changes (0.06 mag), Uranus without its tilt's.
fn planet_magnitude_v(planet: Planet, phase_angle_deg: f64, ring_tilt_rad: f64) -> f64 {
    let phase = |coefficients: &[f64]| {
        coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * phase_angle_deg + coefficient)
    };
    match planet {
        Planet::Mercury => {
            phase(&[-0.613, 6.328_0e-2, -1.633_6e-3, 3.364_4e-5, -3.426_5e-7, 1.689_3e-9, -3.033_4e-12])
        }
        Planet::Venus if phase_angle_deg < 163.7 => {
            phase(&[-4.384, -1.044e-3, 3.687e-4, -2.814e-6, 8.938e-9])
        }
        Planet::Venus => phase(&[236.058_28, -2.819_14, 8.390_34e-3]),
        Planet::Mars if phase_angle_deg <= 50.0 => phase(&[-1.601, 2.267e-2, -1.302e-4]),
        Planet::Mars => phase(&[-0.367, -0.025_73, 3.445e-4]),
        Planet::Jupiter => phase(&[-9.395, -3.7e-4, 6.16e-4]),
        Planet::Saturn => {
            let tilt = ring_tilt_rad.sin();
            -8.914 - 1.825 * tilt + 0.026 * phase_angle_deg - 0.378 * tilt * (-2.25 * phase_angle_deg).exp()
        }
        Planet::Uranus => phase(&[-7.110, 6.587e-3, 1.045e-4]),
        Planet::Neptune => -7.00,
    }
}

/// B − V of a planet (Mallama, Krobusek, Pavlov 2017).
pub(crate) fn planet_b_minus_v(planet: Planet) -> f64 {
    match planet {
        Planet::Mercury => 0.97,
        Planet::Venus => 0.81,
        Planet::Mars => 1.43,
        Planet::Jupiter => 0.87,
        Planet::Saturn => 1.09,
        Planet::Uranus => 0.50,
        Planet::Neptune => 0.41,
    }
}

/// The angle at a direction on the sky from `reference` counterclockwise to `target`, −π..=π; vectors of east, north, up.
fn position_angle(at: DVec3, target: DVec3, reference: DVec3) -> f64 {
    let at = at.normalize();
    let up = reference - at * reference.dot(at);
    let left = up.cross(at);
    let across = target - at * target.dot(at);
    across.dot(left).atan2(across.dot(up))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{site::Site, time::Instant};

    fn at(utc: &str, latitude_deg: f64, longitude_deg: f64) -> Positions {
        let site = Site::new(latitude_deg, longitude_deg, 0.0).unwrap();
        Positions::new(site, Instant::parse(utc).unwrap())
    }

    /// Phase angles as astropy 8.0.2 gives them, and fractions that follow.
    #[test]
    fn phases_of_the_moon_are_those_of_astropy() {
        for (utc, site, phase_angle_deg, is_waxing) in [
            ("1987-04-10T19:21:00Z", (46.17, 8.79), 39.5327, true),
            ("1999-08-11T11:00:00Z", (48.4, 11.7), 179.8614, false),
            ("2010-06-21T22:00:00Z", (69.65, 18.96), 54.9025, true),
            ("2024-02-29T05:30:00Z", (-24.63, -70.40), 51.3508, false),
            ("2026-08-20T23:16:00Z", (41.38, 2.17), 81.0340, true),
            ("2031-12-31T23:59:59Z", (-77.85, 166.67), 35.3828, false),
            ("2008-01-15T12:00:00Z", (0.0, -179.9), 94.9525, true),
        ] {
            let moon = Moon::of(&at(utc, site.0, site.1));
            assert!((moon.phase_angle_rad.to_degrees() - phase_angle_deg).abs() < 0.01, "{utc}");
            if phase_angle_deg < 170.0 {
                assert_eq!(moon.is_waxing, is_waxing, "{utc}");
            }
            let sum_deg = (moon.phase_angle_rad + moon.elongation_rad).to_degrees();
            assert!((179.8..=180.0).contains(&sum_deg), "{utc}: {sum_deg}");
            assert!((29.2..34.2).contains(&(moon.diameter_rad.to_degrees() * 60.0)));
        }
    }

    /// A young Moon in earthshine is ten thousand times fainter than a full one; it turns the same side to us.
    #[test]
    fn earthshine_and_axis_are_given() {
        let moon = Moon::of(&at("2024-02-11T18:30:00Z", 45.0, 0.0));
        assert!((-3.6..-2.2).contains(&moon.earthshine_magnitude_v), "{}", moon.earthshine_magnitude_v);
        assert!((moon.enu_from_moon.determinant() - 1.0).abs() < 1e-12);
        // The middle of the disc is within the Moon's libration of longitude and latitude 0.
        let towards_observer = moon.enu_from_moon.transpose() * -moon.position.enu_au.normalize();
        assert!(towards_observer.x > 9.5_f64.to_radians().cos(), "{towards_observer}");
        assert_eq!(moon.uneclipsed_part, 1.0);
    }

    /// Full Moon −12.73 and brighter at opposition; quarters are ten times fainter; half its light for 1.4 of its distance.
    #[test]
    fn the_moon_fades_with_its_phase() {
        for (phase_angle_deg, magnitude) in [
            (0.0, -13.056),
            (7.0, -12.548),
            (30.0, -11.947),
            (60.0, -11.118),
            (90.0, -10.128),
            (120.0, -8.781),
        ] {
            let found = moon_magnitude_v(phase_angle_deg, 3.844e8, 1.0);
            assert!((found - magnitude).abs() < 1e-3, "{phase_angle_deg}: {found}");
        }
        let far = moon_magnitude_v(20.0, 3.844e8 * 2f64.sqrt(), 1.0) - moon_magnitude_v(20.0, 3.844e8, 1.0);
        assert!((far - 0.752_6).abs() < 1e-3);
    }

    /// The bright limb points to the Sun: on a northern evening the waxing Moon is lit from the right, in the south from the left.
    #[test]
    fn the_bright_limb_points_to_the_sun() {
        let evening = Moon::of(&at("2024-02-16T18:30:00Z", 45.0, 0.0));
        let north_deg = evening.bright_limb_from_north_rad.to_degrees();
        assert!(evening.is_waxing && (-110.0..-70.0).contains(&north_deg), "{north_deg}");
        assert!(evening.bright_limb_from_zenith_rad < 0.0);
        let southern = Moon::of(&at("2024-02-16T18:30:00Z", -45.0, 0.0));
        assert!(southern.is_waxing && southern.bright_limb_from_zenith_rad > 0.0);
    }

    /// Magnitudes of the planets on days when almanacs name them, to the 0.1 mag that Mars turns by.
    #[test]
    fn planets_are_as_bright_as_almanacs_say() {
        for (utc, planet, magnitude) in [
            ("2020-10-13T23:00:00Z", Planet::Mars, -2.6),
            ("2022-09-26T20:00:00Z", Planet::Jupiter, -2.9),
            ("2020-07-20T22:00:00Z", Planet::Saturn, 0.1),
            ("2020-04-28T00:00:00Z", Planet::Venus, -4.7),
            ("2021-09-14T09:00:00Z", Planet::Neptune, 7.7),
            ("2020-10-31T16:00:00Z", Planet::Uranus, 5.7),
            ("2021-05-17T06:00:00Z", Planet::Mercury, 0.4),
        ] {
            let all = PlanetSeen::all(&at(utc, 0.0, 0.0));
            let found = all.iter().find(|seen| seen.planet == planet).unwrap().magnitude_v;
            assert!((found - magnitude).abs() < 0.15, "{planet:?}: {found:.2}");
        }
    }

    #[test]
    fn the_sun_is_brightest_in_january() {
        let [january, july] =
            ["2026-01-03T12:00:00Z", "2026-07-06T12:00:00Z"].map(|utc| Sun::of(&at(utc, 0.0, 0.0)));
        assert!((july.magnitude_v - january.magnitude_v - 0.072_6).abs() < 5e-4);
        assert!((january.diameter_rad.to_degrees() * 60.0 - 32.53).abs() < 0.02);
    }
}
