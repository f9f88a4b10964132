//! The functions of `shaders/lib` in Rust, file by file under the same names, with their derivations. The CPU executor is made
//! of them, the f64 reference solution takes those that are generic over [`Real`], and a test compares each WGSL function with its
//! twin.

pub mod blending;
pub mod elementary;
pub mod fft;
pub mod indexing;
pub mod mixing;
pub(crate) mod types;
pub mod workgroup_fft;

pub use blending::{
    Blend, MAX_DEVIATION, MAX_DEVIATION_SHARE, MIN_PACK_RATIO, RADIANCE_FLOOR_W_M2_SR, blend_radiance,
};
pub use elementary::{Real, natural_exp, natural_log};
pub use fft::{
    Complex, complex_multiply, pair_from_spectra, radix4_butterfly, split_pair_spectrum, transform_16,
    twiddle,
};
pub use indexing::{blocked_layer, cell_texel, list_texel, mixed_texel, shape_texel};
pub use mixing::{cell_weights, lobe_shares, log_scale_between, mixed_curvature};
pub use types::{MAX_BAND_COUNT, band_channels};
pub use workgroup_fft::{Points, Twiddles, transform_256, twiddles};
