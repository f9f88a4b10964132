//! Patches: rectangles of places, the nodes of the target tree, and the ground that they lie on.

use super::chebyshev::{Interval, NODE_COUNT};
use super::place_lattice::PlaceLattice;
use super::place_window::PlaceWindow;
use crate::grid::Grid;
use glam::{DVec3, Vec3};
use skyglow_physics::EARTH_RADIUS_M;
use std::ops::Range;

/// Interpolation nodes of a patch.
pub(super) const PATCH_NODES: usize = NODE_COUNT * NODE_COUNT;

/// A rectangle of places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Patch {
    pub(super) columns: Interval,
    pub(super) rows: Interval,
}

impl Patch {
    /// All of a window.
    pub(super) fn of(window: &PlaceWindow) -> Self {
        let of = |range: &Range<u32>| Interval { first: range.start, last: range.end - 1 };
        Self { columns: of(&window.columns), rows: of(&window.rows) }
    }

    pub(super) fn window(&self) -> PlaceWindow {
        let of = |interval: Interval| interval.first..interval.last + 1;
        PlaceWindow { columns: of(self.columns), rows: of(self.rows) }
    }

    pub(super) fn len(&self) -> usize {
        self.columns.len() as usize * self.rows.len() as usize
    }

    /// Columns and rows of its places, row by row.
    pub(super) fn places(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let Self { columns, rows } = *self;
        (rows.first..=rows.last)
            .flat_map(move |row| (columns.first..=columns.last).map(move |column| (column, row)))
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
    pub(super) fn parts(&self) -> impl Iterator<Item = Self> {
        let Self { columns, rows } = *self;
        let longest = columns.len().max(rows.len());
        let of = move |interval: Interval| {
            let count = if 2 * interval.len() > longest { 2 } else { 0 };
            interval.halves().take(count).chain((count == 0).then_some(interval))
        };
        of(rows).flat_map(move |rows| of(columns).map(move |columns| Self { columns, rows }))
    }

    pub(super) fn longest(&self) -> u32 {
        self.columns.len().max(self.rows.len())
    }
}

/// Where a patch lies.
pub(super) struct PatchGround {
    pub(super) middle: DVec3,
    /// No place of it lies farther than this from the middle, metres.
    pub(super) radius_m: f64,
    pub(super) nodes: [DVec3; PATCH_NODES],
    /// From the middle, metres.
    pub(super) nodes_m: [Vec3; PATCH_NODES],
}

impl PatchGround {
    /// The ground of a patch of a lattice on a raster.
    pub(super) fn of(patch: Patch, lattice: PlaceLattice, grid: &Grid) -> Self {
        let point = |column: f64, row: f64| lattice.point(grid, column, row);
        let (columns, rows) = (patch.columns.nodes(), patch.rows.nodes());
        let ends = |interval: Interval| [interval.first, interval.last].map(f64::from);
        let middle_of = |interval: Interval| {
            let [first, last] = ends(interval);
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
        Self { middle, radius_m, nodes, nodes_m }
    }

    /// Whether all of it is on the Earth, as far as its nodes and its border say.
    pub(super) fn is_whole(&self) -> bool {
        self.radius_m.is_finite() && self.nodes.iter().all(|node| node.is_finite())
    }
}
