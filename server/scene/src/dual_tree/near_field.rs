//! Near field: the lights near a patch, added place by place; a near pixel by adaptive 2 × 2 Gauss–Legendre quadrature over its ground.

use super::sources::{Candidate, Cluster, Sources};
use crate::morton;
use crate::place_kernel::{Compass, RingPosition};
use crate::turns::turns_from_light;
use glam::{DVec3, Vec2, Vec3};
use skyglow_physics::EARTH_RADIUS_M;
use skyglow_physics::source_pixel::MIN_SOURCE_DISTANCE_M;

/// The two Gauss–Legendre points of −1..=1 are ± this, 1/√3.
const GAUSS: f32 = 0.577_350_26;

/// The observer at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Observer {
    pub(super) direction: DVec3,
    /// From the middle of the patch, metres.
    pub(super) place_m: Vec3,
    /// Metres above sea level.
    pub(super) altitude_m: f32,
    /// Of the middle of the patch, a few kilometres away at most.
    pub(super) compass: Compass,
}

#[derive(Clone, Copy, Debug)]
struct NearSource {
    candidate: Candidate,
    direction: DVec3,
    /// From the middle of the patch, metres.
    place_m: Vec3,
    /// From the middle of a pixel to the middles of its eastern and southern side, metres; 0 for blocks.
    halves_m: [Vec3; 2],
    flux_dnb_w: f32,
    altitude_m: f32,
    is_open: bool,
}

/// The lights near a patch.
#[derive(Debug, Default)]
pub(super) struct NearLights(Vec<NearSource>);

impl NearLights {
    pub(super) fn push(
        &mut self,
        sources: &Sources<'_>,
        middle: DVec3,
        candidate: Candidate,
        cluster: &Cluster,
    ) {
        let (light, _) = sources.layer(candidate);
        let index = candidate.index as usize;
        let mut halves_m = [Vec3::ZERO; 2];
        if candidate.level == 0 {
            let (column, row) = morton::decode(light.pixels.codes[index]);
            let [a, b, c, d] = sources.grid.corners(column, row);
            halves_m = [b + c - a - d, c + d - a - b].map(|sum| (0.25 * EARTH_RADIUS_M * sum).as_vec3());
        }
        self.0.push(NearSource {
            candidate,
            direction: cluster.direction,
            place_m: (EARTH_RADIUS_M * (cluster.direction - middle)).as_vec3(),
            halves_m,
            flux_dnb_w: cluster.flux_dnb_w as f32,
            altitude_m: cluster.altitude_m as f32,
            is_open: light.skylines_of(candidate.level as usize, index).is_none(),
        });
    }

    /// What they add up to.
    pub(super) fn at(&self, sources: &Sources<'_>, observer: &Observer) -> f32 {
        self.0.iter().map(|near| near.at(sources, observer)).sum()
    }
}

impl NearSource {
    fn at(&self, sources: &Sources<'_>, observer: &Observer) -> f32 {
        let (light, kernel) = sources.layer(self.candidate);
        let away_m = self.place_m - observer.place_m;
        let square_m2 = away_m.length_squared();
        let Some(ring) = RingPosition::of_square(square_m2) else {
            return 0.0;
        };
        let (candidate, offset_m) = (self.candidate, self.altitude_m - observer.altitude_m);
        let skylines = match self.is_open {
            true => None,
            false => light.skylines_of(candidate.level as usize, candidate.index as usize),
        };
        let turns = skylines.map_or(0.0, |_| turns_from_light(self.direction, observer.direction));
        let (below, up) = kernel.altitudes().position(observer.altitude_m);
        let knows_azimuth = kernel.knows_azimuth();
        let towards = |away_m: Vec3| match knows_azimuth {
            true => observer.compass.towards(away_m),
            false => Vec2::ZERO,
        };
        let one = |ring: RingPosition, towards: Vec2| {
            let blocking = skylines
                .map_or(0.0, |(skylines, index)| skylines.blocking(index, turns, ring.log_distance()) as f32);
            let [low, high] = [below, below + 1]
                .map(|node| sources.sum.at(kernel, node, ring, offset_m, blocking, towards));
            low + up * (high - low)
        };
        // Pixels beyond 5 km are points, as everywhere.
        if square_m2 >= sources.sum.split_within_m().powi(2) as f32 {
            return self.flux_dnb_w * one(ring, towards(away_m));
        }
        let of_point = |away_m: Vec3| {
            let ring = RingPosition::of_square(away_m.length_squared());
            ring.map_or(0.0, |ring| one(ring, towards(away_m)))
        };
        let mut sum = 0.0;
        for_each_point(away_m, self.halves_m, self.flux_dnb_w, &mut |away_m, part| {
            sum += part * of_point(away_m)
        });
        sum
    }
}

/// Calls `visit` with points of a parallelogram around `away_m` from the observer, given half its sides, and the part of it that each
/// stands for: subdivided until the parts are small relative to their distance (to 250 m where they are nearer).
///
/// * `part`: what the parts add up to.
pub(crate) fn for_each_point(
    away_m: Vec3,
    [east, south]: [Vec3; 2],
    part: f32,
    visit: &mut impl FnMut(Vec3, f32),
) {
    let longest_m2 = 4.0 * east.length_squared().max(south.length_squared());
    let ratio = (longest_m2 / away_m.length_squared().max(MIN_SOURCE_DISTANCE_M.powi(2) as f32)).sqrt();
    if ratio <= 1.0 / 6.0 {
        return visit(away_m, part);
    }
    let (apart, is_split) = if ratio <= 0.5 { (GAUSS, false) } else { (0.5, true) };
    for (along, down) in [(-apart, -apart), (apart, -apart), (-apart, apart), (apart, apart)] {
        let away_m = away_m + along * east + down * south;
        if is_split {
            for_each_point(away_m, [0.5 * east, 0.5 * south], 0.25 * part, visit);
        } else {
            visit(away_m, 0.25 * part);
        }
    }
}
