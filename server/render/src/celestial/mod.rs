//! Skies of what shines outside the air: one beam, or light from everywhere, on the processor.

mod kept;
pub mod node_skies;
pub mod tables;

pub use node_skies::{BeamGrid, NodeSkies};
pub use tables::{CelestialTables, SkiesAt};
