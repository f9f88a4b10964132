//! WebP, lossless.

use crate::error::DisplayError;
use image::{ExtendedColorType, RgbImage, codecs::webp::WebPEncoder};

/// An opaque picture as lossless WebP.
///
/// # Errors
/// [`DisplayError::Encoding`], only by a defect.
pub fn encode_webp(picture: &RgbImage) -> Result<Vec<u8>, DisplayError> {
    let mut out = Vec::new();
    WebPEncoder::new_lossless(&mut out)
        .encode(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::Rgb8)
        .map_err(|error| DisplayError::encoding("WebP", error))?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn a_webp_decodes_to_the_same_pixels() {
        let picture = RgbImage::from_fn(61, 33, |x, y| Rgb([x as u8 * 3, y as u8 * 7, (x ^ y) as u8]));
        let bytes = encode_webp(&picture).unwrap();
        let back = image::load_from_memory_with_format(&bytes, image::ImageFormat::WebP).unwrap();
        assert_eq!(back.into_rgb8(), picture);
    }
}
