//! One terrain raster as an observer or a light sees it, and the search for the highest ground along a line of sight.

use super::cell::RaySegment;
use super::elevation::Terrain;
use super::raster::TerrainRaster;
use super::ray::{MIN_GROUND_DISTANCE_M, Ray, Tolerance};
use glam::DVec3;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::horizon::farthest_terrain_m;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};
use std::f64::consts::{PI, TAU};

/// Longest segment of a great circle that counts as straight in a raster's samples, metres: it deviates by
/// s²·tan(latitude)/8R, 5 m at 45°, where the segment is at least 64 km away.
const MAX_SEGMENT_M: f64 = 16_000.0;
/// The shortest, which deviates by 2 cm.
const MIN_SEGMENT_M: f64 = 1_000.0;

/// How precisely a line of sight is followed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Precision {
    /// Length of a segment that counts as straight, at most this fraction of the distance at which it begins.
    segment_ratio: f64,
    max_segment_m: f64,
    tolerance: Tolerance,
}

impl Precision {
    /// For the observer's horizon.
    pub(super) const FINE: Self =
        Self { segment_ratio: 0.25, max_segment_m: MAX_SEGMENT_M, tolerance: Tolerance::NONE };
    /// For the horizon profiles of lights: a segment is as long as it is far, which deviates by 80 m at most (at 64 km
    /// and 45°), and angles are at most 1 % and 0.007° too low, half of the resolution of a byte.
    pub(super) const COARSE: Self = Self {
        segment_ratio: 1.0,
        max_segment_m: 64_000.0,
        tolerance: Tolerance { relative: 0.01, absolute: 1.2e-4 },
    };
}

/// A direction from a point above the ground.
pub(super) struct LineOfSight<'a> {
    frame: &'a LocalFrame,
    forward: DVec3,
    azimuth_rad: f64,
    altitude_m: f64,
}

impl<'a> LineOfSight<'a> {
    pub(super) fn new(frame: &'a LocalFrame, altitude_m: f64, azimuth_rad: f64) -> Self {
        Self { frame, forward: frame.forward(azimuth_rad), azimuth_rad, altitude_m }
    }

    /// The point at a distance along the great circle, as a unit vector.
    fn point(&self, distance_m: f64) -> DVec3 {
        self.frame.along(self.forward, distance_m)
    }
}

/// A raster that may rise above the horizontal plane of a point.
pub(super) struct VisibleRaster<'a> {
    raster: &'a TerrainRaster,
    /// Rasters before this one that may overlap it: where they have a value it counts.
    earlier: Vec<&'a TerrainRaster>,
    /// First and last distance at which the raster can lie, metres: the same for every altitude over a place, and with them
    /// the segments that count as straight. How far one sees, [`Ray::may_be_visible`] tells.
    pub(super) distances_m: (f64, f64),
    /// Middle and half width of the azimuths under which it lies, radians.
    azimuths_rad: (f64, f64),
    /// The observer's place or the grid's middle in the grid's columns and rows: where paths begin.
    start: (f64, f64),
    highest_m: f64,
}

/// The rasters that can rise above the horizontal plane of a point, the nearest first: what is near hides what is far, and one
/// test is then enough for the far raster.
pub(super) fn visible_rasters<'a>(
    terrain: &'a Terrain,
    frame: &LocalFrame,
    altitude_m: f64,
) -> Vec<VisibleRaster<'a>> {
    let rasters = &terrain.rasters;
    let mut visible: Vec<VisibleRaster<'_>> = (0..rasters.len())
        .filter_map(|index| VisibleRaster::new(&rasters[index], &rasters[..index], frame, altitude_m))
        .collect();
    visible.sort_by(|a, b| a.distances_m.0.total_cmp(&b.distances_m.0));
    visible
}

impl<'a> VisibleRaster<'a> {
    /// `None` where no ground of the raster can be above the horizontal plane.
    fn new(
        raster: &'a TerrainRaster,
        earlier: &'a [TerrainRaster],
        frame: &LocalFrame,
        altitude_m: f64,
    ) -> Option<Self> {
        let maxima = raster.maxima();
        let highest_m = maxima.highest_m();
        let farthest_m = farthest_terrain_m(altitude_m, highest_m);
        let bearing = frame.bearing_to(maxima.center);
        let (to_center_rad, radius_rad) = (bearing.distance_m / EARTH_RADIUS_M, maxima.radius_rad);
        let nearest_m = EARTH_RADIUS_M * (to_center_rad - radius_rad).max(0.0);
        let last_m = EARTH_RADIUS_M * (to_center_rad + radius_rad);
        let half_width_rad = if to_center_rad > radius_rad && to_center_rad + radius_rad < PI {
            (radius_rad.sin() / to_center_rad.sin()).clamp(0.0, 1.0).asin()
        } else {
            PI
        };
        let grid = raster.grid();
        let middle = (0.5 * f64::from(grid.width), 0.5 * f64::from(grid.height));
        let overlaps = |other: &&TerrainRaster| {
            let (center, other_radius_rad) = (other.maxima().center, other.maxima().radius_rad);
            center.angle_between(maxima.center) <= radius_rad + other_radius_rad
        };
        (nearest_m < last_m.min(farthest_m)).then(|| Self {
            raster,
            earlier: earlier.iter().filter(overlaps).collect(),
            distances_m: (nearest_m, last_m),
            azimuths_rad: (bearing.azimuth_rad, half_width_rad),
            start: grid.position_near(frame.up, middle).unwrap_or(middle),
            highest_m,
        })
    }

    pub(super) fn lies_towards(&self, azimuth_rad: f64) -> bool {
        let (middle, half_width) = self.azimuths_rad;
        ((azimuth_rad - middle + PI).rem_euclid(TAU) - PI).abs() <= half_width
    }

    /// tan e of the highest ground along a line of sight between two distances [m], at least `floor`, itself at least 0.
    pub(super) fn max_tangent(
        &self,
        sight: &LineOfSight<'_>,
        floor: f64,
        distances_m: (f64, f64),
        precision: Precision,
    ) -> f64 {
        if !self.lies_towards(sight.azimuth_rad) {
            return floor;
        }
        let is_covered = |distance_m: f64| {
            let place = GeoPoint::from_vector(sight.point(distance_m));
            self.earlier.iter().any(|raster| raster.bilinear_m(0, place).is_some())
        };
        let cover: Option<&dyn Fn(f64) -> bool> =
            if self.earlier.is_empty() { None } else { Some(&is_covered) };
        let mut ray = Ray::new(self.raster, sight.altitude_m, floor, cover, precision.tolerance);
        self.scan(&mut ray, sight, distances_m, precision);
        ray.tangent()
    }

    /// Follows a great circle between two distances [m], segment by segment, until nothing farther can be seen.
    fn scan(
        &self,
        ray: &mut Ray<'_>,
        sight: &LineOfSight<'_>,
        (first_m, last_m): (f64, f64),
        precision: Precision,
    ) {
        if !ray.may_be_visible(self.highest_m, first_m) {
            return;
        }
        let grid = self.raster.grid();
        let turn = grid.turn_columns();
        // Meridians converge towards the poles, and great circles curve more between them.
        let longest_m = precision.max_segment_m * sight.frame.up.truncate().length().max(0.02);
        let mut start_m = first_m.max(MIN_GROUND_DISTANCE_M);
        let mut start = grid.position_near(sight.point(start_m), self.start);
        while start_m < last_m && ray.may_be_visible(self.highest_m, start_m) {
            let length_m =
                (precision.segment_ratio * start_m).min(longest_m).max(MIN_SEGMENT_M.min(longest_m));
            let end_m = (start_m + length_m).min(last_m);
            let end = grid.position_near(sight.point(end_m), start.unwrap_or(self.start));
            if let (Some(from), Some(to)) = (start, end) {
                for shift in turn.map_or([0.0, f64::NAN, f64::NAN], |turn| [0.0, turn, -turn]) {
                    // A sample's centre is half a pixel from its edge, and a cell ends half a pixel beyond.
                    let cell = |(column, row): (f64, f64)| (column + shift + 0.5, row + 0.5);
                    if shift.is_finite() {
                        ray.scan(&RaySegment { start: cell(from), end: cell(to), start_m, end_m });
                    }
                }
            }
            (start_m, start) = (end_m, end);
        }
    }
}
