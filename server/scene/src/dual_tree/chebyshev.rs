//! Lagrange interpolation at four Chebyshev nodes along an axis, as in the black-box fast multipole method (Fong & Darve 2009).

/// Nodes along an axis.
pub(super) const NODE_COUNT: usize = 4;

/// Chebyshev's nodes of −1..=1, cos((2k + 1)π/8), ascending.
pub(super) const NODES: [f64; NODE_COUNT] =
    [-0.923_879_532_511_286_7, -0.382_683_432_365_089_8, 0.382_683_432_365_089_8, 0.923_879_532_511_286_7];

/// Weights of the nodes at a place −1..=1 (Lagrange): cubics come out as they are.
pub(super) fn weights(place: f64) -> [f32; NODE_COUNT] {
    std::array::from_fn(|i| {
        let others = (0..NODE_COUNT).filter(|&j| j != i);
        others.map(|j| (place - NODES[j]) / (NODES[i] - NODES[j])).product::<f64>() as f32
    })
}

/// A interval of lattice points along an axis, first to last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub(super) first: u32,
    pub(super) last: u32,
}

impl Interval {
    fn middle(self) -> f64 {
        0.5 * (f64::from(self.first) + f64::from(self.last))
    }

    fn half(self) -> f64 {
        0.5 * (f64::from(self.last) - f64::from(self.first))
    }

    /// Number of points.
    pub(super) fn len(self) -> u32 {
        self.last - self.first + 1
    }

    /// The nodes in the lattice's own numbers.
    pub(super) fn nodes(self) -> [f64; NODE_COUNT] {
        NODES.map(|node| self.middle() + node * self.half())
    }

    /// Weights of the nodes at a place of the lattice.
    pub(super) fn weights_at(self, place: f64) -> [f32; NODE_COUNT] {
        if self.half() == 0.0 {
            return weights(0.0);
        }
        weights((place - self.middle()) / self.half())
    }

    /// Both halves, or itself where it is one point.
    pub(super) fn halves(self) -> impl Iterator<Item = Self> {
        let middle = self.first + (self.last - self.first) / 2;
        let upper = (self.last > middle).then_some(Self { first: middle + 1, last: self.last });
        std::iter::once(Self { first: self.first, last: middle }).chain(upper)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_are_carried_over_and_quartics_are_not() {
        let interval = Interval { first: 8, last: 23 };
        let miss = |power: i32| {
            let f = |x: f64| (0.1 * x - 1.0).powi(power);
            let nodes = interval.nodes().map(f);
            (8..=23)
                .map(|at| {
                    let weights = interval.weights_at(f64::from(at));
                    let sum: f64 = weights.iter().zip(nodes).map(|(w, v)| f64::from(*w) * v).sum();
                    (sum - f(f64::from(at))).abs()
                })
                .fold(0.0, f64::max)
        };
        assert!(miss(3) < 1e-6 && miss(4) > 1e-2, "{} {}", miss(3), miss(4));
    }

    #[test]
    fn halves_hold_every_point_once() {
        for (first, last) in [(0, 0), (3, 4), (0, 8), (5, 131)] {
            let halves: Vec<Interval> = Interval { first, last }.halves().collect();
            assert_eq!(halves.iter().map(|half| half.len()).sum::<u32>(), last - first + 1);
            assert_eq!((halves[0].first, halves[halves.len() - 1].last), (first, last));
        }
        let point = Interval { first: 7, last: 7 };
        assert_eq!(point.weights_at(7.0).iter().sum::<f32>(), 1.0);
    }
}
