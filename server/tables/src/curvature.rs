//! Interpolation of ln of the scale between two nodes of the offset axis, by Everett's formula (Everett 1900).
//!
//! A straight line would be 1–8 % too dark in haze. The *curvature* at a node is the second difference of ln of the scale
//! over the node and the two beside it; between two nodes with curvatures c₀ and c₁, at t of the way,
//!
//! `ln s(t) = (1 − t)·ln s₀ + t·ln s₁ − t(1 − t)/6·((2 − t)·c₀ + (1 + t)·c₁)`,
//!
//! the cubic through the four nodes around.

use crate::axes::OffsetAxis;

/// Largest curvature in use: where the sky ends at a shadow, ln of the scale falls by any amount from one node to the next, and no
/// cubic follows. A curvature of 1 at both nodes changes the scale by an eighth midway.
pub const MAX_CURVATURE: f64 = 1.0;

impl OffsetAxis {
    /// The middle one of the three nodes that give the curvature at a node: the node itself, but at either end the next one
    /// inside, and at the kink the next one above, for a difference across it would be that of two curves.
    pub fn curvature_node(&self, node: usize) -> usize {
        let inside = if node == self.kink_node { node + 1 } else { node };
        inside.clamp(1, self.count - 2)
    }
}

/// The curvature of a mix of lobes, from ln of each lobe's scale at the three nodes of [`OffsetAxis::curvature_node`], `[lobe][node]`,
/// and the lobes' shares of the mixed scale at the node itself: the second difference of ln Σ e^{ln s_l}, which is the
/// shares' mean of the lobes' own second differences and the variance of their slopes.
pub fn mixed_curvature<const N: usize>(shares: [f64; N], log_scale: [[f64; 3]; N]) -> f64 {
    let slope = log_scale.map(|[below, _, above]| 0.5 * (above - below));
    let mean_slope: f64 = shares.iter().zip(slope).map(|(share, slope)| share * slope).sum();
    let curved = |(share, (slope, [below, at, above])): (f64, (f64, [f64; 3]))| {
        share * (below - 2.0 * at + above + (slope - mean_slope).powi(2))
    };
    let curvature: f64 = shares.into_iter().zip(slope.into_iter().zip(log_scale)).map(curved).sum();
    curvature.clamp(-MAX_CURVATURE, MAX_CURVATURE)
}

/// ln of the scale at `upper_weight` (0..1) of the way from a node to the next, from those of both and their curvatures.
pub fn log_scale_between(log_scale: [f64; 2], curvature: [f64; 2], upper_weight: f64) -> f64 {
    let lower_weight = 1.0 - upper_weight;
    let curvature = (1.0 + lower_weight) * curvature[0] + (1.0 + upper_weight) * curvature[1];
    lower_weight * log_scale[0] + upper_weight * log_scale[1] - lower_weight * upper_weight * curvature / 6.0
}

/// ln of the scale of one lobe at a fractional node of an axis, `at` giving it at whole ones.
pub fn log_scale_at(axis: &OffsetAxis, position: f64, at: impl Fn(usize) -> f64) -> f64 {
    let low = (position as usize).min(axis.count - 2);
    let curvature = |node: usize| {
        let middle = axis.curvature_node(node);
        mixed_curvature([1.0], [[at(middle - 1), at(middle), at(middle + 1)]])
    };
    let t = position - low as f64;
    if t == 0.0 {
        return at(low);
    }
    log_scale_between([at(low), at(low + 1)], [curvature(low), curvature(low + 1)], t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const COUNT: usize = 23;

    /// What is made of ln of a scale at the nodes of an axis at a fractional one.
    fn between(axis: &OffsetAxis, log_scale: &dyn Fn(f64) -> f64, position: f64) -> f64 {
        log_scale_at(axis, position, |node| log_scale(node as f64))
    }

    proptest! {
        /// A parabola is reproduced everywhere, and a cubic away from the ends and the kink.
        #[test]
        fn parabolas_and_inner_cubics_are_reproduced(
            position in 0.0..22.0f64, slope in -2.0..2.0f64, curved in -0.4..0.4f64, cubic in -0.01..0.01f64,
        ) {
            let axis = OffsetAxis::at_distance(20_000.0, COUNT);
            let parabola = |x: f64| -40.0 + slope * x + curved * (x - 7.0).powi(2);
            prop_assert!((between(&axis, &parabola, position) - parabola(position)).abs() < 1e-10);
            let whole = |x: f64| parabola(x) + cubic * (x - 7.0).powi(3);
            let low = position.floor() as usize;
            let even = |node: usize| axis.curvature_node(node) == node
                && (2.0 * curved + 6.0 * cubic * (node as f64 - 7.0)).abs() <= MAX_CURVATURE;
            prop_assume!(even(low) && even(low + 1));
            prop_assert!((between(&axis, &whole, position) - whole(position)).abs() < 1e-10);
        }

        /// The curvature of a mix is the second difference of the logarithm of its scale.
        #[test]
        fn mixed_curvature_is_that_of_the_logarithm(
            share in 0.01..0.99f64,
            slopes in prop::array::uniform2(-0.03..0.03f64),
            curved in prop::array::uniform2(-1e-3..1e-3f64),
        ) {
            let lobe = |l: usize, x: f64| [share, 1.0 - share][l].ln() + slopes[l] * x + curved[l] * x * x;
            let at = |l: usize| [-1.0, 0.0, 1.0].map(|x| lobe(l, x));
            let mixed = [-1.0, 0.0, 1.0].map(|x| (lobe(0, x).exp() + lobe(1, x).exp()).ln());
            let exact = mixed[0] - 2.0 * mixed[1] + mixed[2];
            let curvature = mixed_curvature([share, 1.0 - share], [at(0), at(1)]);
            // What is left is of the third order in such small slopes.
            prop_assert!((curvature - exact).abs() < 1e-5, "{curvature} {exact}");
        }
    }

    #[test]
    fn a_kink_stays_a_kink() {
        // Two lines that meet at the kink: no curvature on either side of it.
        let axis = OffsetAxis::at_distance(20_000.0, COUNT);
        let stretched =
            |x: f64| -30.0 + (x - axis.kink_node as f64) * if x < axis.kink_node as f64 { 1.2 } else { 0.1 };
        for position in [12.0, 13.0, 13.5, 14.5, 21.9] {
            assert!((between(&axis, &stretched, position) - stretched(position)).abs() < 1e-12, "{position}");
        }
    }

    #[test]
    fn a_shadow_curves_a_scale_by_at_most_an_eighth() {
        let axis = OffsetAxis::at_distance(20_000.0, COUNT);
        let cut = |x: f64| if x < 12.5 { -40.0 } else { -300.0 };
        for step in 0..=220 {
            let position = f64::from(step) / 10.0;
            let low = position.floor().min(21.0);
            let line = cut(low) + (cut(low + 1.0) - cut(low)) * (position - low);
            assert!((between(&axis, &cut, position) - line).abs() <= 0.125 + 1e-12);
        }
    }
}
