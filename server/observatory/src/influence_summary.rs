//! Influences added up: by distance, by azimuth, inside a boundary, and the most of them.

use crate::{influence_map::InfluenceMap, influence_part::Part};
use rayon::prelude::*;
use skyglow_physics::GeoPoint;
use skyglow_scene::Boundary;
use std::f64::consts::TAU;

/// Edges of the rings of distance, metres.
pub const RING_EDGES_M: [f64; 11] = [
    0.0, 5_000.0, 10_000.0, 20_000.0, 30_000.0, 50_000.0, 75_000.0, 100_000.0, 150_000.0, 200_000.0,
    300_000.0,
];
/// Sectors of azimuth; the first is centred on north.
pub const SECTOR_COUNT: usize = 8;

/// Pixels that all have the brightest colour of a map.
const OUTSHINING_COUNT: usize = 32;

impl InfluenceMap {
    /// All lights within 300 km. For a linear measure their influence is the sky's own value of it.
    pub fn total(&self) -> Part {
        self.total
    }

    /// Between neighbouring [`RING_EDGES_M`]; a pixel belongs to the ring that its centre is in.
    pub fn rings(&self) -> [Part; RING_EDGES_M.len() - 1] {
        let mut parts = [Part::default(); RING_EDGES_M.len() - 1];
        self.add_up(&mut parts, |position| {
            let distance_m = f64::from(self.pixels()[position].distance_m);
            // The outermost may be beyond its edge by what f32 rounds.
            Some(
                (RING_EDGES_M.partition_point(|edge_m| *edge_m <= distance_m) - 1)
                    .min(RING_EDGES_M.len() - 2),
            )
        });
        parts
    }

    /// Sectors of azimuth as wide as each other, clockwise from that around north.
    pub fn sectors(&self) -> [Part; SECTOR_COUNT] {
        let mut parts = [Part::default(); SECTOR_COUNT];
        self.add_up(&mut parts, |position| {
            let turns = f64::from(self.pixels()[position].azimuth_rad) / TAU;
            Some((turns * SECTOR_COUNT as f64 + 0.5) as usize % SECTOR_COUNT)
        });
        parts
    }

    /// Lights whose pixel's centre is inside a boundary.
    pub fn within(&self, boundary: &Boundary) -> Part {
        let inside: Vec<bool> = (0..self.pixels().len())
            .into_par_iter()
            .map(|position| boundary.contains(self.place(position)))
            .collect();
        let mut parts = [Part::default()];
        self.add_up(&mut parts, |position| inside[position].then_some(0));
        parts[0]
    }

    /// Positions of the `count` most influential of [`Self::pixels`], the most first; of equals the one earlier in the list.
    pub fn most(&self, count: usize) -> Vec<usize> {
        let influence = self.influence();
        let order = |a: &usize, b: &usize| influence[*b].total_cmp(&influence[*a]).then(a.cmp(b));
        let mut positions: Vec<usize> =
            (0..influence.len()).filter(|&position| influence[position] > 0.0).collect();
        if count == 0 {
            return Vec::new();
        }
        if positions.len() > count {
            positions.select_nth_unstable_by(count - 1, order);
            positions.truncate(count);
        }
        positions.sort_unstable_by(order);
        positions
    }

    /// The influence that a map shows brightest: that of the 32nd most influential pixel, or of the last where there are fewer,
    /// for the lights right around the observer outshine by far those that make the glow; 0 without light.
    pub fn brightest_colour(&self) -> f64 {
        let influence_of = |position: &usize| f64::from(self.influence()[*position]);
        *self.brightest.get_or_init(|| self.most(OUTSHINING_COUNT).last().map_or(0.0, influence_of))
    }

    /// Centre of one of [`Self::pixels`].
    pub fn place(&self, position: usize) -> GeoPoint {
        let scene = self.open_scene();
        let (column, row) = scene.column_and_row(self.pixels()[position].number);
        scene.pixel_center(column, row)
    }

    fn add_up(&self, parts: &mut [Part], part_of: impl Fn(usize) -> Option<usize>) {
        for (position, (pixel, influence)) in self.pixels().iter().zip(self.influence()).enumerate() {
            if let Some(part) = part_of(position) {
                parts[part].add(pixel, *influence);
            }
        }
    }
}
