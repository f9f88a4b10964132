//! Multilevel summation (Brandt & Lubrecht 1990) by discrete convolutions: the sum of all lights at every place of a lattice in a
//! time that does not depend on how many there are (`docs/model.md#brightness`).
//!
//! The kernel is split into bands of distance that fade into one another ([`bands`]), each on cells twice as wide as the one before.
//! Lights are spread over the cells by cubics and over layers of altitude linearly ([`light_cells`]); between two layers, one of
//! places and one of lights, the kernel is the same everywhere in a row, so a band is a convolution ([`band_sum`]). Where cells are
//! wider apart than places, sums are interpolated to the places by the same cubics.
//!
//! Stencils are those of their own latitude, so nothing is cut into strips by latitude; strips of places are what progress is
//! counted and stored by.

mod band_sum;
mod bands;
mod interpolation;
mod light_cells;
mod stencil;
mod window;

use crate::dual_tree::{PatchStore, PlaceLattice, PlaceWindow};
use crate::grid::{GeographicAxes, Grid};
use crate::light_tree::LightTree;
use crate::place_kernel::PlaceKernel;
use band_sum::{BandSum, TargetRange, Targets};
use bands::Band;
use interpolation::Interpolation;
use light_cells::{LightCells, Pixels};
use rayon::prelude::*;
use skyglow_physics::EARTH_RADIUS_M;
use skyglow_physics::source_pixel::MAX_SOURCE_DISTANCE_M;
use std::sync::Arc;

/// Rows of pixels whose places are summed one after the other.
const STRIP_PIXELS: u32 = 256;
/// Latitudes beyond which a row of cells within reach is too long, degrees.
const MAX_LATITUDE_DEG: f64 = 75.0;
/// Most pixels of a raster, those that it goes on beyond its sides among them: each takes eight bytes.
const MAX_PIXELS: usize = 40_000_000;
/// A pixel is at most so many times as long as wide.
const MAX_ASPECT: f64 = 4.0;

/// Rows of places that are summed together.
pub(crate) fn strip_rows(lattice: PlaceLattice) -> u32 {
    (STRIP_PIXELS / lattice.step).max(1)
}

/// Sums by convolution over the lights of a raster along parallels and meridians.
pub(crate) struct Convolution<'a> {
    grid: &'a Grid,
    axes: GeographicAxes,
    layers: &'a [(LightTree<'a>, &'a PlaceKernel)],
    lattice: PlaceLattice,
    altitudes_m: &'a [f32],
    /// Columns that the raster goes on beyond either side.
    around: usize,
    bands: Vec<Band>,
}

impl<'a> Convolution<'a> {
    /// None where it cannot be: on other grids, near the poles, for lattices with places that do not lie on pixels alike.
    pub(crate) fn new(
        grid: &'a Grid,
        layers: &'a [(LightTree<'a>, &'a PlaceKernel)],
        lattice: PlaceLattice,
        altitudes_m: &'a [f32],
    ) -> Option<Self> {
        let axes = grid.axes()?;
        let latitude_deg = |row: u32| axes.first_latitude_deg + axes.latitude_step_deg * f64::from(row);
        let ends_deg = [latitude_deg(0), latitude_deg(grid.height)];
        let farthest_deg = ends_deg[0].abs().max(ends_deg[1].abs());
        let nearest_deg =
            if ends_deg[0] * ends_deg[1] <= 0.0 { 0.0 } else { ends_deg[0].abs().min(ends_deg[1].abs()) };
        let across_m = |latitude_deg: f64| {
            EARTH_RADIUS_M * axes.longitude_step_deg.to_radians() * latitude_deg.to_radians().cos()
        };
        let down_m = EARTH_RADIUS_M * axes.latitude_step_deg.to_radians().abs();
        let is_square = (1.0 / MAX_ASPECT..MAX_ASPECT).contains(&(across_m(farthest_deg) / down_m))
            && across_m(nearest_deg) / down_m < MAX_ASPECT;
        let around = match grid.turn_columns() {
            None => 0,
            Some(turn) if (turn - turn.round()).abs() > 1e-6 => return None,
            Some(turn) => ((MAX_SOURCE_DISTANCE_M / across_m(farthest_deg)).ceil() + 1.0).min(turn) as usize,
        };
        let pixels = (grid.width as usize + 2 * around) * grid.height as usize;
        let fits = farthest_deg <= MAX_LATITUDE_DEG
            && is_square
            && pixels <= MAX_PIXELS
            && lattice.step.is_power_of_two()
            && lattice.is_even();
        fits.then(|| Self {
            grid,
            axes,
            layers,
            lattice,
            altitudes_m,
            around,
            bands: Band::all(across_m(nearest_deg).max(down_m)),
        })
    }

    /// The sums at all places, row by row from the north; NaN where the altitude is, and in strips that nobody wants. None where
    /// `store` cancelled.
    pub(crate) fn sum(&self, store: &dyn PatchStore) -> Option<Vec<f32>> {
        let columns = self.lattice.columns as usize;
        let (rows, strip_rows) = (self.lattice.rows as usize, strip_rows(self.lattice) as usize);
        let mut bands = None;
        let mut all = Vec::with_capacity(self.lattice.len());
        for (number, first) in (0u64..).zip((0..rows).step_by(strip_rows)) {
            let strip = TargetRange { columns: 0..columns, rows: first..(first + strip_rows).min(rows) };
            let count = strip.rows.len() * columns;
            let window = PlaceWindow {
                columns: 0..self.lattice.columns,
                rows: strip.rows.start as u32..strip.rows.end as u32,
            };
            if !store.wants(&window) {
                all.resize(all.len() + count, f32::NAN);
                continue;
            }
            let known = store.load(number, count).filter(|sums| sums.len() == count);
            if let Some(known) = known {
                all.extend(known);
                continue;
            }
            let sums = self.strip(bands.get_or_insert_with(|| self.band_sums()), &strip);
            all.extend_from_slice(&sums);
            if !store.store(number, &sums, all.len() as f64 / self.lattice.len() as f64) {
                return None;
            }
        }
        Some(all)
    }

    /// The bands of each kind of lights.
    fn band_sums(&self) -> Vec<BandSum> {
        let (x, y) = self.lattice.position(0.0, 0.0);
        let places = Targets { first: [x, y], step: f64::from(self.lattice.step) };
        let whole =
            TargetRange { columns: 0..self.lattice.columns as usize, rows: 0..self.lattice.rows as usize };
        let Some(range_m) = self.altitude_range_m(&whole) else { return Vec::new() };
        let mut kinds: Vec<&PlaceKernel> = Vec::new();
        for (_, kernel) in self.layers {
            if !kinds.iter().any(|kind| std::ptr::eq(*kind, *kernel)) {
                kinds.push(kernel);
            }
        }
        let of_kind = |kernel: &PlaceKernel| {
            let trees = self.layers.iter().filter(|(_, of_layer)| std::ptr::eq(*of_layer, kernel));
            let pixels = Arc::new(Pixels::new(self.grid, trees.map(|(tree, _)| tree), self.around));
            let of_band = |band: &Band| {
                let light = LightCells::new(&pixels, band);
                BandSum::new((*band, light), kernel, self.axes, range_m.map(f64::from), places)
            };
            self.bands.par_iter().map(of_band).collect::<Vec<BandSum>>()
        };
        kinds.into_iter().flat_map(of_kind).collect()
    }

    /// Lowest and highest altitude at some places, metres; None where nobody can be.
    fn altitude_range_m(&self, places: &TargetRange) -> Option<[f32; 2]> {
        let columns = self.lattice.columns as usize;
        let rows = places.rows.clone();
        let of_row = |row: usize| &self.altitudes_m[row * columns..][places.columns.clone()];
        let altitudes = rows.flat_map(|row| of_row(row).iter().copied());
        let range = altitudes.fold([f32::INFINITY, f32::NEG_INFINITY], |[lowest, highest], at| {
            [lowest.min(at), highest.max(at)]
        });
        (range[0] <= range[1]).then_some(range)
    }

    fn strip(&self, bands: &[BandSum], strip: &TargetRange) -> Vec<f32> {
        let columns = strip.columns.len();
        let altitudes_m = &self.altitudes_m[strip.rows.start * columns..strip.rows.end * columns];
        let mut sums = vec![0f32; strip.rows.len() * columns];
        for band in bands {
            if band.has_cells_as_targets() {
                let interpolation = Interpolation::new(band, self.lattice, strip);
                interpolation.add(altitudes_m, |places| self.altitude_range_m(places), &mut sums);
                continue;
            }
            let parts = band.lanes(
                strip,
                &|tile| self.altitude_range_m(tile),
                &|lane| vec![0f32; lane.rows.len() * columns],
                &|sums, lane, layer, [row, column], added| {
                    let altitudes_m = &self.altitudes_m[(lane.rows.start + row) * columns + column..];
                    let sums = &mut sums[row * columns + column..];
                    for ((sum, added), altitude_m) in sums.iter_mut().zip(added).zip(altitudes_m) {
                        *sum += band.altitudes.weight(layer, *altitude_m) * added;
                    }
                },
            );
            sums.iter_mut().zip(parts.iter().flatten()).for_each(|(sum, added)| *sum += added);
        }
        let knows_azimuth = self.layers.iter().any(|(_, kernel)| kernel.knows_azimuth());
        let least = if knows_azimuth { f32::NEG_INFINITY } else { 0.0 };
        for (sum, altitude_m) in sums.iter_mut().zip(altitudes_m) {
            *sum = if altitude_m.is_finite() { sum.max(least) } else { f32::NAN };
        }
        sums
    }
}

#[cfg(test)]
pub(crate) mod tests;
