//! The offset axes of a table in f32, ring by ring: asinh spacing on both sides of a kink.

use crate::twin::natural_log;
use skyglow_physics::simd_dispatch;
use skyglow_tables::OffsetAxis;

/// The offset axis of a ring as f32 needs it: position = kink node + asinh((Δ − Δ₀)/L)/step, L and step of the
/// side of the kink.
#[derive(Clone, Copy, Debug)]
pub struct RingAxis {
    kink_m: f32,
    kink_node: f32,
    last_node: f32,
    per_scale_below_m: f32,
    per_scale_above_m: f32,
    per_step_below: f32,
    per_step_above: f32,
}

impl RingAxis {
    /// An axis of a pack.
    pub(crate) fn of(axis: &OffsetAxis) -> Self {
        Self {
            kink_m: axis.kink_m as f32,
            kink_node: axis.kink_node as f32,
            last_node: (axis.count - 1) as f32,
            per_scale_below_m: (1.0 / axis.scale_below_m) as f32,
            per_scale_above_m: (1.0 / axis.scale_above_m) as f32,
            per_step_below: (1.0 / axis.step_below) as f32,
            per_step_above: (1.0 / axis.step_above) as f32,
        }
    }

    /// [`OffsetAxis::position`] in f32: fast, and right to about 2e-6 nodes.
    pub(crate) fn position(&self, offset_m: f32) -> f32 {
        let (size, per_step) = self.seen_from_kink(offset_m);
        position(size, per_step, self.kink_node, self.last_node)
    }

    /// d(position)/dΔ, m⁻¹; 0 where the axis holds the position at one of its ends.
    pub fn position_per_m(&self, offset_m: f32) -> f32 {
        let position = self.position(offset_m);
        if position <= 0.0 || position >= self.last_node {
            return 0.0;
        }
        let (size, per_step) = self.seen_from_kink(offset_m);
        let per_scale_m = if per_step < 0.0 { -self.per_scale_below_m } else { self.per_scale_above_m };
        per_step * per_scale_m / (size * size + 1.0).sqrt()
    }

    /// |Δ − Δ₀|/L and ±1/step, negative below the kink.
    #[inline(always)]
    fn seen_from_kink(&self, offset_m: f32) -> (f32, f32) {
        let above_m = offset_m - self.kink_m;
        let (per_scale_m, per_step) = if above_m < 0.0 {
            (self.per_scale_below_m, -self.per_step_below)
        } else {
            (self.per_scale_above_m, self.per_step_above)
        };
        (above_m.abs() * per_scale_m, per_step)
    }
}

/// kink node + asinh(size)/step, held on the axis.
#[inline(always)]
fn position(size: f32, per_step: f32, kink_node: f32, last_node: f32) -> f32 {
    let from_kink = per_step * natural_log(size + (size * size + 1.0).sqrt());
    // No `clamp`: its check of the ends would keep loops from vectors.
    (kink_node + from_kink).max(0.0).min(last_node)
}

/// Offsets that are placed on their axes together: enough that the compiler makes a loop of vectors of the arithmetic.
pub(crate) const OFFSETS_AT_ONCE: usize = 64;

/// Offsets gathered with what their axes say of them.
pub(crate) struct Offsets {
    size: [f32; OFFSETS_AT_ONCE],
    per_step: [f32; OFFSETS_AT_ONCE],
    kink_node: [f32; OFFSETS_AT_ONCE],
    last_node: [f32; OFFSETS_AT_ONCE],
}

impl Default for Offsets {
    fn default() -> Self {
        let none = [0.0; OFFSETS_AT_ONCE];
        Self { size: none, per_step: none, kink_node: none, last_node: none }
    }
}

impl Offsets {
    /// Puts an offset, metres, in a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, axis: &RingAxis, offset_m: f32) {
        (self.size[lane], self.per_step[lane]) = axis.seen_from_kink(offset_m);
        self.kink_node[lane] = axis.kink_node;
        self.last_node[lane] = axis.last_node;
    }
}

simd_dispatch! {
    /// [`RingAxis::position`] in every lane, bit for bit.
    pub(crate) fn positions(offsets: &Offsets, positions: &mut [f32; OFFSETS_AT_ONCE]) = positions_body;
}

#[inline(always)]
fn positions_body(offsets: &Offsets, positions: &mut [f32; OFFSETS_AT_ONCE]) {
    for (lane, target) in positions.iter_mut().enumerate() {
        *target = position(
            offsets.size[lane],
            offsets.per_step[lane],
            offsets.kink_node[lane],
            offsets.last_node[lane],
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions of many offsets are those of each bit for bit.
    #[test]
    fn positions_side_by_side_are_the_same_bits() {
        let axes = [300.0, 9_000.0, 250_000.0].map(|m| RingAxis::of(&OffsetAxis::at_distance(m, 23)));
        let (mut offsets, mut together) = (Offsets::default(), [0.0; OFFSETS_AT_ONCE]);
        let offset_m = |lane: usize| -7_000.0 + 211.7 * lane as f32;
        for lane in 0..OFFSETS_AT_ONCE {
            offsets.set(lane, &axes[lane % 3], offset_m(lane));
        }
        positions(&offsets, &mut together);
        let alone = |turned: usize| {
            (0..OFFSETS_AT_ONCE).map(move |lane| axes[(lane + turned) % 3].position(offset_m(lane)).to_bits())
        };
        let differing =
            |turned| together.iter().zip(alone(turned)).filter(|(a, b)| a.to_bits() != *b).count();
        assert_eq!(differing(0), 0);
        assert!(differing(1) > OFFSETS_AT_ONCE / 2);
    }

    /// The slope of an axis is what its positions differ by.
    #[test]
    fn slopes_are_differences_of_positions() {
        for distance_m in [300.0, 9_000.0, 250_000.0] {
            let axis = RingAxis::of(&OffsetAxis::at_distance(distance_m, 23));
            let mut compared = 0;
            for offset_m in (-6_000..6_000).step_by(97).map(|offset_m| offset_m as f32) {
                let ends = [offset_m - 5.0, offset_m + 5.0].map(|offset_m| axis.position(offset_m));
                // Where the axis ends or has its kink in between, the difference says less.
                let is_edge = (offset_m - axis.kink_m).abs() < 5.0
                    || ends.iter().any(|position| *position <= 0.0 || *position >= axis.last_node);
                let (apart, slope) = (ends[1] - ends[0], axis.position_per_m(offset_m));
                compared += usize::from(!is_edge);
                assert!(
                    is_edge || (10.0 * slope - apart).abs() < 0.02 * apart.abs() + 2e-5,
                    "{slope} {apart}"
                );
            }
            assert!(compared > 60, "{compared}");
            assert_eq!(axis.position_per_m(1e6), 0.0);
        }
    }
}
