//! The observer's horizon from all terrain layers.
//!
//! One line of sight a column of the panorama, exact for the bilinear surface but for great circles taken as straight
//! over at most [`LONGEST_STRETCH_M`] and for points beside voids: within 0.02° of a walk over the pixels in small steps
//! (`skyline_tests.rs`; `examples/horizon.rs` measures it on real terrain: 0.012° at most, 0.001° in the mean).

use super::Terrain;
use super::cell::Piece;
use super::layer::TerrainLayer;
use super::ray::{NEAREST_GROUND_M, Ray};
use glam::DVec3;
use rayon::prelude::*;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::horizon::farthest_terrain_m;
use skyglow_physics::panorama::azimuth_rad;
use skyglow_physics::{AZIMUTH_COUNT, EARTH_RADIUS_M, GeoPoint, Horizon};
use std::f64::consts::{PI, TAU};

/// Longest stretch of a great circle that is taken as straight in a layer's samples, metres: it bends away by
/// s²·tan(latitude)/8R, 5 m at 45°, where the stretch is at least 64 km away.
const LONGEST_STRETCH_M: f64 = 16_000.0;
/// The shortest: 2 cm.
const SHORTEST_STRETCH_M: f64 = 1_000.0;
/// Azimuths looked along in one go by a thread: fewer are not worth another's waking up.
const COLUMNS_A_TASK: usize = 32;

/// How long the stretches are that are taken as straight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stride {
    /// At most this part of the distance at which they begin.
    share: f64,
    longest_m: f64,
}

impl Stride {
    /// For the observer's horizon.
    pub(super) const FINE: Self = Self { share: 0.25, longest_m: LONGEST_STRETCH_M };
    /// For skylines at a few azimuths: a stretch as long as it is far, and 80 m off at most, at 64 km and 45°.
    pub(super) const COARSE: Self = Self { share: 1.0, longest_m: 64_000.0 };
}

/// A layer as one observer sees it.
pub(super) struct View<'a> {
    pub(super) layer: &'a TerrainLayer,
    /// Layers before this one that may overlap it: where they have a value it counts.
    pub(super) earlier: Vec<&'a TerrainLayer>,
    /// First and last distance at which the layer can lie, metres: the same for every eye over a place, and with them
    /// the stretches that are taken as straight. How far an eye sees, [`Ray::would_see`] tells.
    pub(super) reach_m: (f64, f64),
    /// Middle and half width of the azimuths under which it lies, radians.
    azimuths_rad: (f64, f64),
    /// The observer's place or the grid's middle in the grid's columns and rows: where paths begin.
    near: (f64, f64),
    pub(super) highest_m: f64,
}

impl Terrain {
    /// Elevation of the ground against the sky, seen from an eye over a place.
    pub(crate) fn horizon(&self, place: GeoPoint, observer_altitude_m: f64) -> Horizon {
        let frame = LocalFrame::at(place);
        let views = self.views(&frame, observer_altitude_m);
        if views.is_empty() {
            return Horizon::flat();
        }
        let mut tangents = [0.0; AZIMUTH_COUNT];
        tangents.par_iter_mut().enumerate().with_min_len(COLUMNS_A_TASK).for_each(|(column, tangent)| {
            *tangent = tangent_towards(&views, &frame, observer_altitude_m, azimuth_rad(column));
        });
        Horizon::from_tangents(&tangents)
    }

    /// The layers that can rise above the horizontal plane of an eye, the nearest first: what is near hides what is
    /// far, and the far layer is then done with one look.
    pub(super) fn views(&self, frame: &LocalFrame, observer_altitude_m: f64) -> Vec<View<'_>> {
        let mut views: Vec<View<'_>> = (0..self.layers.len())
            .filter_map(|index| {
                View::of(&self.layers[index], &self.layers[..index], frame, observer_altitude_m)
            })
            .collect();
        views.sort_by(|a, b| a.reach_m.0.total_cmp(&b.reach_m.0));
        views
    }
}

impl<'a> View<'a> {
    /// `None` where no ground of the layer can be above the observer's horizontal plane.
    fn of(
        layer: &'a TerrainLayer,
        earlier: &'a [TerrainLayer],
        frame: &LocalFrame,
        observer_altitude_m: f64,
    ) -> Option<Self> {
        let bounds = layer.bounds();
        let highest_m = bounds.highest_m();
        let farthest_m = farthest_terrain_m(observer_altitude_m, highest_m);
        let bearing = frame.bearing_to(bounds.center);
        let (to_center_rad, radius_rad) = (bearing.distance_m / EARTH_RADIUS_M, bounds.radius_rad);
        let nearest_m = EARTH_RADIUS_M * (to_center_rad - radius_rad).max(0.0);
        let last_m = EARTH_RADIUS_M * (to_center_rad + radius_rad);
        let half_width_rad = if to_center_rad > radius_rad && to_center_rad + radius_rad < PI {
            (radius_rad.sin() / to_center_rad.sin()).clamp(0.0, 1.0).asin()
        } else {
            PI
        };
        let grid = layer.grid();
        let middle = (0.5 * f64::from(grid.width), 0.5 * f64::from(grid.height));
        let overlaps = |other: &&TerrainLayer| {
            let (center, other_radius_rad) = (other.bounds().center, other.bounds().radius_rad);
            center.angle_between(bounds.center) <= radius_rad + other_radius_rad
        };
        (nearest_m < last_m.min(farthest_m)).then(|| Self {
            layer,
            earlier: earlier.iter().filter(overlaps).collect(),
            reach_m: (nearest_m, last_m),
            azimuths_rad: (bearing.azimuth_rad, half_width_rad),
            near: grid.position_near(frame.up, middle).unwrap_or(middle),
            highest_m,
        })
    }

    pub(super) fn lies_towards(&self, azimuth_rad: f64) -> bool {
        let (middle, half_width) = self.azimuths_rad;
        ((azimuth_rad - middle + PI).rem_euclid(TAU) - PI).abs() <= half_width
    }
}

/// tan e of the highest ground along a line of sight, at least 0.
fn tangent_towards(
    views: &[View<'_>],
    frame: &LocalFrame,
    observer_altitude_m: f64,
    azimuth_rad: f64,
) -> f64 {
    let (sin_az, cos_az) = azimuth_rad.sin_cos();
    let forward = frame.north * cos_az + frame.east * sin_az;
    let point = |distance_m: f64| -> DVec3 {
        let (sin_arc, cos_arc) = (distance_m / EARTH_RADIUS_M).sin_cos();
        frame.up * cos_arc + forward * sin_arc
    };
    let mut tangent = 0.0;
    for view in views.iter().filter(|view| view.lies_towards(azimuth_rad)) {
        let is_covered = |distance_m: f64| {
            let place = GeoPoint::from_vector(point(distance_m));
            view.earlier.iter().any(|layer| layer.bilinear_m(0, place).is_some())
        };
        let cover: Option<&dyn Fn(f64) -> bool> =
            if view.earlier.is_empty() { None } else { Some(&is_covered) };
        let mut ray = Ray::new(view.layer, observer_altitude_m, tangent, cover);
        look_along(&mut ray, view, view.reach_m, Stride::FINE, frame, &point);
        tangent = ray.tangent();
    }
    tangent
}

/// Looks along a great circle over one layer between two distances [m], stretch by stretch, until nothing farther can
/// be seen.
pub(super) fn look_along(
    ray: &mut Ray<'_>,
    view: &View<'_>,
    (first_m, last_m): (f64, f64),
    stride: Stride,
    frame: &LocalFrame,
    point: &dyn Fn(f64) -> DVec3,
) {
    if !ray.would_see(view.highest_m, first_m) {
        return;
    }
    let grid = view.layer.grid();
    let turn = grid.turn_columns();
    // Meridians draw together towards the poles, and great circles bend more between them.
    let longest_m = stride.longest_m * frame.up.truncate().length().max(0.02);
    let mut start_m = first_m.max(NEAREST_GROUND_M);
    let mut start = grid.position_near(point(start_m), view.near);
    while start_m < last_m && ray.would_see(view.highest_m, start_m) {
        let stretch_m = (stride.share * start_m).min(longest_m).max(SHORTEST_STRETCH_M.min(longest_m));
        let end_m = (start_m + stretch_m).min(last_m);
        let end = grid.position_near(point(end_m), start.unwrap_or(view.near));
        if let (Some(from), Some(to)) = (start, end) {
            for shift in turn.map_or([0.0, f64::NAN, f64::NAN], |turn| [0.0, turn, -turn]) {
                // A sample's centre is half a pixel from its edge, and a cell ends half a pixel beyond.
                let cell = |(column, row): (f64, f64)| (column + shift + 0.5, row + 0.5);
                if shift.is_finite() {
                    ray.look(&Piece { start: cell(from), end: cell(to), start_m, end_m });
                }
            }
        }
        (start_m, start) = (end_m, end);
    }
}

#[cfg(test)]
#[path = "skyline_tests.rs"]
mod tests;
