//! Ozone: its density over altitude at mid latitudes (US Standard Atmosphere 1976, after Krueger and Minzner 1976) and its
//! absorption in the visible, the Chappuis band (Bird and Riordan 1984, after Leckner 1978).

/// Centimetres of pure ozone at 0 °C and 1 atm in a Dobson unit.
const ATM_CM_PER_DOBSON: f64 = 1e-3;

/// Altitude [km] and molecules per cm³, in 10¹⁰.
const PROFILE: [(f64, f64); 34] = [
    (0.0, 68.0),
    (2.0, 68.0),
    (4.0, 58.0),
    (6.0, 57.0),
    (8.0, 65.0),
    (10.0, 113.0),
    (12.0, 202.0),
    (14.0, 235.0),
    (16.0, 295.0),
    (18.0, 404.0),
    (20.0, 477.0),
    (22.0, 486.0),
    (24.0, 454.0),
    (26.0, 403.0),
    (28.0, 324.0),
    (30.0, 252.0),
    (32.0, 203.0),
    (34.0, 158.0),
    (36.0, 122.0),
    (38.0, 87.3),
    (40.0, 60.7),
    (42.0, 39.8),
    (44.0, 27.4),
    (46.0, 16.9),
    (48.0, 10.3),
    (50.0, 6.64),
    (52.0, 4.5),
    (55.0, 2.55),
    (60.0, 1.61),
    (65.0, 1.12),
    (70.0, 0.733),
    (74.0, 0.481),
    (80.0, 0.2),
    (100.0, 0.0),
];

/// Wavelength [nm] and absorption coefficient, per atm-cm, base e.
const ABSORPTION: [(f64, f64); 23] = [
    (440.0, 0.0),
    (450.0, 0.003),
    (460.0, 0.006),
    (470.0, 0.009),
    (480.0, 0.014),
    (490.0, 0.021),
    (500.0, 0.03),
    (510.0, 0.04),
    (520.0, 0.048),
    (530.0, 0.063),
    (540.0, 0.075),
    (550.0, 0.085),
    (570.0, 0.12),
    (593.0, 0.119),
    (610.0, 0.12),
    (630.0, 0.09),
    (656.0, 0.065),
    (667.6, 0.051),
    (690.0, 0.028),
    (710.0, 0.018),
    (740.0, 0.01),
    (767.5, 0.005),
    (780.0, 0.0),
];

/// The line through a table's points at x; the end values beyond.
fn interpolated(table: &[(f64, f64)], x: f64) -> f64 {
    let upper = table.partition_point(|point| point.0 <= x).clamp(1, table.len() - 1);
    let ((x0, y0), (x1, y1)) = (table[upper - 1], table[upper]);
    y0 + (y1 - y0) * ((x - x0) / (x1 - x0)).clamp(0.0, 1.0)
}

/// Density relative to the densest layer of the table, near 22 km.
pub(super) fn relative_density(altitude_m: f64) -> f64 {
    interpolated(&PROFILE, altitude_m / 1e3) / 486.0
}

/// ∫ of [`relative_density`] over altitude, metres.
fn relative_column_m() -> f64 {
    PROFILE.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0)).sum::<f64>() * 1e3
        / 486.0
}

/// Absorption coefficient, per atm-cm.
pub(crate) fn absorption_per_atm_cm(wavelength_nm: f64) -> f64 {
    interpolated(&ABSORPTION, wavelength_nm)
}

/// Extinction where ozone is densest, m⁻¹ per Dobson unit over the place.
pub(super) fn densest_extinction_per_m(wavelength_nm: f64) -> f64 {
    absorption_per_atm_cm(wavelength_nm) * ATM_CM_PER_DOBSON / relative_column_m()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table's own column is 345 Dobson units, as published, and absorption peaks near 600 nm.
    #[test]
    fn the_profile_has_its_published_column() {
        let molecules_per_cm2 = relative_column_m() * 100.0 * 486e10;
        let dobson = molecules_per_cm2 / 2.687e16;
        assert!((dobson / 345.0 - 1.0).abs() < 0.03, "{dobson}");
        let depth = 300.0 * densest_extinction_per_m(600.0) * relative_column_m();
        assert!((depth - 0.0358).abs() < 4e-4, "{depth}");
        assert!(densest_extinction_per_m(440.0) < 0.1 * densest_extinction_per_m(510.0));
    }
}
