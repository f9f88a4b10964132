//! Monte Carlo reference solutions (Marchuk et al. 1980), one path at a time: slow, and independent of the solver.
//!
//! [`Tracer`] follows light from the observer to the source; it is exact wherever light is not rare. Far from a
//! source in thick haze it is: [`ForwardTracer`] follows light from the source and counts it at many view rays
//! at once, by the symmetry about the source's vertical. Each checks the other. [`CloudTracer`] follows light backward through
//! clouds as bodies.

mod backward;
mod cloud_cells;
mod crossing;
pub(crate) mod draws;
mod forward;
mod through_clouds;

use super::SourceSetting;
use crate::emission::LOBE_COUNT;
pub use backward::Tracer;
pub use cloud_cells::{CloudField, CloudMatter};
pub use crossing::Detector;
pub use forward::ForwardTracer;
pub use through_clouds::{CloudTracer, MeanRadiance, Town};

/// Both tracers of light below a lid know how a Lambertian one reflects, not how drops do.
fn check_base(setting: &SourceSetting) {
    let is_known = setting.atmosphere.cloud().is_none_or(|cloud| cloud.is_lambertian());
    assert!(is_known, "the tracers know Lambertian clouds alone; `CloudTracer` has drops");
}

/// Orders that are reported separately.
pub const SEPARATE_ORDERS: usize = 12;

/// Radiance of orders two and more with its standard error, per lobe, m⁻² sr⁻¹ per watt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Mean over paths.
    pub radiance_per_m2_sr: [f64; LOBE_COUNT],
    /// Standard error of the mean.
    pub standard_error_per_m2_sr: [f64; LOBE_COUNT],
    /// Mean of order `i + 1` alone (the last one holds all later ones), `[order][lobe]`. Order 1 is a check
    /// against `single_source` and is not part of the mean.
    pub by_order_per_m2_sr: [[f64; LOBE_COUNT]; SEPARATE_ORDERS],
}

impl Estimate {
    /// From means over `count` paths: of every order, and of the squares of orders two and more together.
    fn from_sums(
        orders: [[f64; LOBE_COUNT]; SEPARATE_ORDERS],
        squares: [f64; LOBE_COUNT],
        count: f64,
    ) -> Self {
        let mean: [f64; LOBE_COUNT] =
            std::array::from_fn(|lobe| orders[1..].iter().map(|order| order[lobe]).sum());
        Self {
            radiance_per_m2_sr: mean,
            standard_error_per_m2_sr: std::array::from_fn(|lobe| {
                ((squares[lobe] - mean[lobe] * mean[lobe]).max(0.0) / count).sqrt()
            }),
            by_order_per_m2_sr: orders,
        }
    }
}
