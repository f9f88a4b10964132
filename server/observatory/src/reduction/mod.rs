//! What to dim (paper Eq. 12, `docs/model.md#plans`): from what lights do to the sky to how much of each goes.
//!
//! Pure functions of influences and fluxes; [`Observatory::plan`](crate::Observatory::plan) asks them and looks at the sky
//! before and after.

mod greedy;
mod linear_programme;
mod problem;
mod target;
mod threshold;

pub(crate) use linear_programme::programme_bytes;
pub use problem::{LeastCut, Reduction};
pub use target::least_cut;
pub use threshold::{percentile, threshold_cuts};

#[cfg(test)]
mod tests;
