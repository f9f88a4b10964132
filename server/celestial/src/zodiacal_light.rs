//! Zodiacal light and gegenschein: Leinert et al. 1998, table 16, with its reddening (eq. 22) and R^−2.3 through the year.

use std::sync::LazyLock;

/// |λ − λ☉|, degrees, of the rows.
const LONGITUDES_DEG: [f64; 19] = [
    0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 60.0, 75.0, 90.0, 105.0, 120.0, 135.0, 150.0,
    165.0, 180.0,
];
/// |β|, degrees, of the columns; the pole is added.
const LATITUDES_DEG: [f64; 11] = [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 45.0, 60.0, 75.0, 90.0];
/// At the poles of the ecliptic, S10.
const POLE_S10: f64 = 60.0;
/// Elongation whose colour the spectrum of the component has, degrees.
pub const MEAN_ELONGATION_DEG: f64 = 90.0;
/// How the light goes with the distance from the Sun.
const DISTANCE_POWER: f64 = -2.3;
/// Nearest elongation that the table is continued to, degrees.
const NEAREST_DEG: f64 = 5.0;

/// ln S10 by row and column.
type Table = [[f64; LATITUDES_DEG.len()]; LONGITUDES_DEG.len()];

/// ln S10 every 5°, where all rows and columns of the table lie.
const STEP_DEG: f64 = 5.0;
type Grid = [[f64; 19]; 37];

static LN_S10: LazyLock<Grid> = LazyLock::new(|| {
    let table = table(include_str!("../data/zodiacal_light_s10.csv"));
    std::array::from_fn(|row| {
        let (row, along) = between(&LONGITUDES_DEG, STEP_DEG * row as f64);
        std::array::from_fn(|column| {
            let (column, up) = between(&LATITUDES_DEG, STEP_DEG * column as f64);
            let at = |row: usize| table[row][column] + up * (table[row][column + 1] - table[row][column]);
            at(row) + along * (at(row + 1) - at(row))
        })
    })
});

/// Reads the table. Cells next to the Sun that are blank there continue their neighbours by elongation^−2.3: those of β ≤ 5° along the
/// ecliptic, the others towards it.
fn table(text: &str) -> Table {
    let rows: Vec<Vec<Option<f64>>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').skip(1).map(|cell| cell.parse().ok()).collect())
        .collect();
    let cell = |row: usize, column: usize| match column {
        column if column + 1 == LATITUDES_DEG.len() => Some(POLE_S10),
        _ => rows.get(row).and_then(|row| row.get(column).copied().flatten()),
    };
    let elongation_deg = |row: usize, column: usize| {
        let cos = LONGITUDES_DEG[row].to_radians().cos() * LATITUDES_DEG[column].to_radians().cos();
        cos.acos().to_degrees().max(NEAREST_DEG)
    };
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let filled = (0..LONGITUDES_DEG.len())
                .map(|step| if column <= 1 { (row + step, column) } else { (row, column + step) })
                .find_map(|(row, column)| {
                    cell(row, column).map(|value| (value, elongation_deg(row, column)))
                });
            let (value, at_deg) = filled.unwrap_or((POLE_S10, elongation_deg(row, column)));
            (value * (at_deg / elongation_deg(row, column)).powf(2.3)).ln()
        })
    })
}

/// Where a value lies between the steps of an axis: the step below and the part of the way.
fn between<const N: usize>(axis: &[f64; N], value: f64) -> (usize, f64) {
    let below = axis.partition_point(|step| *step <= value).clamp(1, N - 1) - 1;
    (below, ((value - axis[below]) / (axis[below + 1] - axis[below])).clamp(0.0, 1.0))
}

/// Brightness, S10 at 500 nm outside the air with the Sun at 1 au: ln interpolated in helioecliptic longitude and latitude, degrees.
pub fn table_s10(longitude_from_sun_deg: f64, latitude_deg: f64) -> f64 {
    let from_sun_deg = longitude_from_sun_deg.abs() % 360.0;
    let place = |deg: f64, last: usize| {
        let steps = (deg / STEP_DEG).clamp(0.0, last as f64);
        let below = (steps as usize).min(last - 1);
        (below, steps - below as f64)
    };
    let (row, along) = place(from_sun_deg.min(360.0 - from_sun_deg), 36);
    let (column, up) = place(latitude_deg.abs(), 18);
    let grid = &*LN_S10;
    let at = |row: usize| grid[row][column] + up * (grid[row][column + 1] - grid[row][column]);
    (at(row) + along * (at(row + 1) - at(row))).exp()
}

/// What the distance of Earth and Sun makes of the light.
pub fn distance_factor(sun_distance_au: f64) -> f64 {
    sun_distance_au.powf(DISTANCE_POWER)
}

/// The light's colour over the Sun's, 1 at 500 nm, by elongation, degrees (decadic logarithms; linear between 30 and 90°).
pub fn reddening(wavelength_nm: f64, elongation_deg: f64) -> f64 {
    let (near, far) = if wavelength_nm <= 500.0 { (1.2, 0.9) } else { (0.8, 0.6) };
    1.0 + (near + far_part(elongation_deg) * (far - near)) * (wavelength_nm / 500.0).log10()
}

/// How far an elongation, degrees, lies on the way from the near to the far colour.
pub(crate) fn far_part(elongation_deg: f64) -> f64 {
    ((elongation_deg - 30.0) / 60.0).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Values of the published table at its nodes; the gegenschein is brighter than what lies beside it.
    #[test]
    fn nodes_of_the_table_are_met() {
        for (longitude_deg, latitude_deg, s10) in [
            (90.0, 0.0, 202.0),
            (180.0, 0.0, 180.0),
            (-60.0, 0.0, 395.0),
            (45.0, -30.0, 195.0),
            (0.0, 15.0, 2450.0),
            (15.0, 0.0, 9000.0),
            (123.0, 90.0, 60.0),
            (0.0, -75.0, 78.0),
        ] {
            let found = table_s10(longitude_deg, latitude_deg);
            assert!((found / s10 - 1.0).abs() < 1e-9, "{longitude_deg} {latitude_deg}: {found}");
        }
        assert!(table_s10(180.0, 0.0) > table_s10(150.0, 0.0) && table_s10(0.0, 0.0) > 9000.0);
    }

    /// Decadic, as the paper has it: 1.2·log₁₀(440/500) is −0.067.
    #[test]
    fn the_light_is_redder_than_the_sun() {
        for (nm, elongation_deg, factor) in
            [(500.0, 60.0, 1.0), (440.0, 20.0, 0.9334), (680.0, 100.0, 1.0801), (680.0, 60.0, 1.0935)]
        {
            assert!((reddening(nm, elongation_deg) - factor).abs() < 2e-4, "{nm} {elongation_deg}");
        }
        // Perihelion against aphelion: 8 % between January and July.
        let season = distance_factor(0.9833) / distance_factor(1.0167);
        assert!((season - 1.08).abs() < 0.003, "{season}");
    }

    proptest! {
        /// East and west, north and south are alike, and nothing jumps.
        #[test]
        fn the_light_is_even_and_continuous(longitude in -360.0..360.0_f64, latitude in -90.0..90.0_f64) {
            let s10 = table_s10(longitude, latitude);
            prop_assert!((table_s10(-longitude, latitude) / s10 - 1.0).abs() < 1e-9);
            prop_assert!((table_s10(longitude, -latitude) / s10 - 1.0).abs() < 1e-9);
            prop_assert!((table_s10(longitude + 1e-4, latitude) / s10 - 1.0).abs() < 1e-3);
            prop_assert!((50.0..2e5).contains(&s10));
        }
    }
}
