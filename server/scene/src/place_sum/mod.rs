//! What all lights of a scene add up to at every place of a lattice: Σ flux · kernel(distance, altitudes, skyline).
//!
//! Place by place that is places × lights. Here both are trees (the lattice halved again and again; the light pyramid), and
//! what is far is met high up in both:
//!
//! * a stretch of ground takes a block of lights at 4 × 4 nodes and at the altitudes of the kernel that its ground lies between,
//!   where it is small beside their distance ([`FAR_GROUND_RATIO`]) and that is 5 km or more; its parts inherit the sums by
//!   cubics, which hold far light to a few thousandths ([`nodes`]);
//! * a block stands for its lights at their flux-weighted middle where it is small beside its distance
//!   ([`FAR_LIGHT_RATIO`](ground::FAR_LIGHT_RATIO)), and is opened otherwise;
//! * what is left at stretches of 8 × 8 places is added place by place, pixels wider than a point spread over their ground
//!   ([`near`]).
//!
//! `tests/place_sums.rs` holds it against the plain sum over places and pixels.

mod ground;
mod lattice;
mod near;
mod nodes;
mod patch_store;
mod values;

pub use lattice::PlaceLattice;
pub use patch_store::PatchStore;
pub use values::PlaceValues;

use self::{
    ground::{Candidate, Patch, Spreader},
    nodes::Stretch,
};
use crate::gather::Light;
use crate::place_kernel::PlaceKernel;
use crate::scene::Scene;
use rayon::prelude::*;
use skyglow_physics::Fixture;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Largest half-diagonal of a stretch of ground beside the distance of lights whose sum is carried over it.
const FAR_GROUND_RATIO: f64 = 0.22;
/// Places along a side of the stretches that are not halved any more.
const FEWEST_PLACES: u32 = 8;
/// Largest side of the stretches that the work is shared out by, metres.
const LARGEST_SIDE_M: f64 = 64_000.0;

impl Scene {
    /// The kinds of fixtures, that of the raster's own lights first.
    pub fn fixtures(&self) -> Vec<Fixture> {
        self.by_fixture(|_| ()).into_iter().map(|(fixture, ())| fixture).collect()
    }

    /// What the lights within 300 km add up to at every place of a lattice, row by row from the north; NaN where the altitude is.
    ///
    /// * `altitudes_m`: of the observers at the places, metres above sea level; NaN where none can be.
    /// * `kernels`: of each of [`Self::fixtures`].
    /// * `terrain_hides`: whether the skylines of lights cut their low light, where scene and kernels know them.
    /// * `store`: may know patches from before, is given each that is done, and may cancel the computation.
    ///
    /// None where it was ended.
    ///
    /// # Panics
    /// Where altitudes or kernels do not fit lattice or fixtures.
    pub fn sum_at_places(
        &self,
        lattice: PlaceLattice,
        altitudes_m: &[f32],
        kernels: &[PlaceKernel],
        terrain_hides: bool,
        store: &dyn PatchStore,
    ) -> Option<Vec<f32>> {
        assert_eq!(altitudes_m.len(), lattice.len(), "an altitude for each place");
        let fixtures = self.fixtures();
        assert_eq!(fixtures.len(), kernels.len(), "a kernel for each kind of fixture");
        let calibration = self.metadata.calibration;
        let lights: Vec<(Light<'_>, &PlaceKernel)> = (self.layers.iter())
            .filter_map(|layer| {
                let kind = fixtures.iter().position(|fixture| *fixture == layer.fixture)?;
                let hides = terrain_hides && kernels[kind].knows_skylines();
                Some((layer.light(&self.grid, calibration, hides), &kernels[kind]))
            })
            .collect();
        let step_m = self.metadata.pixel_size_m.max(1.0) * f64::from(lattice.step);
        let spreader = Spreader { grid: &self.grid, lattice, step_m, altitudes_m, lights: &lights };
        let roots: Vec<Candidate> = (0u32..)
            .zip(&lights)
            .filter(|(_, (light, _))| light.pyramid.top() > 0)
            .map(|(layer, (light, _))| Candidate { layer, level: light.pyramid.top() as u32, index: 0 })
            .collect();
        let side = self.largest_side(lattice);
        let stretches = |count: u32| {
            let last = move |first: u32| (first + side - 1).min(count - 1);
            (0..count).step_by(side as usize).map(move |first| Stretch { first, last: last(first) })
        };
        let patches: Vec<Patch> = stretches(lattice.rows)
            .flat_map(|rows| stretches(lattice.columns).map(move |columns| Patch { columns, rows }))
            .collect();
        let places_done = AtomicUsize::new(0);
        let is_ended = AtomicBool::new(false);
        let of_stretch = |(number, patch): (usize, &Patch)| {
            if is_ended.load(Ordering::Relaxed) {
                return None;
            }
            let (number, count) = (number as u64, patch.len());
            let known = store.load(number, count).filter(|sums| sums.len() == count);
            let is_known = known.is_some();
            let sums = known.unwrap_or_else(|| spreader.of_patch(*patch, &roots));
            let done = places_done.fetch_add(count, Ordering::Relaxed) + count;
            let share = done as f64 / lattice.len() as f64;
            if !is_known && !store.store(number, &sums, share) {
                is_ended.store(true, Ordering::Relaxed);
            }
            Some(sums)
        };
        let found: Vec<Option<Vec<f32>>> = patches.par_iter().enumerate().map(of_stretch).collect();
        if is_ended.load(Ordering::Relaxed) {
            return None;
        }
        let mut all = vec![0f32; lattice.len()];
        let whole = Patch::of(lattice);
        for (patch, sums) in patches.iter().zip(found) {
            patch.write(&sums?, whole, &mut all);
        }
        Some(all)
    }

    /// Places along a side of the largest stretches: a power of two times [`FEWEST_PLACES`].
    fn largest_side(&self, lattice: PlaceLattice) -> u32 {
        let step_m = self.metadata.pixel_size_m.max(1.0) * f64::from(lattice.step);
        let mut side = FEWEST_PLACES;
        while f64::from(2 * side) * step_m <= LARGEST_SIDE_M && side < lattice.columns.max(lattice.rows) {
            side *= 2;
        }
        side
    }
}
