//! Bytes of pictures and rasters. All lossless; the same input gives the same bytes.

mod exr_format;
mod png_format;
mod tiff_format;
mod webp_format;

pub use exr_format::encode_exr;
pub use png_format::{encode_png, encode_png_rgba};
pub use tiff_format::encode_tiff;
pub use webp_format::encode_webp;
