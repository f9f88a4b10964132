//! Phase functions (Rayleigh 1871; Henyey and Greenstein 1941), per steradian, normalised to 1 over the sphere. γ is the
//! scattering angle.

use std::f64::consts::PI;

/// Asymmetry of the aerosol's Henyey–Greenstein phase function.
pub const AEROSOL_ASYMMETRY: f64 = 0.8;

/// Rayleigh: 3/(16π)·(1 + cos²γ), sr⁻¹.
pub fn rayleigh_per_sr(cos_gamma: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + cos_gamma * cos_gamma)
}

/// Henyey–Greenstein: (1 − g²)/(4π·(1 + g² − 2g cos γ)^1.5), sr⁻¹.
pub fn henyey_greenstein_per_sr(cos_gamma: f64, asymmetry: f64) -> f64 {
    let g = asymmetry;
    let base = 1.0 + g * g - 2.0 * g * cos_gamma;
    (1.0 - g * g) / (4.0 * PI * base * base.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn over_the_sphere(phase: impl Fn(f64) -> f64) -> f64 {
        let n = 400_000;
        let step = 2.0 / f64::from(n);
        (0..n).map(|i| 2.0 * PI * phase(-1.0 + (f64::from(i) + 0.5) * step) * step).sum()
    }

    #[test]
    fn both_phase_functions_scatter_all_light() {
        assert!((over_the_sphere(rayleigh_per_sr) - 1.0).abs() < 1e-9);
        assert!((over_the_sphere(|c| henyey_greenstein_per_sr(c, 0.8)) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn the_mean_cosine_is_the_asymmetry() {
        let mean = over_the_sphere(|c| c * henyey_greenstein_per_sr(c, AEROSOL_ASYMMETRY));
        assert!((mean - AEROSOL_ASYMMETRY).abs() < 1e-8);
        assert!(over_the_sphere(|c| c * rayleigh_per_sr(c)).abs() < 1e-9);
    }
}
