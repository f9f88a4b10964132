//! One site: the lights that do most for their flux go first.

use super::problem::Reduction;

/// The exact least cut for one site, and the price of its measure: flux that a unit more would cost.
pub(super) fn fill(problem: &Reduction, gain: &[f64], need: f64) -> (Vec<f64>, f64) {
    let mut cut = vec![0.0; problem.flux.len()];
    let mut order: Vec<usize> =
        (0..cut.len()).filter(|&light| problem.most_cut[light] > 0.0 && gain[light] > 0.0).collect();
    let worth = |light: &usize| gain[*light] / problem.flux[*light];
    order.sort_unstable_by(|a, b| worth(b).total_cmp(&worth(a)).then(a.cmp(b)));
    let (mut left, mut price) = (need, 0.0);
    for light in order {
        price = problem.flux[light] / gain[light];
        if problem.most_cut[light] * gain[light] >= left {
            cut[light] = left / gain[light];
            break;
        }
        cut[light] = problem.most_cut[light];
        left -= cut[light] * gain[light];
    }
    (cut, price)
}
