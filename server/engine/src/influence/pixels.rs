//! From what cells do to what pixels do.

use super::CellInfluence;
use rayon::prelude::*;
use skyglow_scene::LightShares;

/// Largest power of e by which a pixel's light counts for more or less than its cell's for standing higher or lower.
const LARGEST_LOG_FACTOR: f32 = 2.0;
/// Pixels that a task works on.
const PIXELS_PER_TASK: usize = 16_384;

/// The measure of every pixel, in the measure's unit, by position in [`LightShares::pixels`].
///
/// A cell's measure is divided among its pixels by their flux in it times e^{s·(h − h̄)}, s being the cell's logarithmic slope and h̄ its
/// mean altitude: so pixels stand at their own altitudes, and still add up to the cell.
pub fn influence_of_pixels(shares: &LightShares, cells: &[CellInfluence]) -> Vec<f32> {
    let factor = |position: usize, cell: usize| {
        let slope = cells[cell].log_slope_per_m;
        let above_m = shares.altitude_m(position) - shares.polar.cells[cell].altitude_m;
        (slope * above_m).clamp(-LARGEST_LOG_FACTOR, LARGEST_LOG_FACTOR).exp()
    };
    let count = shares.len();
    let tasks = count.div_ceil(PIXELS_PER_TASK);
    let range = |task: usize| task * PIXELS_PER_TASK..((task + 1) * PIXELS_PER_TASK).min(count);
    // Σ flux · factor of every cell.
    let weighed: Vec<f32> = (0..tasks)
        .into_par_iter()
        .fold(
            || vec![0f32; cells.len()],
            |mut sums, task| {
                for position in range(task) {
                    for share in shares.shares(position) {
                        sums[share.cell as usize] += share.flux_dnb_w * factor(position, share.cell as usize);
                    }
                }
                sums
            },
        )
        .reduce(
            || vec![0f32; cells.len()],
            |mut sums, more| {
                sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
                sums
            },
        );
    let per_weighed: Vec<f32> = weighed
        .iter()
        .zip(cells)
        .zip(&shares.polar.cells)
        .map(
            |((sum, of), cell)| {
                if *sum > 0.0 { (of.per_dnb_w * f64::from(cell.flux_dnb_w)) as f32 / sum } else { 0.0 }
            },
        )
        .collect();
    let mut influence = vec![0f32; count];
    influence.par_chunks_mut(PIXELS_PER_TASK).enumerate().for_each(|(task, influence)| {
        for (position, influence) in range(task).zip(influence) {
            *influence = shares
                .shares(position)
                .iter()
                .map(|share| {
                    let cell = share.cell as usize;
                    share.flux_dnb_w * factor(position, cell) * per_weighed[cell]
                })
                .sum();
        }
    });
    influence
}
