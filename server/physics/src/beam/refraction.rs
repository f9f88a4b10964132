//! Refraction of a line of sight: from a body's true to its apparent altitude (Sæmundsson 1986).

/// Altitude over which pressure falls to 1/e, metres, near the ground.
const PRESSURE_SCALE_HEIGHT_M: f64 = 8_430.0;
/// True altitudes between which the lift goes from the whole to none, degrees: the formula is for what can be seen, and nobody
/// sees a body that is deeper.
const WHOLE_DEG: f64 = -2.0;
const NONE_DEG: f64 = -5.0;

/// Apparent altitude of a body over the horizontal, radians, from its true one, in air of 1010 hPa and 10 °C at sea level
/// and thinner by the observer's altitude. To 0.1′ over 0; below −2° it goes over to the true one, which it is from −5° down.
pub fn apparent_altitude_rad(true_altitude_rad: f64, observer_altitude_m: f64) -> f64 {
    let true_deg = true_altitude_rad.to_degrees();
    let altitude_deg = true_deg.max(WHOLE_DEG);
    let argument_deg = altitude_deg + 10.3 / (altitude_deg + 5.11);
    let lift_arcmin = 1.02 / argument_deg.to_radians().tan();
    let pressure = (-observer_altitude_m / PRESSURE_SCALE_HEIGHT_M).exp();
    let share = ((true_deg - NONE_DEG) / (WHOLE_DEG - NONE_DEG)).clamp(0.0, 1.0);
    true_altitude_rad + (share * lift_arcmin * pressure / 60.0).max(0.0).to_radians()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 29 arc minutes at the true horizon, 1 at 45°, none at the zenith, less on a mountain.
    #[test]
    fn bodies_are_lifted_as_tables_say() {
        let lift = |deg: f64, altitude_m: f64| {
            (apparent_altitude_rad(deg.to_radians(), altitude_m).to_degrees() - deg) * 60.0
        };
        assert!((lift(0.0, 0.0) - 28.98).abs() < 0.1, "{}", lift(0.0, 0.0));
        assert!((lift(45.0, 0.0) - 1.0).abs() < 0.03);
        assert!(lift(90.0, 0.0).abs() < 0.01);
        assert!((lift(0.0, 3_000.0) / lift(0.0, 0.0) - 0.70).abs() < 0.01);
        assert!(lift(-2.0, 0.0) >= lift(0.0, 0.0));
    }

    /// Deep below the horizon a body is where it is, and on its way there nothing jumps or turns back.
    #[test]
    fn bodies_far_below_are_not_lifted() {
        let apparent = |deg: f64| apparent_altitude_rad(deg.to_radians(), 0.0).to_degrees();
        for deg in [-5.0, -18.0, -90.0] {
            assert!((apparent(deg) - deg).abs() < 1e-9, "{deg}");
        }
        for step in 0..1_000 {
            let deg = -8.0 + 0.01 * f64::from(step);
            let rise = apparent(deg + 0.01) - apparent(deg);
            assert!((0.005..0.014).contains(&rise), "{deg}: {rise}");
        }
    }
}
