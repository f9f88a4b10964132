//! Stretches of ground and what far lights add up to over them.

use super::near::{NearLights, Observer};
use super::nodes::{NODE_COUNT, Stretch};
use super::{FAR_GROUND_RATIO, FEWEST_PLACES, PlaceLattice};
use crate::gather::{Light, turns_from_light};
use crate::grid::Grid;
use crate::morton;
use crate::place_kernel::{PlaceKernel, RingPosition};
use glam::{DVec3, Vec3};
use skyglow_physics::EARTH_RADIUS_M;
use skyglow_physics::source_pixel::{FARTHEST_SOURCE_M, SPLIT_WITHIN_M};

/// Largest distance of a light from the middle of its block beside the distance of the ground that takes the block for its lights.
pub(super) const FAR_LIGHT_RATIO: f64 = 0.06;
/// Longest side of the patches whose lights are added place by place, metres, but for patches of one place: nearer than that, all
/// lights are near.
const LARGEST_SMALL_PATCH_M: f64 = 8_000.0;
/// Nodes of a patch.
const PATCH_NODES: usize = NODE_COUNT * NODE_COUNT;

/// A rectangle of places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Patch {
    pub(super) columns: Stretch,
    pub(super) rows: Stretch,
}

impl Patch {
    /// All of a lattice.
    pub(super) fn of(lattice: PlaceLattice) -> Self {
        Self {
            columns: Stretch { first: 0, last: lattice.columns - 1 },
            rows: Stretch { first: 0, last: lattice.rows - 1 },
        }
    }

    pub(super) fn len(&self) -> usize {
        self.columns.len() as usize * self.rows.len() as usize
    }

    /// Copies values, row by row, to where they belong among those of `whole`, which this is a part of.
    pub(super) fn write(&self, values: &[f32], whole: Self, all: &mut [f32]) {
        let width = self.columns.len() as usize;
        let columns = whole.columns.len() as usize;
        for (row, values) in (self.rows.first - whole.rows.first..).zip(values.chunks_exact(width)) {
            let first = row as usize * columns + (self.columns.first - whole.columns.first) as usize;
            all[first..first + width].copy_from_slice(values);
        }
    }

    /// Its halves along its longer side, along both where those are alike.
    fn parts(&self) -> impl Iterator<Item = Self> {
        let Self { columns, rows } = *self;
        let longest = columns.len().max(rows.len());
        let of = move |stretch: Stretch| {
            let count = if 2 * stretch.len() > longest { 2 } else { 0 };
            stretch.halves().take(count).chain((count == 0).then_some(stretch))
        };
        of(rows).flat_map(move |rows| of(columns).map(move |columns| Self { columns, rows }))
    }

    fn longest(&self) -> u32 {
        self.columns.len().max(self.rows.len())
    }
}

/// A block of lights (a pixel at level 0) of a layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) layer: u32,
    pub(super) level: u32,
    pub(super) index: u32,
}

/// A block of lights as one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lump {
    pub(super) direction: DVec3,
    pub(super) flux_dnb_w: f64,
    pub(super) altitude_m: f64,
    pub(super) radius_m: f64,
}

/// What all lights add up to over the ground of a scene.
pub(super) struct Spreader<'a> {
    pub(super) grid: &'a Grid,
    pub(super) lattice: PlaceLattice,
    /// From one place to the next, metres.
    pub(super) step_m: f64,
    pub(super) altitudes_m: &'a [f32],
    pub(super) lights: &'a [(Light<'a>, &'a PlaceKernel)],
}

/// Sums over far lights at the nodes of a patch.
struct NodeSums {
    patch: Patch,
    /// The lowest altitude of the kernels that they are known for.
    lowest: usize,
    /// `[altitude][node row][node column]`.
    sums: Vec<[f32; PATCH_NODES]>,
}

/// Where a patch lies.
struct PatchGround {
    middle: DVec3,
    /// No place of it lies farther than this from the middle, metres.
    radius_m: f64,
    nodes: [DVec3; PATCH_NODES],
    /// From the middle, metres.
    nodes_m: [Vec3; PATCH_NODES],
}

impl PatchGround {
    /// Whether all of it is on the Earth, as far as its nodes and its border say.
    fn is_whole(&self) -> bool {
        self.radius_m.is_finite() && self.nodes.iter().all(|node| node.is_finite())
    }
}

impl Spreader<'_> {
    /// The sums at the places of a patch, row by row.
    pub(super) fn of_patch(&self, patch: Patch, candidates: &[Candidate]) -> Vec<f32> {
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
        let Some((lowest, highest)) = self.altitudes_of(patch) else {
            return;
        };
        let ground = self.ground_of(patch);
        let mut of_nodes = NodeSums::inherit(patch, (lowest, highest), inherited);
        // A patch over the edge of the world has nodes that are nowhere: only its parts are asked.
        let left = match ground.is_whole() {
            true => self.take_far(&ground, candidates, &mut of_nodes),
            false => candidates.to_vec(),
        };
        let is_small = patch.longest() <= FEWEST_PLACES
            && f64::from(patch.longest()) * self.step_m <= LARGEST_SMALL_PATCH_M
            && ground.is_whole();
        if !is_small && patch.len() > 1 {
            for part in patch.parts() {
                self.add(part, &left, Some(&of_nodes), write);
            }
            return;
        }
        let near = self.near_lights(&ground, left);
        let mut values = Vec::with_capacity(patch.len());
        for row in patch.rows.first..=patch.rows.last {
            for column in patch.columns.first..=patch.columns.last {
                let altitude_m = self.altitude_m(column, row);
                if !altitude_m.is_finite() {
                    values.push(f32::NAN);
                    continue;
                }
                let direction = self.lattice.point(self.grid, f64::from(column), f64::from(row));
                let place_m = (EARTH_RADIUS_M * (direction - ground.middle)).as_vec3();
                let observer = Observer { direction, place_m, altitude_m };
                let far = self.lights.first().map_or(0.0, |(_, kernel)| {
                    of_nodes.at(f64::from(column), f64::from(row), kernel.altitudes().position(altitude_m))
                });
                values.push(far + near.at(self.lights, &observer));
            }
        }
        write(patch, &values);
    }

    fn altitude_m(&self, column: u32, row: u32) -> f32 {
        self.altitudes_m[row as usize * self.lattice.columns as usize + column as usize]
    }

    /// The kernels' altitudes around the ground of a patch; None where none of its places can have an observer.
    fn altitudes_of(&self, patch: Patch) -> Option<(usize, usize)> {
        let axis = self.lights.first().map(|(_, kernel)| kernel.altitudes());
        let mut range: Option<(usize, usize)> = None;
        for row in patch.rows.first..=patch.rows.last {
            for column in patch.columns.first..=patch.columns.last {
                let altitude_m = self.altitude_m(column, row);
                if altitude_m.is_finite() {
                    let below = axis.map_or(0, |axis| axis.position(altitude_m).0);
                    let (lowest, highest) = range.unwrap_or((below, below + 1));
                    range = Some((lowest.min(below), highest.max(below + 1)));
                }
            }
        }
        range
    }

    fn ground_of(&self, patch: Patch) -> PatchGround {
        let point = |column: f64, row: f64| self.lattice.point(self.grid, column, row);
        let (columns, rows) = (patch.columns.nodes(), patch.rows.nodes());
        let ends = |stretch: Stretch| [stretch.first, stretch.last].map(f64::from);
        let middle_of = |stretch: Stretch| {
            let [first, last] = ends(stretch);
            0.5 * (first + last)
        };
        let middle = point(middle_of(patch.columns), middle_of(patch.rows));
        let nodes: [DVec3; PATCH_NODES] =
            std::array::from_fn(|node| point(columns[node % NODE_COUNT], rows[node / NODE_COUNT]));
        let ([west, east], [north, south]) = (ends(patch.columns), ends(patch.rows));
        let corners = [(west, north), (east, north), (west, south), (east, south)];
        let sides = columns.map(|column| [(column, north), (column, south)]).into_iter().flatten();
        let sides = sides.chain(rows.map(|row| [(west, row), (east, row)]).into_iter().flatten());
        let border = corners.into_iter().chain(sides).map(|(column, row)| point(column, row));
        // No number where one of them is nowhere.
        let larger = |a: f64, b: f64| if b <= a { a } else { b };
        let radius_m = border.map(|point| EARTH_RADIUS_M * point.distance(middle)).fold(0.0, larger);
        let radius_m = if middle.is_finite() { radius_m } else { f64::NAN };
        let nodes_m = nodes.map(|node| (EARTH_RADIUS_M * (node - middle)).as_vec3());
        PatchGround { middle, radius_m, nodes, nodes_m }
    }

    /// Adds the lights that are far from a patch at its nodes; the others are left.
    fn take_far(
        &self,
        ground: &PatchGround,
        candidates: &[Candidate],
        of_nodes: &mut NodeSums,
    ) -> Vec<Candidate> {
        let mut left = Vec::new();
        let mut open = candidates.to_vec();
        while let Some(candidate) = open.pop() {
            let lump = self.lump(candidate);
            let distance_m = EARTH_RADIUS_M * lump.direction.distance(ground.middle);
            if self.is_gone(candidate) || distance_m - ground.radius_m - lump.radius_m > FARTHEST_SOURCE_M {
                continue;
            }
            let nearest_m = distance_m - ground.radius_m;
            let ground_is_small = ground.radius_m <= FAR_GROUND_RATIO * (distance_m - lump.radius_m);
            let light_is_small = lump.radius_m <= FAR_LIGHT_RATIO * nearest_m;
            // Of a block larger than the ground some parts may be far.
            let is_near = (!ground_is_small || nearest_m - lump.radius_m < SPLIT_WITHIN_M)
                && (lump.radius_m <= 0.5 * ground.radius_m || candidate.level == 0);
            // Lights that only a part of the ground has within 300 km are no smooth sum over all of it.
            let is_at_the_end = light_is_small && distance_m + ground.radius_m > FARTHEST_SOURCE_M;
            if is_near || is_at_the_end {
                left.push(candidate);
            } else if ground_is_small && light_is_small && !self.is_touched(candidate) {
                self.add_lump(ground, candidate, &lump, of_nodes);
            } else {
                self.open(candidate, |child| open.push(child));
            }
        }
        left
    }

    /// What is left at the smallest patches: pixels, and blocks where those are small enough.
    fn near_lights(&self, ground: &PatchGround, candidates: Vec<Candidate>) -> NearLights {
        let mut near = NearLights::default();
        let mut open = candidates;
        while let Some(candidate) = open.pop() {
            let lump = self.lump(candidate);
            let distance_m = EARTH_RADIUS_M * lump.direction.distance(ground.middle);
            if self.is_gone(candidate) || distance_m - ground.radius_m - lump.radius_m > FARTHEST_SOURCE_M {
                continue;
            }
            let nearest_m = distance_m - ground.radius_m;
            let is_small = nearest_m > SPLIT_WITHIN_M && lump.radius_m <= FAR_LIGHT_RATIO * nearest_m;
            if candidate.level == 0 || is_small && !self.is_touched(candidate) {
                near.push(self.grid, self.lights, ground.middle, candidate, &lump);
            } else {
                self.open(candidate, |child| open.push(child));
            }
        }
        near
    }

    fn add_lump(&self, ground: &PatchGround, candidate: Candidate, lump: &Lump, of_nodes: &mut NodeSums) {
        let (light, kernel) = &self.lights[candidate.layer as usize];
        let skylines = light.skylines_of(candidate.level as usize, candidate.index as usize);
        let place_m = (EARTH_RADIUS_M * (lump.direction - ground.middle)).as_vec3();
        let (flux_dnb_w, altitude_m) = (lump.flux_dnb_w as f32, lump.altitude_m);
        for (node, node_m) in ground.nodes_m.iter().enumerate() {
            let Some(ring) = RingPosition::of_square(node_m.distance_squared(place_m)) else {
                continue;
            };
            let blocking = skylines.map_or(0.0, |skylines| {
                let turns = turns_from_light(lump.direction, ground.nodes[node]);
                skylines.blocking(candidate.index as usize, turns, ring.log_distance())
            });
            for (step, sums) in of_nodes.sums.iter_mut().enumerate() {
                let altitude = of_nodes.lowest + step;
                let offset_m = (altitude_m - kernel.altitudes().node_m(altitude)) as f32;
                sums[node] += flux_dnb_w * kernel.at(altitude, ring, offset_m, blocking as f32);
            }
        }
    }

    fn is_touched(&self, Candidate { layer, level, index }: Candidate) -> bool {
        let gone = self.lights[layer as usize].0.gone;
        level > 0 && gone.is_some_and(|gone| gone.is_touched(level as usize, index as usize))
    }

    fn is_gone(&self, Candidate { layer, level, index }: Candidate) -> bool {
        let is_gone = |gone: &crate::changes::GoneLights| match level {
            0 => gone.is_gone(index as usize),
            level => gone.is_empty_block(level as usize, index as usize),
        };
        self.lights[layer as usize].0.gone.is_some_and(is_gone)
    }

    fn open(&self, Candidate { layer, level, index }: Candidate, mut take: impl FnMut(Candidate)) {
        let children = self.lights[layer as usize].0.pyramid.level(level as usize).children(index as usize);
        children.for_each(|child| take(Candidate { layer, level: level - 1, index: child as u32 }));
    }

    fn lump(&self, Candidate { layer, level, index }: Candidate) -> Lump {
        let light = &self.lights[layer as usize].0;
        let index = index as usize;
        if level > 0 {
            let block = &light.pyramid.level(level as usize).blocks[index];
            return Lump {
                direction: block.direction,
                flux_dnb_w: block.flux_dnb_w,
                altitude_m: block.altitude_m,
                radius_m: block.radius_m,
            };
        }
        let (column, row) = morton::decode(light.pixels.codes[index]);
        Lump {
            direction: self.grid.center(column, row),
            flux_dnb_w: light.pixels.flux_dnb_w(self.grid, light.calibration, index),
            altitude_m: f64::from(light.pixels.altitude_m[index]),
            radius_m: 0.0,
        }
    }
}

impl NodeSums {
    /// Those of the patch that a patch is part of, at its own nodes.
    fn inherit(patch: Patch, (lowest, highest): (usize, usize), from: Option<&Self>) -> Self {
        let mut sums = vec![[0f32; PATCH_NODES]; highest - lowest + 1];
        if let Some(from) = from {
            let columns = patch.columns.nodes().map(|node| from.patch.columns.weights_at(node));
            let rows = patch.rows.nodes().map(|node| from.patch.rows.weights_at(node));
            for (sums, from) in sums.iter_mut().zip(&from.sums[lowest - from.lowest..]) {
                for (node, sum) in sums.iter_mut().enumerate() {
                    *sum = mix(from, &columns[node % NODE_COUNT], &rows[node / NODE_COUNT]);
                }
            }
        }
        Self { patch, lowest, sums }
    }

    /// At a place of the patch and an altitude: the node below on the kernels' axis and the weight of the next.
    fn at(&self, column: f64, row: f64, (below, up): (usize, f32)) -> f32 {
        let (columns, rows) = (self.patch.columns.weights_at(column), self.patch.rows.weights_at(row));
        let [low, high] = [0, 1].map(|step| mix(&self.sums[below - self.lowest + step], &columns, &rows));
        (low + up * (high - low)).max(0.0)
    }
}

fn mix(nodes: &[f32; PATCH_NODES], columns: &[f32; NODE_COUNT], rows: &[f32; NODE_COUNT]) -> f32 {
    let of_row = |(row, weight): (&[f32], &f32)| {
        weight * row.iter().zip(columns).map(|(value, weight)| value * weight).sum::<f32>()
    };
    nodes.chunks_exact(NODE_COUNT).zip(rows).map(of_row).sum()
}
