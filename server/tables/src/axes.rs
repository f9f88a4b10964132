//! The sample points of a pack: distances, observer altitudes, and how far the source lies above the observer
//! (`docs/model.md#axes`).
//!
//! The third axis is not the source's altitude h_c but its offset Δ = h_c − h_o. Shifting observer and source
//! up together changes only densities, which the logarithm of the scale follows well, while Δ against distance
//! decides the shape: a source 100 m up and 300 m away is another sky than one 100 m up and 30 km away. The
//! nodes are even in asinh((Δ − Δ₀)/L), about proportional to r near the observer, some hundred metres apart
//! far away. One node is Δ₀, where the sky has its kink, and nodes are closest there.
//!
//! The first order has its kink at −r²/2R: a source higher than that has the observer, and the lowest part of every ray, below its
//! horizontal plane, in the Earth's shadow. The later orders have it at 0, for the ground that sends light back is that of the
//! lower of source and observer. Under the open sky Δ₀ is the first up to some 80 km, where both are some hundred metres apart
//! at most, and the second from 100 km on, where the lowest row is so far above the ground that the shadow's edge is no kink. Behind a skyline it is where the skyline's cone meets the observer.

use crate::clouds::{Clouds, MAX_DISTANCES, clamped_geometry, observers_below};
use serde::{Deserialize, Serialize};
use skyglow_physics::{
    CloudBase,
    geometry::EARTH_RADIUS_M,
    single_source::SourceGeometry,
    source_pixel::{MAX_SOURCE_DISTANCE_M, MIN_SOURCE_DISTANCE_M},
};

/// Highest observer and source altitude of a pack, metres.
pub const MAX_ALTITUDE_M: f64 = 6_000.0;
/// Lowest source of a node, metres: the model has none below 0, but a cubic over offsets reaches two nodes further down.
const MIN_SOURCE_M: f64 = -2_000.0;

/// The edge of the Earth's shadow is followed down to about this offset, metres; hardly any source is below.
const MIN_EDGE_M: f64 = -3_000.0;
/// The same behind a skyline: a source that far below the observer whose light still passes beneath is rare.
const MIN_CUT_EDGE_M: f64 = -1_500.0;
/// At this distance the kink of an open axis lies halfway between the edge of the shadow and level with the observer, metres; the exponent
/// is the steepness of the transition. At 70 km the lowest rows of the first order still need the edge.
const LEVEL_FROM_M: f64 = 90_000.0;
const LEVEL_EXPONENT: i32 = 12;
/// Part of an open axis's steps that lie below the kink. A ray 0.7° up passes a source below the observer at |Δ| + 0.012 r,
/// and its light there is proportional to the inverse: with nodes some 0.02 r apart at the kink, linear interpolation is
/// 1 % off in the lowest row; far below, where steps must be short against the haze's 1 200 m, as many are needed.
const OPEN: NodeDensity = NodeDensity { share_below: 0.58, distance_per_scale: 20.0 };
/// The same behind a skyline, which hides the light close to the ground.
const CUT: NodeDensity = NodeDensity { share_below: 0.4, distance_per_scale: 4.0 };
/// Largest L below the kink, metres.
const MAX_SCALE_BELOW_M: f64 = 1_500.0;

/// How close the nodes of an offset axis lie below its kink.
#[derive(Clone, Copy)]
struct NodeDensity {
    /// Part of the axis's steps that lie below the kink.
    share_below: f64,
    /// r/L below the kink, near the observer.
    distance_per_scale: f64,
}

/// The offset of the edge of the shadow behind a skyline of `blocking_deg`, metres: −(r²/2R + r tan e), clamped above `lowest_m`.
fn shadow_edge_m(distance_m: f64, blocking_deg: f64, lowest_m: f64) -> f64 {
    let drop_m =
        distance_m * distance_m / (2.0 * EARTH_RADIUS_M) + distance_m * blocking_deg.to_radians().tan();
    // The fourth-power means keep the axis smooth along the distance, which is interpolated at constant node.
    -(drop_m.powi(-4) + lowest_m.powi(-4)).powf(-0.25)
}

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

/// The offset axis at one distance, from −6 000 m through the kink Δ₀ to about min(1.5 r, 6 000 m): nodes even in
/// asinh((Δ − Δ₀)/L), with another L and another step on each side of the kink.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetAxis {
    /// Δ₀, metres: from the edge of the shadow nearby to 0 far away; behind a skyline Δ_e, clamped above −1 500 m.
    pub kink_m: f64,
    /// L below the kink, metres.
    pub scale_below_m: f64,
    /// L above the kink, metres.
    pub scale_above_m: f64,
    /// Step in asinh((Δ − Δ₀)/L) below the kink.
    pub step_below: f64,
    /// Step in asinh((Δ − Δ₀)/L) above the kink.
    pub step_above: f64,
    /// The node of Δ₀.
    pub kink_node: usize,
    /// Number of nodes.
    pub count: usize,
}

impl OffsetAxis {
    /// The axis of sources under the open sky at a distance, with `count` ≥ 3 nodes, more of them below the kink than above.
    pub fn at_distance(distance_m: f64, count: usize) -> Self {
        let edge_m = shadow_edge_m(distance_m, 0.0, MIN_EDGE_M);
        let kink_m = edge_m / (1.0 + (distance_m / LEVEL_FROM_M).powi(LEVEL_EXPONENT));
        Self::about(kink_m, edge_m, distance_m, OPEN, count)
    }

    /// The same about the edge of the Earth's shadow, −r²/2R, clamped above −3 000 m, where the first order has its kink: training
    /// geometries are spread on it, which serves the functions best (`docs/notebook/2026-11-27.md`).
    pub(crate) fn about_shadow_edge(distance_m: f64, count: usize) -> Self {
        let edge_m = shadow_edge_m(distance_m, 0.0, MIN_EDGE_M);
        Self::about(edge_m, edge_m, distance_m, OPEN, count)
    }

    /// The axis of a source behind a skyline of `blocking_deg` > 0: the kink lies where the cone of that elevation
    /// meets the observer, Δ_e = −(r²/2R + r tan e).
    pub fn behind_skyline(distance_m: f64, blocking_deg: f64, count: usize) -> Self {
        let edge_m = shadow_edge_m(distance_m, blocking_deg, MIN_CUT_EDGE_M);
        Self::about(edge_m, edge_m, distance_m, CUT, count)
    }

    fn about(kink_m: f64, edge_m: f64, distance_m: f64, density: NodeDensity, count: usize) -> Self {
        let scale_below_m = 1.0 / (density.distance_per_scale / distance_m + 1.0 / MAX_SCALE_BELOW_M);
        let scale_above_m = (1.0 - edge_m / 500.0) / (16.0 / distance_m + 4.0 / MAX_SCALE_BELOW_M);
        let highest_m = 1.0 / (1.0 / (1.5 * distance_m) + 1.0 / MAX_ALTITUDE_M);
        let kink_node = (((count - 1) as f64 * density.share_below).round() as usize).max(1);
        Self {
            kink_m,
            scale_below_m,
            scale_above_m,
            step_below: ((MAX_ALTITUDE_M + kink_m) / scale_below_m).asinh() / kink_node as f64,
            step_above: ((highest_m - kink_m) / scale_above_m).asinh() / (count - 1 - kink_node) as f64,
            kink_node,
            count,
        }
    }

    /// Δ at a fractional node, metres.
    pub fn offset_m(&self, position: f64) -> f64 {
        let from_kink = position - self.kink_node as f64;
        let (scale_m, step) = if from_kink < 0.0 {
            (self.scale_below_m, self.step_below)
        } else {
            (self.scale_above_m, self.step_above)
        };
        self.kink_m + scale_m * (from_kink * step).sinh()
    }

    /// Fractional node of an offset, clamped to 0..=count − 1.
    pub fn position(&self, offset_m: f64) -> f64 {
        let above_m = offset_m - self.kink_m;
        let (scale_m, step) = if above_m < 0.0 {
            (self.scale_below_m, self.step_below)
        } else {
            (self.scale_above_m, self.step_above)
        };
        (self.kink_node as f64 + (above_m / scale_m).asinh() / step).clamp(0.0, (self.count - 1) as f64)
    }
}

/// A source seen from an altitude, as nodes have it: clamped between −2 000 and 7 500 m (nodes outside repeat the last one inside;
/// no source of the model lies there, but interpolation reaches a little beyond 0 and 6 000 m).
pub(crate) fn clamped_node(distance_m: f64, observer_altitude_m: f64, offset_m: f64) -> SourceGeometry {
    let source_altitude_m = (observer_altitude_m + offset_m).clamp(MIN_SOURCE_M, MAX_ALTITUDE_M + 1_500.0);
    SourceGeometry { distance_m, source_altitude_m, observer_altitude_m }
}

/// Distances from 250 m to 300 km, even in the logarithm.
pub(crate) fn logarithmic(count: usize) -> Vec<f64> {
    let ratio = MAX_SOURCE_DISTANCE_M / MIN_SOURCE_DISTANCE_M;
    (0..count).map(|i| MIN_SOURCE_DISTANCE_M * ratio.powf(i as f64 / (count - 1) as f64)).collect()
}

impl TableAxes {
    /// The axes of the packs that come with the program.
    pub fn full() -> Self {
        Self {
            distance_m: logarithmic(48),
            observer_altitude_m: vec![
                0.0, 300.0, 700.0, 1_200.0, 1_800.0, 2_600.0, 3_600.0, 4_700.0, 6_000.0,
            ],
            // Times the rings at most 8 192, the tallest texture of the smallest devices.
            offset_count: 32,
        }
    }

    /// The same below a layer of cloud, with fewer points.
    pub fn below(self, clouds: Clouds) -> Self {
        Self {
            distance_m: logarithmic(self.distance_m.len().min(MAX_DISTANCES)),
            observer_altitude_m: observers_below(&self.observer_altitude_m, clouds),
            ..self
        }
    }

    /// Few points, made in seconds: for tests of everything but accuracy.
    pub fn coarse() -> Self {
        Self { distance_m: logarithmic(10), observer_altitude_m: vec![0.0, 6_000.0], offset_count: 4 }
    }

    /// The geometry of a node, below a layer of cloud if there is one.
    pub fn geometry(
        &self,
        observer_altitude: usize,
        distance: usize,
        offset: usize,
        cloud: Option<CloudBase>,
    ) -> SourceGeometry {
        let distance_m = self.distance_m[distance];
        let offset_m = OffsetAxis::at_distance(distance_m, self.offset_count).offset_m(offset as f64);
        clamped_geometry(
            clamped_node(distance_m, self.observer_altitude_m[observer_altitude], offset_m),
            cloud,
        )
    }

    /// Number of (distance, offset) nodes: images of one observer altitude, each of all bands and lobes.
    pub fn geometries_per_observer(&self) -> usize {
        self.distance_m.len() * self.offset_count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: usize = 32;

    /// The offset axis spans its range and has a node at the kink at every distance.
    #[test]
    fn the_offset_axis_has_a_node_at_the_kink() {
        for distance_m in [250.0, 3_000.0, 50_000.0, 300_000.0] {
            let axis = OffsetAxis::at_distance(distance_m, COUNT);
            assert!((axis.offset_m(0.0) + 6_000.0).abs() < 1e-6);
            assert!(axis.offset_m((COUNT - 1) as f64) > 0.5 * (1.5 * distance_m).min(6_000.0));
            assert_eq!(axis.position(axis.kink_m), axis.kink_node as f64);
            for position in [0.3, 7.0, 17.9, 18.1, 30.99] {
                assert!((axis.position(axis.offset_m(position)) - position).abs() < 1e-9);
            }
        }
    }

    /// The kink goes from the edge of the Earth's shadow to level with the observer.
    #[test]
    fn the_kink_rises_from_shadow_edge_to_level() {
        // At 50 km the plane through the source falls 196 m below the sphere's tangent.
        assert!((OffsetAxis::at_distance(50_000.0, COUNT).kink_m + 196.2).abs() < 0.5);
        assert!((OffsetAxis::about_shadow_edge(50_000.0, COUNT).kink_m + 196.2).abs() < 0.1);
        let between = [60e3, 70e3, 80e3, 90e3].map(|m| OffsetAxis::at_distance(m, COUNT).kink_m);
        assert!(between.iter().all(|&kink_m| kink_m < -250.0), "{between:?}");
        for distance_m in [150e3, 200e3, 300e3] {
            assert!(OffsetAxis::at_distance(distance_m, COUNT).kink_m > -5.0);
            let edge_m = OffsetAxis::about_shadow_edge(distance_m, COUNT).kink_m;
            assert!((MIN_EDGE_M..-1_500.0).contains(&edge_m), "{edge_m}");
        }
    }

    /// Behind a skyline the kink lies where the cone meets the observer.
    #[test]
    fn the_kink_behind_a_skyline_is_its_cone() {
        // 10 km · tan 4° and 7.8 m of curvature.
        let axis = OffsetAxis::behind_skyline(10_000.0, 4.0, 9);
        assert!((axis.kink_m + 707.1).abs() < 10.0, "{}", axis.kink_m);
        for distance_m in [250.0, 3_000.0, 300_000.0] {
            for blocking_deg in [0.5, 8.0, 32.0] {
                let axis = OffsetAxis::behind_skyline(distance_m, blocking_deg, 9);
                assert!(axis.kink_m >= MIN_CUT_EDGE_M && axis.kink_m < -distance_m * 1e-4);
                let nodes: Vec<f64> = (0..9).map(|node| axis.offset_m(f64::from(node))).collect();
                assert!(nodes.windows(2).all(|pair| pair[1] > pair[0]));
                assert!((nodes[0] + 6_000.0).abs() < 1e-6);
            }
        }
    }
}
