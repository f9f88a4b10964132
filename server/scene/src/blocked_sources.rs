//! The raster's own lights as one observer sees them, each behind its exact skyline: what the reference sums.

use crate::scene::Scene;
use crate::terrain::nearest_wall_m;
use glam::DVec3;
use rayon::prelude::*;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::source_pixel::FARTHEST_SOURCE_M;
use skyglow_physics::{BlockedSource, EARTH_RADIUS_M, Fixture, GeoPoint, SourcePixel};

impl Scene {
    /// Every lit pixel within 300 km of a place as point sources, in the order of
    /// [`point_sources`](skyglow_physics::source_pixel::point_sources), each with its blocking angle from the bilinear
    /// terrain itself. Stored skylines are not asked, so a scene without them will do.
    ///
    /// A pixel looks from its centre at its own altitude, as for the stored skylines; a piece of a near one looks from
    /// there too, towards the azimuth in which the piece sees the observer and as far as the piece is away. Where the
    /// ground under a pixel is unknown, nothing hides it: it was put at sea level, and the edge of the terrain would be
    /// a wall. Seconds for a hundred thousand pixels.
    pub fn blocked_sources(&self, place: GeoPoint) -> Vec<BlockedSource> {
        self.blocked_sources_by_fixture(place).into_iter().flat_map(|(_, sources)| sources).collect()
    }

    /// The same for each kind of fixture, that of the raster's own lights first.
    pub fn blocked_sources_by_fixture(&self, place: GeoPoint) -> Vec<(Fixture, Vec<BlockedSource>)> {
        let observer = LocalFrame::at(place);
        let behind_skylines = |pixels: Vec<SourcePixel>| -> Vec<BlockedSource> {
            let of_pixels: Vec<Vec<BlockedSource>> =
                pixels.par_iter().map(|pixel| self.pieces(pixel, &observer)).collect();
            of_pixels.into_iter().flatten().collect()
        };
        let pixels = self.source_pixels_by_fixture(place, FARTHEST_SOURCE_M);
        pixels.into_iter().map(|(fixture, pixels)| (fixture, behind_skylines(pixels))).collect()
    }

    /// The point sources that a pixel is to an observer.
    fn pieces(&self, pixel: &SourcePixel, observer: &LocalFrame) -> Vec<BlockedSource> {
        let center = pixel.center();
        let light = GeoPoint::from_vector(center);
        let sight = self.terrain.around_source(light, pixel.altitude_m, nearest_wall_m(side_m(pixel)));
        let sees_nothing = sight.is_open() || self.ground(light).known_altitude_m().is_none();
        // Meridians of the pixel's pieces are parallel, so its centre's share of the turn is theirs.
        let turn_rad = LocalFrame::at(light).bearing_to(observer.up).azimuth_rad
            - observer.bearing_to(center).azimuth_rad;
        let mut pieces = Vec::new();
        pixel.for_each_point_source(observer, &mut |source| {
            let mut piece = BlockedSource::open(source);
            if !sees_nothing {
                let [tangent] = sight.tangents(source.azimuth_rad + turn_rad, 0.0, &[source.distance_m]);
                piece.blocking_rad = tangent.atan();
            }
            pieces.push(piece);
        });
        pieces
    }
}

/// Side of a square as large as a pixel, metres.
fn side_m(pixel: &SourcePixel) -> f64 {
    let [a, b, c, _] = pixel.corners;
    let length_m = |from: DVec3, to: DVec3| EARTH_RADIUS_M * from.distance(to);
    (length_m(a, b) * length_m(b, c)).sqrt()
}
