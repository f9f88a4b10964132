//! Irradiance of ground of any slope by nine spherical harmonics of the sky (Ramamoorthi and Hanrahan 2001;
//! `docs/model.md#lit-ground`).

use crate::panorama::{AZIMUTH_COUNT, ELEVATION_COUNT, azimuth_rad, elevation_rad, solid_angle_sr};
use glam::DVec3;
use std::f64::consts::PI;

const COUNT: usize = 9;
/// Factors of the convolution with the clamped cosine, by degree.
const COSINE: [f64; COUNT] = {
    let (two_thirds, quarter) = (2.0 * PI / 3.0, PI / 4.0);
    [PI, two_thirds, two_thirds, two_thirds, quarter, quarter, quarter, quarter, quarter]
};

/// Nine coefficients of the irradiance of a plane of values over the sky, of which the lower half of the sphere is dark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyHarmonics([f64; COUNT]);

impl SkyHarmonics {
    /// Of `[row][column]`.
    pub fn of_plane(plane: &[f32]) -> Self {
        let mut sums = [0.0; COUNT];
        let columns: [(f64, f64); AZIMUTH_COUNT] =
            std::array::from_fn(|column| azimuth_rad(column).sin_cos());
        for (row, values) in plane.chunks_exact(AZIMUTH_COUNT).take(ELEVATION_COUNT).enumerate() {
            let (sin, cos) = elevation_rad(row).sin_cos();
            let cell_sr = solid_angle_sr(row);
            for (value, (sin_azimuth, cos_azimuth)) in values.iter().zip(columns) {
                let of = basis(DVec3::new(cos * sin_azimuth, cos * cos_azimuth, sin));
                let weight = f64::from(*value) * cell_sr;
                sums.iter_mut().zip(of).for_each(|(sum, basis)| *sum += weight * basis);
            }
        }
        Self(std::array::from_fn(|i| COSINE[i] * sums[i]))
    }

    /// With beams, by the direction that they come from and their irradiance across.
    #[must_use]
    pub fn with_beams(mut self, beams: impl Iterator<Item = (DVec3, f64)>) -> Self {
        for (towards, irradiance) in beams {
            let of = basis(towards);
            for (i, coefficient) in self.0.iter_mut().enumerate() {
                *coefficient += COSINE[i] * irradiance * of[i];
            }
        }
        self
    }

    /// Irradiance of a surface by its unit normal (east, north, up), in the unit of the values times sr.
    pub fn irradiance(&self, normal: DVec3) -> f64 {
        let of = basis(normal);
        self.0.iter().zip(of).map(|(coefficient, basis)| coefficient * basis).sum::<f64>().max(0.0)
    }
}

/// Real spherical harmonics of degrees 0 to 2, orthonormal.
fn basis(v: DVec3) -> [f64; COUNT] {
    let DVec3 { x, y, z } = v;
    let first = 0.488_602_511_902_919_9;
    let second = 1.092_548_430_592_079_2;
    [
        0.282_094_791_773_878_14,
        first * y,
        first * z,
        first * x,
        second * x * y,
        second * y * z,
        0.315_391_565_252_520_05 * (3.0 * z * z - 1.0),
        second * x * z,
        0.546_274_215_296_039_6 * (x * x - y * y),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{panorama::Direction, surfaces::Slope};

    fn direct(plane: &[f32], normal: DVec3) -> f64 {
        let sample = |at: usize| {
            let (row, column) = (at / AZIMUTH_COUNT, at % AZIMUTH_COUNT);
            let v = Direction { azimuth_rad: azimuth_rad(column), elevation_rad: elevation_rad(row) }.enu();
            f64::from(plane[at]) * v.dot(normal).max(0.0) * solid_angle_sr(row)
        };
        (0..plane.len()).map(sample).sum()
    }

    /// Under a uniform sky and under the glow of a town, slopes of up to 45° receive what the sum over directions says within 4 %.
    #[test]
    fn slopes_receive_what_the_sky_sends() {
        let glow = |at: usize| {
            let (row, column) = (at / AZIMUTH_COUNT, at % AZIMUTH_COUNT);
            let towards = azimuth_rad(column).cos();
            (1e-4 + 1e-3 * (4.0 * (towards - 1.0) - 5.0 * elevation_rad(row)).exp()) as f32
        };
        let count = ELEVATION_COUNT * AZIMUTH_COUNT;
        for plane in [vec![1e-3; count], (0..count).map(glow).collect::<Vec<f32>>()] {
            let harmonics = SkyHarmonics::of_plane(&plane);
            let level = direct(&plane, DVec3::Z);
            for steepness_rad in [0.0, 0.3, 0.78] {
                for downhill_azimuth_rad in [0.0, 1.0, 2.0, 3.0] {
                    let normal = Slope { steepness_rad, downhill_azimuth_rad }.normal();
                    let error = harmonics.irradiance(normal) - direct(&plane, normal);
                    assert!(error.abs() < 0.04 * level, "{steepness_rad} {downhill_azimuth_rad}: {error}");
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
        let normal = Slope { steepness_rad: 0.78, downhill_azimuth_rad: 0.2 }.normal();
        let [straight, turned] = [0, 64].map(|first| SkyHarmonics::of_plane(&lit(first)).irradiance(normal));
        assert!(straight > 1.5 * turned, "{straight} {turned}");
    }
}
