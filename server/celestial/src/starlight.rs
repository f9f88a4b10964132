//! Starlight that no star is seen of, with diffuse galactic light: Pioneer 10 and 11 beyond the zodiacal dust (Leinert et al. 1998, table 35).

use std::sync::LazyLock;

const LONGITUDE_COUNT: usize = 36;
/// Galactic latitudes of the rows, degrees.
const LATITUDES_DEG: [f64; 25] = [
    -80.0, -70.0, -60.0, -50.0, -40.0, -30.0, -24.0, -20.0, -16.0, -12.0, -8.0, -4.0, 0.0, 4.0, 8.0, 12.0,
    16.0, 20.0, 24.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0,
];

/// Steps of the rows that are kept, degrees: all latitudes of the table lie on one.
const STEP_DEG: f64 = 2.0;
const ROW_COUNT: usize = 91;

/// S10 at 440 nm every 2° of latitude from −90°; a row at each pole has the mean of its neighbour.
type Table = [[f64; LONGITUDE_COUNT]; ROW_COUNT];

static TABLE: LazyLock<Box<Table>> =
    LazyLock::new(|| Box::new(read(include_str!("../data/integrated_starlight_s10.csv"))));

fn read(text: &str) -> Table {
    let mut rows: Vec<(f64, Vec<f64>)> = LATITUDES_DEG
        .into_iter()
        .zip(text.lines().skip(1))
        .map(|(latitude_deg, line)| {
            (latitude_deg, line.split(',').skip(1).map(|cell| cell.parse().unwrap_or(0.0)).collect())
        })
        .collect();
    let pole = |(_, row): &(f64, Vec<f64>)| vec![row.iter().sum::<f64>() / row.len() as f64; LONGITUDE_COUNT];
    let (south, north) = (rows.first().map(pole), rows.last().map(pole));
    rows.insert(0, (-90.0, south.unwrap_or_default()));
    rows.push((90.0, north.unwrap_or_default()));
    std::array::from_fn(|row| {
        let latitude_deg = STEP_DEG * row as f64 - 90.0;
        let below =
            rows.partition_point(|(row_deg, _)| *row_deg <= latitude_deg).clamp(1, rows.len() - 1) - 1;
        let [(low_deg, low), (high_deg, high)] = [&rows[below], &rows[below + 1]];
        let up = (latitude_deg - low_deg) / (high_deg - low_deg);
        std::array::from_fn(|column| low[column] + up * (high[column] - low[column]))
    })
}

/// Brightness of all that shines beyond the zodiacal dust but for stars to V = 6.5, S10 at 440 nm outside the air: linear between the
/// cells of the table, by galactic longitude and latitude, degrees. The table is good to 10 to 15 % over some degrees.
pub fn table_s10(longitude_deg: f64, latitude_deg: f64) -> f64 {
    let steps = ((latitude_deg + 90.0) / STEP_DEG).clamp(0.0, (ROW_COUNT - 1) as f64);
    let row = (steps as usize).min(ROW_COUNT - 2);
    let up = steps - row as f64;
    let turns = longitude_deg / 360.0;
    let place = (turns - turns.floor()) * LONGITUDE_COUNT as f64;
    let (column, along) = (place as usize % LONGITUDE_COUNT, place.fract());
    let next = (column + 1) % LONGITUDE_COUNT;
    let at = |row: usize| TABLE[row][column] + along * (TABLE[row][next] - TABLE[row][column]);
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
