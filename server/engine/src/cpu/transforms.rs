//! Transforms along azimuth.

use super::basis_sum::{BLOCK, BLOCK_COUNT, SpectrumSums};
use crate::prepare::Prepared;
use rayon::prelude::*;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex, num_complex::Complex32};
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, Panorama};
use skyglow_tables::resident::FREQUENCY_COUNT;
use std::sync::Arc;

/// Functions a task transforms: one cache line of every column.
const FUNCTIONS_PER_TASK: usize = 16;

/// F[H], `[band][function][real, imaginary][padded frequency]`.
pub(crate) struct Spectra {
    /// Functions in use.
    pub(crate) basis_count: usize,
    /// The values; frequencies beyond 128 are 0.
    pub(crate) values: Vec<f32>,
}

/// Frequencies with their padding to whole blocks.
pub(crate) const PADDED: usize = BLOCK * BLOCK_COUNT;

/// Plans of the two transforms.
pub(crate) struct Transforms {
    forward: Arc<dyn RealToComplex<f32>>,
    inverse: Arc<dyn ComplexToReal<f32>>,
}

impl Transforms {
    /// Plans for 256 azimuths.
    pub(crate) fn new() -> Self {
        let mut planner = RealFftPlanner::new();
        Self {
            forward: planner.plan_fft_forward(AZIMUTH_COUNT),
            inverse: planner.plan_fft_inverse(AZIMUTH_COUNT),
        }
    }

    /// Spectra of the columns `[column slot][band][padded function]`; columns that are not lit are 0.
    pub(crate) fn forward(
        &self,
        request: &Prepared,
        columns: &[f32],
        basis_count: usize,
        padded_count: usize,
    ) -> Spectra {
        let mut values = vec![0.0; BAND_COUNT * padded_count * 2 * PADDED];
        values.par_chunks_mut(FUNCTIONS_PER_TASK * 2 * PADDED).enumerate().for_each(|(task, spectra)| {
            let band = task * FUNCTIONS_PER_TASK / padded_count;
            let function = task * FUNCTIONS_PER_TASK % padded_count;
            let mut rows = vec![[0f32; AZIMUTH_COUNT]; FUNCTIONS_PER_TASK];
            for (slot, lit) in request.columns.iter().enumerate() {
                let start = (slot * BAND_COUNT + band) * padded_count + function;
                for (row, value) in rows.iter_mut().zip(&columns[start..start + FUNCTIONS_PER_TASK]) {
                    row[lit.azimuth as usize] = *value;
                }
            }
            let mut scratch = self.forward.make_scratch_vec();
            let mut spectrum = [Complex32::default(); FREQUENCY_COUNT];
            for (row, target) in rows.iter_mut().zip(spectra.chunks_exact_mut(2 * PADDED)) {
                // The lengths are constants that fit.
                let done = self.forward.process_with_scratch(row, &mut spectrum, &mut scratch);
                debug_assert!(done.is_ok());
                let (real, imaginary) = target.split_at_mut(PADDED);
                for (f, value) in spectrum.iter().enumerate() {
                    real[f] = value.re;
                    imaginary[f] = value.im;
                }
            }
        });
        Spectra { basis_count, values }
    }

    /// Radiance `[band][row][column]` from the summed spectra, clamped at 0.
    pub(crate) fn inverse(&self, sums: &SpectrumSums) -> Vec<f32> {
        let mut radiance_w_m2_sr = vec![0.0; Panorama::LEN];
        radiance_w_m2_sr.par_chunks_mut(8 * AZIMUTH_COUNT).enumerate().for_each(|(task, rows)| {
            let mut scratch = self.inverse.make_scratch_vec();
            let mut spectrum = [Complex32::default(); FREQUENCY_COUNT];
            for (offset, samples) in rows.chunks_exact_mut(AZIMUTH_COUNT).enumerate() {
                let (band, row) =
                    ((task * 8 + offset) / ELEVATION_COUNT, (task * 8 + offset) % ELEVATION_COUNT);
                for (f, value) in spectrum.iter_mut().enumerate() {
                    let sum = &sums[(f / BLOCK * ELEVATION_COUNT + row) * BAND_COUNT + band];
                    *value = Complex32::new(sum[0][f % BLOCK], sum[1][f % BLOCK]);
                }
                spectrum[0].im = 0.0;
                spectrum[FREQUENCY_COUNT - 1].im = 0.0;
                let done = self.inverse.process_with_scratch(&mut spectrum, samples, &mut scratch);
                debug_assert!(done.is_ok());
                for sample in samples {
                    *sample = (*sample * (1.0 / AZIMUTH_COUNT as f32)).max(0.0);
                }
            }
        });
        radiance_w_m2_sr
    }
}
