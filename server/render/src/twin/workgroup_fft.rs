//! The transform of 256 points by the radix-4 Stockham FFT (Stockham 1966, after Cochran et al. 1967). A device makes the
//! same of two transforms of 16 points each, in workgroup memory.

use super::fft::{Complex, complex_multiply, radix4_butterfly, twiddle};
use crate::cpu::lanes::Aligned;

/// Points of a transform.
const POINT_COUNT: usize = 256;

/// e^{−2πi·n/256} of every n.
pub type Twiddles = [Complex; POINT_COUNT];

/// The points of `N` transforms side by side: `[point][real, imaginary][transform]`.
pub type Points<const N: usize> = [[[f32; N]; 2]; POINT_COUNT];

/// The table of a transform.
pub fn twiddles() -> Twiddles {
    std::array::from_fn(twiddle)
}

/// Index into the twiddle table for input `leg` (0..4) of butterfly `lane` (0..64) in the stage whose
/// sub-transforms have `span` points (1, 4, 16, 64).
#[inline(always)]
pub fn twiddle_index(lane: u32, span: u32, leg: u32) -> u32 {
    leg * (lane % span) * (64 / span)
}

/// Where output `leg` of butterfly `lane` goes in that stage.
#[inline(always)]
pub fn stockham_target(lane: u32, span: u32, leg: u32) -> u32 {
    (lane / span) * span * 4 + lane % span + leg * span
}

/// X_f = Σ_n x_n e^{−2πi fn/256} of `N` transforms, in place; the order of the input and the output is natural.
#[inline(always)]
pub fn transform_256<const N: usize>(twiddles: &Twiddles, points: &mut Points<N>) {
    let Aligned(other) = &mut Aligned([[[0f32; N]; 2]; POINT_COUNT]);
    stage::<1, N>(twiddles, points, other);
    stage::<4, N>(twiddles, other, points);
    stage::<16, N>(twiddles, points, other);
    stage::<64, N>(twiddles, other, points);
}

/// One stage, whose sub-transforms have `SPAN` points.
#[inline(always)]
fn stage<const SPAN: usize, const N: usize>(twiddles: &Twiddles, from: &Points<N>, to: &mut Points<N>) {
    const LEG: usize = POINT_COUNT / 4;
    for within in 0..SPAN {
        let turn: [Complex; 4] = std::array::from_fn(|leg| {
            twiddles[twiddle_index(within as u32, SPAN as u32, leg as u32) as usize]
        });
        for butterfly in (within..LEG).step_by(SPAN) {
            let legs: [&[[f32; N]; 2]; 4] = std::array::from_fn(|leg| &from[butterfly + LEG * leg]);
            let mut out = [[[0f32; N]; 2]; 4];
            for lane in 0..N {
                let turned: [Complex; 4] = std::array::from_fn(|leg| {
                    let value = [legs[leg][0][lane], legs[leg][1][lane]];
                    // The first leg, and all of the first stage, are turned by nothing.
                    if leg == 0 || SPAN == 1 { value } else { complex_multiply(value, turn[leg]) }
                });
                for (out, [real, imaginary]) in out.iter_mut().zip(radix4_butterfly(turned)) {
                    out[0][lane] = real;
                    out[1][lane] = imaginary;
                }
            }
            for (leg, out) in out.into_iter().enumerate() {
                to[stockham_target(butterfly as u32, SPAN as u32, leg as u32) as usize] = out;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        synthetic::Noise,
        twin::{pair_from_spectra, split_pair_spectrum},
    };

    fn row(seed: u64) -> Vec<f64> {
        let mut noise = Noise::new(seed);
        (0..POINT_COUNT).map(|_| noise.unit() - 0.3).collect()
    }

    fn exact(row: &[f64], f: usize) -> (f64, f64) {
        row.iter().enumerate().fold((0.0, 0.0), |(re, im), (n, value)| {
            let angle = std::f64::consts::TAU * ((f * n) % POINT_COUNT) as f64 / POINT_COUNT as f64;
            (re + value * angle.cos(), im - value * angle.sin())
        })
    }

    /// Spectra of rows that are transformed together.
    #[test]
    fn two_real_rows_in_one_transform() {
        let (a, b) = (row(1), row(2));
        let mut z: Points<1> = std::array::from_fn(|n| [[a[n] as f32], [b[n] as f32]]);
        transform_256(&twiddles(), &mut z);
        for f in 0..=POINT_COUNT / 2 {
            let [direct, mirrored] = [f, (POINT_COUNT - f) % POINT_COUNT].map(|f| z[f].map(|[part]| part));
            let got = split_pair_spectrum(direct, mirrored);
            let ((ar, ai), (br, bi)) = (exact(&a, f), exact(&b, f));
            for (got, exact) in got.iter().zip([ar, ai, br, bi]) {
                assert!((f64::from(*got) - exact).abs() < 3e-5, "{f}: {got} {exact}");
            }
        }
    }

    /// Two spectra packed and transformed bring both rows back.
    #[test]
    fn two_real_rows_come_back() {
        let (a, b) = (row(3), row(4));
        let mut z: Points<1> = std::array::from_fn(|f| {
            let mirrored = f > POINT_COUNT / 2;
            let source = if mirrored { POINT_COUNT - f } else { f };
            let ((ar, ai), (br, bi)) = (exact(&a, source), exact(&b, source));
            pair_from_spectra([ar as f32, ai as f32, br as f32, bi as f32], mirrored).map(|part| [part])
        });
        transform_256(&twiddles(), &mut z);
        for n in 0..POINT_COUNT {
            assert!((f64::from(z[n][0][0]) / POINT_COUNT as f64 - a[n]).abs() < 1e-6);
            assert!((-f64::from(z[n][1][0]) / POINT_COUNT as f64 - b[n]).abs() < 1e-6);
        }
    }
}
