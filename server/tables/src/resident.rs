//! A pack laid out for evaluation: distances resampled to the rings of the polar grid.

use crate::{axes::OffsetAxis, clouds::Clouds, manifest::Scattering};
use half::f16;
use skyglow_physics::{BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT, blocking::BLOCKING_COUNT};

/// Azimuthal frequencies stored of a real row of 256 samples: 0..=128.
pub const FREQUENCY_COUNT: usize = 129;

/// One turbidity's tables on the rings of a polar grid. All that an executor
/// needs. Interpolation over observer altitude goes at constant offset Δ. Model (paper Eq. 4–9, with scale and shape apart):
/// `b(θ, φ) ≈ exp(log_scale) · Σ_k shape_k · B_k(θ, φ)`  [m⁻² sr⁻¹].
#[derive(Clone, Debug)]
pub struct ResidentTables {
    /// Turbidity of the pack.
    pub turbidity: f64,
    /// Orders of scattering in it.
    pub scattering: Scattering,
    /// The layer of cloud that it was made under; None for a clear sky.
    pub clouds: Option<Clouds>,
    /// Checksum of the pack file, hexadecimal.
    pub checksum: String,
    /// Whether the data are synthetic, for tests: nothing of the model is then added to their sky.
    pub is_synthetic: bool,
    /// Observer altitudes of the table, metres, ascending.
    pub observer_altitude_m: Vec<f64>,
    /// Number of nodes of the offset axis Δ = source altitude − observer altitude (see [`crate::axes`]).
    pub offset_count: usize,
    /// The offset axis on every ring: fractional node = `offset_axis[ring].position(Δ)`. Between nodes shapes are linear and
    /// scales as in [`crate::curvature`].
    pub offset_axis: Vec<OffsetAxis>,
    /// Ring distances, metres, ascending: the rings of the polar grid.
    pub ring_distance_m: Vec<f64>,
    /// M, number of basis functions; a multiple of 4.
    pub basis_count: usize,
    /// ln of the scale [m⁻² sr⁻¹], `[observer_altitude][lobe][band][ring][offset]`.
    pub log_scale: Vec<f32>,
    /// Shape coefficients, `[ring][offset][observer_altitude][lobe][band][basis]`: a node's lie side by side, for all
    /// that a request mixes of it is read at once.
    pub shape: Vec<f16>,
    /// F[B_k] along azimuth, real because B is even: `[basis][elevation][frequency]`,
    /// `F[f] = Σ_i B(θ_i)·cos(2π f i / 256)`, unnormalised.
    pub basis_spectrum: Vec<f32>,
    /// Sources behind skylines; None where the pack holds the open sky alone.
    pub blocked: Option<ResidentBlocked>,
}

/// Tables of sources whose light below a skyline does not count, over the same rings and the same basis as the open
/// tables beside it ([`ResidentTables`]), one set for each angle of
/// [`skyglow_physics::blocking::BLOCKING_ANGLES_DEG`] but the first (the open sky): place `angle_index` here is angle
/// `angle_index + 1` there. The model is that of the open tables, with the first [`Self::basis_count`] functions.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidentBlocked {
    /// Observer altitudes, metres, ascending; interpolated as those of the open tables, at constant offset.
    pub observer_altitude_m: Vec<f64>,
    /// Number of nodes of the offset axis.
    pub offset_count: usize,
    /// The offset axis of every angle on every ring, `[angle_index][ring]`.
    pub offset_axis: Vec<Vec<OffsetAxis>>,
    /// Number of basis functions in use, those of the open tables from the first on; a multiple of 4.
    pub basis_count: usize,
    /// ln of the scale [m⁻² sr⁻¹], `[observer_altitude][angle_index][lobe][band][ring][offset]`.
    pub log_scale: Vec<f32>,
    /// Shape coefficients, `[angle_index][ring][offset][observer_altitude][lobe][band][basis]`.
    pub shape: Vec<f16>,
}

impl ResidentBlocked {
    /// Number of angles: those of [`skyglow_physics::blocking::BLOCKING_ANGLES_DEG`] but the open sky.
    pub const ANGLE_COUNT: usize = BLOCKING_COUNT - 1;

    /// Position in [`Self::log_scale`].
    pub fn scale_index(
        &self,
        observer_altitude: usize,
        angle_index: usize,
        lobe: usize,
        band: usize,
        ring: usize,
        offset: usize,
    ) -> usize {
        let rings = self.offset_axis[angle_index].len();
        let table = (observer_altitude * Self::ANGLE_COUNT + angle_index) * LOBE_COUNT + lobe;
        ((table * BAND_COUNT + band) * rings + ring) * self.offset_count + offset
    }

    /// Bytes of its arrays.
    pub fn byte_count(&self) -> usize {
        size_of_val(&self.log_scale[..]) + size_of_val(&self.shape[..])
    }

    /// Times [`Self::basis_count`] the start in [`Self::shape`].
    pub fn shape_index(
        &self,
        observer_altitude: usize,
        angle_index: usize,
        lobe: usize,
        band: usize,
        ring: usize,
        offset: usize,
    ) -> usize {
        let rings = self.offset_axis[angle_index].len();
        let node = (angle_index * rings + ring) * self.offset_count + offset;
        image_of_node(node, self.observer_altitude_m.len(), observer_altitude, lobe, band)
    }
}

impl ResidentTables {
    /// Bytes of its arrays.
    pub fn byte_count(&self) -> usize {
        let blocked = self.blocked.as_ref().map_or(0, ResidentBlocked::byte_count);
        size_of_val(&self.log_scale[..])
            + size_of_val(&self.shape[..])
            + size_of_val(&self.basis_spectrum[..])
            + blocked
    }

    /// Position in [`Self::log_scale`].
    pub fn scale_index(
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

    /// Times [`Self::basis_count`] the start in [`Self::shape`].
    pub fn shape_index(
        &self,
        observer_altitude: usize,
        lobe: usize,
        band: usize,
        ring: usize,
        offset: usize,
    ) -> usize {
        let node = ring * self.offset_count + offset;
        image_of_node(node, self.observer_altitude_m.len(), observer_altitude, lobe, band)
    }

    /// Position in [`Self::basis_spectrum`].
    pub fn spectrum_index(&self, basis: usize, elevation: usize, frequency: usize) -> usize {
        (basis * ELEVATION_COUNT + elevation) * FREQUENCY_COUNT + frequency
    }
}

/// Position of an image in `[node][observer_altitude][lobe][band]`.
fn image_of_node(
    node: usize,
    observer_altitudes: usize,
    observer_altitude: usize,
    lobe: usize,
    band: usize,
) -> usize {
    ((node * observer_altitudes + observer_altitude) * LOBE_COUNT + lobe) * BAND_COUNT + band
}
