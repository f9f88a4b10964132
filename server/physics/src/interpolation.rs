//! Lagrange interpolation between uneven nodes (Waring 1779): the cubic through the four nodes around.

use std::{array, iter::Zip, ops::Range};

/// Nodes of a cubic: the most that a stencil has.
pub const MAX_STENCIL: usize = 4;

/// Neighbouring nodes and the weights, summing to 1, with which an interpolation takes their values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stencil {
    first: usize,
    count: usize,
    weight: [f64; MAX_STENCIL],
    /// Weights of linear interpolation between the two nodes around, on the same nodes.
    linear_weight: [f64; MAX_STENCIL],
}

impl Stencil {
    /// One node alone.
    pub fn single(node: usize) -> Self {
        let alone = [1.0, 0.0, 0.0, 0.0];
        Self { first: node, count: 1, weight: alone, linear_weight: alone }
    }

    /// Lagrange interpolation at `x` on ascending `nodes`, of which there is at least one: cubic on the four nodes around,
    /// of lower order where there are fewer. `x` beyond the ends counts as the end.
    ///
    /// w_i = Π_{j≠i} (x − x_j) / (x_i − x_j)
    pub fn lagrange(nodes: &[f64], x: f64) -> Self {
        let last = nodes.len() - 1;
        let x = x.clamp(nodes[0], nodes[last]);
        if last == 0 {
            return Self::single(0);
        }
        let count = nodes.len().min(MAX_STENCIL);
        let upper = nodes.partition_point(|node| *node <= x).clamp(1, last);
        let first = upper.saturating_sub(MAX_STENCIL / 2).min(nodes.len() - count);
        let (mut weight, mut linear_weight) = ([0.0; MAX_STENCIL], [0.0; MAX_STENCIL]);
        for i in 0..count {
            weight[i] = (0..count)
                .filter(|&j| j != i)
                .map(|j| (x - nodes[first + j]) / (nodes[first + i] - nodes[first + j]))
                .product();
        }
        let upper_weight = (x - nodes[upper - 1]) / (nodes[upper] - nodes[upper - 1]);
        linear_weight[upper - 1 - first] = 1.0 - upper_weight;
        linear_weight[upper - first] = upper_weight;
        Self { first, count, weight, linear_weight }
    }

    /// As [`Self::lagrange`], but `x` within `tolerance` of a node takes that node alone.
    pub fn lagrange_or_node(nodes: &[f64], x: f64, tolerance: f64) -> Self {
        let x = x.clamp(nodes[0], nodes[nodes.len() - 1]);
        let on_node = nodes.iter().position(|node| (node - x).abs() <= tolerance);
        on_node.map_or_else(|| Self::lagrange(nodes, x), Self::single)
    }

    /// The same stencil on nodes that begin at `first` in a longer list.
    pub fn shifted(self, first: usize) -> Self {
        Self { first: self.first + first, ..self }
    }

    /// The nodes.
    pub fn nodes(&self) -> Range<usize> {
        self.first..self.first + self.count
    }

    /// Weights of [`Self::nodes`].
    pub fn weights(&self) -> &[f64] {
        &self.weight[..self.count]
    }

    /// Weights of linear interpolation between the two of [`Self::nodes`] around.
    pub fn linear_weights(&self) -> &[f64] {
        &self.linear_weight[..self.count]
    }

    /// [`Self::weights`] in f32, 0 behind the last node.
    pub fn weights_f32(&self) -> [f32; MAX_STENCIL] {
        self.weight.map(|weight| weight as f32)
    }

    /// [`Self::linear_weights`] in f32, 0 behind the last node.
    pub fn linear_weights_f32(&self) -> [f32; MAX_STENCIL] {
        self.linear_weight.map(|weight| weight as f32)
    }

    /// Nodes with their weights.
    pub fn iter(&self) -> Zip<Range<usize>, array::IntoIter<f64, MAX_STENCIL>> {
        self.nodes().zip(self.weight)
    }

    /// Σ weight · value over the nodes.
    pub fn sum(&self, value: impl Fn(usize) -> f64) -> f64 {
        self.iter().map(|(node, weight)| weight * value(node)).sum()
    }
}

impl IntoIterator for Stencil {
    type Item = (usize, f64);
    type IntoIter = Zip<Range<usize>, array::IntoIter<f64, MAX_STENCIL>>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl IntoIterator for &Stencil {
    type Item = (usize, f64);
    type IntoIter = Zip<Range<usize>, array::IntoIter<f64, MAX_STENCIL>>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const NODES: [f64; 6] = [0.0, 250.0, 700.0, 1500.0, 3000.0, 6000.0];

    /// Fewer than four nodes give lines and constants; beyond the ends the end counts.
    #[test]
    fn few_nodes_and_ends() {
        let line = Stencil::lagrange(&[1.0, 3.0], 1.5);
        assert_eq!((line.nodes(), line.weights()), (0..2, [0.75, 0.25].as_slice()));
        assert_eq!(line.linear_weights(), line.weights());
        assert_eq!(Stencil::lagrange(&[1.0, 2.0], 5.0).iter().collect::<Vec<_>>(), [(0, 0.0), (1, 1.0)]);
        assert_eq!(Stencil::lagrange(&[3.0], 5.0), Stencil::single(0));
        assert_eq!(Stencil::lagrange_or_node(&NODES, -40.0, 1e-9), Stencil::single(0));
        assert_eq!(Stencil::lagrange_or_node(&NODES, 9000.0, 1e-9), Stencil::single(5));
    }

    #[test]
    fn a_node_stands_alone_within_the_tolerance() {
        assert_eq!(Stencil::lagrange_or_node(&NODES, 1500.0 + 1e-10, 1e-9), Stencil::single(3));
        let beside = Stencil::lagrange_or_node(&NODES, 1500.0 + 1e-8, 1e-9);
        assert_eq!(beside, Stencil::lagrange(&NODES, 1500.0 + 1e-8));
        assert_eq!(beside.shifted(7).nodes(), 9..13);
    }

    #[test]
    fn two_nodes_on_each_side_where_there_are() {
        let nodes = |x| Stencil::lagrange(&NODES, x).nodes();
        assert_eq!([1000.0, 100.0, 5000.0].map(nodes), [1..5, 0..4, 2..6]);
        let linear = |x| Stencil::lagrange(&NODES, x).linear_weights().to_vec();
        assert_eq!(linear(1100.0), [0.0, 0.5, 0.5, 0.0]);
        assert_eq!(linear(100.0), [0.6, 0.4, 0.0, 0.0]);
        assert_eq!(linear(4500.0), [0.0, 0.0, 0.5, 0.5]);
    }

    /// The control of the next test: a quartic is missed.
    #[test]
    fn quartics_are_not_reproduced() {
        let quartic = |x: f64| x.powi(4) * 1e-13;
        let got = Stencil::lagrange(&NODES, 5000.0).sum(|node| quartic(NODES[node]));
        assert!((got - quartic(5000.0)).abs() > 1e-3);
    }

    proptest! {
        #[test]
        fn cubics_are_reproduced(x in 0.0f64..6_000.0, c in -2.0f64..2.0) {
            let cubic = |x: f64| { let t = x / 3_000.0; 1.0 + c * t - t * t + 0.3 * c * t * t * t };
            for stencil in [Stencil::lagrange(&NODES, x), Stencil::lagrange_or_node(&NODES, x, 1e-12)] {
                prop_assert!((stencil.weights().iter().sum::<f64>() - 1.0).abs() < 1e-12);
                prop_assert!((stencil.sum(|node| cubic(NODES[node])) - cubic(x)).abs() < 1e-9);
            }
        }
    }
}
