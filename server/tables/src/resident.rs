//! A pack laid out for evaluation: distances resampled to the rings of the polar grid.

use crate::{axes::OffsetAxis, manifest::Scattering};
use half::f16;
use skyglow_physics::{BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT};

/// Azimuthal frequencies kept of a real row of 256 samples: 0..=128.
pub const FREQUENCY_COUNT: usize = 129;

/// One turbidity's tables on the rings of a polar grid. Everything an executor needs, nothing it must look up
/// elsewhere. Interpolation over observer altitude goes at constant offset Δ. Model (paper Eq. 4–9, with scale and shape apart):
/// `b(θ, φ) ≈ exp(log_scale) · Σ_k shape_k · B_k(θ, φ)`  [m⁻² sr⁻¹].
#[derive(Clone, Debug)]
pub struct ResidentTables {
    /// Turbidity of the pack.
    pub turbidity: f64,
    /// Orders of scattering in it.
    pub scattering: Scattering,
    /// Checksum of the pack file, hexadecimal.
    pub checksum: String,
    /// Observer altitudes of the table, metres, ascending.
    pub observer_altitude_m: Vec<f64>,
    /// Number of nodes of the offset axis Δ = source altitude − observer altitude (see [`crate::axes`]).
    pub offset_count: usize,
    /// The offset axis on every ring: fractional node = `offset_axis[ring].position(Δ)`, linear between nodes.
    pub offset_axis: Vec<OffsetAxis>,
    /// Ring distances, metres, ascending: the rings of the polar grid.
    pub ring_distance_m: Vec<f64>,
    /// M, number of basis functions; a multiple of 4.
    pub basis_count: usize,
    /// ln of the scale [m⁻² sr⁻¹], `[observer_altitude][lobe][band][ring][offset]`.
    pub log_scale: Vec<f32>,
    /// Shape coefficients, `[observer_altitude][lobe][band][ring][offset][basis]`.
    pub shape: Vec<f16>,
    /// F[B_k] along azimuth, real because B is even: `[basis][elevation][frequency]`,
    /// `F[f] = Σ_i B(θ_i)·cos(2π f i / 256)`, unnormalised.
    pub basis_spectrum: Vec<f32>,
}

impl ResidentTables {
    /// Position in [`Self::log_scale`]; times [`Self::basis_count`] the start in [`Self::shape`].
    pub fn node_index(
        &self,
        observer_altitude: usize,
        lobe: usize,
        band: usize,
        ring: usize,
        offset: usize,
    ) -> usize {
        (((observer_altitude * LOBE_COUNT + lobe) * BAND_COUNT + band) * self.ring_distance_m.len() + ring)
            * self.offset_count
            + offset
    }

    /// Position in [`Self::basis_spectrum`].
    pub fn spectrum_index(&self, basis: usize, elevation: usize, frequency: usize) -> usize {
        (basis * ELEVATION_COUNT + elevation) * FREQUENCY_COUNT + frequency
    }
}
