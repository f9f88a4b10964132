//! The least flux that must go so that sites meet limits: min Σ f_i·x_i with Σ_i a_ij·x_i ≥ need_j and 0 ≤ x_i ≤ most_i.
//!
//! One site is a greedy fill, several are a linear programme. Either way the answer carries a proof: prices y ≥ 0 of the sites'
//! measures bound the flux of every plan from below by Σ_j y_j·need_j − Σ_i most_i·max(0, Σ_j y_j·a_ij − f_i) (weak duality).

use super::{greedy, linear_programme};

/// Lights and what is wanted of them. All vectors of lights are as long as each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reduction {
    /// Upward flux of each light, above 0; in any unit.
    pub flux: Vec<f64>,
    /// The largest part of each light that may go, 0..=1.
    pub most_cut: Vec<f64>,
    /// What each light does to a site's measure, `[site][light]`.
    pub gain: Vec<Vec<f64>>,
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
        prices.iter().zip(&self.gain).map(|(price, gain)| price * gain[light]).sum()
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

/// Finds the least cut. A need beyond reach counts as all that is in reach.
pub fn least_cut(problem: &Reduction) -> LeastCut {
    let reach = |site: usize| problem.reach(site);
    let need = problem.need.iter().enumerate().map(|(site, need)| need.max(0.0).min(reach(site)));
    let problem = Reduction { need: need.collect(), ..problem.clone() };
    let wanting: Vec<usize> = (0..problem.need.len()).filter(|&site| problem.need[site] > 0.0).collect();
    let (cut, prices) = match wanting.as_slice() {
        [] => (vec![0.0; problem.flux.len()], vec![0.0; problem.need.len()]),
        &[site] => {
            let (cut, price) = greedy::fill(&problem, &problem.gain[site], problem.need[site]);
            let mut prices = vec![0.0; problem.need.len()];
            prices[site] = price;
            (cut, prices)
        }
        _ => linear_programme::solve(&problem),
    };
    let flux = cut.iter().zip(&problem.flux).map(|(cut, flux)| cut * flux).sum();
    LeastCut { least_flux: problem.bound(&prices).max(0.0), cut, flux }
}
