//! One line of sight over one raster, front to back: ground that its maximum mipmap bounds below the highest ground so far is
//! skipped, other cells are traversed one by one (Amanatides & Woo 1987).

use super::cell::{CellCrossing, RaySegment};
use super::max_mipmap::{BLOCK_CELLS, MaxMipmap};
use super::raster::TerrainRaster;
use super::tile::SIDE;
use skyglow_physics::EARTH_RADIUS_M;
use skyglow_physics::horizon::terrain_elevation_tangent;
use std::sync::Arc;

/// Nearer ground does not count, metres.
pub(super) const MIN_GROUND_DISTANCE_M: f64 = 1.0;

/// By how much the tangent of ground must exceed that of the highest ground so far to be examined.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tolerance {
    pub(super) relative: f64,
    pub(super) absolute: f64,
}

impl Tolerance {
    pub(super) const NONE: Self = Self { relative: 0.0, absolute: 0.0 };
}

/// A line of sight and the highest ground along it so far.
pub(super) struct Ray<'a> {
    raster: &'a TerrainRaster,
    maxima: &'a MaxMipmap,
    observer_altitude_m: f64,
    /// Whether another raster takes precedence at a distance, metres; None where no raster may.
    cover: Option<&'a dyn Fn(f64) -> bool>,
    /// tan e of the highest ground so far, at least 0.
    tangent: f64,
    /// How much higher ground must be to be examined.
    tolerance: Tolerance,
    /// Cached tiles, by the parity of their column and row: neighbours never evict each other.
    tiles: [(usize, Option<Arc<Vec<f32>>>); 4],
}

impl<'a> Ray<'a> {
    /// A line of sight over a raster that ignores ground below `tangent`.
    pub(super) fn new(
        raster: &'a TerrainRaster,
        observer_altitude_m: f64,
        tangent: f64,
        cover: Option<&'a dyn Fn(f64) -> bool>,
        tolerance: Tolerance,
    ) -> Self {
        let tiles = std::array::from_fn(|_| (usize::MAX, None));
        Self { raster, maxima: raster.maxima(), observer_altitude_m, cover, tangent, tolerance, tiles }
    }

    /// tan e of the highest ground so far, at least that of the start.
    pub(super) fn tangent(&self) -> f64 {
        self.tangent
    }

    /// Whether ground of some altitude, at a distance or farther, would be seen: never false where
    /// [`terrain_elevation_tangent`] is above the highest so far, by the first terms of its sine and cosine, which bound them.
    pub(super) fn may_be_visible(&self, altitude_m: f64, distance_m: f64) -> bool {
        let arc = distance_m.max(MIN_GROUND_DISTANCE_M) / EARTH_RADIUS_M;
        let (square, radius_m) = (arc * arc, EARTH_RADIUS_M + altitude_m);
        let drop_m = radius_m * square * (0.5 - square / 24.0);
        let threshold = self.tangent * (1.0 + self.tolerance.relative) + self.tolerance.absolute;
        altitude_m - self.observer_altitude_m - drop_m > threshold * radius_m * arc * (1.0 - square / 6.0)
    }

    /// Examines a segment.
    pub(super) fn scan(&mut self, segment: &RaySegment) {
        let grid = self.raster.grid();
        if let Some(segment) = segment.clipped((f64::from(grid.width), f64::from(grid.height))) {
            self.descend(&segment);
        }
    }

    fn descend(&mut self, segment: &RaySegment) {
        let cells = |a: f64, b: f64| a.min(b) as usize..=a.max(b) as usize;
        let columns = cells(segment.start.0, segment.end.0);
        let highest_m = self.maxima.max_over_m(columns, cells(segment.start.1, segment.end.1));
        if !self.may_be_visible(highest_m, segment.start_m) {
            return;
        }
        if segment.extent() <= BLOCK_CELLS {
            return self.cross_cells(segment);
        }
        self.descend(&segment.part(0.0, 0.5));
        self.descend(&segment.part(0.5, 1.0));
    }

    /// Examines every cell that a segment crosses.
    fn cross_cells(&mut self, segment: &RaySegment) {
        let runs = (segment.end.0 - segment.start.0, segment.end.1 - segment.start.1);
        // The fraction of the segment at which it meets the next line between cells, and from line to line.
        let lines = |start: f64, run: f64| {
            let to_line = if run > 0.0 { start.floor() + 1.0 - start } else { start.ceil() - 1.0 - start };
            if run == 0.0 { (f64::INFINITY, f64::INFINITY) } else { (to_line / run, 1.0 / run.abs()) }
        };
        let (mut next_u, step_u) = lines(segment.start.0, runs.0);
        let (mut next_v, step_v) = lines(segment.start.1, runs.1);
        let mut from = 0.0;
        while from < 1.0 {
            let to = next_u.min(next_v).min(1.0);
            if to > from {
                self.cross_cell(&segment.part(from, to));
            }
            if next_u <= to {
                next_u += step_u;
            }
            if next_v <= to {
                next_v += step_v;
            }
            from = to;
        }
    }

    /// Examines a segment within one cell.
    fn cross_cell(&mut self, segment: &RaySegment) {
        let middle = (0.5 * (segment.start.0 + segment.end.0), 0.5 * (segment.start.1 + segment.end.1));
        let (u, v) = (middle.0.floor(), middle.1.floor());
        let (i, j) = (u as usize, v as usize);
        let corners =
            [self.sample(i, j), self.sample(i + 1, j), self.sample(i, j + 1), self.sample(i + 1, j + 1)];
        let highest_m = corners.iter().copied().filter(|h| h.is_finite()).fold(f32::NEG_INFINITY, f32::max);
        if !self.may_be_visible(f64::from(highest_m), segment.start_m) {
            return;
        }
        let crossing = CellCrossing::new(segment, corners.map(f64::from), (u, v));
        let cover = self.cover;
        let is_covered = |t: f64| cover.is_some_and(|cover| cover(segment.distance_m(t)));
        let covered = [0.0, 0.5, 1.0].map(is_covered);
        if covered == [false; 3] && crossing.is_whole() {
            let crest = crossing.crest(self.observer_altitude_m);
            for t in [Some(0.0), Some(1.0), crest].into_iter().flatten() {
                self.include(crossing.height_m(t), segment.distance_m(t));
            }
        } else if covered != [true; 3] {
            let ground_m = |t: f64| crossing.height_m(t).filter(|_| !is_covered(t));
            crossing.with_edges(&ground_m, |t, height_m| self.include(Some(height_m), segment.distance_m(t)));
            // Where another raster covers a part of the cell, the highest ground is at its edge, or the crest where that is free.
            let crest = if crossing.is_whole() { crossing.crest(self.observer_altitude_m) } else { None };
            if let Some(t) = crest.filter(|t| !is_covered(*t)) {
                self.include(crossing.height_m(t), segment.distance_m(t));
            }
        }
    }

    /// Takes a point of the ground into account.
    fn include(&mut self, altitude_m: Option<f64>, distance_m: f64) {
        if let Some(altitude_m) = altitude_m.filter(|_| distance_m >= MIN_GROUND_DISTANCE_M) {
            let tangent = terrain_elevation_tangent(self.observer_altitude_m, altitude_m, distance_m);
            self.tangent = self.tangent.max(tangent);
        }
    }

    /// The sample left of and above cell (column, row), of those around the raster too, else clamped to those there are, metres;
    /// NaN for a void.
    fn sample(&mut self, column: usize, row: usize) -> f32 {
        let grid = self.raster.grid();
        let wanted = (column as i64 - 1, row as i64 - 1);
        let column = column.saturating_sub(1).min(grid.width as usize - 1);
        let row = row.saturating_sub(1).min(grid.height as usize - 1);
        if (column as i64, row as i64) != wanted {
            let border_m = self.raster.border_m(0, wanted.0, wanted.1);
            if border_m.is_finite() {
                return border_m;
            }
        }
        let (tile_column, tile_row) = (column / SIDE, row / SIDE);
        let number = tile_row * self.raster.tile_columns() + tile_column;
        let slot = &mut self.tiles[(tile_row & 1) * 2 + (tile_column & 1)];
        if slot.0 != number {
            *slot = (number, self.raster.cached(0, number));
        }
        slot.1.as_ref().map_or(f32::NAN, |samples| samples[row % SIDE * SIDE + column % SIDE])
    }
}
