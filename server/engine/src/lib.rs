//! Resident packs on a wgpu device, passes, read-back.
