//! Dual-tree (Barnes & Hut 1986, Gray & Moore 2001) sum of all lights at every place of a lattice:
//! Σ flux · kernel(distance, altitudes, skyline) (`docs/model.md#brightness`).
//!
//! The direct sum takes places × lights. Here both are trees, patches of the lattice halved again and again and the light pyramid,
//! and far pairs interact high up in both:
//!
//! * a cluster of lights acts on a patch at 4 × 4 Chebyshev nodes and at the kernel's altitudes around its ground, where the
//!   patch is small relative to their distance and that is 5 km or more; the parts of a patch inherit its sums by
//!   interpolation, which is good to a few thousandths ([`chebyshev`]);
//! * a block stands for its lights at their flux-weighted centre where it is small relative to its distance, and is opened
//!   otherwise;
//! * what is left at leaf patches of 8 × 8 places is added place by place ([`near_field`]).
//!
//! `tests/dual_tree.rs` compares it with the direct sum over places and pixels.

mod accumulator;
mod chebyshev;
mod near_field;
mod node_sums;
mod patch;
mod patch_store;
mod place_lattice;
mod place_values;
mod place_window;
mod sources;

pub(crate) use accumulator::Accumulator;
pub(crate) use near_field::for_each_point;
pub use patch_store::PatchStore;
pub(crate) use patch_store::Stage;
pub use place_lattice::PlaceLattice;
pub(crate) use place_lattice::ground_altitudes_m;
pub use place_values::PlaceValues;
pub use place_window::{Observers, PlaceWindow};
pub(crate) use sources::{Sources, SumOf};

use crate::grid::Grid;
use crate::skyline_view::Disc;
use accumulator::LEAF_SIDE_PLACES;
use chebyshev::Interval;
use patch::Patch;
use rayon::prelude::*;
use skyglow_physics::EARTH_RADIUS_M;
use skyglow_physics::source_pixel::MAX_SOURCE_DISTANCE_M;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Longest side of a root patch, metres. The work is divided by root patches.
const MAX_ROOT_SIDE_M: f64 = 64_000.0;

/// The sums at the observers' places, row by row from the north; NaN where the altitude is, and in root patches that nobody wants.
/// None where `store` cancelled.
pub(crate) fn sum(accumulator: &Accumulator<'_>, store: &dyn PatchStore) -> Option<Vec<f32>> {
    let observers = accumulator.observers;
    let candidates = accumulator.sources.roots();
    let side = root_side(observers.lattice, accumulator.step_m);
    let patches = root_patches(observers.lattice, side, &observers.window);
    let places_done = AtomicUsize::new(0);
    let is_cancelled = AtomicBool::new(false);
    let of_patch = |(number, patch): &(u64, Patch)| {
        if is_cancelled.load(Ordering::Relaxed) {
            return None;
        }
        let (number, count) = (*number, patch.len());
        if !store.wants(&patch.window()) {
            return Some(vec![f32::NAN; count]);
        }
        let known = store.load(number, count).filter(|sums| sums.len() == count);
        let is_known = known.is_some();
        let sums = known.unwrap_or_else(|| accumulator.sum_patch(*patch, &candidates));
        let done = places_done.fetch_add(count, Ordering::Relaxed) + count;
        let progress = done as f64 / observers.window.count() as f64;
        if !is_known && !store.store(number, &sums, progress) {
            is_cancelled.store(true, Ordering::Relaxed);
        }
        Some(sums)
    };
    let found: Vec<Option<Vec<f32>>> = patches.par_iter().map(of_patch).collect();
    if is_cancelled.load(Ordering::Relaxed) {
        return None;
    }
    let mut all = vec![0f32; observers.window.count()];
    let whole = Patch::of(&observers.window);
    for ((_, patch), sums) in patches.iter().zip(found) {
        patch.write(&sums?, whole, &mut all);
    }
    Some(all)
}

/// The lights that reach the root patches of a window that a store wants: discs around these.
pub(crate) fn wanted_discs(
    lattice: PlaceLattice,
    window: &PlaceWindow,
    grid: &Grid,
    step_m: f64,
    store: &dyn PatchStore,
) -> Vec<Disc> {
    let side = root_side(lattice, step_m);
    let patches = root_patches(lattice, side, window).into_iter().map(|(_, patch)| patch);
    let wanted = patches.filter(|patch| store.wants(&patch.window()));
    let disc = |patch: Patch| {
        let [columns, rows] =
            [patch.columns, patch.rows].map(|interval| [f64::from(interval.first), f64::from(interval.last)]);
        let middle = lattice.point(grid, 0.5 * (columns[0] + columns[1]), 0.5 * (rows[0] + rows[1]));
        let corners = columns.map(|column| rows.map(|row| lattice.point(grid, column, row)));
        let around_m = corners.iter().flatten().map(|corner| EARTH_RADIUS_M * corner.distance(middle));
        // A little more, as sides are curved.
        let radius_m = MAX_SOURCE_DISTANCE_M + 1.1 * around_m.fold(step_m, f64::max);
        middle.is_finite().then_some(Disc { middle, radius_m })
    };
    wanted.filter_map(disc).collect()
}

/// The patches, of those into which a lattice is divided, that have places of a window, with their numbers among all.
fn root_patches(lattice: PlaceLattice, side: u32, window: &PlaceWindow) -> Vec<(u64, Patch)> {
    let intervals = |range: &Range<u32>, count: u32| {
        let interval =
            move |at: u32| Interval { first: at * side, last: (at * side + (side - 1)).min(count - 1) };
        (range.start / side..range.end.div_ceil(side)).map(move |at| (u64::from(at), interval(at)))
    };
    let a_row = u64::from(lattice.columns.div_ceil(side));
    let columns = || intervals(&window.columns, lattice.columns);
    intervals(&window.rows, lattice.rows)
        .flat_map(|(row, rows)| {
            columns().map(move |(column, columns)| (row * a_row + column, Patch { columns, rows }))
        })
        .collect()
}

/// Places along a side of a root patch: a power of two times [`LEAF_SIDE_PLACES`].
pub(crate) fn root_side(lattice: PlaceLattice, step_m: f64) -> u32 {
    let mut side = LEAF_SIDE_PLACES;
    while f64::from(2 * side) * step_m <= MAX_ROOT_SIDE_M && side < lattice.columns.max(lattice.rows) {
        side *= 2;
    }
    side
}

#[cfg(test)]
mod tests;
