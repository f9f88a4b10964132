//! Sums over the visible directions of the panorama grid.

use crate::{
    horizon::Horizon,
    panorama::{AZIMUTH_COUNT, ELEVATION_COUNT, elevation_rad, solid_angle_sr},
    seen_sky::SkyPart,
    spectrum::{NODE_COUNT, Response},
};
use std::f64::consts::PI;

/// Radius of the cap that "the zenith" means, radians (5°).
pub const ZENITH_CAP_RAD: f64 = 5.0 * PI / 180.0;

/// What is summed over the directions of one response.
pub(crate) struct Sums {
    pub(crate) zenith: f64,
    pub(crate) mean: f64,
    pub(crate) brightest: f64,
    pub(crate) brightest_row: usize,
    pub(crate) brightest_column: usize,
}

impl Sums {
    pub(crate) fn of(plane: &[f32], horizon: &Horizon) -> Self {
        let mut brightest = (0.0, horizon.first_visible_row(0).min(ELEVATION_COUNT - 1), 0);
        for (row, values) in plane.chunks_exact(AZIMUTH_COUNT).enumerate() {
            for (column, &value) in values.iter().enumerate() {
                if horizon.hides_sample(row, column) {
                    continue;
                }
                let value = f64::from(value);
                if value > brightest.0 {
                    brightest = (value, row, column);
                }
            }
        }
        Self {
            zenith: weighted_mean(plane, horizon, in_zenith_cap),
            mean: weighted_mean(plane, horizon, |_| 1.0),
            brightest: brightest.0,
            brightest_row: brightest.1,
            brightest_column: brightest.2,
        }
    }
}

/// Mean over the visible directions of a plane whose hidden samples are 0; `weight` of a direction given its angle to the zenith
/// [rad].
pub(crate) fn weighted_mean(plane: &[f32], horizon: &Horizon, weight: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for (row, values) in plane.chunks_exact(AZIMUTH_COUNT).enumerate() {
        let w = weight(PI / 2.0 - elevation_rad(row)) * solid_angle_sr(row);
        if w > 0.0 {
            total += w * visible_columns(horizon, row) as f64;
            sum += w * values.iter().map(|&value| f64::from(value)).sum::<f64>();
        }
    }
    if total > 0.0 { sum / total } else { 0.0 }
}

/// 1 in the cap that the zenith means, else 0.
pub(crate) fn in_zenith_cap(angle_rad: f64) -> f64 {
    if angle_rad <= ZENITH_CAP_RAD { 1.0 } else { 0.0 }
}

/// Number of columns whose sample in a row is sky.
pub(crate) fn visible_columns(horizon: &Horizon, row: usize) -> usize {
    (0..AZIMUTH_COUNT).filter(|&column| !horizon.hides_sample(row, column)).count()
}

/// Means of the parts' kernels over the visible directions, `weight` of a direction being that of its angle to the zenith [rad].
/// 0 where nothing with a weight is visible.
pub(crate) fn mean_kernels(
    parts: &[SkyPart],
    horizon: &Horizon,
    weight: impl Fn(f64) -> f64,
) -> Vec<[f64; NODE_COUNT]> {
    let weights: Vec<f64> =
        (0..ELEVATION_COUNT).map(|row| weight(PI / 2.0 - elevation_rad(row)) * solid_angle_sr(row)).collect();
    let total: f64 =
        weights.iter().enumerate().map(|(row, weight)| weight * visible_columns(horizon, row) as f64).sum();
    let mean = |part: &SkyPart, node: usize| {
        let lit = weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
        let sum: f64 = lit.map(|(row, weight)| weight * part.kernel.row_sum(node, row)).sum();
        if total > 0.0 { sum / total } else { 0.0 }
    };
    parts.iter().map(|part| std::array::from_fn(|node| mean(part, node))).collect()
}

/// What a response sees of lights behind their kernels.
pub(crate) fn value_of(parts: &[SkyPart], kernels: &[[f64; NODE_COUNT]], response: &Response) -> f64 {
    let of_parts = parts.iter().zip(kernels).map(|(part, kernel)| part.light.rule(response).value(*kernel));
    of_parts.fold(0.0, |sum, value| sum + value)
}
