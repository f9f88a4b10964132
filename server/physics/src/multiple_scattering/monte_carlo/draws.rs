//! Random numbers (xoshiro256++, Blackman and Vigna 2021) and samples of directions and free paths.

use crate::phase::{AEROSOL_ASYMMETRY, henyey_greenstein_per_sr, rayleigh_per_sr};
use glam::DVec3;
use std::f64::consts::TAU;

/// xoshiro256++ (Blackman and Vigna 2021), seeded by SplitMix64 (Steele et al. 2014).
pub(crate) struct Random([u64; 4]);

impl Random {
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        let mut state = seed ^ stream.wrapping_mul(0xD134_2543_DE82_EF95);
        Self(std::array::from_fn(|_| {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            z ^ (z >> 31)
        }))
    }

    /// Even in 0..1, neither end included.
    pub(crate) fn unit(&mut self) -> f64 {
        let s = &mut self.0;
        let result = s[0].wrapping_add(s[3]).rotate_left(23).wrapping_add(s[0]);
        let t = s[1] << 17;
        s[2] ^= s[0];
        s[3] ^= s[1];
        s[1] ^= s[2];
        s[0] ^= s[3];
        s[2] ^= t;
        s[3] = s[3].rotate_left(45);
        ((result >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }
}

/// Σ coefficient·phase, m⁻¹ sr⁻¹. Rays are followed against the light, so no turn is cos γ = 1 here too.
pub(crate) fn mixed_phase(scatterers: [f64; 2], cos_gamma: f64) -> f64 {
    let cos_gamma = cos_gamma.clamp(-1.0, 1.0);
    scatterers[0] * rayleigh_per_sr(cos_gamma)
        + scatterers[1] * henyey_greenstein_per_sr(cos_gamma, AEROSOL_ASYMMETRY)
}

/// A direction after a scattering from `direction`, drawn from the mix of both phase functions (Henyey–Greenstein by
/// inversion, Witt 1977).
pub(crate) fn scattered_direction(direction: DVec3, scatterers: [f64; 2], random: &mut Random) -> DVec3 {
    let cosine = if random.unit() * (scatterers[0] + scatterers[1]) < scatterers[0] {
        rayleigh_cosine(random)
    } else {
        let g = AEROSOL_ASYMMETRY;
        let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * random.unit());
        ((1.0 + g * g - s * s) / (2.0 * g)).clamp(-1.0, 1.0)
    };
    turned(direction, cosine, TAU * random.unit())
}

/// A direction drawn as a Lambertian surface sends light out.
pub(crate) fn lambertian_direction(normal: DVec3, random: &mut Random) -> DVec3 {
    let cosine = random.unit().sqrt();
    turned(normal, cosine, TAU * random.unit())
}

/// The cosine of a Rayleigh turn by rejection.
fn rayleigh_cosine(random: &mut Random) -> f64 {
    loop {
        let cosine = 2.0 * random.unit() - 1.0;
        if 2.0 * random.unit() < 1.0 + cosine * cosine {
            return cosine;
        }
    }
}

/// The unit vector at an angle from `axis`, turned about it.
pub(crate) fn turned(axis: DVec3, cosine: f64, turn: f64) -> DVec3 {
    let (a, b) = axis.any_orthonormal_pair();
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    (axis * cosine + (a * turn.cos() + b * turn.sin()) * sine).normalize()
}

/// Path at which an ascending optical depth reaches `wanted`, metres; `whole` is the depth at `end_m`.
pub(crate) fn path_of_depth_m(wanted: f64, whole: f64, end_m: f64, depth_at: impl Fn(f64) -> f64) -> f64 {
    let (mut a, mut b, mut depth_a, mut depth_b) = (0.0, end_m, 0.0, whole);
    for k in 0..60 {
        // Secants, limited to 2–98 % of the interval, and every third time a bisection.
        let secant = (wanted - depth_a) / (depth_b - depth_a).max(f64::MIN_POSITIVE);
        let share = if k % 3 == 2 { 0.5 } else { secant.clamp(0.02, 0.98) };
        let middle = a + (b - a) * share;
        let depth = depth_at(middle);
        if depth < wanted {
            (a, depth_a) = (middle, depth);
        } else {
            (b, depth_b) = (middle, depth);
        }
        if b - a < 1e-5 * b + 1e-3 {
            break;
        }
    }
    0.5 * (a + b)
}
