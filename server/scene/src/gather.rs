//! The polar grid of an observer, gathered in parallel.
//!
//! First tasks find where light belongs, each that of some subtrees, then others add it up, each in some columns. The tasks
//! depend on the scene and the place alone, and light is added in the order of the subtrees, so that a polar grid is the same on
//! every machine.

use crate::{
    light_tree::{LightSink, LightTree, Subtree},
    polar_grid::{
        AZIMUTH_COLUMN_COUNT, LitCells, NearLight, PlacedLight, PolarAccumulator, PolarAxes, PolarGrid,
    },
};
use rayon::prelude::*;
use skyglow_physics::{GeoPoint, geometry::LocalFrame};
use std::ops::Range;

/// Blocks have at most so many pixels when they are shared out.
const MAX_SUBTREE_PIXELS: usize = 1_024;
/// Pixels that a task has at least.
const MIN_TASK_PIXELS: usize = 4_096;
/// Tasks that find light at most.
const MAX_TASKS: usize = 8;
/// Columns that a task adds up.
const COLUMNS_PER_TASK: usize = 32;
const COLUMN_TASKS: usize = AZIMUTH_COLUMN_COUNT / COLUMNS_PER_TASK;

/// The grid of all light of the layers within 300 km.
pub(crate) fn polar_grid(
    lights: &[LightTree],
    place: GeoPoint,
    far_block_ratio: f64,
    coverage: f64,
) -> PolarGrid {
    let frame = LocalFrame::at(place);
    let subtrees: Vec<(&LightTree, Subtree)> = lights
        .iter()
        .flat_map(|light| {
            light.subtrees(&frame, MAX_SUBTREE_PIXELS).into_iter().map(move |subtree| (light, subtree))
        })
        .collect();
    let found: Vec<PlacedLights> = divide(&subtrees)
        .into_par_iter()
        .map(|subtrees| {
            let mut found = PlacedLights::new();
            for (light, subtree) in subtrees {
                light.gather_block(subtree.from, &frame, far_block_ratio, &mut found);
            }
            found
        })
        .collect();
    let lit: Vec<LitCells> = (0..COLUMN_TASKS)
        .into_par_iter()
        .map(|task| {
            let columns = task * COLUMNS_PER_TASK..(task + 1) * COLUMNS_PER_TASK;
            let mut accumulator = PolarAccumulator::of_columns(columns);
            for light in found.iter().flat_map(|found| &found.by_columns[task]) {
                accumulator.add(*light);
            }
            accumulator.lit()
        })
        .collect();
    let flux_dnb_w = found.iter().map(|found| found.flux_dnb_w).sum();
    let near = found.iter().map(|found| found.near.as_slice()).collect::<Vec<_>>().concat();
    PolarGrid::from_parts(place, &lit, near, flux_dnb_w, coverage)
}

/// LightTree that a task found.
struct PlacedLights {
    /// By the task that adds it up; what lies between two of them both have.
    by_columns: [Vec<PlacedLight>; COLUMN_TASKS],
    near: Vec<NearLight>,
    flux_dnb_w: f64,
    axes: PolarAxes,
}

impl PlacedLights {
    fn new() -> Self {
        Self { by_columns: Default::default(), near: Vec::new(), flux_dnb_w: 0.0, axes: PolarAxes::new() }
    }
}

impl LightSink for PlacedLights {
    #[inline(always)]
    fn take(&mut self, numbers: Range<u32>, light: PlacedLight) {
        let [first, second] = self.axes.columns(light.azimuth_rad).map(|column| column / COLUMNS_PER_TASK);
        self.by_columns[first].push(light);
        if second != first {
            self.by_columns[second].push(light);
        }
        self.flux_dnb_w += light.flux_dnb_w;
        self.near.extend(NearLight::of(numbers, light));
    }
}

/// The subtrees of each task, about as many pixels for each.
fn divide<'s, 'a>(subtrees: &'s [(&'a LightTree<'a>, Subtree)]) -> Vec<&'s [(&'a LightTree<'a>, Subtree)]> {
    let pixels: usize = subtrees.iter().map(|(_, subtree)| subtree.pixels).sum();
    let tasks = (pixels / MIN_TASK_PIXELS).clamp(1, MAX_TASKS);
    let mut rest = subtrees;
    let mut shared = Vec::with_capacity(tasks);
    for left in (1..=tasks).rev() {
        let target = rest.iter().map(|(_, subtree)| subtree.pixels).sum::<usize>().div_ceil(left);
        let mut sum = 0;
        let count = rest
            .iter()
            .position(|(_, subtree)| {
                sum += subtree.pixels;
                sum >= target
            })
            .map_or(rest.len(), |last| last + 1);
        let (of_task, others) = rest.split_at(count);
        shared.push(of_task);
        rest = others;
    }
    shared
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{GeographicAxes, Grid},
        light_pyramid::LightPyramid,
        light_tree::{FAR_BLOCK_RATIO, LightSkylines},
        lit_pixels::LitPixels,
        morton,
        skylines::{SKYLINE_AZIMUTH_COUNT, Skylines},
    };
    use skyglow_physics::GeoPoint;

    const SIDE: u32 = 200;

    #[test]
    fn several_tasks_gather_what_one_does() {
        let axes = GeographicAxes {
            first_longitude_deg: 7.0,
            first_latitude_deg: 47.0,
            longitude_step_deg: 0.01,
            latitude_step_deg: -0.01,
        };
        let grid = Grid::geographic(axes, SIDE, SIDE);
        let mut pixels = LitPixels::default();
        for (row, column) in (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (row, column))) {
            pixels.codes.push(morton::encode(column, row));
            pixels.radiance_nw_cm2_sr.push(1.0 + (row * 7 + column * 3 % 11) as f32);
            pixels.altitude_m.push((column % 50) as f32 * 10.0);
        }
        pixels.sort();
        let mut skylines = Skylines::default();
        for pixel in 0..pixels.len() {
            // Every third is among hills.
            skylines.push(&[[20 * u8::from(pixel % 3 == 0); 9]; SKYLINE_AZIMUTH_COUNT]);
        }
        let pyramid = LightPyramid::build(&grid, &pixels, Some(&skylines), 1.0);
        let light = LightTree {
            grid: &grid,
            pixels: &pixels,
            pyramid: &pyramid,
            calibration: 1.0,
            skylines: Some(LightSkylines::Whole(&skylines)),
            removed: None,
            first_number: 0,
        };
        for place_deg in [[46.2, 7.9], [46.2, 6.6]] {
            let place = GeoPoint::from_deg(place_deg[0], place_deg[1]).unwrap();
            let frame = LocalFrame::at(place);
            let subtrees: Vec<(&LightTree, Subtree)> = light
                .subtrees(&frame, MAX_SUBTREE_PIXELS)
                .into_iter()
                .map(|subtree| (&light, subtree))
                .collect();
            assert!(divide(&subtrees).len() > 1);
            let together = polar_grid(&[light], place, FAR_BLOCK_RATIO, 1.0);
            let mut alone = PolarAccumulator::new();
            light.gather(&frame, FAR_BLOCK_RATIO, &mut alone);
            let alone = alone.finish(place, 1.0);
            assert!((together.flux_dnb_w / alone.flux_dnb_w - 1.0).abs() < 1e-12);
            assert!(alone.cells.iter().any(|cell| cell.blocking > 0) && alone.cells.len() > 1_000);
            assert_eq!(PolarGrid { flux_dnb_w: alone.flux_dnb_w, ..together }, alone);
            // A missing subtree shows.
            let mut fewer = PolarAccumulator::new();
            for (light, subtree) in &subtrees[1..] {
                light.gather_block(subtree.from, &frame, FAR_BLOCK_RATIO, &mut fewer);
            }
            assert!(fewer.finish(place, 1.0).flux_dnb_w < 0.999 * alone.flux_dnb_w);
        }
    }

    #[test]
    fn without_light_the_grid_is_dark() {
        let grid = polar_grid(&[], GeoPoint::from_rad_unchecked(0.3, 0.4), FAR_BLOCK_RATIO, 0.5);
        assert!(grid.cells.is_empty() && grid.near.is_empty() && grid.flux_dnb_w == 0.0);
        assert_eq!(grid.azimuth_start, vec![0; AZIMUTH_COLUMN_COUNT + 1]);
    }
}
