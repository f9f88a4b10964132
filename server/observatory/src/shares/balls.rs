//! Sums over lights by their owners: lights are halved into balls, each with the candidates that may own some of it.

use crate::{influence_map::InfluenceMap, influence_part::Part, watch::Watch};
use glam::DVec3;
use skyglow_physics::EARTH_RADIUS_M;
use std::ops::Range;

/// Lights that are looked at one by one.
const LEAF_LIGHTS: usize = 32;
/// Lights whose halves are worth a thread each.
const LIGHTS_OF_A_THREAD: usize = 4096;

/// Sums over some lights: owners that have any, ascending.
#[derive(Debug, Default)]
pub(super) struct Sums {
    pub(super) of_owners: Vec<(u32, Part)>,
    pub(super) of_nobody: Part,
    pub(super) shared_pixels: u64,
}

/// Lights in a ball.
pub(super) struct Ball {
    middle: DVec3,
    pub(super) radius_m: f64,
}

/// Who may own lights.
pub(super) trait Owners: Sync {
    /// Those of the candidates that may own a light in the ball.
    fn of_ball(&self, ball: &Ball, candidates: &[u32]) -> Vec<u32>;
    /// Those of the candidates that own a light, ascending.
    fn of_light(&self, light: DVec3, candidates: &[u32], owners: &mut Vec<u32>);
}

/// Lights with what they do.
pub(super) struct Lights<'a> {
    pub(super) map: &'a InfluenceMap,
    pub(super) directions: Vec<DVec3>,
}

impl Lights<'_> {
    /// Added up in the order of the lights whatever the threads: the same map is to give the same bits.
    pub(super) fn sums(
        &self,
        range: Range<usize>,
        candidates: &[u32],
        owners: &impl Owners,
        watch: &Watch<'_>,
    ) -> Sums {
        let nearby = owners.of_ball(&Ball::around(&self.directions[range.clone()]), candidates);
        if nearby.is_empty() || range.len() <= LEAF_LIGHTS {
            return self.sums_one_by_one(range, &nearby, owners);
        }
        let middle = range.start + range.len() / 2;
        let halves = [range.start..middle, middle..range.end];
        let nearby = &nearby[..];
        let [first, second] = halves.map(|half| move || self.sums(half, nearby, owners, watch));
        if range.len() < LIGHTS_OF_A_THREAD {
            return first().with(second());
        }
        // Who gave up gets no answer from these.
        if !watch(range.start as f64 / self.directions.len() as f64) {
            return Sums::default();
        }
        let (first, second) = rayon::join(first, second);
        first.with(second)
    }

    fn sums_one_by_one(&self, range: Range<usize>, candidates: &[u32], owners: &impl Owners) -> Sums {
        let mut sums = Sums::default();
        let mut of_light = Vec::new();
        for at in range {
            of_light.clear();
            if !candidates.is_empty() {
                owners.of_light(self.directions[at], candidates, &mut of_light);
            }
            let (pixel, influence) = (&self.map.pixels()[at], self.map.influence()[at]);
            if of_light.is_empty() {
                sums.of_nobody.add(pixel, influence);
            }
            sums.shared_pixels += u64::from(of_light.len() > 1);
            for &owner in &of_light {
                let at = sums.of_owners.binary_search_by_key(&owner, |(known, _)| *known);
                let at = at.unwrap_or_else(|at| {
                    sums.of_owners.insert(at, (owner, Part::default()));
                    at
                });
                sums.of_owners[at].1.add(pixel, influence);
            }
        }
        sums
    }
}

impl Sums {
    fn with(mut self, other: Self) -> Self {
        self.of_nobody = self.of_nobody.with(other.of_nobody);
        self.shared_pixels += other.shared_pixels;
        // A stable sort: of the same owner the earlier lights come first.
        self.of_owners.extend(other.of_owners);
        self.of_owners.sort_by_key(|(owner, _)| *owner);
        self.of_owners.dedup_by(|next, first| {
            let is_same = next.0 == first.0;
            if is_same {
                first.1 = first.1.with(next.1);
            }
            is_same
        });
        self
    }
}

impl Ball {
    pub(super) fn around(directions: &[DVec3]) -> Self {
        let middle = directions.iter().sum::<DVec3>() / directions.len().max(1) as f64;
        let radius =
            directions.iter().map(|direction| direction.distance_squared(middle)).fold(0.0, f64::max);
        Self { middle, radius_m: EARTH_RADIUS_M * radius.sqrt() }
    }

    /// From the ball's middle to a place, along the chord, metres.
    pub(super) fn distance_m(&self, direction: DVec3) -> f64 {
        EARTH_RADIUS_M * self.middle.distance(direction)
    }
}
