//! F[B]: the azimuthal spectrum of even functions, real and half as long, by the fast Fourier transform (Cooley and Tukey
//! 1965).

use crate::{
    layout::{HALF_COLUMN_COUNT, PIXEL_COUNT},
    resident::FREQUENCY_COUNT,
};
use realfft::RealFftPlanner;
use skyglow_physics::{AZIMUTH_COUNT, ELEVATION_COUNT};

/// Spectrum `[basis][row][frequency]` of functions `[basis][row][column 0..=128]` that are even in azimuth:
/// F[f] = Σ_i B(θ_i)·cos(2πfi/256), unnormalised.
pub fn even_spectrum(functions: &[f32]) -> Vec<f32> {
    debug_assert_eq!(functions.len() % PIXEL_COUNT, 0);
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(AZIMUTH_COUNT);
    let mut row = fft.make_input_vec();
    let mut spectrum = fft.make_output_vec();
    let mut out = Vec::with_capacity(functions.len() / PIXEL_COUNT * ELEVATION_COUNT * FREQUENCY_COUNT);
    for half in functions.chunks_exact(HALF_COLUMN_COUNT) {
        for (i, sample) in row.iter_mut().enumerate() {
            *sample = f64::from(half[if i < HALF_COLUMN_COUNT { i } else { AZIMUTH_COUNT - i }]);
        }
        // The buffers come from the plan itself, so their lengths fit.
        if fft.process(&mut row, &mut spectrum).is_ok() {
            out.extend(spectrum.iter().map(|value| value.re as f32));
        }
    }
    out
}

/// The functions `[basis][row][column 0..=128]` of a spectrum of [`even_spectrum`], to f32 rounding.
pub fn even_functions(spectrum: &[f32]) -> Vec<f32> {
    let cosine: Vec<f64> =
        (0..AZIMUTH_COUNT).map(|i| (i as f64 * std::f64::consts::TAU / AZIMUTH_COUNT as f64).cos()).collect();
    let mut out = Vec::with_capacity(spectrum.len() / FREQUENCY_COUNT * HALF_COLUMN_COUNT);
    for row in spectrum.chunks_exact(FREQUENCY_COUNT) {
        out.extend((0..HALF_COLUMN_COUNT).map(|column| {
            let sum: f64 = row
                .iter()
                .enumerate()
                .map(|(f, &value)| {
                    // Every frequency but the first and the last stands for its negative too.
                    let copies = if f == 0 || f == FREQUENCY_COUNT - 1 { 1.0 } else { 2.0 };
                    copies * f64::from(value) * cosine[f * column % AZIMUTH_COUNT]
                })
                .sum();
            (sum / AZIMUTH_COUNT as f64) as f32
        }));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_come_back_from_their_spectrum() {
        let functions: Vec<f32> =
            (0..2 * PIXEL_COUNT).map(|i| ((i * 37 % 101) as f32 - 40.0) / 50.0).collect();
        let back = even_functions(&even_spectrum(&functions));
        assert_eq!(back.len(), functions.len());
        for (back, function) in back.iter().zip(&functions) {
            assert!((back - function).abs() < 2e-5);
        }
    }

    /// A cosine has one spectral line, and a constant only the zeroth.
    #[test]
    fn a_cosine_has_one_spectral_line() {
        let mut functions = vec![0.0f32; PIXEL_COUNT];
        for (i, sample) in functions.iter_mut().enumerate() {
            let azimuth = (i % HALF_COLUMN_COUNT) as f64 * std::f64::consts::TAU / 256.0;
            *sample = (2.0 + (3.0 * azimuth).cos()) as f32;
        }
        let spectrum = even_spectrum(&functions);
        assert_eq!(spectrum.len(), ELEVATION_COUNT * FREQUENCY_COUNT);
        for (f, &value) in spectrum[..FREQUENCY_COUNT].iter().enumerate() {
            let expected = match f {
                0 => 512.0,
                3 => 128.0,
                _ => 0.0,
            };
            assert!((f64::from(value) - expected).abs() < 1e-4, "{f}: {value}");
        }
    }
}
