//! The sample points of a pack: distances, observer altitudes, and how far the source lies above the observer.
//!
//! The third axis is not the source's altitude h_c but its offset Δ = h_c − h_o. Shifting observer and source
//! up together changes only densities, which the logarithm of the scale follows well, while Δ against distance
//! decides the shape: a source 100 m up and 300 m away is another sky than one 100 m up and 30 km away. The
//! nodes are even in asinh(Δ/L) with L = 1/(4/r + 1/1500 m): proportional to r near the observer, some hundred
//! metres apart far away. One node is Δ = 0, where the sky bends: low rays towards a source above the observer
//! start in the Earth's shadow, those towards one below start in its light.

use serde::{Deserialize, Serialize};
use skyglow_physics::source_pixel::{FARTHEST_SOURCE_M, NEAREST_SOURCE_M};

/// Highest observer and source altitude of a pack, metres.
pub const HIGHEST_ALTITUDE_M: f64 = 6_000.0;
/// Lowest source of a node, metres: the model has none below 0, but interpolation at a low observer reaches for
/// the next node down.
const LOWEST_SOURCE_M: f64 = -1_500.0;

/// The sample points of a pack.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TableAxes {
    /// Distances, metres, ascending, even in the logarithm.
    pub distance_m: Vec<f64>,
    /// Observer altitudes, metres, ascending from 0.
    pub observer_altitude_m: Vec<f64>,
    /// Number of nodes of the offset axis at every distance.
    pub offset_count: usize,
}

/// The offset axis at one distance, from −6 000 m through 0 to about min(1.5 r, 6 000 m): nodes even in
/// asinh(Δ/L) below zero and, with another step, above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetAxis {
    /// L, metres.
    pub scale_m: f64,
    /// Step in asinh(Δ/L) below zero.
    pub step_below: f64,
    /// Step in asinh(Δ/L) above zero.
    pub step_above: f64,
    /// The node of Δ = 0.
    pub zero_node: usize,
    /// Number of nodes.
    pub count: usize,
}

impl OffsetAxis {
    /// The axis at a distance with `count` ≥ 3 nodes, three fifths of them below zero.
    pub fn at_distance(distance_m: f64, count: usize) -> Self {
        let scale_m = 1.0 / (4.0 / distance_m + 1.0 / 1_500.0);
        let highest_m = 1.0 / (1.0 / (1.5 * distance_m) + 1.0 / HIGHEST_ALTITUDE_M);
        let zero_node = ((count - 1) * 3 / 5).max(1);
        Self {
            scale_m,
            step_below: (HIGHEST_ALTITUDE_M / scale_m).asinh() / zero_node as f64,
            step_above: (highest_m / scale_m).asinh() / (count - 1 - zero_node) as f64,
            zero_node,
            count,
        }
    }

    /// Δ at a fractional node, metres.
    pub fn offset_m(&self, position: f64) -> f64 {
        let from_zero = position - self.zero_node as f64;
        let step = if from_zero < 0.0 { self.step_below } else { self.step_above };
        self.scale_m * (from_zero * step).sinh()
    }

    /// Fractional node of an offset, clamped to 0..=count − 1.
    pub fn position(&self, offset_m: f64) -> f64 {
        let step = if offset_m < 0.0 { self.step_below } else { self.step_above };
        (self.zero_node as f64 + (offset_m / self.scale_m).asinh() / step).clamp(0.0, (self.count - 1) as f64)
    }
}

fn logarithmic(count: usize) -> Vec<f64> {
    let ratio = FARTHEST_SOURCE_M / NEAREST_SOURCE_M;
    (0..count).map(|i| NEAREST_SOURCE_M * ratio.powf(i as f64 / (count - 1) as f64)).collect()
}

impl TableAxes {
    /// The axes of the packs that come with the program.
    pub fn full() -> Self {
        Self {
            distance_m: logarithmic(56),
            observer_altitude_m: vec![0.0, 300.0, 700.0, 1_200.0, 1_900.0, 2_900.0, 4_200.0, 6_000.0],
            offset_count: 17,
        }
    }

    /// Few points, made in seconds: for tests of everything but accuracy.
    pub fn coarse() -> Self {
        Self { distance_m: logarithmic(10), observer_altitude_m: vec![0.0, 6_000.0], offset_count: 4 }
    }

    /// Source altitude of a node, metres; clamped to −1 500 … 7 500 m (nodes outside repeat the last one
    /// inside; no source of the model lies there, but interpolation reaches a little beyond 0 and 6 000 m).
    pub fn source_altitude_m(&self, observer_altitude: usize, distance: usize, offset: usize) -> f64 {
        let axis = OffsetAxis::at_distance(self.distance_m[distance], self.offset_count);
        (self.observer_altitude_m[observer_altitude] + axis.offset_m(offset as f64))
            .clamp(LOWEST_SOURCE_M, HIGHEST_ALTITUDE_M + 1_500.0)
    }

    /// Number of (distance, offset) nodes: images of one observer altitude, each of all bands and lobes.
    pub fn geometries_per_observer(&self) -> usize {
        self.distance_m.len() * self.offset_count
    }
}

/// Lagrange interpolation at `x` over the `taps` nodes nearest to it (fewer where there are fewer): pairs
/// (node, weight), weights summing to 1. `x` is clamped to the range of the nodes, which must ascend.
pub fn lagrange_taps(nodes: &[f64], x: f64, taps: usize) -> Vec<(usize, f64)> {
    let taps = taps.min(nodes.len());
    let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
    let x = x.clamp(first, last);
    let upper = nodes.partition_point(|&node| node <= x).clamp(1, nodes.len().max(2) - 1);
    let start = upper.saturating_sub(taps.div_ceil(2)).min(nodes.len() - taps);
    (start..start + taps)
        .map(|j| {
            let weight = (start..start + taps)
                .filter(|&k| k != j)
                .map(|k| (x - nodes[k]) / (nodes[j] - nodes[k]))
                .product();
            (j, weight)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_offset_axis_spans_its_range_and_has_a_node_at_zero_at_every_distance() {
        for distance_m in [250.0, 3_000.0, 300_000.0] {
            let axis = OffsetAxis::at_distance(distance_m, 17);
            assert!((axis.offset_m(0.0) + 6_000.0).abs() < 1e-6);
            assert!(axis.offset_m(16.0) > 0.5 * (1.5 * distance_m).min(6_000.0));
            assert_eq!(axis.position(0.0), axis.zero_node as f64);
            for position in [0.3, 7.0, 8.9, 9.1, 15.99] {
                assert!((axis.position(axis.offset_m(position)) - position).abs() < 1e-9);
            }
        }
    }

    proptest! {
        #[test]
        fn lagrange_taps_reproduce_cubics_and_sum_to_one(x in 0.0f64..6_000.0, c in -2.0f64..2.0) {
            let nodes = TableAxes::full().observer_altitude_m;
            let cubic = |x: f64| { let t = x / 3_000.0; 1.0 + c * t - t * t + 0.3 * c * t * t * t };
            let taps = lagrange_taps(&nodes, x, 4);
            prop_assert_eq!(taps.len(), 4);
            prop_assert!((taps.iter().map(|t| t.1).sum::<f64>() - 1.0).abs() < 1e-12);
            let value: f64 = taps.iter().map(|&(j, w)| w * cubic(nodes[j])).sum();
            prop_assert!((value - cubic(x)).abs() < 1e-9);
        }
    }

    #[test]
    fn taps_clamp_at_the_ends_and_use_what_nodes_there_are() {
        assert_eq!(lagrange_taps(&[1.0, 2.0], 5.0, 4), vec![(0, 0.0), (1, 1.0)]);
        assert_eq!(lagrange_taps(&[3.0], 5.0, 4), vec![(0, 1.0)]);
    }
}
