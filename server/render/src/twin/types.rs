//! Structures shared with `shaders/lib/types.wgsl`; a test compares the offsets.

use bytemuck::{Pod, Zeroable};
use skyglow_physics::{BAND_COUNT, LOBE_COUNT};

/// Bands that the channels of one texel hold.
pub const MAX_BAND_COUNT: usize = 4;

/// One value a band as the channels of a texel: 0 beyond the last band.
#[inline(always)]
pub fn band_channels(of_bands: [f32; BAND_COUNT]) -> [f32; MAX_BAND_COUNT] {
    let mut channels = [0.0; MAX_BAND_COUNT];
    channels[..BAND_COUNT].copy_from_slice(&of_bands);
    channels
}

/// One pack's share of a batch.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Frame {
    pub(crate) request_count: u32,
    pub(crate) node_count: u32,
    pub(crate) cell_count: u32,
    pub(crate) basis_count: u32,
    pub(crate) quad_count: u32,
    pub(crate) table_octet_count: u32,
    pub(crate) ring_count: u32,
    pub(crate) offset_count: u32,
    pub(crate) pack_slot: u32,
    pub(crate) pack_count: u32,
    pub(crate) blocked_octet_count: u32,
    pub(crate) blocked_offset_count: u32,
    pub(crate) kink_node: u32,
    pub(crate) blocked_kink_node: u32,
}

/// One request of a batch.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Request {
    pub(crate) altitude_index: [u32; 4],
    pub(crate) altitude_weight: [f32; 4],
    pub(crate) blend_weight: [f32; 4],
    pub(crate) linear_weight: [f32; 4],
    pub(crate) emission: [f32; LOBE_COUNT],
    pub(crate) altitude_count: u32,
    pub(crate) flux_per_dnb_flux: [f32; MAX_BAND_COUNT],
    pub(crate) blocked_altitude_index: [u32; 4],
    pub(crate) blocked_altitude_weight: [f32; 4],
    pub(crate) blocked_altitude_count: u32,
    pub(crate) padding: [u32; 3],
}

/// A (blocking angle, ring, offset) to mix for a request.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Node {
    pub(crate) request: u32,
    pub(crate) ring: u32,
    pub(crate) offset: u32,
    pub(crate) blocking: u32,
}

/// An azimuth column and its cells; none where it is dark.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Column {
    pub(crate) request: u32,
    pub(crate) azimuth: u32,
    pub(crate) first_cell: u32,
    pub(crate) end_cell: u32,
}
