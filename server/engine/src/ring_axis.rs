//! The offset axes of a table in f32, ring by ring.

use crate::twin::natural_log;
use skyglow_tables::OffsetAxis;

/// The offset axis of a ring as f32 needs it: position = bend node + asinh((Δ − Δ₀)/L)/step, L and step of the
/// side of the bend.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RingAxis {
    bend_m: f32,
    bend_node: f32,
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
            bend_m: axis.bend_m as f32,
            bend_node: axis.bend_node as f32,
            last_node: (axis.count - 1) as f32,
            per_scale_below_m: (1.0 / axis.scale_below_m) as f32,
            per_scale_above_m: (1.0 / axis.scale_above_m) as f32,
            per_step_below: (1.0 / axis.step_below) as f32,
            per_step_above: (1.0 / axis.step_above) as f32,
        }
    }

    /// [`OffsetAxis::position`] in f32: fast, and right to about 2e-6 nodes.
    pub(crate) fn position(&self, offset_m: f32) -> f32 {
        let above_m = offset_m - self.bend_m;
        let (per_scale_m, per_step) = if above_m < 0.0 {
            (self.per_scale_below_m, -self.per_step_below)
        } else {
            (self.per_scale_above_m, self.per_step_above)
        };
        let size = above_m.abs() * per_scale_m;
        let from_bend = per_step * natural_log(size + (size * size + 1.0).sqrt());
        (self.bend_node + from_bend).clamp(0.0, self.last_node)
    }
}
