//! The radiance of one order of scattering at every place of the grid.

use super::{lanes::LANES, source_function::Moments};

/// The radiance of one order, `[point]`.
#[derive(Clone, Debug)]
pub(super) struct Radiance {
    pub(super) moments: Moments,
    /// Flux through the horizontal from above, m⁻² per watt, `[point]`.
    pub(super) down_flux: Vec<[f64; LANES]>,
    /// Flux through the horizontal from below, m⁻² per watt, `[point]`.
    pub(super) up_flux: Vec<[f64; LANES]>,
}
