//! The functions of `shaders/lib` in Rust, under the same names, with their derivations. The CPU executor is made
//! of them, and a test holds each WGSL function to its twin.

pub mod blending;
pub mod elementary;
pub mod fft;
pub mod indexing;
pub mod mixing;

pub use blending::{
    Blend, MAX_DEVIATION, MAX_DEVIATION_SHARE, MIN_PACK_RATIO, RADIANCE_FLOOR_W_M2_SR, blend_radiance,
};
pub use elementary::{Real, natural_exp, natural_log};
pub use fft::{
    Complex, complex_multiply, pair_from_spectra, radix4_butterfly, split_pair_spectrum, stockham_target,
    transform_16, transform_256, twiddle, twiddle_index,
};
pub use indexing::{blocked_layer, cell_texel, list_texel, mixed_texel, shape_texel};
pub use mixing::{cell_weights, lobe_shares, log_scale_between, mixed_curvature};
