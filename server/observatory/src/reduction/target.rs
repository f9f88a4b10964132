//! The least flux that must go so that sites meet limits: min Σ f_i·x_i with Σ_i a_ij·x_i ≥ need_j and 0 ≤ x_i ≤ most_i.
//!
//! One site is a greedy fill, several are a linear programme. Either way the answer carries a proof: prices y ≥ 0 of the sites'
//! measures bound the flux of every plan from below by Σ_j y_j·need_j − Σ_i most_i·max(0, Σ_j y_j·a_ij − f_i) (weak duality).

use super::{
    greedy, linear_programme,
    problem::{LeastCut, Reduction},
};

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
