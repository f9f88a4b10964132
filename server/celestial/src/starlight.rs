//! Starlight that no star is seen of, with diffuse galactic light: Pioneer 10 and 11 beyond the zodiacal dust (Leinert et al. 1998, table 35).

use std::sync::LazyLock;

const LONGITUDE_COUNT: usize = 36;
/// Galactic latitudes of the rows, degrees.
const LATITUDES_DEG: [f64; 25] = [
    -80.0, -70.0, -60.0, -50.0, -40.0, -30.0, -24.0, -20.0, -16.0, -12.0, -8.0, -4.0, 0.0, 4.0, 8.0, 12.0,
    16.0, 20.0, 24.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0,
];

/// S10 at 440 nm; a row at each pole has the mean of its neighbour.
struct Table {
    latitudes_deg: [f64; LATITUDES_DEG.len() + 2],
    s10: [[f64; LONGITUDE_COUNT]; LATITUDES_DEG.len() + 2],
}

static TABLE: LazyLock<Table> =
    LazyLock::new(|| Table::read(include_str!("../data/integrated_starlight_s10.csv")));

impl Table {
    fn read(text: &str) -> Self {
        let last = LATITUDES_DEG.len() + 1;
        let latitudes_deg = std::array::from_fn(|row| match row {
            0 => -90.0,
            row if row == last => 90.0,
            row => LATITUDES_DEG[row - 1],
        });
        let mut s10 = [[0.0; LONGITUDE_COUNT]; LATITUDES_DEG.len() + 2];
        for (row, line) in s10[1..last].iter_mut().zip(text.lines().skip(1)) {
            for (value, cell) in row.iter_mut().zip(line.split(',').skip(1)) {
                *value = cell.parse().unwrap_or(0.0);
            }
        }
        let mean =
            |row: [f64; LONGITUDE_COUNT]| [row.iter().sum::<f64>() / LONGITUDE_COUNT as f64; LONGITUDE_COUNT];
        s10[0] = mean(s10[1]);
        s10[last] = mean(s10[last - 1]);
        Self { latitudes_deg, s10 }
    }
}

/// Brightness of all that shines beyond the zodiacal dust but for stars to V = 6.5, S10 at 440 nm outside the air: linear between the
/// cells of the table, by galactic longitude and latitude, degrees. The table is good to 10 to 15 % over some degrees.
pub fn table_s10(longitude_deg: f64, latitude_deg: f64) -> f64 {
    let table = &*TABLE;
    let rows = table.latitudes_deg.len();
    let row = table.latitudes_deg.partition_point(|step| *step <= latitude_deg).clamp(1, rows - 1) - 1;
    let [low, high] = [table.latitudes_deg[row], table.latitudes_deg[row + 1]];
    let up = ((latitude_deg - low) / (high - low)).clamp(0.0, 1.0);
    let place = longitude_deg.rem_euclid(360.0) / 10.0;
    let (column, along) = (place as usize % LONGITUDE_COUNT, place.fract());
    let next = (column + 1) % LONGITUDE_COUNT;
    let at = |row: usize| table.s10[row][column] + along * (table.s10[row][next] - table.s10[row][column]);
    at(row) + up * (at(row + 1) - at(row))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Values of the published table; the Large Magellanic Cloud is in it.
    #[test]
    fn nodes_of_the_table_are_met() {
        for (longitude_deg, latitude_deg, s10) in [
            (0.0, 0.0, 290.0),
            (0.0, -4.0, 569.0),
            (290.0, 0.0, 634.0),
            (280.0, -30.0, 213.0),
            (350.0, 80.0, 31.0),
            (-10.0, -80.0, 30.0),
            (180.0, 4.0, 182.0),
        ] {
            assert_eq!(table_s10(longitude_deg, latitude_deg), s10, "{longitude_deg} {latitude_deg}");
        }
        assert!((table_s10(10.0, 90.0) - table_s10(200.0, 90.0)).abs() < 1e-12);
    }

    /// The mean of the sphere is some 90 S10, the poles a third of that.
    #[test]
    fn the_mean_is_that_of_the_galaxy() {
        let (mut sum, mut weights) = (0.0, 0.0);
        for latitude in 0..180 {
            let latitude_deg = f64::from(latitude) - 89.5;
            let weight = latitude_deg.to_radians().cos();
            for longitude in 0..72 {
                sum += weight * table_s10(f64::from(longitude) * 5.0, latitude_deg);
                weights += weight;
            }
        }
        let mean = sum / weights;
        assert!((80.0..110.0).contains(&mean), "{mean}");
        assert!((25.0..35.0).contains(&table_s10(0.0, 90.0)));
    }

    proptest! {
        #[test]
        fn starlight_is_continuous(longitude in -400.0..400.0_f64, latitude in -90.0..90.0_f64) {
            let s10 = table_s10(longitude, latitude);
            prop_assert!((20.0..640.0).contains(&s10));
            prop_assert!((table_s10(longitude + 1e-5, latitude + 1e-5) - s10).abs() < 0.01);
            prop_assert!((table_s10(longitude + 360.0, latitude) - s10).abs() < 1e-9);
        }
    }
}
