//! The 256-point transform: on a device two of sixteen points, on the CPU four radix-4 Stockham stages; and the
//! two-for-one packing of real rows.

/// A complex number as (real, imaginary), WGSL's `vec2<f32>`.
pub type Complex = [f32; 2];

/// Points of a transform.
const N: usize = 256;

/// (a_r + i a_i)(b_r + i b_i).
#[inline(always)]
pub fn complex_multiply(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// e^{−2πi·index/256}, computed in f64; shaders read a table of those that they need.
pub fn twiddle(index: usize) -> Complex {
    let angle = -std::f64::consts::TAU * index as f64 / N as f64;
    [angle.cos() as f32, angle.sin() as f32]
}

/// The 4-point transform: X_q = Σ_p x_p·(−i)^{pq}.
#[inline(always)]
pub fn radix4_butterfly(x: [Complex; 4]) -> [Complex; 4] {
    let even_sum = [x[0][0] + x[2][0], x[0][1] + x[2][1]];
    let even_difference = [x[0][0] - x[2][0], x[0][1] - x[2][1]];
    let odd_sum = [x[1][0] + x[3][0], x[1][1] + x[3][1]];
    // (x_1 − x_3)·(−i)
    let odd_turned = [x[1][1] - x[3][1], x[3][0] - x[1][0]];
    [
        [even_sum[0] + odd_sum[0], even_sum[1] + odd_sum[1]],
        [even_difference[0] + odd_turned[0], even_difference[1] + odd_turned[1]],
        [even_sum[0] - odd_sum[0], even_sum[1] - odd_sum[1]],
        [even_difference[0] - odd_turned[0], even_difference[1] - odd_turned[1]],
    ]
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

/// X_f = Σ_n x_n e^{−2πi fn/16}: with n = j + 4m and f = q + 4p,
/// X_f = Σ_j (−i)^{jp} · e^{−2πi jq/16} · Σ_m x_{j+4m} (−i)^{mq}.
///
/// A device makes one of 256 points of two: with n = l + 16m and f = q + 16p,
/// X_f = Σ_l e^{−2πi lp/16} · e^{−2πi lq/256} · Σ_m x_{l+16m} e^{−2πi mq/16}.
pub fn transform_16(x: [Complex; 16]) -> [Complex; 16] {
    let rows: [[Complex; 4]; 4] =
        std::array::from_fn(|j| radix4_butterfly(std::array::from_fn(|m| x[j + 4 * m])));
    let turned = |q: usize| -> [Complex; 4] {
        std::array::from_fn(|j| complex_multiply(rows[j][q], twiddle(16 * j * q)))
    };
    let columns: [[Complex; 4]; 4] = std::array::from_fn(|q| radix4_butterfly(turned(q)));
    std::array::from_fn(|f| columns[f % 4][f / 4])
}

/// X_f = Σ_n x_n e^{−2πi fn/256}, in place; the order of the input and the output is natural.
pub fn transform_256(data: &mut [Complex; N]) {
    for span in [1u32, 4, 16, 64] {
        let mut next = [[0.0; 2]; N];
        for lane in 0..64u32 {
            let legs = std::array::from_fn(|leg| {
                let value = data[lane as usize + 64 * leg];
                complex_multiply(value, twiddle(twiddle_index(lane, span, leg as u32) as usize))
            });
            for (leg, value) in radix4_butterfly(legs).into_iter().enumerate() {
                next[stockham_target(lane, span, leg as u32) as usize] = value;
            }
        }
        *data = next;
    }
}

/// Spectra of two real rows a, b from that of z = a + i b: with Z_f and Z_{256−f},
/// A = (Z_f + Z̄_{256−f})/2, B = (Z_f − Z̄_{256−f})/(2i); answers (A_r, A_i, B_r, B_i).
#[inline(always)]
pub fn split_pair_spectrum(z: Complex, z_mirrored: Complex) -> [f32; 4] {
    [
        0.5 * (z[0] + z_mirrored[0]),
        0.5 * (z[1] - z_mirrored[1]),
        0.5 * (z[1] + z_mirrored[1]),
        0.5 * (z_mirrored[0] - z[0]),
    ]
}

/// The conjugate of A_f + i B_f for the inverse by a forward transform: `spectra` is (A_r, A_i, B_r, B_i) at
/// f ≤ 128, or at 256 − f with `mirrored`, where real rows have the conjugates.
#[inline(always)]
pub fn pair_from_spectra(spectra: [f32; 4], mirrored: bool) -> Complex {
    let sign = if mirrored { -1.0 } else { 1.0 };
    [spectra[0] - sign * spectra[3], -(sign * spectra[1] + spectra[2])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Noise;

    fn row(seed: u64) -> Vec<f64> {
        let mut noise = Noise::new(seed);
        (0..N).map(|_| noise.unit() - 0.3).collect()
    }

    fn exact(row: &[f64], f: usize) -> (f64, f64) {
        row.iter().enumerate().fold((0.0, 0.0), |(re, im), (n, value)| {
            let angle = std::f64::consts::TAU * ((f * n) % N) as f64 / N as f64;
            (re + value * angle.cos(), im - value * angle.sin())
        })
    }

    #[test]
    fn one_transform_gives_the_spectra_of_two_real_rows() {
        let (a, b) = (row(1), row(2));
        let mut z = std::array::from_fn(|n| [a[n] as f32, b[n] as f32]);
        transform_256(&mut z);
        for f in 0..=N / 2 {
            let got = split_pair_spectrum(z[f], z[(N - f) % N]);
            let ((ar, ai), (br, bi)) = (exact(&a, f), exact(&b, f));
            for (got, exact) in got.iter().zip([ar, ai, br, bi]) {
                assert!((f64::from(*got) - exact).abs() < 3e-5, "{f}: {got} {exact}");
            }
        }
    }

    #[test]
    fn packing_two_spectra_and_transforming_brings_both_rows_back() {
        let (a, b) = (row(3), row(4));
        let mut z = std::array::from_fn(|f| {
            let mirrored = f > N / 2;
            let source = if mirrored { N - f } else { f };
            let ((ar, ai), (br, bi)) = (exact(&a, source), exact(&b, source));
            pair_from_spectra([ar as f32, ai as f32, br as f32, bi as f32], mirrored)
        });
        transform_256(&mut z);
        for n in 0..N {
            assert!((f64::from(z[n][0]) / N as f64 - a[n]).abs() < 1e-6);
            assert!((-f64::from(z[n][1]) / N as f64 - b[n]).abs() < 1e-6);
        }
    }
}
