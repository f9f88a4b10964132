//! Illuminance of surfaces by their orientation: horizontal, sloping, vertical, cylindrical and spherical (EN 12665:2018;
//! `docs/model.md#surfaces`).
//!
//! All are integrals of the sky's luminance L over the directions v that a surface of normal n faces, ∫ L max(0, n·v) dΩ, or means
//! of that over the sides of a small upright cylinder (¹⁄π ∫ L cos e dΩ) and over a small sphere (¼ ∫ L dΩ).

use crate::{
    horizon::Horizon,
    panorama::{
        AZIMUTH_COUNT, Direction, ELEVATION_COUNT, azimuth_rad, cos_sr, projected_sr, solid_angle_sr,
    },
    spectrum::{Light, NODE_COUNT, Response},
};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::{f64::consts::PI, sync::Arc};

/// How the ground lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Slope {
    /// Angle to the horizontal plane, radians, 0..π/2.
    pub steepness_rad: f64,
    /// Azimuth in which it falls, radians clockwise from north.
    pub downhill_azimuth_rad: f64,
}

impl Slope {
    /// Of ground that rises by so many metres for each metre to the east and to the north.
    pub fn of_gradient(to_east: f64, to_north: f64) -> Self {
        let rise = to_east.hypot(to_north);
        // Differences of equal heights are rounding.
        if rise < 1e-9 {
            return Self::default();
        }
        let downhill_azimuth_rad = (-to_east).atan2(-to_north).rem_euclid(2.0 * PI);
        Self { steepness_rad: rise.atan(), downhill_azimuth_rad }
    }

    /// Unit normal (east, north, up).
    pub fn normal(self) -> DVec3 {
        let elevation_rad = PI / 2.0 - self.steepness_rad;
        Direction { azimuth_rad: self.downhill_azimuth_rad, elevation_rad }.enu()
    }
}

/// What surfaces receive, in the unit of [`SurfaceLight::unit`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct SurfaceIlluminance {
    /// A level surface.
    pub horizontal: f64,
    /// The ground as the terrain slopes here.
    pub slope: f64,
    /// A wall that faces north.
    pub vertical_north: f64,
    /// A wall that faces east.
    pub vertical_east: f64,
    /// A wall that faces south.
    pub vertical_south: f64,
    /// A wall that faces west.
    pub vertical_west: f64,
    /// The wall that receives most.
    pub vertical_largest: f64,
    /// Where that one faces, degrees clockwise from north, to 360/256 degrees.
    pub vertical_largest_azimuth_deg: f64,
    /// Mean over the sides of a small upright cylinder: over all walls.
    pub cylindrical: f64,
    /// Mean over a small sphere: a quarter of the scalar illuminance ∫ L dΩ.
    pub spherical: f64,
}

/// What surfaces receive as one response sees it: of the visible sky alone, without what the ground or lamps near by send.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct SurfaceLight {
    /// Which.
    pub response: String,
    /// Unit of the values: lx for luminances, in the response's own kind of light.
    pub unit: String,
    /// By artificial light.
    pub artificial: SurfaceIlluminance,
    /// With the natural sky, and what comes straight from Sun, Moon, planets and stars.
    pub total: SurfaceIlluminance,
}

/// Light that surfaces at a place receive from the sky.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Surfaces {
    /// Angle of the ground to the horizontal plane, degrees; 0 where there is no terrain or it is not asked for.
    pub slope_deg: f64,
    /// Azimuth in which it falls, degrees clockwise from north; null for level ground.
    pub downhill_azimuth_deg: Option<f64>,
    /// As the eye by day (photopic) and in the dark (scotopic) sees it, and the response that was asked for.
    pub by_response: Vec<SurfaceLight>,
}

impl Surfaces {
    pub(crate) fn new(slope: Slope, by_response: Vec<SurfaceLight>) -> Self {
        let is_level = slope.steepness_rad == 0.0;
        Self {
            slope_deg: slope.steepness_rad.to_degrees(),
            downhill_azimuth_deg: (!is_level).then(|| slope.downhill_azimuth_rad.to_degrees()),
            by_response,
        }
    }
}

impl SurfaceLight {
    pub(crate) fn new(response: &Response, artificial: &SurfaceSums, total: &SurfaceSums) -> Self {
        let unit = match response.unit() {
            "cd m-2" => "lx",
            radiance => radiance.strip_suffix(" sr-1").unwrap_or(radiance),
        };
        Self {
            response: response.name().to_owned(),
            unit: unit.to_owned(),
            artificial: artificial.illuminance(),
            total: total.illuminance(),
        }
    }
}

/// Integrals over the sky of a response that the illuminance of every surface follows from.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceSums {
    /// ∫ L sin e dΩ.
    horizontal: f64,
    /// ∫ L dΩ.
    scalar: f64,
    /// ∫ L max(0, n·v) dΩ of the sloping ground.
    slope: f64,
    /// ∫ L cos e dΩ of every column.
    by_azimuth: [f64; AZIMUTH_COUNT],
}

impl SurfaceSums {
    /// Of a sky whose hidden samples are 0, `[row][column]`.
    pub(crate) fn of_plane(plane: &[f32], slope: Slope) -> Self {
        Self::of(slope, |row, column| {
            plane.get(row * AZIMUTH_COUNT + column).map_or(0.0, |&value| f64::from(value))
        })
    }

    /// Of what is the same in every visible direction.
    pub(crate) fn of_even(value: f64, horizon: &Horizon, slope: Slope) -> Self {
        Self::of(slope, |row, column| if horizon.hides_sample(row, column) { 0.0 } else { value })
    }

    fn of(slope: Slope, value: impl Fn(usize, usize) -> f64) -> Self {
        let normal = slope.normal();
        let towards_normal: [f64; AZIMUTH_COUNT] = std::array::from_fn(|column| {
            let (sin, cos) = azimuth_rad(column).sin_cos();
            normal.x * sin + normal.y * cos
        });
        let mut sums = Self { horizontal: 0.0, scalar: 0.0, slope: 0.0, by_azimuth: [0.0; AZIMUTH_COUNT] };
        for row in 0..ELEVATION_COUNT {
            // Exact means of sine and cosine of the elevation over a cell, so that a uniform sky gives πL and πL/2.
            let (cell_sr, sin_sr, cos_sr) = (solid_angle_sr(row), projected_sr(row), cos_sr(row));
            let (mut all, mut of_slope) = (0.0, 0.0);
            for (column, by_azimuth) in sums.by_azimuth.iter_mut().enumerate() {
                let value = value(row, column);
                all += value;
                *by_azimuth += value * cos_sr;
                of_slope += value * (normal.z * sin_sr + towards_normal[column] * cos_sr).max(0.0);
            }
            sums.scalar += all * cell_sr;
            sums.horizontal += all * sin_sr;
            sums.slope += of_slope;
        }
        sums
    }

    /// With other light.
    pub(crate) fn plus(mut self, other: &Self) -> Self {
        self.horizontal += other.horizontal;
        self.scalar += other.scalar;
        self.slope += other.slope;
        self.by_azimuth.iter_mut().zip(other.by_azimuth).for_each(|(sum, value)| *sum += value);
        self
    }

    /// With what a response sees of beams.
    pub(crate) fn plus_beams(mut self, beams: &[BeamSums], response: &Response) -> Self {
        for beams in beams.iter().filter(|beams| beams.scalar.iter().any(|value| *value > 0.0)) {
            let rule = beams.light.rule(response);
            self.horizontal += rule.value(beams.horizontal);
            self.scalar += rule.value(beams.scalar);
            self.slope += rule.value(beams.slope);
            for (sum, kernel) in self.by_azimuth.iter_mut().zip(&beams.by_azimuth) {
                if kernel.iter().any(|value| *value > 0.0) {
                    *sum += rule.value(*kernel);
                }
            }
        }
        self
    }

    fn illuminance(&self) -> SurfaceIlluminance {
        let walls = self.walls();
        let largest = (0..AZIMUTH_COUNT).max_by(|a, b| walls[*a].total_cmp(&walls[*b])).unwrap_or_default();
        let quarter = AZIMUTH_COUNT / 4;
        SurfaceIlluminance {
            horizontal: self.horizontal,
            slope: self.slope,
            vertical_north: walls[0],
            vertical_east: walls[quarter],
            vertical_south: walls[2 * quarter],
            vertical_west: walls[3 * quarter],
            vertical_largest: walls[largest],
            vertical_largest_azimuth_deg: azimuth_rad(largest).to_degrees(),
            cylindrical: self.by_azimuth.iter().sum::<f64>() / PI,
            spherical: self.scalar / 4.0,
        }
    }

    /// Of walls that face each column: Σ c_i max(0, cos(a − a_i)) over the half circle before it, by running sums of c cos a_i and
    /// c sin a_i.
    fn walls(&self) -> [f64; AZIMUTH_COUNT] {
        let half = AZIMUTH_COUNT / 4;
        let mut running = vec![[0.0; 2]];
        for at in 0..2 * AZIMUTH_COUNT {
            let (sin, cos) = azimuth_rad(at % AZIMUTH_COUNT).sin_cos();
            let (value, [x, y]) = (self.by_azimuth[at % AZIMUTH_COUNT], running[at]);
            running.push([x + value * cos, y + value * sin]);
        }
        std::array::from_fn(|facing| {
            let (sin, cos) = azimuth_rad(facing).sin_cos();
            let first = (facing + AZIMUTH_COUNT - half) % AZIMUTH_COUNT;
            let ([x0, y0], [x1, y1]) = (running[first], running[first + 2 * half + 1]);
            (cos * (x1 - x0) + sin * (y1 - y0)).max(0.0)
        })
    }
}

/// What beams of one kind of light bring to surfaces, at every node.
#[derive(Clone, Debug)]
pub struct BeamSums {
    light: Arc<Light>,
    /// Irradiance of a horizontal surface.
    horizontal: [f64; NODE_COUNT],
    /// Sum of irradiances across the beams.
    scalar: [f64; NODE_COUNT],
    /// Irradiance of the sloping ground.
    slope: [f64; NODE_COUNT],
    /// Horizontal part of the irradiance, divided between the two columns next to the beam.
    by_azimuth: Vec<[f64; NODE_COUNT]>,
}

impl BeamSums {
    /// Of beams by the direction that they come from and their irradiance across.
    pub fn new(
        light: Arc<Light>,
        slope: Slope,
        beams: impl Iterator<Item = (Direction, [f64; NODE_COUNT])>,
    ) -> Self {
        let none = [0.0; NODE_COUNT];
        let mut sums = Self {
            light,
            horizontal: none,
            scalar: none,
            slope: none,
            by_azimuth: vec![none; AZIMUTH_COUNT],
        };
        let normal = slope.normal();
        for (direction, irradiance) in beams {
            let column = direction.azimuth_rad.rem_euclid(2.0 * PI) / (2.0 * PI) * AZIMUTH_COUNT as f64;
            let (left, weight) = (column.floor(), column - column.floor());
            let left = left as usize % AZIMUTH_COUNT;
            let right = (left + 1) % AZIMUTH_COUNT;
            let (sin, cos) = direction.elevation_rad.sin_cos();
            let on_slope = normal.dot(direction.enu()).max(0.0);
            for (node, value) in irradiance.into_iter().enumerate() {
                sums.horizontal[node] += sin * value;
                sums.scalar[node] += value;
                sums.slope[node] += on_slope * value;
                sums.by_azimuth[left][node] += (1.0 - weight) * cos * value;
                sums.by_azimuth[right][node] += weight * cos * value;
            }
        }
        sums
    }

    /// What a response sees of the light on a horizontal surface.
    pub fn horizontal(&self, response: &Response) -> f64 {
        self.light.rule(response).value(self.horizontal)
    }
}

#[cfg(test)]
#[path = "surfaces_tests.rs"]
mod tests;
