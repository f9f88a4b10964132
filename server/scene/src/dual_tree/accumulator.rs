//! Dual-tree traversal: patches of places against clusters of lights, far pairs at the patch's nodes and near ones at each place.

use super::near_field::{NearLights, Observer};
use super::node_sums::NodeSums;
use super::patch::{Patch, PatchGround};
use super::place_window::Observers;
use super::sources::{Candidate, Cluster, Sources};
use crate::place_kernel::{Compass, RingPosition};
use crate::turns::turns_from_light;
use glam::Vec2;
use skyglow_physics::EARTH_RADIUS_M;
use skyglow_physics::source_pixel::MAX_SOURCE_DISTANCE_M;

/// Places along a side of a leaf patch, which is not halved any more, at most.
pub(super) const LEAF_SIDE_PLACES: u32 = 8;
/// Longest side of a leaf patch, metres, unless it is one place: nearer than that, all lights are near.
const MAX_LEAF_SIDE_M: f64 = 8_000.0;

/// Accumulates the sums over all lights at places of a lattice.
pub(crate) struct Accumulator<'a> {
    pub(crate) sources: Sources<'a>,
    /// In a window of whole root patches.
    pub(crate) observers: &'a Observers,
    /// From one place to the next, metres.
    pub(crate) step_m: f64,
}

impl Accumulator<'_> {
    /// The sums at the places of a patch, row by row.
    pub(super) fn sum_patch(&self, patch: Patch, candidates: &[Candidate]) -> Vec<f32> {
        let mut sums = vec![f32::NAN; patch.len()];
        self.add(patch, candidates, None, &mut |part: Patch, values: &[f32]| {
            part.write(values, patch, &mut sums)
        });
        sums
    }

    fn add(
        &self,
        patch: Patch,
        candidates: &[Candidate],
        inherited: Option<&NodeSums>,
        write: &mut impl FnMut(Patch, &[f32]),
    ) {
        let Some((lowest, highest)) = self.kernel_altitudes(patch) else {
            return;
        };
        let ground = PatchGround::of(patch, self.observers.lattice, self.sources.grid);
        let mut node_sums = NodeSums::inherit(patch, (lowest, highest), inherited);
        // A patch over the edge of the world has nodes without a place: only its parts are summed.
        let left = match ground.is_whole() {
            true => self.add_far(&ground, candidates, &mut node_sums),
            false => candidates.to_vec(),
        };
        // Beyond the reach of all lights, as most of a planet is.
        if left.is_empty() && node_sums.is_dark() {
            let dark = |altitude_m: f32| if altitude_m.is_finite() { 0.0 } else { f32::NAN };
            let places = patch.places().map(|(column, row)| dark(self.altitude_m(column, row)));
            return write(patch, &places.collect::<Vec<f32>>());
        }
        let is_small = patch.longest() <= LEAF_SIDE_PLACES
            && f64::from(patch.longest()) * self.step_m <= MAX_LEAF_SIDE_M
            && ground.is_whole();
        if !is_small && patch.len() > 1 {
            for part in patch.parts() {
                self.add(part, &left, Some(&node_sums), write);
            }
            return;
        }
        let near = self.near_lights(&ground, left);
        let compass = Compass::at(ground.middle);
        let is_positive = self.sources.is_positive();
        let mut values = Vec::with_capacity(patch.len());
        for (column, row) in patch.places() {
            let altitude_m = self.altitude_m(column, row);
            if !altitude_m.is_finite() {
                values.push(f32::NAN);
                continue;
            }
            let (x, y) = (f64::from(column), f64::from(row));
            let direction = self.observers.lattice.point(self.sources.grid, x, y);
            let place_m = (EARTH_RADIUS_M * (direction - ground.middle)).as_vec3();
            let observer = Observer { direction, place_m, altitude_m, compass };
            let far = self
                .sources
                .layers
                .first()
                .map_or(0.0, |(_, kernel)| node_sums.at(x, y, kernel.altitudes().position(altitude_m)));
            let far = if is_positive { far.max(0.0) } else { far };
            values.push(far + near.at(&self.sources, &observer));
        }
        write(patch, &values);
    }

    fn altitude_m(&self, column: u32, row: u32) -> f32 {
        let Observers { window, altitudes_m, .. } = self.observers;
        let (column, row) = ((column - window.columns.start) as usize, (row - window.rows.start) as usize);
        altitudes_m[row * window.columns.len() + column]
    }

    /// The kernels' altitudes around the ground of a patch; None where none of its places can have an observer.
    fn kernel_altitudes(&self, patch: Patch) -> Option<(usize, usize)> {
        let axis = self.sources.layers.first().map(|(_, kernel)| kernel.altitudes());
        let mut range: Option<(usize, usize)> = None;
        for (column, row) in patch.places() {
            let altitude_m = self.altitude_m(column, row);
            if altitude_m.is_finite() {
                let below = axis.map_or(0, |axis| axis.position(altitude_m).0);
                let (lowest, highest) = range.unwrap_or((below, below + 1));
                range = Some((lowest.min(below), highest.max(below + 1)));
            }
        }
        range
    }

    /// Adds the lights that are far from a patch at its nodes; the others are left.
    fn add_far(
        &self,
        ground: &PatchGround,
        candidates: &[Candidate],
        node_sums: &mut NodeSums,
    ) -> Vec<Candidate> {
        let mut left = Vec::new();
        let mut open = candidates.to_vec();
        while let Some(candidate) = open.pop() {
            let cluster = self.sources.cluster(candidate);
            let distance_m = EARTH_RADIUS_M * cluster.direction.distance(ground.middle);
            if self.sources.is_removed(candidate)
                || distance_m - ground.radius_m - cluster.radius_m > MAX_SOURCE_DISTANCE_M
            {
                continue;
            }
            let nearest_m = distance_m - ground.radius_m;
            let ground_is_small =
                ground.radius_m <= self.sources.sum.far_ground_ratio() * (distance_m - cluster.radius_m);
            let light_is_small = cluster.radius_m <= self.sources.sum.far_light_ratio() * nearest_m;
            // Of a block larger than the ground some parts may be far.
            let is_near = (!ground_is_small
                || nearest_m - cluster.radius_m < self.sources.sum.pixels_within_m())
                && (cluster.radius_m <= 0.5 * ground.radius_m || candidate.level == 0);
            // Lights that only a part of the ground has within 300 km are no smooth sum over all of it.
            let is_at_the_end = light_is_small && distance_m + ground.radius_m > MAX_SOURCE_DISTANCE_M;
            if is_near || is_at_the_end {
                left.push(candidate);
            } else if ground_is_small && light_is_small && !self.sources.is_touched(candidate) {
                self.add_cluster(ground, candidate, &cluster, node_sums);
            } else {
                open.extend(self.sources.children(candidate));
            }
        }
        left
    }

    /// What is left at the smallest patches: pixels, and blocks where those are small enough.
    fn near_lights(&self, ground: &PatchGround, candidates: Vec<Candidate>) -> NearLights {
        let mut near = NearLights::default();
        let mut open = candidates;
        while let Some(candidate) = open.pop() {
            let cluster = self.sources.cluster(candidate);
            let distance_m = EARTH_RADIUS_M * cluster.direction.distance(ground.middle);
            if self.sources.is_removed(candidate)
                || distance_m - ground.radius_m - cluster.radius_m > MAX_SOURCE_DISTANCE_M
            {
                continue;
            }
            let nearest_m = distance_m - ground.radius_m;
            let is_small = nearest_m > self.sources.sum.pixels_within_m()
                && cluster.radius_m <= self.sources.sum.far_light_ratio() * nearest_m;
            if candidate.level == 0 || is_small && !self.sources.is_touched(candidate) {
                near.push(&self.sources, ground.middle, candidate, &cluster);
            } else {
                open.extend(self.sources.children(candidate));
            }
        }
        near
    }

    fn add_cluster(
        &self,
        ground: &PatchGround,
        candidate: Candidate,
        cluster: &Cluster,
        node_sums: &mut NodeSums,
    ) {
        let (light, kernel) = self.sources.layer(candidate);
        let skylines = light.skylines_of(candidate.level as usize, candidate.index as usize);
        let place_m = (EARTH_RADIUS_M * (cluster.direction - ground.middle)).as_vec3();
        let (flux_dnb_w, altitude_m) = (cluster.flux_dnb_w as f32, cluster.altitude_m);
        let knows_azimuth = kernel.knows_azimuth();
        for (node, node_m) in ground.nodes_m.iter().enumerate() {
            let Some(ring) = RingPosition::of_square(node_m.distance_squared(place_m)) else {
                continue;
            };
            let blocking = skylines.map_or(0.0, |(skylines, index)| {
                let turns = turns_from_light(cluster.direction, ground.nodes[node]);
                skylines.blocking(index, turns, ring.log_distance())
            });
            let towards = match knows_azimuth {
                true => Compass::at(ground.nodes[node]).towards(place_m - *node_m),
                false => Vec2::ZERO,
            };
            for (step, sums) in node_sums.sums.iter_mut().enumerate() {
                let altitude = node_sums.lowest + step;
                let offset_m = (altitude_m - kernel.altitudes().node_m(altitude)) as f32;
                let blocking = blocking as f32;
                sums[node] +=
                    flux_dnb_w * self.sources.sum.at(kernel, altitude, ring, offset_m, blocking, towards);
            }
        }
    }
}
