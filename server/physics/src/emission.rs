//! Emission lobes: upward flux over zenith angle ψ (Garstang 1986; Falchi et al. 2016).
//!
//! Each lobe integrates to 1 over the upper hemisphere and is zero at and below the horizon.

use crate::error::PhysicsError;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI, TAU};

/// Number of lobes; the length of every per-lobe array, in the order of [`Lobe::ALL`].
pub const LOBE_COUNT: usize = 3;

/// 1/∫₀^{π/2} ψ⁴ sin ψ dψ. The antiderivative is −ψ⁴cos ψ + 4ψ³sin ψ + 12ψ²cos ψ − 24ψ sin ψ − 24cos ψ.
const HORIZON_NORM: f64 = {
    let h = FRAC_PI_2;
    1.0 / (4.0 * h * h * h - 24.0 * h + 24.0)
};
/// 16/(3√3).
const OBLIQUE_NORM: f64 = 16.0 / (3.0 * 1.732_050_807_568_877_2);

/// One emission lobe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Lobe {
    /// cos ψ / π.
    Lambert,
    /// C ψ⁴ / 2π (Garstang's low-angle term).
    Horizon,
    /// C' sin 3ψ / 2π for ψ < 60°, else 0 (third function of Falchi et al. 2016).
    Oblique,
}

impl Lobe {
    /// All lobes in array order.
    pub const ALL: [Lobe; LOBE_COUNT] = [Lobe::Lambert, Lobe::Horizon, Lobe::Oblique];

    /// Position in every per-lobe array.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The name used in requests, answers and files.
    pub const fn name(self) -> &'static str {
        match self {
            Lobe::Lambert => "lambert",
            Lobe::Horizon => "horizon",
            Lobe::Oblique => "oblique",
        }
    }

    /// f(ψ), sr⁻¹, from the cosine of the zenith angle at the source. Zero for cos ψ ≤ 0.
    pub fn intensity_per_sr(self, cos_zenith: f64) -> f64 {
        lobe_intensities_per_sr(cos_zenith)[self.index()]
    }
}

/// f(ψ) of all three lobes, sr⁻¹, from the cosine of the zenith angle at the source; zero for cos ψ ≤ 0.
pub fn lobe_intensities_per_sr(cos_zenith: f64) -> [f64; LOBE_COUNT] {
    if cos_zenith <= 0.0 {
        return [0.0; LOBE_COUNT];
    }
    let c = cos_zenith.min(1.0);
    let psi = c.acos();
    let psi2 = psi * psi;
    let oblique = if psi < FRAC_PI_3 {
        // sin 3ψ = sin ψ (4cos²ψ − 1)
        OBLIQUE_NORM / TAU * (1.0 - c * c).max(0.0).sqrt() * (4.0 * c * c - 1.0)
    } else {
        0.0
    };
    [c / PI, HORIZON_NORM / TAU * psi2 * psi2, oblique.max(0.0)]
}

/// ∫ f dΩ of each lobe over elevations above `blocking_rad` at the source: the power that a source of 1 W still
/// emits behind a skyline, W. Exactly 1 for the open sky (0 and below), 0 at π/2.
pub fn emitted_shares(blocking_rad: f64) -> [f64; LOBE_COUNT] {
    // NaN is an open sky too.
    if blocking_rad.is_nan() || blocking_rad <= 0.0 {
        return [1.0; LOBE_COUNT];
    }
    let psi = (FRAC_PI_2 - blocking_rad).max(0.0);
    let (sine, cosine) = psi.sin_cos();
    let psi2 = psi * psi;
    let horizon = 4.0 * psi * psi2 * sine - psi2 * psi2 * cosine + 12.0 * psi2 * cosine - 24.0 * psi * sine
        + 24.0 * (1.0 - cosine);
    let last = psi.min(FRAC_PI_3);
    // ∫ sin 3ψ sin ψ dψ = ½∫(cos 2ψ − cos 4ψ) dψ
    let oblique = 0.5 * OBLIQUE_NORM * (0.5 * (2.0 * last).sin() - 0.25 * (4.0 * last).sin());
    [sine * sine, (HORIZON_NORM * horizon).clamp(0.0, 1.0), oblique.clamp(0.0, 1.0)]
}

/// Weights of the three lobes, each ≥ 0, summing to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "[f64; LOBE_COUNT]", try_from = "[f64; LOBE_COUNT]")]
pub struct EmissionMix {
    weights: [f64; LOBE_COUNT],
}

impl EmissionMix {
    /// From weights ≥ 0 that are normalised to sum to 1.
    ///
    /// # Errors
    /// [`PhysicsError::Invalid`] naming `emission` for a negative, non-finite or all-zero set.
    pub fn new(weights: [f64; LOBE_COUNT]) -> Result<Self, PhysicsError> {
        let sum: f64 = weights.iter().sum();
        if weights.iter().any(|w| !w.is_finite() || *w < 0.0) || sum <= 0.0 || !sum.is_finite() {
            return Err(PhysicsError::Invalid {
                parameter: "emission",
                reason: format!(
                    "weights {weights:?} (lambert, horizon, oblique) must be finite, not negative, and not all zero"
                ),
            });
        }
        Ok(Self::normalized(weights))
    }

    /// From weights of which it is known that [`Self::new`] takes them.
    pub(crate) fn normalized(weights: [f64; LOBE_COUNT]) -> Self {
        let sum: f64 = weights.iter().sum();
        Self { weights: weights.map(|w| w / sum) }
    }

    /// `lambert` alone.
    pub fn lambert() -> Self {
        Self { weights: [1.0, 0.0, 0.0] }
    }

    /// One lobe alone.
    pub fn only(lobe: Lobe) -> Self {
        let mut weights = [0.0; LOBE_COUNT];
        weights[lobe.index()] = 1.0;
        Self { weights }
    }

    /// Weights in lobe order, summing to 1.
    pub fn weights(self) -> [f64; LOBE_COUNT] {
        self.weights
    }
}

impl From<EmissionMix> for [f64; LOBE_COUNT] {
    fn from(mix: EmissionMix) -> Self {
        mix.weights
    }
}

impl TryFrom<[f64; LOBE_COUNT]> for EmissionMix {
    type Error = PhysicsError;

    fn try_from(weights: [f64; LOBE_COUNT]) -> Result<Self, PhysicsError> {
        let mix = Self::new(weights)?;
        // What was normalised once stays as it is, to the last bit.
        let is_normal = (weights.iter().sum::<f64>() - 1.0).abs() < 1e-12;
        Ok(if is_normal { Self { weights } } else { mix })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ f dΩ = 2π ∫ f(ψ) sin ψ dψ by a midpoint rule fine enough for 1e-8.
    fn hemisphere_integral(lobe: Lobe) -> f64 {
        let n = 200_000;
        let step = FRAC_PI_2 / n as f64;
        (0..n)
            .map(|i| {
                let psi: f64 = (i as f64 + 0.5) * step;
                TAU * lobe.intensity_per_sr(psi.cos()) * psi.sin() * step
            })
            .sum()
    }

    #[test]
    fn every_lobe_sends_out_exactly_its_flux() {
        for lobe in Lobe::ALL {
            let integral = hemisphere_integral(lobe);
            assert!((integral - 1.0).abs() < 1e-8, "{lobe:?}: {integral}");
        }
    }

    /// The share emitted above a skyline is the integral over the directions that it leaves.
    #[test]
    fn emitted_share_is_the_integral_above() {
        for blocking_deg in [0.5f64, 8.0, 29.0, 31.0, 60.0] {
            let blocking_rad = blocking_deg.to_radians();
            let n = 100_000;
            let step = (FRAC_PI_2 - blocking_rad) / n as f64;
            for lobe in Lobe::ALL {
                let integral: f64 = (0..n)
                    .map(|i| {
                        let psi: f64 = (i as f64 + 0.5) * step;
                        TAU * lobe.intensity_per_sr(psi.cos()) * psi.sin() * step
                    })
                    .sum();
                let share = emitted_shares(blocking_rad)[lobe.index()];
                assert!((share - integral).abs() < 1e-8, "{lobe:?} {blocking_deg}: {share} {integral}");
            }
        }
        assert_eq!(emitted_shares(0.0), [1.0; LOBE_COUNT]);
        assert_eq!(emitted_shares(-0.1), [1.0; LOBE_COUNT]);
        assert!(emitted_shares(FRAC_PI_2).iter().all(|&share| share < 1e-12));
        // Half a degree takes nearly 3 % of the low lobe: the check can fail.
        assert!(emitted_shares(0.5f64.to_radians())[1] < 0.98);
    }

    /// No lobe emits downwards, and the oblique lobe ends at 60 degrees.
    #[test]
    fn lobes_end_at_their_edges() {
        for lobe in Lobe::ALL {
            assert_eq!(lobe.intensity_per_sr(-1e-12), 0.0);
        }
        assert_eq!(Lobe::Oblique.intensity_per_sr(61f64.to_radians().cos()), 0.0);
        assert!(Lobe::Oblique.intensity_per_sr(30f64.to_radians().cos()) > 0.0);
    }

    #[test]
    fn bad_weights_are_refused() {
        for bad in [[-1.0, 2.0, 0.0], [0.0; 3], [f64::NAN, 1.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
            assert!(EmissionMix::new(bad).is_err(), "{bad:?}");
        }
        assert_eq!(EmissionMix::new([2.0, 2.0, 0.0]).unwrap().weights(), [0.5, 0.5, 0.0]);
    }
}
