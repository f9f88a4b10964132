//! The paper's plan: lights are cut by how influential they are.

/// γ of every light (paper Eq. 12): clamp((Q − Q_a)/(Q_b − Q_a), 0, 1)·γ_usr; a step at Q_a where Q_b is the same.
///
/// * `influence`: Q, in any unit; `from`, `to`: Q_a ≤ Q_b in that unit; `gamma`: γ_usr, 0..=1.
pub fn threshold_cuts(influence: &[f64], from: f64, to: f64, gamma: f64) -> Vec<f64> {
    let cut = |&q: &f64| {
        let ramp = if to > from {
            ((q - from) / (to - from)).clamp(0.0, 1.0)
        } else if q >= from {
            1.0
        } else {
            0.0
        };
        ramp * gamma
    };
    influence.iter().map(cut).collect()
}

/// The value below which `percent` of the values lie, 0..=100, linear between neighbours; 0 of none.
pub fn percentile(values: &[f64], percent: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let position = (percent / 100.0).clamp(0.0, 1.0) * last as f64;
    let below = position as usize;
    let above = (below + 1).min(last);
    sorted[below] + (position - below as f64) * (sorted[above] - sorted[below])
}
