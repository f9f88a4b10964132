//! Table packs: axes, precompute, basis fit, pack format.
//!
//! A pack holds, for one turbidity, the sky images of single sources (paper Eq. 4) as coefficients over a
//! basis: `b(θ, φ; r, h_c, h_o, lobe, band) ≈ exp(log_scale) · Σ_k shape_k · B_k(θ, φ)`.

pub mod axes;
pub mod resident;

pub use axes::{OffsetAxis, TableAxes, lagrange_taps};
pub use resident::ResidentTables;
