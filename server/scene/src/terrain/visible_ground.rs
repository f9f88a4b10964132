//! Ground that an eye sees, front to back along each azimuth: the floating-horizon algorithm (Wright 1973).
//!
//! Distances grow by a constant factor near by, then by half a sample of the terrain, and far away by a smaller factor; they are the
//! same for every azimuth. Stretches that the maximum mipmap bounds below what is seen already are skipped (in the spirit of Tevs,
//! Ihrke & Seidel 2008), and so is what lies below the picture.

use super::elevation::Terrain;
use super::path::{Distances, Path, PathPoint};
use rayon::prelude::*;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::horizon::farthest_terrain_m;
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
const SEA_LEVEL_M: f64 = 0.0;
/// Distances of a stretch, which counts as straight in a raster: at 150 km it is 12 km long and 3 m off at 45° of latitude.
const STRETCH: usize = 16;
/// Points of ground are as far apart in the view, parts of the step from azimuth to azimuth.
const APART: f64 = 0.5;

/// What of the ground is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundSight {
    /// Azimuth of the first line, radians clockwise from north, the step to the next, and how many.
    pub azimuths: (f64, f64, usize),
    /// tan of the lowest elevation that is wanted; of ground below it one point of a line is told at most.
    pub lowest_tangent: f64,
}

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
    /// Ground seen by an eye over a place.
    pub(crate) fn visible_ground(
        &self,
        place: GeoPoint,
        eye_altitude_m: f64,
        sight: &GroundSight,
    ) -> Vec<GroundLine> {
        let highest_m = self.rasters.iter().map(|raster| raster.maxima().highest_m()).fold(0.0, f64::max);
        let sample_m = self.rasters.iter().map(|raster| raster.sample_size_m()).fold(1_000.0, f64::min);
        // Ground below the eye is seen down to the horizon of a sphere, higher ground beyond it.
        let horizon_m = (2.0 * EARTH_RADIUS_M * eye_altitude_m.max(1.0)).sqrt();
        let farthest_m = (horizon_m + farthest_terrain_m(0.0, highest_m)).min(FARTHEST_GROUND_M);
        let look = Look {
            terrain: self,
            frame: LocalFrame::at(place),
            distances: Distances::new(distances_m(sample_m, farthest_m)),
            eye_altitude_m,
            highest_m,
            lowest_tangent: sight.lowest_tangent,
            step_rad: sight.azimuths.1,
        };
        let (first_rad, step_rad, count) = sight.azimuths;
        (0..count).into_par_iter().map(|line| look.line(first_rad + line as f64 * step_rad)).collect()
    }
}

/// What is the same for all azimuths.
struct Look<'a> {
    terrain: &'a Terrain,
    frame: LocalFrame,
    distances: Distances,
    eye_altitude_m: f64,
    highest_m: f64,
    lowest_tangent: f64,
    step_rad: f64,
}

/// A point that is seen, before its slope is known.
#[derive(Clone, Copy)]
struct Found {
    at: usize,
    point: PathPoint,
    tangent: f64,
    is_behind_ridge: bool,
}

impl Look<'_> {
    fn line(&self, azimuth_rad: f64) -> GroundLine {
        let mut path = Path::new(self.terrain, &self.distances, &self.frame, azimuth_rad);
        let (mut found, mut top): (Vec<Found>, f64) = (Vec::new(), f64::NEG_INFINITY);
        let mut is_behind_ridge = false;
        let last = self.distances.metres.len() - 1;
        for from in (0..last).step_by(STRETCH) {
            let to = (from + STRETCH).min(last);
            // What cannot rise above what is seen, or into the picture.
            let least = top.max(self.lowest_tangent);
            if self.highest_tangent(self.highest_m, (from, last)) < least {
                break;
            }
            let highest_m = path.enter(from, to).max(SEA_LEVEL_M);
            if self.highest_tangent(highest_m, (from, to)) < least {
                is_behind_ridge = !found.is_empty();
                continue;
            }
            for at in from..to {
                let point = path.point(at);
                let altitude_m = point.elevation_m.unwrap_or(SEA_LEVEL_M);
                let tangent = self.distances.tangent(at, self.eye_altitude_m, altitude_m);
                if tangent <= top {
                    is_behind_ridge = !found.is_empty();
                    continue;
                }
                top = tangent;
                self.add(&mut found, Found { at, point, tangent, is_behind_ridge });
                is_behind_ridge = false;
            }
        }
        let seen = found.iter().map(|found| self.seen(&mut path, found, azimuth_rad)).collect();
        GroundLine { azimuth_rad, seen }
    }

    /// tan of the elevation that ground has at most that is nowhere higher than `highest_m`, between two distances: ground below the eye
    /// is highest in the view at the horizon of a sphere.
    fn highest_tangent(&self, highest_m: f64, (from, to): (usize, usize)) -> f64 {
        let below_m = (self.eye_altitude_m - highest_m).max(0.0);
        let at_m = (2.0 * EARTH_RADIUS_M * below_m).sqrt();
        let at = self.distances.metres[from..=to].partition_point(|distance_m| *distance_m < at_m) + from;
        // The top lies between two of the distances.
        let tangent = |at: usize| self.distances.tangent(at.clamp(from, to), self.eye_altitude_m, highest_m);
        let highest = tangent(at).max(tangent(at.saturating_sub(1)));
        highest + 1e-4 * highest.abs()
    }

    /// Adds a point, in the place of the last one where the view cannot tell that from its predecessor.
    fn add(&self, found: &mut Vec<Found>, new: Found) {
        if let [.., before, last] = found[..] {
            let apart = APART * self.step_rad * (1.0 + new.tangent * new.tangent);
            let is_near = new.tangent - before.tangent < apart && !last.is_behind_ridge;
            if is_near && !new.is_behind_ridge {
                found.pop();
            }
        }
        if new.tangent < self.lowest_tangent {
            found.clear();
        }
        found.push(new);
    }

    fn seen(&self, path: &mut Path<'_>, found: &Found, azimuth_rad: f64) -> SeenGround {
        let distance_m = self.distances.metres[found.at];
        let (along, across) = path.rise(found.at, &found.point, distance_m * self.step_rad);
        let (sin, cos) = azimuth_rad.sin_cos();
        SeenGround {
            tangent: found.tangent,
            distance_m,
            altitude_m: found.point.elevation_m.unwrap_or(SEA_LEVEL_M),
            slope: Slope::of_gradient(along * sin + across * cos, along * cos - across * sin),
            is_behind_ridge: found.is_behind_ridge,
        }
    }
}

#[cfg(test)]
#[path = "visible_ground_tests.rs"]
mod tests;
