//! The sample points of a pack: distances, observer altitudes, and how far the source lies above the observer.
//!
//! The third axis is not the source's altitude h_c but its offset Δ = h_c − h_o. Shifting observer and source
//! up together changes only densities, which the logarithm of the scale follows well, while Δ against distance
//! decides the shape: a source 100 m up and 300 m away is another sky than one 100 m up and 30 km away. The
//! nodes are even in asinh(Δ/L) with L = 1/(2/r + 1/2000 m): proportional to r near the observer, about 500 m
//! apart far away. Measured on single sources (turbidity 1.5 and 6), interpolating h_c at fixed nodes left
//! errors of 14 % (90th percentile, 25 nodes), this axis 1–3 % with 25 and 2–8 % with 17 nodes over the whole
//! range −6 000 m … +1.5 r.

use serde::{Deserialize, Serialize};
use skyglow_physics::source_pixel::{FARTHEST_SOURCE_M, NEAREST_SOURCE_M};

/// Highest observer and source altitude of a pack, metres.
pub const HIGHEST_ALTITUDE_M: f64 = 6_000.0;
/// Sources lower than this below sea level are not computed: the model has none below 0.
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

/// The offset axis at one distance: node j lies at Δ = L·sinh(κ₀ + j·δκ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetAxis {
    /// L, metres.
    pub scale_m: f64,
    /// κ₀ = asinh(Δ_min/L).
    pub asinh_first: f64,
    /// δκ.
    pub asinh_step: f64,
    /// Number of nodes.
    pub count: usize,
}

impl OffsetAxis {
    /// The axis at a distance, from −6 000 m to about min(1.5 r, 6 000 m).
    pub fn at_distance(distance_m: f64, count: usize) -> Self {
        let scale_m = 1.0 / (2.0 / distance_m + 1.0 / 2_000.0);
        let highest_m = 1.0 / (1.0 / (1.5 * distance_m) + 1.0 / HIGHEST_ALTITUDE_M);
        let asinh_first = (-HIGHEST_ALTITUDE_M / scale_m).asinh();
        let asinh_last = (highest_m / scale_m).asinh();
        Self { scale_m, asinh_first, asinh_step: (asinh_last - asinh_first) / (count - 1) as f64, count }
    }

    /// Δ of a node, metres.
    pub fn offset_m(&self, node: usize) -> f64 {
        self.scale_m * (self.asinh_first + node as f64 * self.asinh_step).sinh()
    }

    /// Fractional node of an offset, clamped to 0..=count − 1.
    pub fn position(&self, offset_m: f64) -> f64 {
        (((offset_m / self.scale_m).asinh() - self.asinh_first) / self.asinh_step)
            .clamp(0.0, (self.count - 1) as f64)
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
            offset_count: 15,
        }
    }

    /// Few points, made in seconds: for tests of everything but accuracy.
    pub fn coarse() -> Self {
        Self {
            distance_m: logarithmic(10),
            observer_altitude_m: vec![0.0, 6_000.0],
            offset_count: 4,
        }
    }

    /// Source altitude of a node, metres; clamped to −1 500 … 6 000 m (nodes outside repeat the last one
    /// inside, no source of the model lies there).
    pub fn source_altitude_m(&self, observer_altitude: usize, distance: usize, offset: usize) -> f64 {
        let axis = OffsetAxis::at_distance(self.distance_m[distance], self.offset_count);
        (self.observer_altitude_m[observer_altitude] + axis.offset_m(offset))
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
    fn the_offset_axis_spans_its_range_at_every_distance() {
        for distance_m in [250.0, 3_000.0, 300_000.0] {
            let axis = OffsetAxis::at_distance(distance_m, 15);
            assert!((axis.offset_m(0) + 6_000.0).abs() < 1e-6);
            assert!(axis.offset_m(14) > 0.5 * (1.5 * distance_m).min(6_000.0));
            assert!((axis.position(axis.offset_m(7)) - 7.0).abs() < 1e-9);
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
