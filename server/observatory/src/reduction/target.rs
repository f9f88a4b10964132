//! The least flux that must go so that sites meet limits: min Σ f_i·x_i with Σ_i a_ij·x_i ≥ need_j and 0 ≤ x_i ≤ most_i.
//!
//! One site is a greedy fill, several are a linear programme. Either way the answer carries a proof: prices y ≥ 0 of the sites'
//! measures bound the flux of every plan from below by Σ_j y_j·need_j − Σ_i most_i·max(0, Σ_j y_j·a_ij − f_i) (weak duality).

use super::{greedy, linear_programme};
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
    fn bound(&self, prices: &[f64]) -> f64 {
        let wanted: f64 = prices.iter().zip(&self.need).map(|(price, need)| price * need).sum();
        let spared: f64 = (0..self.flux.len())
            .map(|light| self.most_cut[light] * (self.worth(light, prices) - self.flux[light]).max(0.0))
            .sum();
        wanted - spared
    }
}

/// A need this near to all that is in reach takes all: there is no room left for a choice.
const ALL: f64 = 1.0 - 1e-9;

/// Finds the least cut. A need beyond reach counts as all that is in reach.
pub fn least_cut(problem: &Reduction) -> LeastCut {
    let lights = problem.flux.len();
    let mut rest = problem.clone();
    // Sites that need all they can get take it, and leave nothing to choose for the lights that they see.
    let mut taken = vec![0.0; lights];
    for site in 0..problem.need.len() {
        if problem.need[site] > 0.0 && problem.need[site] >= ALL * problem.reach(site) {
            for light in (0..lights).filter(|&light| problem.gain[site][light] > 0.0) {
                taken[light] = problem.most_cut[light];
            }
        }
    }
    for light in (0..lights).filter(|&light| taken[light] > 0.0) {
        rest.most_cut[light] = 0.0;
    }
    for site in 0..problem.need.len() {
        let left = problem.need[site] - problem.fall(site, &taken);
        // Of what was taken whole rounding is left.
        rest.need[site] =
            if left > (1.0 - ALL) * problem.need[site] { left.min(rest.reach(site)) } else { 0.0 };
    }
    let wanting: Vec<usize> = (0..rest.need.len()).filter(|&site| rest.need[site] > 0.0).collect();
    let (mut cut, prices) = match wanting.as_slice() {
        [] => (vec![0.0; lights], vec![0.0; rest.need.len()]),
        &[site] => {
            let (cut, price) = greedy::fill(&rest, &rest.gain[site], rest.need[site]);
            let mut prices = vec![0.0; rest.need.len()];
            prices[site] = price;
            (cut, prices)
        }
        _ => linear_programme::solve(&rest),
    };
    let flux_of = |cut: &[f64]| cut.iter().zip(&problem.flux).map(|(cut, flux)| cut * flux).sum::<f64>();
    let least_flux = flux_of(&taken) + rest.bound(&prices).max(0.0);
    cut.iter_mut().zip(&taken).for_each(|(cut, taken)| *cut += taken);
    LeastCut { least_flux, flux: flux_of(&cut), cut }
}
