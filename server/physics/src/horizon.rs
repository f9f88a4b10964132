//! The skyline of an observer: in which directions the ground hides the sky (`docs/model.md#horizon`).
//!
//! A terrain point at altitude h and arc distance d is seen from an eye at altitude h_o at the elevation e with
//!
//! ```text
//! tan e = ((R + h)·cos α − (R + h_o)) / ((R + h)·sin α),    α = d / R
//! ```
//!
//! the exact angle on the sphere of radius R = [`EARTH_RADIUS_M`]; the Earth's curvature is in it, refraction is
//! not. It grows with h. For a point above the eye's level plane (e > 0) it falls with d, so the highest altitude
//! of a stretch of ground, put at the stretch's near end, bounds the whole stretch from above.

use crate::{
    bands::BAND_COUNT,
    error::{PhysicsError, check_range},
    geometry::EARTH_RADIUS_M,
    panorama::{AZIMUTH_COUNT, Direction, ELEVATION_COUNT, Panorama, elevation_rad},
};
use std::f64::consts::{FRAC_PI_2, TAU};

/// tan e of a terrain point: the tangent of its elevation above the observer's horizontal plane, no unit.
///
/// * `observer_altitude_m`, `terrain_altitude_m`: metres above the sphere.
/// * `distance_m`: great-circle arc at radius R, metres, above 0 and below a quarter of the Earth.
pub fn terrain_elevation_tangent(observer_altitude_m: f64, terrain_altitude_m: f64, distance_m: f64) -> f64 {
    let (sin_arc, cos_arc) = (distance_m / EARTH_RADIUS_M).sin_cos();
    let radius_m = EARTH_RADIUS_M + terrain_altitude_m;
    (radius_m * cos_arc - (EARTH_RADIUS_M + observer_altitude_m)) / (radius_m * sin_arc)
}

/// Arc distance [m] beyond which terrain of at most `highest_altitude_m` stays below the observer's horizontal plane:
/// R·acos((R + h_o) / (R + h)). 0 where nothing is higher than the observer.
pub fn farthest_terrain_m(observer_altitude_m: f64, highest_altitude_m: f64) -> f64 {
    if highest_altitude_m <= observer_altitude_m {
        return 0.0;
    }
    // acos of nearly 1 loses half of the digits: by the half angle instead, 1 − cos α = 2·sin²(α/2).
    let drop = (highest_altitude_m - observer_altitude_m) / (EARTH_RADIUS_M + highest_altitude_m);
    EARTH_RADIUS_M * 2.0 * (0.5 * drop).sqrt().asin()
}

/// Elevations below which the ground hides the sky, one for each column of the panorama.
///
/// Column i is at azimuth i·360/256 degrees clockwise from north, as in [`Panorama`]; each elevation is in radians,
/// 0..=π/2: the ground never shows sky below the horizontal plane. A point sample at the column's azimuth, not a mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Horizon {
    elevation_rad: Vec<f64>,
}

impl Default for Horizon {
    fn default() -> Self {
        Self::flat()
    }
}

impl Horizon {
    /// Nothing is hidden: 0 in every column.
    pub fn flat() -> Self {
        Self { elevation_rad: vec![0.0; AZIMUTH_COUNT] }
    }

    /// From the elevation of each column, radians.
    ///
    /// # Errors
    /// [`PhysicsError`] naming `horizon` unless there are 256 values, each 0 to π/2.
    pub fn new(elevation_rad: Vec<f64>) -> Result<Self, PhysicsError> {
        if elevation_rad.len() != AZIMUTH_COUNT {
            let reason = format!("{} elevations, {AZIMUTH_COUNT} are needed", elevation_rad.len());
            return Err(PhysicsError::Invalid { parameter: "horizon", reason });
        }
        for &value in &elevation_rad {
            check_range("horizon", value, 0.0, FRAC_PI_2, "rad")?;
        }
        Ok(Self { elevation_rad })
    }

    /// From tan e of the highest ground in each column, as [`terrain_elevation_tangent`] has it; ground below the
    /// horizontal plane (or none, or NaN) hides nothing.
    pub fn from_tangents(tangents: &[f64; AZIMUTH_COUNT]) -> Self {
        Self { elevation_rad: tangents.iter().map(|tangent| tangent.max(0.0).atan()).collect() }
    }

    /// Whether nothing is hidden.
    pub fn is_flat(&self) -> bool {
        self.elevation_rad.iter().all(|&elevation| elevation == 0.0)
    }

    /// The elevation of each column, radians.
    pub fn elevations_rad(&self) -> &[f64] {
        &self.elevation_rad
    }

    /// The elevation at any azimuth [rad], radians: linear between the columns, exact at them.
    pub fn elevation_at_rad(&self, azimuth_rad: f64) -> f64 {
        let turns = azimuth_rad * (1.0 / TAU);
        let column = (turns - turns.floor()) * AZIMUTH_COUNT as f64;
        // Dividing a column's own azimuth by 2π may round its last digit either way.
        let nearest = column.round();
        let column = if (column - nearest).abs() < 1e-9 { nearest } else { column };
        let weight = column - column.floor();
        let left = column.floor() as usize % AZIMUTH_COUNT;
        let (low, high) = (self.elevation_rad[left], self.elevation_rad[(left + 1) % AZIMUTH_COUNT]);
        low + weight * (high - low)
    }

    /// Whether a direction is below the horizon. On it counts as sky.
    pub fn hides(&self, direction: Direction) -> bool {
        direction.elevation_rad < self.elevation_at_rad(direction.azimuth_rad)
    }

    /// Whether the sample of a panorama at (row, column) is ground: its elevation is below that column's horizon.
    pub fn hides_sample(&self, row: usize, column: usize) -> bool {
        elevation_rad(row) < self.elevation_rad[column]
    }

    /// The lowest row of a column that shows sky, 0..=64; 64 where none does.
    pub fn first_visible_row(&self, column: usize) -> usize {
        (0..ELEVATION_COUNT).find(|&row| !self.hides_sample(row, column)).unwrap_or(ELEVATION_COUNT)
    }

    /// Makes the ground of a panorama dark: radiance 0 in every hidden sample. Visible samples stay bit for bit.
    pub fn darken(&self, panorama: &mut Panorama) {
        for column in 0..AZIMUTH_COUNT {
            for row in 0..self.first_visible_row(column) {
                for band in 0..BAND_COUNT {
                    panorama.samples_mut()[Panorama::index(band, row, column)] = 0.0;
                }
            }
        }
    }
}

#[cfg(test)]
#[path = "horizon_tests.rs"]
mod tests;
