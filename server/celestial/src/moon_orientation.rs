//! How the Moon is turned: its pole and prime meridian (IAU Working Group on Cartographic Coordinates 2009, Archinal et al. 2011).

use glam::{DMat3, DVec3};

/// Arguments E1 to E13: degrees at J2000, and degrees a day.
const ARGUMENTS: [(f64, f64); 13] = [
    (125.045, -0.052_992_1),
    (250.089, -0.105_984_2),
    (260.008, 13.012_000_9),
    (176.625, 13.340_715_4),
    (357.529, 0.985_600_3),
    (311.589, 26.405_708_4),
    (134.963, 13.064_993_0),
    (276.617, 0.328_714_6),
    (34.226, 1.748_487_7),
    (15.134, -0.158_976_3),
    (119.743, 0.003_609_6),
    (239.961, 0.164_357_3),
    (25.053, 12.959_008_8),
];
/// Sines of the arguments in the pole's right ascension, degrees.
const RIGHT_ASCENSION: [f64; 13] =
    [-3.8787, -0.1204, 0.0700, -0.0172, 0.0, 0.0072, 0.0, 0.0, 0.0, -0.0052, 0.0, 0.0, 0.0043];
/// Cosines in its declination.
const DECLINATION: [f64; 13] =
    [1.5419, 0.0239, -0.0278, 0.0068, 0.0, -0.0029, 0.0009, 0.0, 0.0, 0.0008, 0.0, 0.0, -0.0009];
/// Sines in the angle of the prime meridian.
const MERIDIAN: [f64; 13] = [
    3.5610, 0.1208, -0.0642, 0.0158, 0.0252, -0.0066, -0.0047, -0.0046, 0.0028, 0.0052, 0.0040, 0.0019,
    -0.0044,
];

/// Turns GCRS into the Moon's own axes: x to longitude and latitude 0, which face the Earth in the mean, z to its north pole. True to
/// 0.01°, so many days of TT after J2000.
pub fn moon_from_gcrs(days: f64) -> DMat3 {
    let arguments = ARGUMENTS.map(|(at_j2000, a_day)| (at_j2000 + a_day * days).to_radians());
    let sum = |coefficients: &[f64; 13], wave: fn(f64) -> f64| -> f64 {
        coefficients.iter().zip(arguments).map(|(coefficient, argument)| coefficient * wave(argument)).sum()
    };
    let centuries = days / 36_525.0;
    let right_ascension = 269.9949 + 0.0031 * centuries + sum(&RIGHT_ASCENSION, f64::sin);
    let declination = 66.5392 + 0.0130 * centuries + sum(&DECLINATION, f64::cos);
    let meridian = 38.3213 + 13.176_358_15 * days - 1.4e-12 * days * days + sum(&MERIDIAN, f64::sin);
    let pole = DVec3::from_array(sofars::vm::s2c(right_ascension.to_radians(), declination.to_radians()));
    // Where the Moon's equator rises through the celestial one; the meridian is counted from there.
    let node = DVec3::Z.cross(pole).normalize();
    let (sin, cos) = meridian.to_radians().sin_cos();
    let x = node * cos + pole.cross(node) * sin;
    DMat3::from_cols(x, pole.cross(x), pole).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ephemeris::Body, ephemeris::Epoch, time::Instant};

    /// 1992-04-12, 0 h TD: libration −1.23° in longitude, +4.20° in latitude, axis at 15.08° (Meeus 1998, example 53.a).
    #[test]
    fn the_moon_is_turned_as_in_meeus() {
        let instant = Instant::parse("1992-04-11T23:59:01Z").unwrap();
        let epoch = Epoch::new(instant);
        let turn = moon_from_gcrs(instant.days_since_j2000());
        assert!((turn * turn.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-12));
        let moon = (epoch.cirs_from_gcrs().transpose() * epoch.geocentric_au(Body::Moon)).normalize();
        let earth = turn * -moon;
        let (longitude_deg, latitude_deg) =
            (earth.y.atan2(earth.x).to_degrees(), earth.z.asin().to_degrees());
        assert!(
            (longitude_deg + 1.23).abs() < 0.05 && (latitude_deg - 4.20).abs() < 0.05,
            "{longitude_deg} {latitude_deg}"
        );
        // The axis on the sky, from celestial north to the east.
        let pole = epoch.cirs_from_gcrs() * (turn.transpose() * DVec3::Z);
        let at = epoch.cirs_from_gcrs() * moon;
        let east = DVec3::Z.cross(at);
        let position_deg = pole.dot(east).atan2(pole.dot(at.cross(east))).to_degrees();
        assert!((position_deg - 15.08).abs() < 0.1, "{position_deg}");
    }
}
