//! S = Σ_k F[H_k]·F[B_k] at every elevation and frequency: the convolution theorem along azimuth.

use super::{
    lanes::Aligned,
    layout::{FUNCTIONS_PER_GROUP, FrequencySums, GroupSpectra, ROW_GROUPS, ROWS_PER_GROUP},
    work::for_each_part,
};
use skyglow_physics::{BAND_COUNT, ELEVATION_COUNT, simd::multiply_add, simd_dispatch};
use skyglow_tables::resident::{FREQUENCY_COUNT, ResidentTables};

/// Frequencies that a task sums.
const FREQUENCIES_PER_TASK: usize = 16;

/// Share of a row's largest value in its spectrum below which a value is 0: what is smaller than f32's normal numbers, and
/// leads the processor to them, costs a hundred times as much, and counts for nothing in a sum of f32.
const NEGLIGIBLE: f32 = 1e-20;

/// F[B] so that one frequency reads straight on: `[frequency][group of elevations][function][elevation in group]`.
pub struct BlockedBasis {
    function_count: usize,
    values: Vec<Aligned<[f32; ROWS_PER_GROUP]>>,
}

impl BlockedBasis {
    /// Lays out a pack's basis.
    pub fn of(tables: &ResidentTables) -> Self {
        let function_count = tables.basis_count;
        let largest = |row: &[f32]| row.iter().fold(0f32, |largest, value| largest.max(value.abs()));
        let smallest: Vec<f32> = tables
            .basis_spectrum
            .chunks_exact(FREQUENCY_COUNT)
            .map(|row| NEGLIGIBLE * largest(row))
            .collect();
        let mut values = vec![Aligned([0.0; ROWS_PER_GROUP]); FREQUENCY_COUNT * ROW_GROUPS * function_count];
        for (position, value) in values.iter_mut().enumerate() {
            let function = position % function_count;
            let first_row = position / function_count % ROW_GROUPS * ROWS_PER_GROUP;
            let f = position / function_count / ROW_GROUPS;
            for (row, value) in (first_row..).zip(&mut value.0) {
                let exact = tables.basis_spectrum[tables.spectrum_index(function, row, f)];
                let is_negligible = exact.abs() < smallest[function * ELEVATION_COUNT + row];
                *value = if is_negligible { 0.0 } else { exact };
            }
        }
        Self { function_count, values }
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        (self.values.len() * ROWS_PER_GROUP * 4) as u64
    }
}

/// Sums over the first `basis_count` functions; `spectra` is `[group of functions][band]`.
pub fn basis_sum(
    basis: &BlockedBasis,
    spectra: &[GroupSpectra],
    basis_count: usize,
    side_by_side: bool,
    sums: &mut Vec<FrequencySums>,
) {
    sums.resize(FREQUENCY_COUNT, Aligned([[[0.0; ELEVATION_COUNT]; 2]; BAND_COUNT]));
    for_each_part(side_by_side, sums, FREQUENCIES_PER_TASK, |task, sums| {
        let first = task * FREQUENCIES_PER_TASK;
        let per_frequency = ROW_GROUPS * basis.function_count;
        let values = &basis.values[first * per_frequency..][..sums.len() * per_frequency];
        sum_frequencies(values, basis.function_count, spectra, first, basis_count, sums);
    });
}

simd_dispatch! {
    /// Sums at consecutive frequencies from `first` on, of which `basis` holds the functions.
    fn sum_frequencies(
        basis: &[Aligned<[f32; ROWS_PER_GROUP]>],
        function_count: usize,
        spectra: &[GroupSpectra],
        first: usize,
        basis_count: usize,
        sums: &mut [FrequencySums],
    ) = sum_frequencies_body::<FUSED>;
}

#[inline(always)]
fn sum_frequencies_body<const FUSED: bool>(
    basis: &[Aligned<[f32; ROWS_PER_GROUP]>],
    function_count: usize,
    spectra: &[GroupSpectra],
    first: usize,
    basis_count: usize,
    sums: &mut [FrequencySums],
) {
    let frequencies = basis.chunks_exact(ROW_GROUPS * function_count).zip(sums);
    for (f, (basis, sums)) in (first..).zip(frequencies) {
        for (row_group, basis) in basis.chunks_exact(function_count).enumerate() {
            let mut sum = [[0f32; ROWS_PER_GROUP]; 2 * BAND_COUNT];
            let groups =
                basis[..basis_count].chunks(FUNCTIONS_PER_GROUP).zip(spectra.chunks_exact(BAND_COUNT));
            for (basis, bands) in groups {
                let parts: [&[f32; FUNCTIONS_PER_GROUP]; 2 * BAND_COUNT] =
                    std::array::from_fn(|part| &bands[part / 2].0[f][part % 2]);
                for (k, &Aligned(rows)) in basis.iter().enumerate().take(FUNCTIONS_PER_GROUP) {
                    for part in 0..2 * BAND_COUNT {
                        let value = parts[part][k];
                        for row in 0..ROWS_PER_GROUP {
                            sum[part][row] = multiply_add::<FUSED>(value, rows[row], sum[part][row]);
                        }
                    }
                }
            }
            for (part, sum) in sum.iter().enumerate() {
                let target = &mut sums.0[part / 2][part % 2];
                target[row_group * ROWS_PER_GROUP..][..ROWS_PER_GROUP].copy_from_slice(sum);
            }
        }
    }
}
