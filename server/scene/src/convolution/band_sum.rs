//! Discrete convolution of one band: at targets evenly spread over a raster, the sum over the light cells around each.

use super::bands::Band;
use super::light_cells::LightCells;
use super::stencil::{Stencil, on_rings};
use super::window::{TILE_COLUMNS, Windows};
use crate::grid::GeographicAxes;
use crate::place_kernel::{AzimuthFactor, PlaceKernel, UniformAxis};
use rayon::prelude::*;
use std::ops::Range;

/// Rows of pixels that share the stencils of their middle row at most.
const LANE_PIXELS: f64 = 8.0;
/// Metres across differ from those of the middle row by at most this part.
const MAX_STRETCH: f64 = 6e-4;

/// Points spread evenly over a raster.
#[derive(Clone, Copy, Debug)]
pub(super) struct Targets {
    /// Pixel coordinates of the first.
    pub(super) first: [f64; 2],
    /// Pixels from one to the next.
    pub(super) step: f64,
}

/// A rectangle of targets.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TargetRange {
    pub(super) columns: Range<usize>,
    pub(super) rows: Range<usize>,
}

/// A band with its lights and its kernel.
pub(super) struct BandSum {
    pub(super) band: Band,
    pub(super) light: LightCells,
    /// Layers of altitude of the targets.
    pub(super) altitudes: UniformAxis,
    pub(super) targets: Targets,
    axes: GeographicAxes,
    /// The parts of the kernel on the rings, `[target layer][light layer]`.
    on_rings: Vec<Vec<(AzimuthFactor, Vec<f32>)>>,
}

impl BandSum {
    /// * `altitude_range_m`: of the targets.
    /// * `places`: where the targets are, if they are as far apart as cells or farther; else they are the cells.
    pub(super) fn new(
        (band, light): (Band, LightCells),
        kernel: &PlaceKernel,
        axes: GeographicAxes,
        altitude_range_m: [f64; 2],
        places: Targets,
    ) -> Self {
        let [lowest_m, highest_m] = altitude_range_m;
        let altitudes = UniformAxis::between(lowest_m, highest_m, band.steps_m()[0], usize::MAX);
        let targets = match places.step % light.cell_pixels == 0.0 {
            true => places,
            false => Targets { first: light.first, step: light.cell_pixels },
        };
        let pairs = (0..altitudes.count)
            .flat_map(|place| (0..light.altitudes.count).map(move |light| (place, light)));
        let on_rings = pairs
            .map(|(place, layer)| on_rings(kernel, altitudes.node_m(place), light.altitudes.node_m(layer)))
            .collect();
        Self { band, light, altitudes, targets, axes, on_rings }
    }

    /// Whether the targets are cells, from which the sums at places are interpolated.
    pub(super) fn has_cells_as_targets(&self) -> bool {
        self.targets.first == self.light.first
            && self.targets.step == self.light.cell_pixels
            && self.band.level > 0
    }

    /// Some rows of targets after another, each with what `sum` makes of it.
    ///
    /// * `altitudes_m`: lowest and highest altitude for which sums are wanted at some targets, metres; None where nowhere.
    /// * `take`: takes sums of some targets of a row for a layer of altitude: what it fills, layer, row and first column within the
    ///   lane, sums.
    pub(super) fn lanes<T: Send>(
        &self,
        range: &TargetRange,
        altitudes_m: &(impl Fn(&TargetRange) -> Option<[f32; 2]> + Sync),
        new: &(impl Fn(&TargetRange) -> T + Sync),
        take: &(impl Fn(&mut T, &TargetRange, usize, [usize; 2], &[f32]) + Sync),
    ) -> Vec<T> {
        let end_deg = |row: usize| {
            let y = self.targets.first[1] + self.targets.step * row as f64;
            (self.axes.first_latitude_deg + self.axes.latitude_step_deg * y).abs()
        };
        let slope = end_deg(range.rows.start).max(end_deg(range.rows.end)).min(89.0).to_radians().tan();
        let stretch_of_pixel = 0.5 * slope * self.axes.latitude_step_deg.to_radians().abs();
        let lane_pixels = LANE_PIXELS.min(MAX_STRETCH / stretch_of_pixel.max(1e-12));
        let lane_rows = (lane_pixels / self.targets.step).max(1.0) as usize;
        let lanes: Vec<TargetRange> = (range.rows.clone().step_by(lane_rows))
            .map(|first| TargetRange {
                rows: first..(first + lane_rows).min(range.rows.end),
                columns: range.columns.clone(),
            })
            .collect();
        lanes.into_par_iter().map(|lane| self.lane(lane, altitudes_m, new, take)).collect()
    }

    fn lane<T>(
        &self,
        lane: TargetRange,
        altitudes_m: &impl Fn(&TargetRange) -> Option<[f32; 2]>,
        new: &impl Fn(&TargetRange) -> T,
        take: &impl Fn(&mut T, &TargetRange, usize, [usize; 2], &[f32]),
    ) -> T {
        let mut sums = new(&lane);
        let cell = self.light.cell_pixels;
        let base: [f64; 2] = [0, 1].map(|axis| (self.targets.first[axis] - self.light.first[axis]) / cell);
        let off = base.map(|at| at - (at + 1e-9).floor());
        let base = base.map(|at| (at + 1e-9).floor() as i64);
        let stride = (self.targets.step / cell) as usize;
        let middle =
            self.targets.first[1] + 0.5 * self.targets.step * (lane.rows.start + lane.rows.end - 1) as f64;
        let latitude_deg = self.axes.first_latitude_deg + self.axes.latitude_step_deg * middle;
        let stencil = Stencil::new(&self.band, self.axes, latitude_deg, off);
        let mut weights: Vec<Option<Vec<f32>>> = vec![None; self.on_rings.len()];
        let mut windows = Windows::new(&stencil, lane.rows.len(), stride, self.light.altitudes.count);
        let first_row = base[1] + (lane.rows.start * stride) as i64;
        for first in lane.columns.clone().step_by(TILE_COLUMNS) {
            let columns = first..(first + TILE_COLUMNS).min(lane.columns.end);
            let tile = TargetRange { columns, rows: lane.rows.clone() };
            let Some([lowest_m, highest_m]) = altitudes_m(&tile) else { continue };
            if !windows.fill(&self.light, [base[0] + (first * stride) as i64, first_row]) {
                continue;
            }
            let (below, _) = self.altitudes.position(lowest_m);
            let (above, up) = self.altitudes.position(highest_m);
            for layer in below..=above + usize::from(up > 0.0) {
                let of_lights = |light: usize| layer * self.light.altitudes.count + light;
                for light in windows.lit_layers() {
                    weights[of_lights(light)]
                        .get_or_insert_with(|| stencil.weights(&self.on_rings[of_lights(light)]));
                }
                let added = windows.sums(|light| weights[of_lights(light)].as_deref().unwrap_or_default());
                for (row, values) in added.iter().enumerate() {
                    let at = [row, first - lane.columns.start];
                    take(&mut sums, &lane, layer, at, &values[..tile.columns.len()]);
                }
            }
        }
        sums
    }
}
