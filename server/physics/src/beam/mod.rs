//! Skies of a parallel beam from outside the air, such as that of the Sun, the Moon or a planet
//! (`docs/model.md#beams`).
//!
//! The light of a beam is symmetric about the line to its source. So the radiance of each order is stored by the
//! source's zenith angle and altitude, and one field holds the skies of all zenith angles. First-order light is
//! integrated along every ray under refracted, shadowed light of the beam ([`sunlight`]); each later order is followed
//! along straight rays from every place ([`field`]), and scattered there into fixed directions ([`grid`]).
//! [`monte_carlo`] is the reference solution.

mod air;
mod field;
mod grid;
pub mod monte_carlo;
pub(crate) mod ozone;
mod path;
mod refraction;
mod sunlight;

pub use air::{BeamAir, MixedPhase, MoleculeProfile, USUAL_OZONE_DOBSON};
pub use field::{BeamField, BeamSetting, BeamView};
pub use refraction::apparent_altitude_rad;

#[cfg(test)]
mod tests;
