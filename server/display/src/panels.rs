//! Bilinear sampling along the rows of an equirectangular picture: every pixel of a row lies between the same two rows of the
//! panorama, every pixel of a column between the same two columns. The same as [`taps`] pixel by pixel, to rounding.

use crate::projection::View;
use skyglow_physics::{AZIMUTH_COUNT, Direction, sampler::taps};
use std::ops::Range;

/// Where a picture's columns lie between the panorama's.
pub(crate) struct Columns {
    /// The panorama's column on the left, the one on the right, and how much of the way from one to the other.
    between: Vec<(usize, usize, f64)>,
    runs: Vec<Run>,
}

/// Columns of a picture side by side that lie between the same two of the panorama.
pub(crate) struct Run {
    pub(crate) columns: Range<usize>,
    pub(crate) left: usize,
    pub(crate) right: usize,
}

impl Columns {
    /// Of a picture `width_px` wide; None where the view is not equirectangular.
    pub(crate) fn new(view: &View, width_px: u32) -> Option<Self> {
        let column = |x: u32| {
            let azimuth_rad = view.direction_at(f64::from(x) + 0.5, 0.5)?.azimuth_rad;
            let taps = taps(Direction { azimuth_rad, elevation_rad: 0.5 })?;
            let [left, right] = [0, 1].map(|tap| taps.offset[tap] % AZIMUTH_COUNT);
            Some((left, right, (taps.weight[1] + taps.weight[3]).min(1.0)))
        };
        let between = (0..width_px).map(column).collect::<Option<Vec<_>>>()?;
        let mut runs: Vec<Run> = Vec::new();
        for (x, &(left, right, _)) in between.iter().enumerate() {
            match runs.last_mut().filter(|run| run.left == left) {
                Some(run) => run.columns.end = x + 1,
                None => runs.push(Run { columns: x..x + 1, left, right }),
            }
        }
        Some(Self { between, runs })
    }

    /// All columns, by what they lie between.
    pub(crate) fn runs(&self) -> &[Run] {
        &self.runs
    }
}

/// A row of a picture: the panorama's values at its elevation, by column of the panorama.
pub(crate) struct Row(pub(crate) [f64; AZIMUTH_COUNT]);

impl Row {
    /// * `values`: `[row][column]` of the panorama.
    pub(crate) fn new(values: &[f64], elevation_rad: f64) -> Option<Self> {
        // Between columns nothing is asked: the taps on the left alone.
        let taps = taps(Direction { azimuth_rad: 0.0, elevation_rad })?;
        let (low, high) = (taps.offset[0] / AZIMUTH_COUNT, taps.offset[2] / AZIMUTH_COUNT);
        let turn = taps.offset[2] % AZIMUTH_COUNT;
        let up = taps.weight[2] + taps.weight[3];
        let row = |row: usize| &values[row * AZIMUTH_COUNT..(row + 1) * AZIMUTH_COUNT];
        let (low, high) = (row(low), row(high));
        let value = |column: usize| {
            let above = high[(column + turn) % AZIMUTH_COUNT];
            (1.0 - up) * low[column] + up * above
        };
        Some(Self(std::array::from_fn(value)))
    }

    /// The value in a column of the picture.
    #[inline(always)]
    pub(crate) fn at(&self, columns: &Columns, x: usize) -> f64 {
        let (left, right, along) = columns.between[x];
        self.0[left] + along * (self.0[right] - self.0[left])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Projection;
    use skyglow_physics::ELEVATION_COUNT;

    /// Rows and columns give what taps give at every pixel.
    #[test]
    fn separable_sampling_equals_pixel_sampling() {
        let values: Vec<f64> =
            (0..ELEVATION_COUNT * AZIMUTH_COUNT).map(|i| 1.0 + ((i * 7919) % 1009) as f64).collect();
        for (width, height) in [(1024, 256), (256, 64), (100, 37)] {
            let view = View::new(Projection::Equirectangular, width, height);
            let columns = Columns::new(&view, width).unwrap();
            for y in 0..height {
                let elevation_rad = view.direction_at(0.5, f64::from(y) + 0.5).unwrap().elevation_rad;
                let row = Row::new(&values, elevation_rad).unwrap();
                for x in 0..width {
                    let direction = view.direction_at(f64::from(x) + 0.5, f64::from(y) + 0.5).unwrap();
                    let taps = taps(direction).unwrap();
                    let wanted: f64 = (0..4).map(|tap| taps.weight[tap] * values[taps.offset[tap]]).sum();
                    let got = row.at(&columns, x as usize);
                    assert!((got - wanted).abs() < 1e-9, "{x} {y}: {got} {wanted}");
                }
            }
        }
    }
}
