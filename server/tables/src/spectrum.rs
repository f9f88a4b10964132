//! F[B]: the azimuthal spectrum of even functions, real and half as long.

use crate::{
    images::{HALF_COLUMN_COUNT, PIXEL_COUNT},
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cosine_has_one_line_and_a_constant_only_the_zeroth() {
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
