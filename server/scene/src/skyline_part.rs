//! The part of skylines that one observer needs: the azimuths towards it, as far as it is away. A fifteenth of the work.
//!
//! Every code that [`Skylines::blocking`](crate::skylines::Skylines::blocking) reads for that observer, of lights and of the blocks that
//! may count as one, is the same number as in the whole skyline; others stay 0.

use crate::skyline_tile::SkylineTile;
use crate::skylines::{SKYLINE_AZIMUTH_COUNT, SKYLINE_DISTANCES_M};
use crate::turns::turns_from_light;
use glam::DVec3;
use skyglow_physics::EARTH_RADIUS_M;
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

/// Of a light that is nearer, metres, the whole skyline counts: its pixel is split, and the pieces see the observer elsewhere.
const WHOLE_WITHIN_M: f64 = 6_000.0;
/// Sine of a latitude (84°) beyond which whole skylines are found: north turns fast there.
const WHOLE_BEYOND_SINE: f64 = 0.995;
/// Azimuths on either side that are found too, of a step between azimuths.
const MARGIN_STEPS: f64 = 0.1;
/// How much farther is looked, of the distance.
const MARGIN_RATIO: f64 = 0.01;
/// When so many observers needed a part of a tile, all of it is cheaper.
const PARTS_BEFORE_WHOLE: u32 = 12;
/// Observers whose parts stay in memory: what is asked of one place is asked together.
const MOST_OBSERVERS: usize = 8;
/// Bytes of their parts, but for those of the last.
const MAX_BYTES: usize = 192 << 20;

/// An observer who sees lights from a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Observer {
    /// A unit vector.
    place: DVec3,
    /// Blocks count as one where their radius is at most this part of their distance.
    block_ratio: f64,
}

/// What of a skyline is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Part {
    /// The first azimuth, and how many.
    azimuths: (usize, usize),
    /// Of the distances, the last one's index.
    last_distance: usize,
}

impl Observer {
    pub(crate) fn new(place: DVec3, far_block_ratio: f64) -> Self {
        Self { place, block_ratio: far_block_ratio.max(0.0) }
    }

    /// The part of the skyline of a light, at a unit vector, that is wanted.
    pub(crate) fn part(&self, light: DVec3) -> Part {
        let distance_m = EARTH_RADIUS_M * light.distance(self.place);
        if distance_m < WHOLE_WITHIN_M || light.z.abs() > WHOLE_BEYOND_SINE {
            return Part::WHOLE;
        }
        // A block's middle lies in another direction than its light, and at another distance.
        let steps = SKYLINE_AZIMUTH_COUNT as f64;
        let margin = MARGIN_STEPS + steps * self.block_ratio.min(1.0).asin() / std::f64::consts::TAU;
        let towards = steps * turns_from_light(light, self.place);
        let first = (towards - margin).floor();
        let count = (towards + margin).floor() - first + 2.0;
        if count >= steps {
            return Part::WHOLE;
        }
        let farthest_m = distance_m * (1.0 + self.block_ratio + MARGIN_RATIO);
        let reaching = SKYLINE_DISTANCES_M.iter().position(|reach_m| *reach_m >= farthest_m);
        Part {
            azimuths: (first.rem_euclid(steps) as usize, count as usize),
            last_distance: reaching.unwrap_or(SKYLINE_DISTANCES_M.len() - 1),
        }
    }
}

impl Part {
    /// All of it.
    pub(crate) const WHOLE: Self =
        Self { azimuths: (0, SKYLINE_AZIMUTH_COUNT), last_distance: SKYLINE_DISTANCES_M.len() - 1 };

    /// Indices of the azimuths.
    pub(crate) fn azimuths(&self) -> impl Iterator<Item = usize> + use<> {
        let (first, count) = self.azimuths;
        (first..first + count).map(|azimuth| azimuth % SKYLINE_AZIMUTH_COUNT)
    }

    /// The distances, metres; those that are not wanted are those of the last that is, beyond which no time is spent.
    pub(crate) fn distances_m(&self) -> [f64; SKYLINE_DISTANCES_M.len()] {
        SKYLINE_DISTANCES_M.map(|distance_m| distance_m.min(SKYLINE_DISTANCES_M[self.last_distance]))
    }
}

/// Parts of tiles in memory.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    /// By the index of the tile's block; of the last observer first.
    of_observers: VecDeque<(Observer, HashMap<usize, Arc<SkylineTile>>)>,
    /// How many observers needed a part of a tile.
    made: HashMap<usize, u32>,
}

impl Parts {
    /// Those of an observer.
    pub(crate) fn of(&self, observer: &Observer) -> Option<&HashMap<usize, Arc<SkylineTile>>> {
        self.of_observers.iter().find(|(other, _)| other == observer).map(|(_, tiles)| tiles)
    }

    /// Whether all of a tile is to be made, since parts of it were made often.
    pub(crate) fn are_many(&self, tile: usize) -> bool {
        self.made.get(&tile).is_some_and(|made| *made >= PARTS_BEFORE_WHOLE)
    }

    /// Keeps those that were made for an observer.
    pub(crate) fn keep(
        &mut self,
        observer: &Observer,
        parts: impl IntoIterator<Item = (usize, Arc<SkylineTile>)>,
    ) {
        let at = self.of_observers.iter().position(|(other, _)| other == observer);
        let mut of = at.and_then(|at| self.of_observers.remove(at)).unwrap_or((*observer, HashMap::new()));
        for (tile, part) in parts {
            *self.made.entry(tile).or_default() += 1;
            of.1.insert(tile, part);
        }
        self.of_observers.push_front(of);
        let bytes = |parts: &HashMap<_, Arc<SkylineTile>>| parts.values().map(|part| part.byte_count()).sum();
        let mut total: usize = self.of_observers.iter().map(|(_, parts)| bytes(parts)).sum();
        while self.of_observers.len() > MOST_OBSERVERS || total > MAX_BYTES && self.of_observers.len() > 1 {
            total -= self.of_observers.pop_back().map_or(0, |(_, parts)| bytes(&parts));
        }
    }

    /// Forgets those of a tile that is there as a whole.
    pub(crate) fn forget(&mut self, tile: usize) {
        self.made.remove(&tile);
        self.of_observers.iter_mut().for_each(|(_, parts)| drop(parts.remove(&tile)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use skyglow_physics::GeoPoint;
    use std::f64::consts::TAU;

    proptest! {
        /// Both azimuths beside the observer are in the part of a light and of every light of its block, and the distance is covered.
        #[test]
        fn a_part_has_what_an_observer_reads(
            latitude in -83.0f64..83.0, turns in 0.0f64..1.0, log_distance in 8.8f64..12.6,
            off in 0.0f64..1.0, aside in 0.0f64..1.0,
        ) {
            let block = GeoPoint::from_deg(latitude, 179.9).unwrap();
            let distance_m = log_distance.exp();
            let place = block.destination(turns * TAU, distance_m).unit_vector();
            let observer = Observer::new(place, 0.1);
            // A light of a block as large as one may be.
            let light = block.destination(off * TAU, aside * 0.1 * distance_m).unit_vector();
            let part = observer.part(light);
            let azimuths: Vec<usize> = part.azimuths().collect();
            for seen in [block.unit_vector(), light] {
                let left = (SKYLINE_AZIMUTH_COUNT as f64 * turns_from_light(seen, place)) as usize;
                for azimuth in [left, left + 1] {
                    prop_assert!(azimuths.contains(&(azimuth % SKYLINE_AZIMUTH_COUNT)), "{azimuths:?} {left}");
                }
                let arc_m = EARTH_RADIUS_M * seen.angle_between(place);
                let last_m = SKYLINE_DISTANCES_M[part.last_distance];
                prop_assert!(last_m >= arc_m || part.last_distance == SKYLINE_DISTANCES_M.len() - 1);
            }
            let alone = Observer::new(place, -1.0).part(block.unit_vector());
            prop_assert!(distance_m < WHOLE_WITHIN_M || alone.azimuths().count() <= 4);
        }
    }
}
