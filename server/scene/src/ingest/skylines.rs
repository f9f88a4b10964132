//! The skylines of all lit pixels, computed from the terrain.

use super::options::{IngestProgress, IngestStage};
use crate::grid::Grid;
use crate::lit_pixels::LitPixels;
use crate::skyline_of_light::skyline_of_light;
use crate::skylines::{Skyline, Skylines};
use crate::terrain::Terrain;
use rayon::prelude::*;

/// Pixels between two reports of progress.
const PIXELS_AT_ONCE: usize = 4_096;

/// The skyline of each lit pixel, from its centre at its altitude; None without terrain. On as many threads as there
/// are cores.
pub(super) fn of_lights(
    terrain: &Terrain,
    grid: &Grid,
    pixels: &LitPixels,
    progress: &mut dyn FnMut(IngestProgress),
) -> Option<Skylines> {
    if terrain.is_empty() {
        return None;
    }
    let total = pixels.len();
    let mut skylines = Skylines::default();
    for first in (0..total).step_by(PIXELS_AT_ONCE) {
        progress(IngestProgress { stage: IngestStage::Skyline, done: first as u64, total: total as u64 });
        let end = (first + PIXELS_AT_ONCE).min(total);
        let found: Vec<Skyline> = (first..end)
            .into_par_iter()
            .map(|index| skyline_of_light(terrain, grid, pixels, index, None))
            .collect();
        found.iter().for_each(|skyline| skylines.push(skyline));
    }
    progress(IngestProgress { stage: IngestStage::Skyline, done: total as u64, total: total as u64 });
    Some(skylines)
}
