//! Illuminance of ground of any slope by a sky (`docs/model.md#lit-ground`): in elevation the sum over the rows of the panorama, in
//! azimuth waves of the clamped cosine, in the spirit of Ramamoorthi and Hanrahan (2001).

use crate::panorama::{AZIMUTH_COUNT, ELEVATION_COUNT, azimuth_rad, cos_sr, projected_sr};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Waves over azimuth, those of order 0 to 8.
const WAVES: usize = 9;
/// Steepnesses of the table, from level ground to walls.
const STEEPNESSES: usize = 25;
/// Azimuths of the table.
const AZIMUTHS: usize = 64;

/// What ground of any slope receives of some planes of values over the sky, in their unit times sr. Below the horizontal plane it is
/// dark.
#[derive(Clone, Debug, PartialEq)]
pub struct LitSlopes<const N: usize> {
    /// `[steepness][azimuth]`.
    values: Vec<[f32; N]>,
}

impl<const N: usize> LitSlopes<N> {
    /// Of planes, `[row][column]`.
    pub fn of_planes(planes: [&[f32]; N]) -> Self {
        let (waves, side) = (rows_in_waves(planes), FRAC_PI_2 / (STEEPNESSES - 1) as f64);
        let of_azimuths: Vec<[[f64; 2]; WAVES]> =
            (0..AZIMUTHS).map(|at| wave_values(at as f64 * TAU / AZIMUTHS as f64)).collect();
        let mut values = Vec::with_capacity(STEEPNESSES * AZIMUTHS);
        for steepness in 0..STEEPNESSES {
            let (sin, cos) = (steepness as f64 * side).sin_cos();
            let mut sums = [[[0.0; 2]; WAVES]; N];
            for (row, of_row) in waves.iter().enumerate() {
                let received = clamped_waves(cos * projected_sr(row), sin * cos_sr(row));
                for (sums, of_row) in sums.iter_mut().zip(of_row) {
                    for ((sum, of_row), received) in sums.iter_mut().zip(of_row).zip(received) {
                        (0..2).for_each(|part| sum[part] += received * of_row[part]);
                    }
                }
            }
            values.extend(of_azimuths.iter().map(|azimuth| {
                std::array::from_fn(|plane| {
                    let waves = sums[plane].iter().zip(azimuth);
                    waves.map(|(sum, of)| sum[0] * of[0] + sum[1] * of[1]).sum::<f64>().max(0.0) as f32
                })
            }));
        }
        Self { values }
    }

    /// Of ground that is so steep, radians, and falls towards an azimuth.
    pub fn illuminance(&self, steepness_rad: f64, downhill_azimuth_rad: f64) -> [f64; N] {
        let steepness = (steepness_rad / FRAC_PI_2).clamp(0.0, 1.0) * (STEEPNESSES - 1) as f64;
        let turns = downhill_azimuth_rad * (1.0 / TAU);
        let azimuth = (turns - turns.floor()) * AZIMUTHS as f64;
        let (low, left) = ((steepness as usize).min(STEEPNESSES - 2), azimuth as usize % AZIMUTHS);
        let (s, t) = (steepness - low as f64, azimuth - azimuth.floor());
        let right = (left + 1) % AZIMUTHS;
        let at = |steepness: usize, azimuth: usize| &self.values[steepness * AZIMUTHS + azimuth];
        let four = [at(low, left), at(low, right), at(low + 1, left), at(low + 1, right)];
        let weights = [(1.0 - s) * (1.0 - t), (1.0 - s) * t, s * (1.0 - t), s * t];
        std::array::from_fn(|plane| {
            four.iter().zip(weights).map(|(value, weight)| weight * f64::from(value[plane])).sum()
        })
    }
}

/// cos mφ and sin mφ.
fn wave_values(azimuth_rad: f64) -> [[f64; 2]; WAVES] {
    std::array::from_fn(|order| {
        let (sin, cos) = (order as f64 * azimuth_rad).sin_cos();
        [cos, sin]
    })
}

/// Σ L cos mφ and Σ L sin mφ of every row.
fn rows_in_waves<const N: usize>(planes: [&[f32]; N]) -> Vec<[[[f64; 2]; WAVES]; N]> {
    let columns: Vec<[[f64; 2]; WAVES]> =
        (0..AZIMUTH_COUNT).map(|column| wave_values(azimuth_rad(column))).collect();
    let of_row = |row: usize| {
        planes.map(|plane| {
            let mut sums = [[0.0; 2]; WAVES];
            let values = plane.get(row * AZIMUTH_COUNT..(row + 1) * AZIMUTH_COUNT).unwrap_or_default();
            for (value, column) in values.iter().zip(&columns) {
                for (sum, of) in sums.iter_mut().zip(column) {
                    (0..2).for_each(|part| sum[part] += f64::from(*value) * of[part]);
                }
            }
            sums
        })
    };
    (0..ELEVATION_COUNT).map(of_row).collect()
}

/// Waves of max(0, up + along·cos x).
fn clamped_waves(up: f64, along: f64) -> [f64; WAVES] {
    // Light from azimuths beyond comes from behind the slope.
    let end = if along <= up { PI } else { (-up / along).acos() };
    let over = |order: f64| if order == 0.0 { end } else { (order * end).sin() / order };
    std::array::from_fn(|order| {
        let order = order as f64;
        let integral = up * over(order) + 0.5 * along * (over(order - 1.0) + over(order + 1.0));
        if order == 0.0 { integral / PI } else { 2.0 * integral / PI }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{panorama::elevation_rad, surfaces::Slope};

    fn direct(plane: &[f32], slope: Slope) -> f64 {
        let normal = slope.normal();
        let sample = |at: usize| {
            let (row, column) = (at / AZIMUTH_COUNT, at % AZIMUTH_COUNT);
            let (sin, cos) = azimuth_rad(column).sin_cos();
            let along = cos_sr(row) * (normal.x * sin + normal.y * cos);
            f64::from(plane[at]) * (normal.z * projected_sr(row) + along).max(0.0)
        };
        (0..plane.len()).map(sample).sum()
    }

    /// Under a uniform sky and under the glow of a town, level ground, slopes and walls receive what the sum over directions says
    /// within 0.5 % of level ground, and each plane its own.
    #[test]
    fn slopes_receive_what_the_sky_sends() {
        let glow = |at: usize| {
            let (row, column) = (at / AZIMUTH_COUNT, at % AZIMUTH_COUNT);
            let towards = azimuth_rad(column).cos();
            (1e-4 + 1e-3 * (4.0 * (towards - 1.0) - 5.0 * elevation_rad(row)).exp()) as f32
        };
        let count = ELEVATION_COUNT * AZIMUTH_COUNT;
        let planes = [vec![1e-3; count], (0..count).map(glow).collect::<Vec<f32>>()];
        let lit = LitSlopes::of_planes([&planes[0], &planes[1]]);
        for (nth, plane) in planes.iter().enumerate() {
            let level = direct(plane, Slope::default());
            for steepness_rad in [0.0, 0.05, 0.3, 0.78, 1.2, FRAC_PI_2] {
                for downhill_azimuth_rad in [0.0, 1.0, 2.0, 3.0, 6.25] {
                    let slope = Slope { steepness_rad, downhill_azimuth_rad };
                    let error =
                        lit.illuminance(steepness_rad, downhill_azimuth_rad)[nth] - direct(plane, slope);
                    assert!(error.abs() < 0.005 * level, "{nth} {slope:?}: {error} of {level}");
                }
            }
        }
    }

    /// A planted fault is found: a sky turned by a quarter lights other slopes.
    #[test]
    fn a_turned_sky_lights_other_slopes() {
        let lit = |first: usize| {
            let of = |at: usize| {
                let column = (at + AZIMUTH_COUNT - first) % AZIMUTH_COUNT;
                if at / AZIMUTH_COUNT < 20 && column < 20 { 1.0 } else { 0.0 }
            };
            (0..ELEVATION_COUNT * AZIMUTH_COUNT).map(of).collect::<Vec<f32>>()
        };
        let [straight, turned] =
            [0, 64].map(|first| LitSlopes::of_planes([&lit(first)]).illuminance(0.78, 0.2)[0]);
        assert!(straight > 1.5 * turned, "{straight} {turned}");
    }
}
