//! The linear programme of a reduction plan, its answer, and the bound that prices give (weak duality).

use std::sync::Arc;

/// Lights and what is wanted of them. All vectors of lights are as long as each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reduction {
    /// Upward flux of each light, above 0; in any unit.
    pub flux: Vec<f64>,
    /// The largest part of each light that may go, 0..=1.
    pub most_cut: Vec<f64>,
    /// What each light does to a site's measure, `[site][light]`.
    pub gain: Arc<[Vec<f64>]>,
    /// By how much each site's measure is to fall; where that is 0 or less the site wants nothing.
    pub need: Vec<f64>,
}

/// The least cut.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LeastCut {
    /// Part of each light that goes.
    pub cut: Vec<f64>,
    /// Σ f·x, in the flux's unit.
    pub flux: f64,
    /// No plan that meets the needs takes less flux than this.
    pub least_flux: f64,
}

impl Reduction {
    /// The most that a site's measure can fall.
    pub fn reach(&self, site: usize) -> f64 {
        let falls = self.gain[site].iter().zip(&self.most_cut);
        falls.map(|(gain, most)| gain.max(0.0) * most).sum()
    }

    /// By how much a site's measure falls by cuts.
    pub fn fall(&self, site: usize, cut: &[f64]) -> f64 {
        self.gain[site].iter().zip(cut).map(|(gain, cut)| gain * cut).sum()
    }

    /// Σ_j y_j·a_ij of a light.
    pub(super) fn worth(&self, light: usize, prices: &[f64]) -> f64 {
        prices.iter().zip(self.gain.iter()).map(|(price, gain)| price * gain[light]).sum()
    }

    /// The bound that prices give.
    pub(super) fn bound(&self, prices: &[f64]) -> f64 {
        let wanted: f64 = prices.iter().zip(&self.need).map(|(price, need)| price * need).sum();
        let spared: f64 = (0..self.flux.len())
            .map(|light| self.most_cut[light] * (self.worth(light, prices) - self.flux[light]).max(0.0))
            .sum();
        wanted - spared
    }
}
