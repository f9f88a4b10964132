//! Sums over all lights at the places of a lattice.

use super::Scene;
use crate::convolution::{self, Convolution};
use crate::dual_tree::{
    self, Accumulator, Observers, PatchStore, PlaceLattice, PlaceWindow, Sources, Stage, SumOf,
};
use crate::light_layer::LightLayer;
use crate::light_tree::LightTree;
use crate::place_kernel::PlaceKernel;
use skyglow_physics::GeoPoint;

/// Numbers of what convolutions store begin here, and those of patches of what skylines take, so that they are none of the dual
/// tree's.
const STRIPS: u64 = 1 << 46;
const HIDDEN_PATCHES: u64 = 1 << 47;
/// The part of the time that convolutions take where there are skylines, about.
const CONVOLUTION_PART: f64 = 0.3;

/// No block of lights of a larger radius counts as one: the largest opening ratio of the dual tree, 0.15, at 300 km, and a third more.
const LARGEST_BLOCK_M: f64 = 60_000.0;

/// How the lights at all places of a lattice are summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SumWay {
    /// By the dual tree: at any places, and behind skylines.
    DualTree,
    /// By convolution where that can be, what skylines take by the dual tree; else all by that.
    Convolution,
}

impl Scene {
    /// A place for each pixel, or for blocks of them where that would be more than `max_places`.
    pub fn place_lattice(&self, max_places: usize) -> PlaceLattice {
        PlaceLattice::within(self.grid.width, self.grid.height, max_places)
    }

    /// The same for the part of the raster within reach of a place, with about `step_m` from one place to the next, or more where
    /// those would be more than 40 000; None where the place is off the raster.
    pub fn place_window(&self, place: GeoPoint, reach_m: f64, step_m: f64) -> Option<PlaceLattice> {
        PlaceLattice::around(&self.grid, place, reach_m, step_m)
    }

    /// The part of a lattice within bounds; None where none of its places lies there.
    ///
    /// * `bounds`: west, south, east, north, degrees; west of east beyond the antimeridian.
    pub fn places_within(&self, lattice: PlaceLattice, bounds: [f64; 4]) -> Option<PlaceWindow> {
        PlaceWindow::within(lattice, &self.grid, bounds)
    }

    /// A place of a lattice by its column and row.
    pub fn lattice_place(&self, lattice: PlaceLattice, column: u32, row: u32) -> GeoPoint {
        GeoPoint::from_vector(lattice.point(&self.grid, f64::from(column), f64::from(row)))
    }

    /// GDAL's six coefficients of a raster with a pixel for each place of a lattice.
    pub fn lattice_geotransform(&self, lattice: PlaceLattice) -> [f64; 6] {
        lattice.geotransform(self.metadata.grid.geotransform)
    }

    /// Columns and rows of a lattice that [`Self::sum_at_places`] finds together: windows that are made of whole ones cost no more
    /// than their share of the whole lattice.
    pub fn patch_size(&self, lattice: PlaceLattice) -> [u32; 2] {
        let side = dual_tree::root_side(lattice, self.place_step_m(lattice));
        match self.way_to_sum(lattice) {
            SumWay::Convolution => [lattice.columns, convolution::strip_rows(lattice).max(side)],
            SumWay::DualTree => [side; 2],
        }
    }

    /// The window in which [`Self::sum_at_places`] finds the sums at some places: by the dual tree that of whole patches around
    /// them, by convolution all places.
    pub fn summed_window(&self, lattice: PlaceLattice, places: &PlaceWindow, way: SumWay) -> PlaceWindow {
        match way {
            SumWay::Convolution => lattice.whole(),
            SumWay::DualTree => {
                let side = dual_tree::root_side(lattice, self.place_step_m(lattice));
                places.of_whole_blocks(side, lattice)
            }
        }
    }

    /// Metres from one place of a lattice to the next.
    fn place_step_m(&self, lattice: PlaceLattice) -> f64 {
        self.metadata.pixel_size_m.max(1.0) * f64::from(lattice.step)
    }

    /// Altitude of the ground at every place of a lattice, metres above sea level, at least 0, row by row from the north; NaN off
    /// the world.
    pub fn ground_altitudes_m(&self, lattice: PlaceLattice) -> Vec<f32> {
        dual_tree::ground_altitudes_m(lattice, &self.grid, &self.terrain)
    }

    /// The sum over the lights within 300 km at every observer's place, row by row from the north; NaN where the altitude is, and where
    /// `store` does not want it. It may be below 0 where the kernels know azimuths.
    ///
    /// * `observers`: in a window as of [`Self::summed_window`]: what is found at a place depends on the lattice, not on the window.
    /// * `kernels`: of each of [`Self::fixtures`].
    /// * `terrain_hides`: whether the skylines of lights cut their low light, where scene and kernels know them.
    /// * `way`: how they are summed; [`Self::way_to_sum`] says which is the shorter.
    /// * `store`: may know patches from before, is given each that is done, and may cancel the computation.
    ///
    /// None where it was cancelled.
    ///
    /// # Panics
    /// Where altitudes, window or kernels do not fit window, lattice or fixtures.
    pub fn sum_at_places(
        &self,
        observers: &Observers,
        kernels: &[PlaceKernel],
        terrain_hides: bool,
        way: SumWay,
        store: &dyn PatchStore,
    ) -> Option<Vec<f32>> {
        let Observers { lattice, window, altitudes_m } = observers;
        let lattice = *lattice;
        assert_eq!(altitudes_m.len(), window.count(), "an altitude for each place");
        assert_eq!(*window, self.summed_window(lattice, window, way), "a window of whole patches");
        let fixtures = self.fixtures();
        assert_eq!(fixtures.len(), kernels.len(), "a kernel for each kind of fixture");
        let any_hides = terrain_hides && kernels.iter().any(PlaceKernel::knows_skylines);
        let step_m = self.place_step_m(lattice);
        let discs = || dual_tree::wanted_discs(lattice, window, &self.grid, step_m, store);
        let view = self.skyline_view(any_hides, discs, LARGEST_BLOCK_M, None);
        let layers: Vec<(LightTree<'_>, &PlaceKernel)> = (self.light_layers.iter())
            .filter_map(|layer| {
                let kind = fixtures.iter().position(|fixture| *fixture == layer.fixture)?;
                let hides = terrain_hides && kernels[kind].knows_skylines();
                let hides = hides.then_some(view.as_ref());
                Some((layer.light(&self.grid, self.metadata.calibration, hides), &kernels[kind]))
            })
            .collect();
        let tree = |sum: SumOf, store: &dyn PatchStore| {
            let sources = Sources { grid: &self.grid, layers: &layers, sum };
            dual_tree::sum(&Accumulator { sources, observers, step_m }, store)
        };
        let convolution = Convolution::new(&self.grid, &layers, lattice, altitudes_m);
        let (SumWay::Convolution, Some(convolution)) = (way, convolution) else {
            return tree(SumOf::All, store);
        };
        let stage =
            |first_number: u64, begin: f64, end: f64| Stage { store, first_number, progress: [begin, end] };
        if layers.iter().all(|(light, _)| light.skylines.is_none()) {
            return convolution.sum(&stage(STRIPS, 0.0, 1.0));
        }
        // Under an open sky, and of that what skylines take.
        let open = convolution.sum(&stage(STRIPS, 0.0, CONVOLUTION_PART))?;
        let hidden = tree(SumOf::Hidden, &stage(HIDDEN_PATCHES, CONVOLUTION_PART, 1.0))?;
        let knows_azimuth = kernels.iter().any(PlaceKernel::knows_azimuth);
        let together = |(open, hidden): (&f32, f32)| match knows_azimuth {
            true => open + hidden,
            false => (open + hidden).max(0.0 * open),
        };
        Some(open.iter().zip(hidden).map(together).collect())
    }

    /// The way in which the lights at the places of a lattice are summed sooner, by an estimate: convolutions take as long whether
    /// there is light or not, the dual tree takes longer the more pixels are lit near a place. Where no convolution can be, the dual
    /// tree.
    pub fn way_to_sum(&self, lattice: PlaceLattice) -> SumWay {
        if Convolution::new(&self.grid, &[], lattice, &[]).is_none() {
            return SumWay::DualTree;
        }
        let lit_pixels = self.light_layers.iter().map(LightLayer::len).sum::<usize>() as f64;
        let pixels = f64::from(self.grid.width) * f64::from(self.grid.height);
        let range_m =
            self.light_altitude_range_m().map_or(0.0, |[lowest, highest]| f64::from(highest - lowest));
        let places = lattice.len() as f64;
        let tree_us = places * (2.0 + 50.0 * lit_pixels / pixels);
        let convolution_us = places * (1.0 + (range_m / 250.0).min(8.0)) + lit_pixels + 0.02 * pixels;
        if convolution_us < tree_us { SumWay::Convolution } else { SumWay::DualTree }
    }
}
