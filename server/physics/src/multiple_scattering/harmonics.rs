//! Real spherical harmonics (Laplace 1782) that are even in azimuth: N_lm·P_lm(μ)·cos mφ, orthonormal over the sphere.
//!
//! The light of one source is mirror symmetric about the vertical plane through the source, so the odd half
//! (sin mφ) never occurs. A phase function Σ (2l + 1)/4π·χ_l·P_l turns the moments L_lm of the incoming
//! radiance into those of the scattered one, χ_l·L_lm (Funk–Hecke theorem), so radiance is stored as moments here.

use std::{f64::consts::PI, sync::LazyLock};

/// Number of (l, m) pairs, 0 ≤ m ≤ l ≤ `degree`.
pub(super) const fn pair_count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// Place of (l, m) in an array of [`pair_count`] entries.
pub(super) const fn pair_index(l: usize, m: usize) -> usize {
    l * (l + 1) / 2 + m
}

/// More than the degree of any field, which is 36 at most.
const STORED_DEGREE: usize = 40;
/// [`factors`] of every pair up to [`STORED_DEGREE`]: roots and quotients took a thirtieth of a field's time.
static FACTORS: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| {
    (0..=STORED_DEGREE)
        .flat_map(|l| (0..=l).map(move |m| if m < l { factors(l, m) } else { (0.0, 0.0) }))
        .collect()
});

/// What P_l of order m is made of: (a, b) of a·(μ·P_{l−1} − b·P_{l−2}), m < l.
fn factors(l: usize, m: usize) -> (f64, f64) {
    let (l2, m2) = ((l * l) as f64, (m * m) as f64);
    let b2 = ((l - 1) * (l - 1)) as f64;
    (((4.0 * l2 - 1.0) / (l2 - m2)).sqrt(), ((b2 - m2) / (4.0 * b2 - 1.0)).sqrt())
}

/// N_lm·P_lm(μ) for all pairs up to `degree`, sr^−½; times cos mφ they are orthonormal over the sphere.
/// −1 ≤ μ ≤ 1; shape `[pair]`.
pub(super) fn legendre(degree: usize, cos_zenith: f64) -> Vec<f64> {
    let mut values = vec![0.0; pair_count(degree)];
    let sine = (1.0 - cos_zenith * cos_zenith).max(0.0).sqrt();
    let mut sectoral = (1.0 / (4.0 * PI)).sqrt();
    for m in 0..=degree {
        if m > 0 {
            let order = m as f64;
            // cos mφ has half the mean square of cos 0: √2 enters once, at m = 1.
            let azimuthal: f64 = if m == 1 { 2.0 } else { 1.0 };
            sectoral *= (azimuthal * (2.0 * order + 1.0) / (2.0 * order)).sqrt() * sine;
        }
        values[pair_index(m, m)] = sectoral;
        let (mut before, mut last) = (0.0, sectoral);
        for l in m + 1..=degree {
            let (a, b) = FACTORS.get(pair_index(l, m)).copied().unwrap_or_else(|| factors(l, m));
            (before, last) = (last, a * (cos_zenith * last - b * before));
            values[pair_index(l, m)] = last;
        }
    }
    values
}

/// cos mφ for m = 0..=degree.
pub(super) fn cosines(degree: usize, cos_azimuth: f64) -> Vec<f64> {
    let mut values = vec![1.0; degree + 1];
    if degree > 0 {
        values[1] = cos_azimuth;
    }
    for m in 2..=degree {
        values[m] = 2.0 * cos_azimuth * values[m - 1] - values[m - 2];
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{phase::henyey_greenstein_per_sr, quadrature::gauss_legendre};

    #[test]
    fn the_harmonics_are_orthonormal_over_the_sphere() {
        let degree = 6;
        let pairs: Vec<(usize, usize)> = (0..=degree).flat_map(|l| (0..=l).map(move |m| (l, m))).collect();
        for &(l, m) in &pairs {
            for &(k, n) in &pairs {
                let mut sum = 0.0;
                for (x, weight) in gauss_legendre(16) {
                    let values = legendre(degree, 2.0 * x - 1.0);
                    for i in 0..16 {
                        let cosine = cosines(degree, (PI * (f64::from(i) + 0.5) / 16.0).cos());
                        sum += 2.0 * weight * 2.0 * PI / 16.0
                            * values[pair_index(l, m)]
                            * cosine[m]
                            * values[pair_index(k, n)]
                            * cosine[n];
                    }
                }
                let expected = if (l, m) == (k, n) { 1.0 } else { 0.0 };
                assert!((sum - expected).abs() < 1e-12, "{l} {m} {k} {n}: {sum}");
            }
        }
    }

    /// A beam scattered through its moments is the phase function.
    #[test]
    fn a_scattered_beam_is_the_phase_function() {
        // Both directions in the plane φ = 0, where the odd half is zero.
        let (degree, g) = (60, 0.8f64);
        let (first, second) = (0.3f64, -0.5f64);
        let (a, b) = (legendre(degree, first), legendre(degree, second));
        let sum: f64 = (0..=degree)
            .flat_map(|l| (0..=l).map(move |m| (l, m)))
            .map(|(l, m)| g.powi(l as i32) * a[pair_index(l, m)] * b[pair_index(l, m)])
            .sum();
        let cos_gamma = first * second + ((1.0 - first * first) * (1.0 - second * second)).sqrt();
        let exact = henyey_greenstein_per_sr(cos_gamma, g);
        assert!((sum / exact - 1.0).abs() < 1e-4, "{sum} {exact}");
    }
}
