//! Lit pixels as the point sources that one observer sees, each with its exact blocking angle: what the reference solution sums.

use crate::terrain::{Terrain, min_blocking_distance_m};
use glam::DVec3;
use rayon::prelude::*;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::{BlockedSource, EARTH_RADIUS_M, GeoPoint, SourcePixel};

/// The point sources that pixels are to an observer at a place, in their order.
pub(crate) fn of_pixels(terrain: &Terrain, pixels: &[SourcePixel], place: GeoPoint) -> Vec<BlockedSource> {
    let observer = LocalFrame::at(place);
    let of_pixels: Vec<Vec<BlockedSource>> =
        pixels.par_iter().map(|pixel| of_pixel(terrain, pixel, &observer)).collect();
    of_pixels.into_iter().flatten().collect()
}

fn of_pixel(terrain: &Terrain, pixel: &SourcePixel, observer: &LocalFrame) -> Vec<BlockedSource> {
    let center = pixel.center();
    let light = GeoPoint::from_vector(center);
    let horizon = terrain.source_horizon(light, pixel.altitude_m, min_blocking_distance_m(side_m(pixel)));
    let is_open = horizon.is_open() || terrain.ground(light).known_altitude_m().is_none();
    // Meridians of the pixel's pieces are parallel, so the turn at its centre is theirs.
    let turn_rad =
        LocalFrame::at(light).bearing_to(observer.up).azimuth_rad - observer.bearing_to(center).azimuth_rad;
    let mut pieces = Vec::new();
    pixel.for_each_point_source(observer, &mut |source| {
        let mut piece = BlockedSource::open(source);
        if !is_open {
            let [tangent] = horizon.tangents(source.azimuth_rad + turn_rad, 0.0, &[source.distance_m]);
            piece.blocking_rad = tangent.atan();
        }
        pieces.push(piece);
    });
    pieces
}

/// Side of a square as large as a pixel, metres.
fn side_m(pixel: &SourcePixel) -> f64 {
    let [a, b, c, _] = pixel.corners;
    let length_m = |from: DVec3, to: DVec3| EARTH_RADIUS_M * from.distance(to);
    (length_m(a, b) * length_m(b, c)).sqrt()
}
