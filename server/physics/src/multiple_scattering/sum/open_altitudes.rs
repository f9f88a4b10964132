//! Altitudes of open sources that a sum solves fields for.
//!
//! There is a kink where source and observer stand equally high: a higher source leaves the air below it unlit and has its
//! ground below it. So the altitudes below the observer and those above are interpolated apart, with a node at the
//! observer's own, and they crowd above it.

use crate::interpolation::{MAX_STENCIL, Stencil};

/// Distances of the lowest nodes above the observer, in steps; then even ones.
const CROWDED: [f64; 3] = [0.0, 1.0 / 6.0, 0.5];
/// A node that another follows this closely is replaced by it, in steps: neighbours so near would have weights of many
/// times 1 between farther ones. So no gap is wider than a step and this.
const MIN_GAP: f64 = 0.2;

/// Where sources span less than the steps that [`MAX_STENCIL`] nodes take, steps are halved, at most so many times. Seen from 302 m
/// at turbidity 6, lights evenly from 0 to 300 m are 2 to 18 % too dark in the lowest row if their logarithm is a line between
/// fields at both ends, and up to 0.7 % at the zenith; three nodes 150 m apart are within 0.2 % of five, 2 % within 1.5 km.
#[derive(Clone, Copy)]
struct Narrow {
    steps: f64,
    max_halvings: u32,
}

impl Narrow {
    /// The step of a side on which sources span some metres.
    fn step_m(self, span_m: f64, step_m: f64) -> f64 {
        let halved = |times: u32| step_m / f64::from(1u32 << times);
        let has_room = |step_m: &f64| span_m >= self.steps * step_m;
        (0..self.max_halvings).map(halved).find(has_room).unwrap_or(halved(self.max_halvings))
    }
}

/// Below the observer nodes are even.
const BELOW: Narrow = Narrow { steps: (MAX_STENCIL - 1) as f64, max_halvings: 3 };
/// Above, three lie within the first half of a step.
const ABOVE: Narrow = Narrow { steps: CROWDED[2] + MIN_GAP, max_halvings: 1 };

/// Altitudes of fields, and how sources lie between them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OpenAltitudes {
    /// Metres, ascending.
    pub(super) altitude_m: Vec<f64>,
    observer_altitude_m: f64,
    /// Nodes that are not above the observer.
    below: usize,
    /// First node of those above, the observer's own if it is one.
    first_above: usize,
}

impl OpenAltitudes {
    /// For sources at some altitudes, of which there is at least one; nodes are `step_m` apart, or up to a fifth more, and
    /// closer on a side that is narrow. Where the sources have no more altitudes on a side than it would have nodes, theirs
    /// are the nodes.
    pub(super) fn new(altitudes_m: impl Iterator<Item = f64>, observer_altitude_m: f64, step_m: f64) -> Self {
        let mut own: Vec<f64> = altitudes_m.collect();
        own.sort_by(f64::total_cmp);
        own.dedup();
        let (low, high) = own.split_at(own.partition_point(|&altitude_m| altitude_m <= observer_altitude_m));
        let fewer =
            |nodes: Vec<f64>, own: &[f64]| if own.len() <= nodes.len() { own.to_vec() } else { nodes };
        let span_m = low.last().zip(low.first()).map_or(0.0, |(highest, lowest)| highest - lowest);
        let step_below_m = BELOW.step_m(span_m, step_m);
        let below_nodes = match low {
            [lowest, .., highest] => fewer(nodes_below_m(*lowest, *highest, step_below_m), low),
            own => own.to_vec(),
        };
        let above_nodes = match high {
            [] => Vec::new(),
            [.., highest] => {
                let step_m = ABOVE.step_m(highest - observer_altitude_m, step_m);
                fewer(nodes_above_m(observer_altitude_m, *highest, step_m), high)
            }
        };
        let mut altitude_m = below_nodes;
        if above_nodes.first() == Some(&observer_altitude_m) {
            // That node is of both sides. Where every altitude below has its own, only an equal one gives way: all the lamps may
            // stand at the observer's feet.
            let too_close_m = if altitude_m == low { 0.0 } else { MIN_GAP * step_below_m };
            altitude_m.retain(|&node_m| node_m < observer_altitude_m - too_close_m);
        }
        altitude_m.extend(above_nodes);
        let below = altitude_m.partition_point(|&node_m| node_m <= observer_altitude_m);
        let is_shared = below > 0 && altitude_m[below - 1] == observer_altitude_m;
        let first_above = below - usize::from(is_shared);
        Self { altitude_m, observer_altitude_m, below, first_above }
    }

    /// Nodes around a source and their weights.
    pub(super) fn stencil(&self, altitude_m: f64) -> Stencil {
        if altitude_m <= self.observer_altitude_m {
            return Stencil::lagrange(&self.altitude_m[..self.below], altitude_m);
        }
        let above = Stencil::lagrange(&self.altitude_m[self.first_above..], altitude_m);
        above.shifted(self.first_above)
    }
}

/// Multiples of the step, so that observers share fields, and the highest source.
fn nodes_below_m(lowest_m: f64, highest_m: f64, step_m: f64) -> Vec<f64> {
    // None is below both the sea and the lowest source, and one that the last follows closely gives way to it.
    let first = (lowest_m / step_m).floor() as i64;
    let mut nodes = vec![(first as f64 * step_m).max(lowest_m.min(0.0))];
    let others = (first + 1..).map(|k| k as f64 * step_m);
    nodes.extend(others.take_while(|&node_m| node_m <= highest_m - MIN_GAP * step_m));
    nodes.push(highest_m);
    nodes
}

/// The observer's own altitude, nodes crowding above it, and the highest source.
fn nodes_above_m(observer_altitude_m: f64, highest_m: f64, step_m: f64) -> Vec<f64> {
    let even = (1..).map(|k| CROWDED[CROWDED.len() - 1] + f64::from(k));
    let offsets_m = CROWDED.into_iter().chain(even).map(|steps| steps * step_m);
    let span_m = highest_m - observer_altitude_m;
    let too_close_m = MIN_GAP * span_m.min(step_m);
    let mut nodes: Vec<f64> = offsets_m
        .take_while(|&offset_m| offset_m <= span_m - too_close_m)
        .map(|offset_m| observer_altitude_m + offset_m)
        .collect();
    nodes.push(highest_m);
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes(altitudes_m: &[f64], observer_m: f64) -> OpenAltitudes {
        OpenAltitudes::new(altitudes_m.iter().copied(), observer_m, 300.0)
    }

    /// Few altitudes are their own nodes, and many lie between nodes on their side of the observer.
    #[test]
    fn many_altitudes_lie_between_nodes() {
        assert_eq!(nodes(&[40.0, 40.0], 900.0).altitude_m, [40.0]);
        assert_eq!(nodes(&[100.0, 400.0], 200.0).altitude_m, [100.0, 400.0]);
        // Under a plain and a hill, and above an eye at the sea: a line between two nodes was 300 m long there.
        assert_eq!(nodes(&[0.0, 100.0, 300.0], 302.0).altitude_m, [0.0, 100.0, 300.0]);
        assert_eq!(nodes(&[100.0, 200.0, 300.0], 2.0).altitude_m, [100.0, 200.0, 300.0]);
        let many: Vec<f64> = (0..=100).map(|k| 13.0 * f64::from(k)).collect();
        assert_eq!(nodes(&many, 2_000.0).altitude_m, [0.0, 300.0, 600.0, 900.0, 1_200.0, 1_300.0]);
        let around = nodes(&many, 500.0);
        let expected = [0.0, 150.0, 300.0, 450.0, 500.0, 550.0, 650.0, 950.0, 1_300.0];
        assert_eq!(around.altitude_m, expected);
        for &altitude_m in &many {
            let stencil = around.stencil(altitude_m);
            let at = stencil.sum(|node| around.altitude_m[node]);
            assert!((at - altitude_m).abs() < 1e-9, "{altitude_m} {stencil:?}");
            // No source takes anything from the other side; the observer's own altitude is of both.
            let is_of_side = |node: usize| {
                let node_m = around.altitude_m[node];
                if altitude_m <= 500.0 { node_m <= 500.0 } else { node_m >= 500.0 }
            };
            assert!(stencil.iter().all(|(node, weight)| weight == 0.0 || is_of_side(node)), "{altitude_m}");
        }
    }

    /// No two nodes are so close that weights explode, and no gap is wider than stated.
    #[test]
    fn weights_and_gaps_are_bounded() {
        let mut most: f64 = 0.0;
        for (observer_m, highest_m) in [(300.0, 2_500.0), (200.0, 4_200.0), (700.0, 1_300.0), (650.0, 700.0)]
        {
            // Sources everywhere, one a centimetre under the observer.
            let mut altitudes_m: Vec<f64> = (0..=200).map(|k| highest_m * f64::from(k) / 200.0).collect();
            altitudes_m.push(observer_m - 0.01);
            let around = nodes(&altitudes_m, observer_m);
            for &altitude_m in &altitudes_m {
                most = most.max(around.stencil(altitude_m).weights().iter().map(|weight| weight.abs()).sum());
            }
            let gaps_m = around.altitude_m.windows(2).map(|pair| pair[1] - pair[0]);
            assert!(gaps_m.clone().all(|gap_m| gap_m <= 360.0 + 1e-9), "{:?}", around.altitude_m);
            assert!(gaps_m.clone().all(|gap_m| gap_m > 9.0), "{:?}", around.altitude_m);
        }
        assert!(most > 1.1 && most < 3.0, "{most}");
    }

    /// Lamps at the observer's feet have a field of their own.
    #[test]
    fn lamps_at_the_observers_feet_have_a_node() {
        let mut altitudes_m: Vec<f64> = (0..=100).map(|k| 13.0 * f64::from(k)).collect();
        for feet_m in [0.0, 1.5, 2.0] {
            altitudes_m[0] = feet_m;
            let around = nodes(&altitudes_m, 2.0);
            let stencil = around.stencil(feet_m);
            let at = stencil.sum(|node| around.altitude_m[node]);
            assert!((at - feet_m).abs() < 1e-12, "{feet_m}: {stencil:?}");
            assert!(around.altitude_m.contains(&feet_m));
            assert_eq!(around.altitude_m.iter().filter(|&&node_m| node_m == 2.0).count(), 1);
        }
    }

    /// Narrow sides have as many nodes as a stencil, unless those were a few metres apart.
    #[test]
    fn narrow_sides_have_full_stencils() {
        for span_m in [120.0, 200.0, 299.0, 300.0, 600.0, 899.0, 900.0] {
            let many: Vec<f64> = (0..=200).map(|k| span_m * f64::from(k) / 200.0).collect();
            for [low_m, eye_m] in [[0.0, 2_000.0], [40.0, 2_000.0], [100.0, 40.0], [100.0, 100.0]] {
                let altitudes_m: Vec<f64> = many.iter().map(|above_m| low_m + above_m).collect();
                let around = nodes(&altitudes_m, eye_m);
                let sides = [around.below, around.altitude_m.len() - around.first_above];
                assert!(sides.iter().all(|&side| side <= 1 || side >= MAX_STENCIL), "{span_m} {around:?}");
                // No more than twice as many as needed.
                assert!(sides.iter().all(|&side| side <= 2 * MAX_STENCIL + 1), "{span_m} {around:?}");
            }
        }
        assert_eq!(nodes(&[0.0, 1.0, 2.0, 2.5], 900.0).altitude_m, [0.0, 2.5]);
    }

    #[test]
    fn observers_share_nodes_below_them() {
        let many: Vec<f64> = (0..=100).map(|k| 13.0 * f64::from(k)).collect();
        let [low, high] = [700.0, 1_000.0].map(|observer_m| nodes(&many, observer_m).altitude_m);
        assert!([0.0, 300.0].iter().all(|node_m| low.contains(node_m) && high.contains(node_m)));
        let below = nodes(&[-20.0, -10.0, -15.0, -5.0, 3.0], 700.0);
        assert_eq!(below.altitude_m, [-20.0, 3.0]);
    }
}
