//! Skyglow of one source: single scattering along a view ray (Garstang 1986; paper Eq. 1–2, on a spherical Earth;
//! `docs/model.md#first-order`).
//!
//!   b = ∫ f(ψ)/d² · [β_m(z)p_m(γ) + 0.9β_a(z)p_a(γ)] · exp(−τ(S,P) − τ(P,O)) du     [m⁻² sr⁻¹]
//!
//! Under a cloud the ray ends at its base, and what the base reflects of the source's light is added.

mod overcast;
mod partly_hidden;
mod radiance;
mod ray;
mod scattering;

use crate::{bands::BAND_COUNT, emission::LOBE_COUNT};

pub use partly_hidden::mixed_radiance_per_watt_where;
pub use radiance::{
    cut_mixed_radiance_per_watt, cut_radiance_per_watt, cut_radiance_per_watt_fixed,
    cut_radiance_per_watt_of, mixed_radiance_per_watt, radiance_per_watt, radiance_per_watt_fixed,
    radiance_per_watt_of,
};
pub use ray::{RayPoint, SourceGeometry, SourceRay};

/// Outputs of one atmosphere: bands × lobes.
pub const OUTPUT_COUNT: usize = BAND_COUNT * LOBE_COUNT;

/// Sky radiance per watt of upward flux, m⁻² sr⁻¹, `[band][lobe]`.
pub type RadiancePerWatt = [[f64; LOBE_COUNT]; BAND_COUNT];

#[cfg(test)]
mod tests;

#[cfg(test)]
mod cut_tests;

#[cfg(test)]
mod overcast_tests;
