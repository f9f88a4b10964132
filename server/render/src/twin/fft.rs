//! Parts of the fast Fourier transform (Cooley and Tukey 1965): the radix-4 butterfly, the transform of 16 points made of
//! eight of them, and the packing of two real rows into one complex one (Cooley, Lewis and Welch 1970).

/// A complex number as (real, imaginary), WGSL's `vec2<f32>`.
pub type Complex = [f32; 2];

/// (a_r + i a_i)(b_r + i b_i).
#[inline(always)]
pub fn complex_multiply(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// e^{−2πi·index/256}, computed in f64; shaders read a table of those that they need.
pub fn twiddle(index: usize) -> Complex {
    let angle = -std::f64::consts::TAU * index as f64 / 256.0;
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
