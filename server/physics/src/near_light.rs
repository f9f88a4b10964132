//! First-order radiance next to the direction of a near source, where the sky has a peak: an asymptotic form, tabulated.
//!
//! Let a view ray pass the source at the distance D, n be the unit vector from the source to the ray's nearest point, v the
//! view, ŝ the vertical at the source, and α the angle at the source from that nearest point: u = u_c + D·tan α, so that
//! du/d² = dα/D, cos γ = −sin α and cos ψ = (n·ŝ)·cos α + (v·ŝ)·sin α. Close to the source the air's densities and what gets
//! through hardly change over the α that matter, and the integral of `docs/model.md#first-order` becomes
//!
//! ```text
//! b ≈ 1/D · Σ_species ω β(z_D) e^{−τ(S,O)} · F,    F = ∫ f(ψ(α)) p(γ(α)) dα     [m⁻² sr⁻¹]
//! ```
//!
//! With n·ŝ = s·cos χ and v·ŝ = s·sin χ, cos ψ = s·cos(α − χ): F depends on s and χ alone, for each lobe and each species.
//! [`NearScattering`] holds it as a table. The ray is taken to come from infinity; for a view above the source's horizontal
//! plane what that adds is in the Earth's shadow.

use crate::{
    emission::{EmissionMix, LOBE_COUNT, lobe_intensities_per_sr},
    phase::{AEROSOL_ASYMMETRY, henyey_greenstein_per_sr, rayleigh_per_sr},
    quadrature::gauss_legendre,
};
use std::{f64::consts::FRAC_PI_2, sync::LazyLock};

/// Nodes of s over 0..=1.
const SIZE_COUNT: usize = 97;
/// Nodes of q = (n·ŝ)/(|n·ŝ| + v·ŝ) over −1..=1, which stands for χ: it needs no arc tangent. One lies at 0, where q has a kink.
const TURN_COUNT: usize = 97;
const NODE_COUNT: usize = TURN_COUNT * SIZE_COUNT;
/// Gauss–Legendre nodes a piece.
const NODES: usize = 24;

/// F of molecules and of aerosol (its albedo is the caller's), m⁰ sr⁻².
pub type Species = [f32; 2];

/// F of a mix of lobes.
#[derive(Clone, Debug)]
pub struct NearScattering {
    /// `[q][s]`.
    values: Box<[Species; NODE_COUNT]>,
}

/// F of every lobe, `[lobe][q][s]`.
static OF_LOBES: LazyLock<Vec<Vec<[f64; 2]>>> = LazyLock::new(|| {
    let nodes = gauss_legendre(NODES);
    let mut of_lobes = vec![Vec::new(); LOBE_COUNT];
    for turn in 0..TURN_COUNT {
        let q = 2.0 * turn as f64 / (TURN_COUNT - 1) as f64 - 1.0;
        for size in 0..SIZE_COUNT {
            let s = size as f64 / (SIZE_COUNT - 1) as f64;
            let values = integrals(s, (1.0 - q.abs()).atan2(q), &nodes);
            of_lobes.iter_mut().zip(values).for_each(|(of_lobe, value)| of_lobe.push(value));
        }
    }
    of_lobes
});

/// F of molecules and aerosol for each lobe, by its integral; `turn_rad` is χ, 0..=π.
fn integrals(size: f64, turn_rad: f64, nodes: &[(f64, f64)]) -> [[f64; 2]; LOBE_COUNT] {
    // A source straight below or above the ray's plane of symmetry: its light goes along the horizon.
    let size = size.max(1e-9);
    let mut edges = vec![turn_rad - FRAC_PI_2, FRAC_PI_2];
    // The `oblique` lobe ends at 60°.
    if size > 0.5 {
        let half = (0.5 / size).acos();
        edges.extend([turn_rad - half, turn_rad + half]);
    }
    edges.retain(|edge| (turn_rad - FRAC_PI_2..=FRAC_PI_2).contains(edge));
    edges.sort_by(f64::total_cmp);
    let mut sums = [[0.0; 2]; LOBE_COUNT];
    for pair in edges.windows(2) {
        let width = pair[1] - pair[0];
        for &(x, weight) in nodes {
            let alpha = pair[0] + width * x;
            let lobes = lobe_intensities_per_sr(size * (alpha - turn_rad).cos());
            let cos_gamma = -alpha.sin();
            let phases = [rayleigh_per_sr(cos_gamma), henyey_greenstein_per_sr(cos_gamma, AEROSOL_ASYMMETRY)];
            for (sums, lobe) in sums.iter_mut().zip(lobes) {
                for (sum, phase) in sums.iter_mut().zip(phases) {
                    *sum += width * weight * lobe * phase;
                }
            }
        }
    }
    sums
}

/// The integer part of a number from 0 to 2²², 0 for NaN. By additions, which vectorise; a saturating cast does not.
#[inline(always)]
pub fn trunc_to_u32(x: f32) -> u32 {
    /// From here to twice as much the last bit of an f32 is 1.
    const SHIFT: f32 = 8_388_608.0;
    // Rounds to the nearest, ties to even: for an integer that may be the one before.
    let nearest = ((x - 0.5).max(0.0) + SHIFT).to_bits().wrapping_sub(SHIFT.to_bits());
    nearest + u32::from(x - nearest as i32 as f32 >= 1.0)
}

impl NearScattering {
    /// The table of a mix of lobes.
    pub fn of(emission: EmissionMix) -> Self {
        let mut values = Box::new([[0f32; 2]; NODE_COUNT]);
        for (of_lobe, weight) in OF_LOBES.iter().zip(emission.weights()) {
            for (value, of_lobe) in values.iter_mut().zip(of_lobe) {
                for (value, of_lobe) in value.iter_mut().zip(of_lobe) {
                    *value += (weight * of_lobe) as f32;
                }
            }
        }
        Self { values }
    }

    /// The largest F of molecules and of aerosol, sr⁻², of rays that pass above the source: n·ŝ at least a half.
    pub fn largest_above(&self) -> Species {
        let mut largest = [0f32; 2];
        for (turn, row) in self.values.chunks_exact(SIZE_COUNT).enumerate() {
            let q = 2.0 * turn as f64 / (TURN_COUNT - 1) as f64 - 1.0;
            // cos χ of the node after it, which may be nearer to the half.
            let next = (q + 2.0 / (TURN_COUNT - 1) as f64).min(1.0);
            let cosine = (1.0 - next.abs()).atan2(next).cos();
            for (size, value) in row.iter().enumerate() {
                if (size + 1) as f64 / (SIZE_COUNT - 1) as f64 * cosine >= 0.5 {
                    largest.iter_mut().zip(value).for_each(|(largest, value)| *largest = largest.max(*value));
                }
            }
        }
        largest
    }

    /// F of molecules and of aerosol, sr⁻², `[species][ray]`, from n·ŝ and v·ŝ of some rays; what lies below 0 of the second
    /// counts as 0. Linear between nodes: within 2 % of the largest value.
    #[inline(always)]
    pub fn at<const N: usize>(&self, across: &[f32; N], along: &[f32; N]) -> [[f32; N]; 2] {
        // Positions first, then table values, then sums: the first and the last vectorise, the middle has no branches.
        let (mut node, mut u, mut v) = ([0i32; N], [0f32; N], [0f32; N]);
        for ray in 0..N {
            let (across, along) = (across[ray], along[ray].max(0.0));
            let size = (across * across + along * along).sqrt().min(1.0);
            let turn = across / (across.abs() + along).max(1e-9);
            let x = (0.5 * (TURN_COUNT - 1) as f32) * (turn + 1.0);
            let y = (SIZE_COUNT - 1) as f32 * size;
            let i = (trunc_to_u32(x) as i32).min(TURN_COUNT as i32 - 2);
            let j = (trunc_to_u32(y) as i32).min(SIZE_COUNT as i32 - 2);
            (u[ray], v[ray]) = (x - i as f32, y - j as f32);
            node[ray] = i * SIZE_COUNT as i32 + j;
        }
        let mut corners = [[[0f32; N]; 2]; 4];
        for ray in 0..N {
            let at = (node[ray] as usize).min(NODE_COUNT - SIZE_COUNT - 2);
            for (corner, next) in corners.iter_mut().zip([0, 1, SIZE_COUNT, SIZE_COUNT + 1]) {
                [corner[0][ray], corner[1][ray]] = self.values[at + next];
            }
        }
        let [a, b, c, d] = corners;
        let mut scattered = [[0f32; N]; 2];
        for (species, scattered) in scattered.iter_mut().enumerate() {
            for ray in 0..N {
                let low = a[species][ray] + v[ray] * (b[species][ray] - a[species][ray]);
                let high = c[species][ray] + v[ray] * (d[species][ray] - c[species][ray]);
                scattered[ray] = low + u[ray] * (high - low);
            }
        }
        scattered
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emission::Lobe;

    #[test]
    fn trunc_to_u32_is_a_cast() {
        let near = |x: f32| [x.next_down(), x, x.next_up()];
        for x in (0..5_000u16).flat_map(|n| near(f32::from(n))).chain((0..200).map(|n| 0.37 * n as f32)) {
            assert_eq!(trunc_to_u32(x), x as u32, "{x}");
        }
        assert_eq!(near(4_194_303.0).map(trunc_to_u32), near(4_194_303.0).map(|x| x as u32));
        assert_eq!([f32::NAN, -3.0, f32::NEG_INFINITY].map(trunc_to_u32), [0; 3]);
    }

    #[test]
    fn the_table_is_its_integral_between_nodes_too() {
        let nodes = gauss_legendre(64);
        for lobe in Lobe::ALL {
            let table = NearScattering::of(EmissionMix::only(lobe));
            let (mut worst, mut largest) = (0f64, 0f64);
            for step in 0..400 {
                let (s, turn) = (0.03 + 0.0024 * f64::from(step), 0.0078 * f64::from(step) + 0.01);
                let exact = integrals(s, turn, &nodes)[lobe.index()];
                let got = table.at(&[(s * turn.cos()) as f32], &[(s * turn.sin()) as f32]);
                for ([got], exact) in got.into_iter().zip(exact) {
                    worst = worst.max((f64::from(got) - exact).abs());
                    largest = largest.max(exact);
                }
            }
            assert!(worst < 0.02 * largest, "{lobe:?}: {worst:e} of {largest:e}");
        }
    }

    /// Light that only goes up is seen above a source and not beside it.
    #[test]
    fn upward_light_is_seen_above_the_source() {
        let table = NearScattering::of(EmissionMix::only(Lobe::Oblique));
        // Above it: n·ŝ = 1; beside it, with a level view: nothing leaves within 30° of the horizon.
        let aerosol = |across: f32, along: f32| table.at(&[across], &[along])[1][0];
        assert!(aerosol(0.8, 0.3) > 1e-3);
        assert!(aerosol(0.8, 0.3) > 3.0 * aerosol(0.55, 0.02));
        assert!(aerosol(0.1, 0.02) < 1e-6);
        // Below it everything is in the shadow but what the ray meets beyond.
        assert!(aerosol(-0.9, 0.02) < 1e-3 * aerosol(0.9, 0.02));
    }
}
