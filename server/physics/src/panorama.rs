//! The panorama grid: point samples of radiance at fixed directions.

use crate::bands::BAND_COUNT;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// N_θ: columns, at azimuth i·360/256 degrees clockwise from north; column 0 is north.
pub const AZIMUTH_COUNT: usize = 256;
/// N_φ: rows, at elevation (j + ½)·90/64 degrees; row 0 is lowest.
pub const ELEVATION_COUNT: usize = 64;

/// A view direction at the observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// Radians clockwise from north.
    pub azimuth_rad: f64,
    /// Radians above the horizontal plane, 0..π/2.
    pub elevation_rad: f64,
}

impl Direction {
    /// Components (east, north, up).
    pub fn enu(self) -> DVec3 {
        let (sin_az, cos_az) = self.azimuth_rad.sin_cos();
        let (sin_el, cos_el) = self.elevation_rad.sin_cos();
        DVec3::new(sin_az * cos_el, cos_az * cos_el, sin_el)
    }

    /// Row and column of the sample nearest to a direction above the horizon.
    pub fn nearest_sample(self) -> (usize, usize) {
        let row = (self.elevation_rad / FRAC_PI_2 * ELEVATION_COUNT as f64) as usize;
        let column = (self.azimuth_rad.rem_euclid(TAU) / TAU * AZIMUTH_COUNT as f64).round() as usize;
        (row.min(ELEVATION_COUNT - 1), column % AZIMUTH_COUNT)
    }
}

/// Azimuth of a column's samples, radians.
pub fn azimuth_rad(column: usize) -> f64 {
    column as f64 * TAU / AZIMUTH_COUNT as f64
}

/// Elevation of a row's samples, radians.
pub fn elevation_rad(row: usize) -> f64 {
    (row as f64 + 0.5) * FRAC_PI_2 / ELEVATION_COUNT as f64
}

/// Solid angle of the grid cell around any sample in `row`, sr. All rows and columns sum to 2π.
pub fn solid_angle_sr(row: usize) -> f64 {
    let step = FRAC_PI_2 / ELEVATION_COUNT as f64;
    let (low, high) = (row as f64 * step, (row + 1) as f64 * step);
    TAU / AZIMUTH_COUNT as f64 * (high.sin() - low.sin())
}

/// ∫ sin φ dΩ over the grid cell around any sample in `row`, sr: exact, so that a uniform sky gives E = πL.
pub fn projected_sr(row: usize) -> f64 {
    let step = FRAC_PI_2 / ELEVATION_COUNT as f64;
    let (low, high) = (row as f64 * step, (row + 1) as f64 * step);
    TAU / AZIMUTH_COUNT as f64 * 0.5 * (high.sin() * high.sin() - low.sin() * low.sin())
}

/// ∫ cos φ dΩ over the grid cell around any sample in `row`, sr: exact, so that a uniform sky gives walls ½πL.
pub fn cos_sr(row: usize) -> f64 {
    let step = FRAC_PI_2 / ELEVATION_COUNT as f64;
    let integral = |e: f64| 0.5 * e + 0.25 * (2.0 * e).sin();
    TAU / AZIMUTH_COUNT as f64 * (integral((row + 1) as f64 * step) - integral(row as f64 * step))
}

/// Spectral-band radiance of the whole upper hemisphere, W m⁻² sr⁻¹ in each band.
///
/// Shape `[band][row][column]`, bands as in [`crate::Band::ALL`]; row 0 lowest; column 0 north.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    radiance_w_m2_sr: Vec<f32>,
}

impl Panorama {
    /// Number of samples: bands × rows × columns.
    pub const LEN: usize = BAND_COUNT * ELEVATION_COUNT * AZIMUTH_COUNT;

    /// A dark sky.
    pub fn dark() -> Self {
        Self { radiance_w_m2_sr: vec![0.0; Self::LEN] }
    }

    /// From samples in `[band][row][column]` order; None unless there are exactly [`Self::LEN`].
    pub fn from_samples(radiance_w_m2_sr: Vec<f32>) -> Option<Self> {
        (radiance_w_m2_sr.len() == Self::LEN).then_some(Self { radiance_w_m2_sr })
    }

    /// Position of a sample in [`Self::samples`].
    pub const fn index(band: usize, row: usize, column: usize) -> usize {
        (band * ELEVATION_COUNT + row) * AZIMUTH_COUNT + column
    }

    /// Radiance of one sample, W m⁻² sr⁻¹.
    pub fn radiance_w_m2_sr(&self, band: usize, row: usize, column: usize) -> f64 {
        f64::from(self.radiance_w_m2_sr[Self::index(band, row, column)])
    }

    /// All samples in `[band][row][column]` order.
    pub fn samples(&self) -> &[f32] {
        &self.radiance_w_m2_sr
    }

    /// All samples, writable.
    pub fn samples_mut(&mut self) -> &mut [f32] {
        &mut self.radiance_w_m2_sr
    }

    /// Sum over the samples of a row in one band, W m⁻² sr⁻¹.
    pub fn row_sum(&self, band: usize, row: usize) -> f64 {
        let start = Self::index(band, row, 0);
        self.radiance_w_m2_sr[start..start + AZIMUTH_COUNT].iter().map(|&value| f64::from(value)).sum()
    }

    /// Luminance of one sample, cd m⁻², by one efficacy a band: what errors of the engine are measured in.
    pub fn luminance_cd_m2(&self, row: usize, column: usize) -> f64 {
        crate::photometry::luminance_cd_m2(std::array::from_fn(|band| {
            self.radiance_w_m2_sr(band, row, column)
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solid_angles_cover_the_hemisphere() {
        let total: f64 = (0..ELEVATION_COUNT).map(|row| solid_angle_sr(row) * AZIMUTH_COUNT as f64).sum();
        assert!((total - TAU).abs() < 1e-12);
    }

    #[test]
    fn column_0_looks_north_and_column_64_east() {
        let at = |column| Direction { azimuth_rad: azimuth_rad(column), elevation_rad: 0.0 }.enu();
        assert!((at(0) - DVec3::Y).length() < 1e-15);
        assert!((at(64) - DVec3::X).length() < 1e-15);
    }
}
