//! Bilinear sampling of a sky at any direction.

use crate::panorama::{AZIMUTH_COUNT, Direction, ELEVATION_COUNT};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The four grid samples around a direction, with weights that sum to 1.
#[derive(Clone, Copy, Debug)]
pub struct Taps {
    /// `row · AZIMUTH_COUNT + column` of each sample.
    pub offset: [usize; 4],
    /// Weight of each sample.
    pub weight: [f64; 4],
}

/// The samples around a direction; None below the horizon.
///
/// Columns wrap. Above the highest row, half a step below the zenith, the row beyond is the same row seen
/// across the zenith (azimuth + 180°), so the sky is continuous there. Below the lowest row, half a step
/// above the horizon, the lowest row holds.
#[inline]
pub fn taps(direction: Direction) -> Option<Taps> {
    let Direction { azimuth_rad, elevation_rad } = direction;
    if !((0.0..=FRAC_PI_2 + 1e-9).contains(&elevation_rad) && azimuth_rad.is_finite()) {
        return None;
    }
    let turns = azimuth_rad * (1.0 / TAU);
    let column = (turns - turns.floor()) * AZIMUTH_COUNT as f64;
    let left = column.floor();
    let right_weight = column - left;
    let left = left as usize % AZIMUTH_COUNT;
    let right = (left + 1) % AZIMUTH_COUNT;

    let row =
        (elevation_rad * (ELEVATION_COUNT as f64 / FRAC_PI_2) - 0.5).clamp(0.0, ELEVATION_COUNT as f64 - 0.5);
    let low = (row.floor() as usize).min(ELEVATION_COUNT - 1);
    let high_weight = row - low as f64;
    // The row above: itself, or across the zenith.
    let (high, turn) = if low + 1 < ELEVATION_COUNT { (low + 1, 0) } else { (low, AZIMUTH_COUNT / 2) };
    let at = |row: usize, column: usize| row * AZIMUTH_COUNT + column % AZIMUTH_COUNT;
    Some(Taps {
        offset: [at(low, left), at(low, right), at(high, left + turn), at(high, right + turn)],
        weight: [
            (1.0 - high_weight) * (1.0 - right_weight),
            (1.0 - high_weight) * right_weight,
            high_weight * (1.0 - right_weight),
            high_weight * right_weight,
        ],
    })
}

/// Planes of a sky ready to be looked at in any direction.
#[derive(Clone, Copy, Debug)]
pub struct Sampler<'a, const PLANES: usize = 3> {
    planes: [&'a [f32]; PLANES],
}

impl<'a, const PLANES: usize> Sampler<'a, PLANES> {
    /// Looks at planes, `[row][column]` each.
    #[inline]
    pub fn new(planes: [&'a [f32]; PLANES]) -> Self {
        Self { planes }
    }

    /// The value of each plane, in its unit; None below the horizon.
    #[inline]
    pub fn values(&self, direction: Direction) -> Option<[f64; PLANES]> {
        let taps = taps(direction)?;
        Some(std::array::from_fn(|plane| {
            let values = self.planes[plane];
            (0..4).map(|tap| taps.weight[tap] * f64::from(values[taps.offset[tap]])).sum()
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::panorama::{azimuth_rad, elevation_rad};

    const COUNT: usize = ELEVATION_COUNT * AZIMUTH_COUNT;

    fn numbered() -> Vec<f32> {
        (0..3 * COUNT).map(|i| i as f32).collect()
    }

    fn sampler(values: &[f32]) -> Sampler<'_> {
        Sampler::new(std::array::from_fn(|plane| &values[plane * COUNT..][..COUNT]))
    }

    fn at(plane: usize, row: usize, column: usize) -> usize {
        plane * COUNT + row * AZIMUTH_COUNT + column
    }

    #[test]
    fn a_grid_direction_gives_exactly_its_sample() {
        let values = numbered();
        let sampler = sampler(&values);
        for (row, column) in [(0, 0), (63, 255), (17, 128), (63, 0)] {
            let direction = Direction { azimuth_rad: azimuth_rad(column), elevation_rad: elevation_rad(row) };
            let seen = sampler.values(direction).unwrap();
            for (band, value) in seen.iter().enumerate() {
                let expected = f64::from(values[at(band, row, column)]);
                assert!((value - expected).abs() < 1e-6 * expected.max(1.0), "{row} {column} {band}");
            }
        }
    }

    /// Between the last and the first column the sky wraps.
    #[test]
    fn azimuth_wraps_at_the_last_column() {
        let mut values = vec![0.0; 3 * COUNT];
        values[at(0, 5, 255)] = 2.0;
        values[at(0, 5, 0)] = 4.0;
        let direction =
            Direction { azimuth_rad: azimuth_rad(255) + TAU / 512.0, elevation_rad: elevation_rad(5) };
        let seen = sampler(&values).values(direction).unwrap();
        assert!((seen[0] - 3.0).abs() < 1e-9, "{seen:?}");
    }

    #[test]
    fn the_sky_is_continuous_across_the_zenith() {
        // A gradient from south to north: L = 10 + x with x the northward component of the direction.
        let mut values = vec![0.0; 3 * COUNT];
        for row in 0..ELEVATION_COUNT {
            for column in 0..AZIMUTH_COUNT {
                let v =
                    Direction { azimuth_rad: azimuth_rad(column), elevation_rad: elevation_rad(row) }.enu();
                values[at(1, row, column)] = (10.0 + v.y) as f32;
            }
        }
        let sampler = sampler(&values);
        for azimuth in [0.0, 0.7, 2.0, 4.5] {
            for offset_deg in [0.0, 0.1, 0.35, 0.69, 0.71] {
                let direction = Direction {
                    azimuth_rad: azimuth,
                    elevation_rad: FRAC_PI_2 - f64::to_radians(offset_deg),
                };
                let value = sampler.values(direction).unwrap()[1];
                let exact = 10.0 + direction.enu().y;
                assert!((value - exact).abs() < 2e-5, "{azimuth} {offset_deg}: {value} {exact}");
            }
        }
    }

    /// Nothing is seen below the horizon and the lowest row reaches down to it.
    #[test]
    fn the_lowest_row_reaches_the_horizon() {
        let values = numbered();
        let sampler = sampler(&values);
        let at = |elevation_rad| sampler.values(Direction { azimuth_rad: 0.0, elevation_rad });
        assert_eq!(at(-1e-6), None);
        assert_eq!(at(f64::NAN), None);
        assert_eq!(at(0.0), at(elevation_rad(0)));
    }
}
