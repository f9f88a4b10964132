//! Ground that an eye sees, front to back along each azimuth: the floating-horizon algorithm (Wright 1973).
//!
//! Distances grow by a constant factor near by, then by half a sample of the terrain, and far away by a smaller factor; they are the
//! same for every azimuth, so slopes follow from neighbours in a table of elevations.

use super::elevation::Terrain;
use rayon::prelude::*;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::horizon::{farthest_terrain_m, terrain_elevation_tangent};
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint, Slope};

/// Where the nearest ground is looked at, metres from the eye.
const NEAREST_M: f64 = 2.0;
/// Longest step from one sample to the next near by, of the distance.
const NEAR_STEP: f64 = 0.04;
/// Shortest step, of the distance.
const FAR_STEP: f64 = 0.005;
/// Ground beyond is not looked at, metres: air hides it.
const FARTHEST_GROUND_M: f64 = 150_000.0;
/// Level ground at sea level counts where terrain has no value.
const SEA_LEVEL_M: f32 = 0.0;

/// A point of ground that is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenGround {
    /// tan of its elevation above the eye's horizontal plane.
    pub tangent: f64,
    /// Arc distance, metres.
    pub distance_m: f64,
    /// Metres above sea level.
    pub altitude_m: f64,
    /// How it lies, azimuths being those of the eye.
    pub slope: Slope,
    /// Whether ground that is not seen lies before it: between its predecessor and it is a ridge.
    pub is_behind_ridge: bool,
}

/// Ground along one azimuth, front to back: each point is higher in the view than those before it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroundLine {
    /// Radians clockwise from north.
    pub azimuth_rad: f64,
    /// What is seen.
    pub seen: Vec<SeenGround>,
}

impl GroundLine {
    /// Whether something at a distance, metres, and tan of an elevation stands before all ground that is nearer.
    pub fn shows(&self, distance_m: f64, tangent: f64) -> bool {
        let nearer = self.seen.partition_point(|ground| ground.distance_m < distance_m);
        nearer.checked_sub(1).is_none_or(|last| self.seen[last].tangent <= tangent)
    }
}

/// Distances that are looked at, metres.
fn distances_m(sample_size_m: f64, farthest_m: f64) -> Vec<f64> {
    let mut distances = vec![NEAREST_M];
    let mut distance_m = NEAREST_M;
    while distance_m < farthest_m {
        distance_m += (NEAR_STEP * distance_m).min(0.5 * sample_size_m).max(FAR_STEP * distance_m);
        distances.push(distance_m);
    }
    distances
}

impl Terrain {
    /// Ground seen by an eye over a place, along `count` azimuths a step apart.
    pub(crate) fn visible_ground(
        &self,
        place: GeoPoint,
        eye_altitude_m: f64,
        (first_rad, step_rad, count): (f64, f64, usize),
    ) -> Vec<GroundLine> {
        let highest_m = self.rasters.iter().map(|raster| raster.maxima().highest_m()).fold(0.0, f64::max);
        let sample_m = self.rasters.iter().map(|raster| raster.sample_size_m()).fold(1_000.0, f64::min);
        // Ground below the eye is seen down to the horizon of a sphere, higher ground beyond it.
        let horizon_m = (2.0 * EARTH_RADIUS_M * eye_altitude_m.max(1.0)).sqrt();
        let farthest_m = (horizon_m + farthest_terrain_m(0.0, highest_m)).min(FARTHEST_GROUND_M);
        let distances_m = distances_m(sample_m, farthest_m);
        let frame = LocalFrame::at(place);
        let elevations: Vec<Vec<f32>> = (0..count)
            .into_par_iter()
            .map(|line| {
                let azimuth_rad = first_rad + line as f64 * step_rad;
                self.elevations_along(&frame, azimuth_rad, &distances_m, eye_altitude_m, highest_m)
            })
            .collect();
        let table = Table { elevations, distances_m, step_rad, sample_m, under_eye: self.slope(place) };
        (0..count)
            .into_par_iter()
            .map(|line| table.line(line, first_rad + line as f64 * step_rad, eye_altitude_m))
            .collect()
    }

    /// Elevations along an azimuth, as far as ground may be seen.
    fn elevations_along(
        &self,
        frame: &LocalFrame,
        azimuth_rad: f64,
        distances_m: &[f64],
        eye_altitude_m: f64,
        highest_m: f64,
    ) -> Vec<f32> {
        let forward = frame.forward(azimuth_rad);
        let mut elevations = Vec::with_capacity(distances_m.len());
        let mut top = f64::NEG_INFINITY;
        for &distance_m in distances_m {
            // Nothing farther can rise above what is seen already.
            if terrain_elevation_tangent(eye_altitude_m, highest_m, distance_m) < top
                && highest_m > eye_altitude_m
            {
                break;
            }
            let place = GeoPoint::from_vector(frame.along(forward, distance_m));
            let elevation_m = self.elevation_m(place).map_or(SEA_LEVEL_M, |elevation_m| elevation_m as f32);
            top = top.max(terrain_elevation_tangent(eye_altitude_m, f64::from(elevation_m), distance_m));
            elevations.push(elevation_m);
        }
        elevations
    }
}

/// Elevations by azimuth and distance.
struct Table {
    elevations: Vec<Vec<f32>>,
    distances_m: Vec<f64>,
    step_rad: f64,
    sample_m: f64,
    under_eye: Slope,
}

impl Table {
    fn line(&self, line: usize, azimuth_rad: f64, eye_altitude_m: f64) -> GroundLine {
        let mut seen = Vec::new();
        let mut top = f64::NEG_INFINITY;
        let mut is_behind_ridge = false;
        for (at, &elevation_m) in self.elevations[line].iter().enumerate() {
            let altitude_m = f64::from(elevation_m);
            let distance_m = self.distances_m[at];
            let tangent = terrain_elevation_tangent(eye_altitude_m, altitude_m, distance_m);
            if tangent <= top {
                is_behind_ridge = !seen.is_empty();
                continue;
            }
            top = tangent;
            let slope = self.slope(line, at, azimuth_rad);
            seen.push(SeenGround { tangent, distance_m, altitude_m, slope, is_behind_ridge });
            is_behind_ridge = false;
        }
        GroundLine { azimuth_rad, seen }
    }

    /// By differences over about a sample of the terrain each way; nearer than one sample as it is under the eye.
    fn slope(&self, line: usize, at: usize, azimuth_rad: f64) -> Slope {
        let here_m = self.distances_m[at];
        if here_m < self.sample_m {
            return self.under_eye;
        }
        let row = &self.elevations[line];
        let away = |step: isize| -> usize {
            let mut to = at;
            while let Some(next) = to.checked_add_signed(step).filter(|next| *next < row.len()) {
                to = next;
                if (self.distances_m[to] - here_m).abs() >= self.sample_m {
                    break;
                }
            }
            to
        };
        let (near, far) = (away(-1), away(1));
        let along =
            f64::from(row[far] - row[near]) / (self.distances_m[far] - self.distances_m[near]).max(1.0);
        let lines = (0.5 * self.sample_m / (here_m * self.step_rad)).ceil().max(1.0) as usize;
        let value = |line: usize| self.elevations[line].get(at).copied();
        // As far to one side as to the other; the outermost lines have one neighbour.
        let last = self.elevations.len() - 1;
        let lines = lines.min(line).min(last - line);
        let (left, right) = if lines > 0 {
            (line - lines, line + lines)
        } else {
            (line.saturating_sub(1), (line + 1).min(last))
        };
        let width_m = 2.0 * here_m * (0.5 * self.step_rad * (right - left) as f64).sin();
        // A line that ends before this distance, or next to none, says nothing.
        let across = match (value(left), value(right)) {
            (Some(left), Some(right)) if width_m > 1.0 => f64::from(right - left) / width_m,
            _ => 0.0,
        };
        let (sin, cos) = azimuth_rad.sin_cos();
        Slope::of_gradient(along * sin + across * cos, along * cos - across * sin)
    }
}

#[cfg(test)]
#[path = "visible_ground_tests.rs"]
mod tests;
