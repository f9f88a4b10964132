//! From what cells do to what pixels do.

use super::CellInfluence;
use rayon::prelude::*;
use skyglow_physics::{simd::multiply_add, simd_dispatch};
use skyglow_render::cpu::lanes::exponential;
use skyglow_scene::{LightShares, PolarCell};

/// Largest power of e by which a pixel's light counts for more or less than its cell's for standing higher or lower.
const MAX_LOG_FACTOR: f32 = 2.0;
/// Pixels that a task works on.
const PIXELS_PER_TASK: usize = 16_384;
/// Cells that a task makes ready.
const CELLS_PER_TASK: usize = 8_192;

/// What the pixels of a cell need of it.
#[derive(Clone, Copy, Default)]
#[repr(C, align(16))]
pub(crate) struct CellLine {
    /// s.
    slope_per_m: f32,
    /// −s·h̄.
    at_sea: f32,
    /// The measure per DNB watt at h̄.
    per_dnb_w: f32,
}

/// The measure of every pixel, in the measure's unit, by position in [`LightShares::pixels`].
///
/// Of a cell's measure per watt a pixel has that of its flux in it times e^{s·(h − h̄)}, s being the cell's logarithmic slope and h̄ its
/// mean altitude: pixels stand at their own altitudes.
///
/// * `of_sky`: what all of them are to add up to; None for what comes out. A sky takes the light of a cell at its mean altitude,
///   and far light by blocks of pixels: it differs from the sum over pixels, each where it is, by 1e-3 or so, and all are
///   multiplied by the second number, which makes up for that.
pub fn influence_of_pixels(
    shares: &LightShares,
    cells: &[CellInfluence],
    of_sky: Option<f64>,
) -> (Vec<f32>, f64) {
    let of_cells = cells.par_iter().zip(&shares.polar.cells);
    let line = |(of, cell): (&CellInfluence, &PolarCell)| CellLine {
        slope_per_m: of.log_slope_per_m,
        at_sea: -of.log_slope_per_m * cell.altitude_m,
        per_dnb_w: of.per_dnb_w as f32,
    };
    let lines: Vec<CellLine> = of_cells.with_min_len(CELLS_PER_TASK).map(line).collect();
    let mut influence = vec![0f32; shares.len()];
    // Added up in order: the same request is to give the same bits.
    let sums: Vec<f64> = influence
        .par_chunks_mut(PIXELS_PER_TASK)
        .enumerate()
        .map(|(task, influence)| {
            add_shares(shares, &lines, task * PIXELS_PER_TASK, influence);
            influence.iter().copied().map(f64::from).sum::<f64>()
        })
        .collect();
    let sum: f64 = sums.iter().sum();
    let scale = of_sky.map_or(1.0, |of_sky| if sum > 0.0 { of_sky / sum } else { 1.0 });
    if scale != 1.0 {
        influence.par_iter_mut().for_each(|influence| *influence *= scale as f32);
    }
    (influence, scale)
}

simd_dispatch! {
    /// Fills in the influence of pixels from `first` on.
    fn add_shares(
        shares: &LightShares,
        lines: &[CellLine],
        first: usize,
        influence: &mut [f32],
    ) = add_shares_body::<FUSED>;
}

#[inline(always)]
fn add_shares_body<const FUSED: bool>(
    shares: &LightShares,
    lines: &[CellLine],
    first: usize,
    influence: &mut [f32],
) {
    let pixels = &shares.pixels()[first..];
    for (at, (influence, pixel)) in influence.iter_mut().zip(pixels).enumerate() {
        let mut sum = 0.0;
        for share in shares.shares(first + at) {
            let line = &lines[share.cell as usize];
            let here = share.flux_dnb_w * line.per_dnb_w;
            sum = multiply_add::<FUSED>(here, factor::<FUSED>(line, pixel.altitude_m), sum);
        }
        *influence = sum;
    }
}

/// e^{s·(h − h̄)}, the exponent held within ±2; to 4e-6.
#[inline(always)]
fn factor<const FUSED: bool>(cell: &CellLine, altitude_m: f32) -> f32 {
    let exponent = multiply_add::<FUSED>(cell.slope_per_m, altitude_m, cell.at_sea);
    exponential::<FUSED>(exponent.clamp(-MAX_LOG_FACTOR, MAX_LOG_FACTOR))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_powers_of_e_and_held_within_two() {
        for step in -400i16..=400 {
            let cell = CellLine { slope_per_m: 0.01, at_sea: -10.0, per_dnb_w: 1.0 };
            let exponent = 0.01 * f32::from(step);
            let wanted = f64::from(exponent).clamp(-2.0, 2.0).exp();
            let got = f64::from(factor::<false>(&cell, 1000.0 + f32::from(step)));
            assert!((got / wanted - 1.0).abs() < 1e-5, "{exponent} {got} {wanted}");
        }
    }
}
