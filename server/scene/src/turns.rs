//! The azimuth in which a light sees the observer.

use glam::DVec3;

/// Azimuth of the observer seen from a light over 2π, 0..=1, to 2e-5: a thousandth of the step between a skyline's
/// azimuths. Both are given as unit vectors.
pub(crate) fn turns_from_light(light: DVec3, observer: DVec3) -> f64 {
    // East and north there, both times the light's distance from the Earth's axis.
    let across = light.x * light.x + light.y * light.y;
    let east = light.x * observer.y - light.y * observer.x;
    let north = observer.z * across - light.z * (light.x * observer.x + light.y * observer.y);
    let (small, large) = (east.abs().min(north.abs()), east.abs().max(north.abs()));
    let slope = small / large.max(f64::MIN_POSITIVE);
    let square = slope * slope;
    // atan(slope)/2π, fitted over 0..=1.
    let octant =
        slope * (0.159_029_83 + square * (-0.051_116_69 + square * (0.023_278_98 - square * 0.006_205_08)));
    let quarter = if east.abs() > north.abs() { 0.25 - octant } else { octant };
    let half = if north < 0.0 { 0.5 - quarter } else { quarter };
    if east < 0.0 { 1.0 - half } else { half }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use skyglow_physics::GeoPoint;
    use std::f64::consts::TAU;

    proptest! {
        #[test]
        fn the_observer_is_found_where_the_light_sees_it(
            latitude in -89.0f64..89.0, longitude in -180.0f64..180.0, turns in 0.0f64..1.0, distance_m in 10.0f64..3e5,
        ) {
            let light = GeoPoint::from_deg(latitude, longitude).unwrap();
            let observer = light.destination(turns * TAU, distance_m);
            let found = turns_from_light(light.unit_vector(), observer.unit_vector());
            prop_assert!((0.0..=1.0).contains(&found));
            let off = (found - turns + 0.5).rem_euclid(1.0) - 0.5;
            prop_assert!(off.abs() < 2e-5, "{} {}", found, turns);
        }
    }
}
