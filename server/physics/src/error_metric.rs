//! Relative error of a fast answer, with a floor below what can be seen (`docs/model.md#error`).

use crate::{bands::BAND_COUNT, photometry::luminance_cd_m2};
use serde::{Deserialize, Serialize};

/// Floor L₀ of the error in luminance, cd m⁻²: 1 % of the natural sky.
pub const LUMINANCE_FLOOR_CD_M2: f64 = 1.7e-6;
/// Floor L₀ of the error in a band, W m⁻² sr⁻¹.
pub const BAND_FLOOR_W_M2_SR: f64 = 3e-9;

/// |L − L_ref| / max(L_ref, L₀), the worst of the luminance and the bands; radiances W m⁻² sr⁻¹.
pub fn relative_error(radiance: [f64; BAND_COUNT], reference: [f64; BAND_COUNT]) -> f64 {
    let error = |value: f64, reference: f64, floor: f64| (value - reference).abs() / reference.max(floor);
    let mut worst = error(luminance_cd_m2(radiance), luminance_cd_m2(reference), LUMINANCE_FLOOR_CD_M2);
    for band in 0..BAND_COUNT {
        worst = worst.max(error(radiance[band], reference[band], BAND_FLOOR_W_M2_SR));
    }
    worst
}

/// Error statistics over directions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorStatistics {
    /// Number of directions.
    pub directions: usize,
    /// Mean.
    pub mean: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest.
    pub maximum: f64,
}

impl ErrorStatistics {
    /// Of a list of relative errors; None of an empty one. An error that is not a number counts as infinite.
    pub fn of(errors: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> =
            errors.into_iter().map(|e| if e.is_nan() { f64::INFINITY } else { e }).collect();
        sorted.sort_by(f64::total_cmp);
        let maximum = *sorted.last()?;
        Some(Self {
            directions: sorted.len(),
            mean: sorted.iter().sum::<f64>() / sorted.len() as f64,
            p99: sorted[(sorted.len() * 99 / 100).min(sorted.len() - 1)],
            maximum,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::Band;

    /// The worst band counts, and errors below the floor of visibility do not.
    #[test]
    fn worst_band_counts_above_the_floor() {
        let shortest = Band::SHORTEST.index();
        let (dark, mut brighter, mut faint) = ([0.0; BAND_COUNT], [1e-6; BAND_COUNT], [0.0; BAND_COUNT]);
        (brighter[shortest], faint[shortest]) = (1.3e-6, 3e-10);
        assert!((relative_error(brighter, [1e-6; BAND_COUNT]) - 0.3).abs() < 1e-12);
        assert!((relative_error(faint, dark) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn statistics_never_hide_a_nan() {
        assert_eq!(ErrorStatistics::of([]), None);
        assert_eq!(ErrorStatistics::of([0.1, f64::NAN]).unwrap().maximum, f64::INFINITY);
        assert!((ErrorStatistics::of([0.1, 0.3]).unwrap().mean - 0.2).abs() < 1e-12);
    }
}
