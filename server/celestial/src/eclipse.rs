//! What eclipses take of the light of Sun and Moon: discs that cover each other, of even brightness (Explanatory Supplement 2013,
//! chapter 11).

use crate::ephemeris::AU_M;
use glam::DVec3;
use std::f64::consts::PI;

/// Radius of the Sun, m (IAU 2015).
pub(crate) const SUN_RADIUS_M: f64 = 6.957e8;
/// Radius of the Moon, m.
pub(crate) const MOON_RADIUS_M: f64 = 1.737_4e6;
/// Radius of the Earth's shadow as it falls on the Moon, m: air makes it 2 % larger (Chauvenet).
const SHADOW_RADIUS_M: f64 = 6.378_1e6 * 1.02;
/// Light that the air bends into the shadow, over full moonlight: the Moon is some twelve magnitudes fainter there.
const BENT_LIGHT: f64 = 1.5e-5;
/// Rings and places on each that stand for the Moon's disc.
const RINGS: usize = 6;

/// Part of a disc that another does not cover, 0..=1; radii and the distance of the middles in one unit.
pub fn uncovered_part(radius: f64, other_radius: f64, distance: f64) -> f64 {
    if distance >= radius + other_radius {
        return 1.0;
    }
    if distance <= (radius - other_radius).abs() {
        return (1.0 - (other_radius / radius).powi(2)).max(0.0);
    }
    let half_angle = |own: f64, other: f64| {
        ((distance * distance + own * own - other * other) / (2.0 * distance * own)).clamp(-1.0, 1.0).acos()
    };
    let (one, two) = (half_angle(radius, other_radius), half_angle(other_radius, radius));
    let lens = radius * radius * (one - one.sin() * one.cos())
        + other_radius * other_radius * (two - two.sin() * two.cos());
    (1.0 - lens / (PI * radius * radius)).clamp(0.0, 1.0)
}

/// Part of the Sun's disc that an observer sees beside the Moon; both from the observer, au.
pub fn sun_uncovered(sun_au: DVec3, moon_au: DVec3) -> f64 {
    let radius = |metres: f64, distance_au: f64| (metres / (distance_au * AU_M)).asin();
    uncovered_part(
        radius(SUN_RADIUS_M, sun_au.length()),
        radius(MOON_RADIUS_M, moon_au.length()),
        sun_au.angle_between(moon_au),
    )
}

/// Part of the Moon's light that the Earth's shadow leaves; Sun and Moon from the Earth's centre, au.
pub fn moon_lit(sun_au: DVec3, moon_au: DVec3) -> f64 {
    let axis = -sun_au.normalize();
    // Sun and shadow in the sky of the Moon, and how far apart they are at most on its disc.
    let distance_au = moon_au.length();
    let sun_radius = (SUN_RADIUS_M / (AU_M * (sun_au.length() + distance_au))).asin();
    let earth_radius = (SHADOW_RADIUS_M / (AU_M * distance_au)).asin();
    let reach = sun_radius + earth_radius + MOON_RADIUS_M / (AU_M * distance_au);
    if moon_au.angle_between(axis) > reach {
        return 1.0;
    }
    let along = moon_au.cross(axis).cross(moon_au).try_normalize().unwrap_or(DVec3::X);
    let across = moon_au.normalize().cross(along);
    let (mut sum, mut count) = (0.0, 0.0);
    for ring in 0..RINGS {
        let radius_au = MOON_RADIUS_M / AU_M * ((ring as f64 + 0.5) / RINGS as f64).sqrt();
        for place in 0..24 {
            let (sin, cos) = (f64::from(place) * PI / 12.0).sin_cos();
            let point = moon_au + (along * cos + across * sin) * radius_au;
            let apart = (sun_au - point).angle_between(-point);
            sum += uncovered_part(sun_radius, earth_radius, apart).max(BENT_LIGHT);
            count += 1.0;
        }
    }
    sum / count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        ephemeris::{Body, Positions},
        site::Site,
        time::Instant,
    };
    use proptest::prelude::*;

    fn positions(utc: &str, latitude_deg: f64, longitude_deg: f64) -> Positions {
        let site = Site::new(latitude_deg, longitude_deg, 150.0).unwrap();
        Positions::new(site, Instant::parse(utc).unwrap())
    }

    /// Dallas, 2024-04-08: total from 18:40:43 to 18:44:35 UTC, and partial from 17:23 to 20:02.
    #[test]
    fn the_sun_is_eclipsed_over_dallas() {
        let uncovered = |utc: &str| {
            let positions = positions(utc, 32.78, -96.80);
            sun_uncovered(positions.of(Body::Sun).enu_au, positions.of(Body::Moon).enu_au)
        };
        for utc in ["2024-04-08T18:41:00Z", "2024-04-08T18:44:20Z"] {
            assert_eq!(uncovered(utc), 0.0, "{utc}");
        }
        for utc in ["2024-04-08T18:40:20Z", "2024-04-08T18:45:00Z"] {
            assert!((1e-5..0.02).contains(&uncovered(utc)), "{utc}");
        }
        assert_eq!(uncovered("2024-04-08T17:22:00Z"), 1.0);
        assert_eq!(uncovered("2024-04-08T20:04:00Z"), 1.0);
        assert!((0.3..0.7).contains(&uncovered("2024-04-08T18:03:00Z")));
    }

    /// 2025-03-14: penumbra from 03:57 to 10:00 UTC, umbra from 05:09 to 08:48, total from 06:26 to 07:31.
    #[test]
    fn the_moon_is_eclipsed_in_the_shadow() {
        let lit = |utc: &str| {
            let positions = positions(utc, 0.0, -90.0);
            let [sun, moon] = [Body::Sun, Body::Moon].map(|body| positions.epoch.geocentric_au(body));
            moon_lit(sun, moon)
        };
        for (utc, from, to) in [
            ("2025-03-14T03:50:00Z", 1.0, 1.0),
            ("2025-03-14T05:05:00Z", 0.5, 0.9),
            ("2025-03-14T05:50:00Z", 0.05, 0.5),
            ("2025-03-14T06:59:00Z", BENT_LIGHT, 0.01),
            ("2025-03-14T08:50:00Z", 0.5, 0.9),
            ("2025-03-14T10:10:00Z", 1.0, 1.0),
        ] {
            assert!((from..=to).contains(&lit(utc)), "{utc}: {}", lit(utc));
        }
    }

    proptest! {
        /// Parts are parts, and more distance never covers more.
        #[test]
        fn discs_cover_each_other(radius in 0.1..3.0_f64, other in 0.1..3.0_f64, distance in 0.0..7.0_f64) {
            let part = uncovered_part(radius, other, distance);
            prop_assert!((0.0..=1.0).contains(&part));
            prop_assert!(uncovered_part(radius, other, distance + 0.01) >= part - 1e-9);
            prop_assert!(uncovered_part(radius, other, distance + 1e-7) - part < 1e-3);
        }
    }
}
