//! How dense the tables of a sum over sources are.

/// Radiance that stands for darkness, m⁻² sr⁻¹ per watt.
pub(super) const DARKNESS_PER_M2_SR: f64 = 1e-36;

/// How dense the tables of a sum are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SumDensity {
    /// Largest step between altitudes of sources, metres.
    pub altitude_step_m: f64,
    /// Step between altitudes at which fields are solved behind skylines, in ln(1 + |Δ|/150 m), Δ from the observer's.
    pub cut_offset_step: f64,
    /// Distances from 250 m to 300 km, even in the logarithm.
    pub distances: usize,
    /// Azimuths of a half turn, crowding at the source's.
    pub azimuths: usize,
}

impl Default for SumDensity {
    fn default() -> Self {
        Self { altitude_step_m: 300.0, cut_offset_step: 0.7, distances: 72, azimuths: 41 }
    }
}
