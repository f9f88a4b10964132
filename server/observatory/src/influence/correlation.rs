//! G_k(θ) = Σ_p w(p)·B_k(θ_p − θ, φ_p) for every function and azimuth, by the cross-correlation theorem.

use rayon::prelude::*;
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, Panorama};
use skyglow_render::{
    cpu::{
        azimuth_fft::azimuth_fft,
        inverse_fft::inverse_fft,
        lanes::Aligned,
        layout::{BLOCK, ColumnBlock, FUNCTIONS_PER_GROUP, FrequencySums},
    },
    twin::Twiddles,
};
use skyglow_tables::resident::{FREQUENCY_COUNT, ResidentTables};

/// Functions that one inverse transform takes: a panorama's rows stand for them.
const FUNCTIONS_AT_ONCE: usize = ELEVATION_COUNT;
/// Functions that a task multiplies.
const FUNCTIONS_PER_TASK: usize = 16;

/// G in the layout of mixed nodes, `[block of functions][azimuth]`, `[band][function]` each; functions beyond `basis_count`
/// are 0. `weights` are `[band][row][column]`.
///
/// With spectra over azimuth, F[G_k] = Σ_row F[w_row]·F[B_k,row], for F[B] is real.
pub(super) fn correlate(
    twiddles: &Twiddles,
    tables: &ResidentTables,
    basis_count: usize,
    weights: &[f32],
) -> Vec<ColumnBlock> {
    let spectra = weight_spectra(twiddles, weights);
    let blocks = basis_count.div_ceil(BLOCK);
    let mut correlated = vec![Aligned([[0f32; BLOCK]; BAND_COUNT]); blocks * AZIMUTH_COUNT];
    let mut rows = Vec::new();
    for first in (0..basis_count).step_by(FUNCTIONS_AT_ONCE) {
        let count = (basis_count - first).min(FUNCTIONS_AT_ONCE);
        let sums = products(tables, &spectra, first, count);
        inverse_fft(twiddles, f32::NEG_INFINITY, [true; BAND_COUNT], &sums, true, &mut rows);
        for band in 0..BAND_COUNT {
            for function in 0..count {
                let row = &rows[Panorama::index(band, function, 0)..][..AZIMUTH_COUNT];
                let (block, within) = ((first + function) / BLOCK, (first + function) % BLOCK);
                for (azimuth, value) in row.iter().enumerate() {
                    correlated[block * AZIMUTH_COUNT + azimuth].0[band][within] = *value;
                }
            }
        }
    }
    correlated
}

/// Spectra of the weights of each row, `[band][row][real, imaginary][frequency]`.
type WeightSpectra = Vec<[[f32; FREQUENCY_COUNT]; 2]>;

/// Rows take the place of functions in the transform of columns.
fn weight_spectra(twiddles: &Twiddles, weights: &[f32]) -> WeightSpectra {
    let mut columns =
        vec![Aligned([[0f32; BLOCK]; BAND_COUNT]); ELEVATION_COUNT.div_ceil(BLOCK) * AZIMUTH_COUNT];
    for band in 0..BAND_COUNT {
        for row in 0..ELEVATION_COUNT {
            for azimuth in 0..AZIMUTH_COUNT {
                columns[row / BLOCK * AZIMUTH_COUNT + azimuth].0[band][row % BLOCK] =
                    weights[Panorama::index(band, row, azimuth)];
            }
        }
    }
    let mut groups = Vec::new();
    azimuth_fft(twiddles, [true; BAND_COUNT], &columns, ELEVATION_COUNT, true, &mut groups);
    let mut spectra = vec![[[0f32; FREQUENCY_COUNT]; 2]; BAND_COUNT * ELEVATION_COUNT];
    for band in 0..BAND_COUNT {
        for row in 0..ELEVATION_COUNT {
            let group = &groups[row / FUNCTIONS_PER_GROUP * BAND_COUNT + band].0;
            for (f, parts) in group.iter().enumerate() {
                for (part, values) in parts.iter().enumerate() {
                    spectra[band * ELEVATION_COUNT + row][part][f] = values[row % FUNCTIONS_PER_GROUP];
                }
            }
        }
    }
    spectra
}

/// F[G_k] of `count` functions from `first` on, each in the place of a row.
fn products(
    tables: &ResidentTables,
    spectra: &WeightSpectra,
    first: usize,
    count: usize,
) -> Vec<FrequencySums> {
    let pairs: Vec<(usize, usize)> =
        (0..BAND_COUNT).flat_map(|band| (0..count).map(move |function| (band, function))).collect();
    let product = |&(band, function): &(usize, usize)| {
        let mut product = [[0f32; FREQUENCY_COUNT]; 2];
        let of_band = &spectra[band * ELEVATION_COUNT..][..ELEVATION_COUNT];
        for (row, weights) in of_band.iter().enumerate().filter(|(_, weights)| is_lit(weights)) {
            let basis = &tables.basis_spectrum[tables.spectrum_index(first + function, row, 0)..];
            for (product, weights) in product.iter_mut().zip(weights) {
                for ((sum, weight), basis) in product.iter_mut().zip(weights).zip(basis) {
                    *sum += weight * basis;
                }
            }
        }
        product
    };
    let products: Vec<[[f32; FREQUENCY_COUNT]; 2]> =
        pairs.par_iter().with_min_len(FUNCTIONS_PER_TASK).map(product).collect();
    let mut sums = vec![Aligned([[[0f32; ELEVATION_COUNT]; 2]; BAND_COUNT]); FREQUENCY_COUNT];
    for ((band, function), product) in pairs.into_iter().zip(products) {
        for (part, product) in product.iter().enumerate() {
            for (sums, value) in sums.iter_mut().zip(product) {
                sums.0[band][part][function] = *value;
            }
        }
    }
    sums
}

/// Whether a row has any weight: the zenith has it in few.
fn is_lit(weights: &[[f32; FREQUENCY_COUNT]; 2]) -> bool {
    weights.as_flattened().iter().any(|value| *value != 0.0)
}
