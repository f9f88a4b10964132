//! Refraction of a line of sight: from a body's true to its apparent altitude (Sæmundsson 1986).

/// Altitude over which pressure falls to 1/e, metres, near the ground.
const PRESSURE_SCALE_HEIGHT_M: f64 = 8_430.0;
/// Below this true altitude nothing is lifted further, radians: the formula is for what can be seen.
const LOWEST_RAD: f64 = -0.035;

/// Apparent altitude of a body over the horizontal, radians, from its true one, in air of 1010 hPa and 10 °C at sea level
/// and thinner by the observer's altitude. To 0.1′ over 0; below −2° the lift of −2° is kept.
pub fn apparent_altitude_rad(true_altitude_rad: f64, observer_altitude_m: f64) -> f64 {
    let altitude_deg = true_altitude_rad.max(LOWEST_RAD).to_degrees();
    let argument_deg = altitude_deg + 10.3 / (altitude_deg + 5.11);
    let lift_arcmin = 1.02 / argument_deg.to_radians().tan();
    let pressure = (-observer_altitude_m / PRESSURE_SCALE_HEIGHT_M).exp();
    true_altitude_rad + (lift_arcmin * pressure / 60.0).max(0.0).to_radians()
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
        assert!(lift(-5.0, 0.0) >= lift(0.0, 0.0));
    }
}
