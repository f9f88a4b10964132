//! S = Σ_k F[H_k]·F[B_k] at every elevation and frequency.

use super::{
    accumulate::dispatch_avx2,
    transforms::{PADDED, Spectra},
};
use rayon::prelude::*;
use skyglow_physics::{BAND_COUNT, ELEVATION_COUNT};
use skyglow_tables::resident::{FREQUENCY_COUNT, ResidentTables};

/// Frequencies summed side by side.
pub(crate) const BLOCK: usize = 8;
/// Blocks that hold all frequencies.
pub(crate) const BLOCK_COUNT: usize = FREQUENCY_COUNT.div_ceil(BLOCK);

/// `[block][elevation][band]` of (real, imaginary) at the block's frequencies.
pub(crate) type SpectrumSums = Vec<[[f32; BLOCK]; 2]>;

/// F[B] so that one (block, elevation) reads straight on: `[block][elevation][function][frequency in block]`.
pub(crate) struct BlockedBasis {
    function_count: usize,
    values: Vec<[f32; BLOCK]>,
}

impl BlockedBasis {
    /// Lays out a pack's basis; frequencies beyond 128 are 0.
    pub(crate) fn of(tables: &ResidentTables) -> Self {
        let function_count = tables.basis_count;
        let mut values = vec![[0.0; BLOCK]; BLOCK_COUNT * ELEVATION_COUNT * function_count];
        for (position, value) in values.iter_mut().enumerate() {
            let function = position % function_count;
            let row = position / function_count % ELEVATION_COUNT;
            let first = position / function_count / ELEVATION_COUNT * BLOCK;
            for (f, value) in (first..FREQUENCY_COUNT).zip(value) {
                *value = tables.basis_spectrum[tables.spectrum_index(function, row, f)];
            }
        }
        Self { function_count, values }
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> u64 {
        (self.values.len() * BLOCK * 4) as u64
    }
}

/// Sums over the functions in use.
pub(crate) fn basis_sum(basis: &BlockedBasis, spectra: &Spectra) -> SpectrumSums {
    let function_count = spectra.basis_count;
    let stride = spectra.values.len() / BAND_COUNT;
    let mut sums = vec![[[0.0; BLOCK]; 2]; BLOCK_COUNT * ELEVATION_COUNT * BAND_COUNT];
    sums.par_chunks_mut(ELEVATION_COUNT * BAND_COUNT).enumerate().for_each(|(block, sums)| {
        let mut spectrum = vec![[[0.0; BLOCK]; 2 * BAND_COUNT]; function_count];
        for (function, channels) in spectrum.iter_mut().enumerate() {
            for (channel, lanes) in channels.iter_mut().enumerate() {
                let start = channel / 2 * stride + (function * 2 + channel % 2) * PADDED + block * BLOCK;
                lanes.copy_from_slice(&spectra.values[start..start + BLOCK]);
            }
        }
        let per_row = basis.function_count;
        let rows = &basis.values[block * ELEVATION_COUNT * per_row..][..ELEVATION_COUNT * per_row];
        sum_block(rows, per_row, &spectrum, sums);
    });
    sums
}

dispatch_avx2!(
    /// One block of frequencies: `basis` is `[elevation][function]`, `sums` `[elevation][band]`.
    sum_block, sum_block_avx2, sum_block_body,
    (basis: &[[f32; BLOCK]], per_row: usize, spectrum: &[[[f32; BLOCK]; 2 * BAND_COUNT]], sums: &mut [[[f32; BLOCK]; 2]])
);

#[inline(always)]
fn sum_block_body(
    basis: &[[f32; BLOCK]],
    per_row: usize,
    spectrum: &[[[f32; BLOCK]; 2 * BAND_COUNT]],
    sums: &mut [[[f32; BLOCK]; 2]],
) {
    for (row, sums) in basis.chunks_exact(per_row).zip(sums.chunks_exact_mut(BAND_COUNT)) {
        let mut sum = [[0.0f32; BLOCK]; 2 * BAND_COUNT];
        for (function, channels) in row.iter().zip(spectrum) {
            for channel in 0..2 * BAND_COUNT {
                for lane in 0..BLOCK {
                    sum[channel][lane] += function[lane] * channels[channel][lane];
                }
            }
        }
        for (band, target) in sums.iter_mut().enumerate() {
            *target = [sum[2 * band], sum[2 * band + 1]];
        }
    }
}
