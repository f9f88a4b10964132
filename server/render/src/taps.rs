//! Interpolation weights, computed in f64 once a request.

/// Up to four nodes and their weights, which sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taps {
    count: usize,
    index: [usize; Self::MAX],
    weight: [f64; Self::MAX],
    /// Weights of linear interpolation between the two nodes around, on the same nodes.
    bracket: [f64; Self::MAX],
}

impl Taps {
    /// Most taps there are: a cubic's.
    pub const MAX: usize = 4;

    /// One node alone.
    pub fn single(index: usize) -> Self {
        let alone = [1.0, 0.0, 0.0, 0.0];
        Self { count: 1, index: [index, 0, 0, 0], weight: alone, bracket: alone }
    }

    /// The same taps on nodes that begin at `first` in a longer list.
    pub fn shifted(mut self, first: usize) -> Self {
        for index in &mut self.index[..self.count] {
            *index += first;
        }
        self
    }

    /// Nodes, in ascending order.
    pub fn indices(&self) -> &[usize] {
        &self.index[..self.count]
    }

    /// Weights of [`Self::indices`].
    pub fn weights(&self) -> &[f64] {
        &self.weight[..self.count]
    }

    /// Weights as the shaders take them: f32, zero behind the last tap.
    pub fn weights_f32(&self) -> [f32; Self::MAX] {
        self.weight.map(|weight| weight as f32)
    }

    /// Weights of linear interpolation between the two of [`Self::indices`] around.
    pub fn bracket(&self) -> &[f64] {
        &self.bracket[..self.count]
    }

    /// [`Self::bracket`] as the shaders take it: f32, zero behind the last tap.
    pub fn bracket_f32(&self) -> [f32; Self::MAX] {
        self.bracket.map(|weight| weight as f32)
    }

    /// Node indices as the shaders take them, zero behind the last tap.
    pub fn indices_u32(&self) -> [u32; Self::MAX] {
        self.index.map(|index| index as u32)
    }
}

/// Lagrange interpolation at `x` on ascending `nodes`: cubic on the four nodes around it, of lower order where
/// there are fewer nodes. `x` beyond the ends counts as the end; `x` within `tolerance` of a node takes
/// that node alone.
///
/// w_i = Π_{j≠i} (x − x_j) / (x_i − x_j)
///
/// Panics in debug builds on an empty slice. Checked by the tests below.
pub fn lagrange_taps(nodes: &[f64], x: f64, tolerance: f64) -> Taps {
    debug_assert!(!nodes.is_empty());
    let last = nodes.len() - 1;
    let x = x.clamp(nodes[0], nodes[last]);
    if let Some(index) = nodes.iter().position(|node| (node - x).abs() <= tolerance) {
        return Taps::single(index);
    }
    let count = nodes.len().min(Taps::MAX);
    let above = nodes.partition_point(|node| *node <= x);
    let first = above.saturating_sub(2).min(nodes.len() - count);
    let none = [0.0; Taps::MAX];
    let mut taps = Taps { count, index: [0; Taps::MAX], weight: none, bracket: none };
    for i in 0..count {
        taps.index[i] = first + i;
        taps.weight[i] = (0..count)
            .filter(|&j| j != i)
            .map(|j| (x - nodes[first + j]) / (nodes[first + i] - nodes[first + j]))
            .product();
    }
    // x lies between two nodes, for it is on none of them.
    let upper_weight = (x - nodes[above - 1]) / (nodes[above] - nodes[above - 1]);
    taps.bracket[above - 1 - first] = 1.0 - upper_weight;
    taps.bracket[above - first] = upper_weight;
    taps
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODES: [f64; 6] = [0.0, 250.0, 700.0, 1500.0, 3000.0, 6000.0];

    fn interpolate(nodes: &[f64], x: f64, f: impl Fn(f64) -> f64) -> f64 {
        let taps = lagrange_taps(nodes, x, 1e-9);
        taps.indices().iter().zip(taps.weights()).map(|(&i, w)| w * f(nodes[i])).sum()
    }

    #[test]
    fn cubics_are_reproduced_and_quartics_are_not() {
        let cubic = |x: f64| 1.0 + x * (2e-3 + x * (-3e-7 + x * 5e-11));
        let quartic = |x: f64| x.powi(4) * 1e-13;
        for x in [0.0, 1.0, 249.0, 250.0, 1000.0, 2999.0, 5999.0, 6000.0] {
            let got = interpolate(&NODES, x, cubic);
            assert!((got - cubic(x)).abs() < 1e-11 * cubic(x).abs(), "{x}: {got}");
        }
        assert!((interpolate(&NODES, 5000.0, quartic) - quartic(5000.0)).abs() > 1e-3);
    }

    #[test]
    fn weights_sum_to_one_everywhere() {
        for step in 0..=700 {
            let taps = lagrange_taps(&NODES, step as f64 * 10.0 - 500.0, 1e-9);
            assert!((taps.weights().iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn values_beyond_the_ends_take_the_end_node() {
        assert_eq!(lagrange_taps(&NODES, -40.0, 1e-9), Taps::single(0));
        assert_eq!(lagrange_taps(&NODES, 9000.0, 1e-9), Taps::single(5));
    }

    #[test]
    fn a_node_stands_alone() {
        assert_eq!(lagrange_taps(&NODES, 1500.0, 1e-9), Taps::single(3));
        assert_eq!(lagrange_taps(&[2.0], 5.0, 1e-9), Taps::single(0));
    }

    #[test]
    fn two_nodes_interpolate_linearly() {
        let taps = lagrange_taps(&[1.0, 3.0], 1.5, 1e-9);
        assert_eq!(taps.indices(), [0, 1]);
        assert_eq!(taps.weights(), [0.75, 0.25]);
        assert_eq!(taps.bracket(), taps.weights());
    }

    #[test]
    fn neighbours_are_taken_on_both_sides_where_there_are_any() {
        assert_eq!(lagrange_taps(&NODES, 1000.0, 1e-9).indices(), [1, 2, 3, 4]);
        assert_eq!(lagrange_taps(&NODES, 100.0, 1e-9).indices(), [0, 1, 2, 3]);
        assert_eq!(lagrange_taps(&NODES, 5000.0, 1e-9).indices(), [2, 3, 4, 5]);
        assert_eq!(lagrange_taps(&NODES, 1100.0, 1e-9).bracket(), [0.0, 0.5, 0.5, 0.0]);
        assert_eq!(lagrange_taps(&NODES, 100.0, 1e-9).bracket(), [0.6, 0.4, 0.0, 0.0]);
        assert_eq!(lagrange_taps(&NODES, 4500.0, 1e-9).bracket(), [0.0, 0.0, 0.5, 0.5]);
    }
}
