//! Table packs: axes, precompute, basis fit (weighted PCA), pack format.
//!
//! A pack holds, for one turbidity, the sky images of single sources (paper Eq. 4) as coefficients over a
//! basis: `b(θ, φ; r, h_c, h_o, lobe, band) ≈ exp(log_scale) · Σ_k shape_k · B_k(θ, φ)`.

pub mod axes;
mod blocked;
pub mod celestial;
mod checkpoint;
pub mod clouds;
pub mod curvature;
pub mod error;
pub mod fit;
pub mod fit_constants;
pub mod images;
pub mod layout;
pub mod manifest;
mod measure;
pub mod multiple;
mod options;
pub mod pack;
mod packing;
pub mod precompute;
mod progress;
pub mod resident;
pub mod spectrum;
mod training;

pub use axes::{OffsetAxis, TableAxes};
pub use blocked::{BlockedAxes, LaterAxes};
pub use celestial::CelestialTable;
pub use clouds::Clouds;
pub use error::TablesError;
pub use manifest::{Manifest, Scattering};
pub use multiple::{MultipleAxes, MultipleTable};
pub use options::{BasisCount, PrecomputeOptions};
pub use pack::{Pack, celestial_tables_in, packs_in};
pub use precompute::{precompute, precompute_together};
pub use progress::{NoProgress, Progress};
pub use resident::{ResidentBlocked, ResidentTables};
