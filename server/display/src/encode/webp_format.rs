//! WebP, lossless.

use crate::{error::DisplayError, notes::Notes};
use image::{ExtendedColorType, ImageEncoder, RgbImage, codecs::webp::WebPEncoder};

/// An opaque picture as lossless WebP.
///
/// # Errors
/// [`DisplayError::Encoding`], only by a defect.
pub fn encode_webp(picture: &RgbImage, notes: &Notes) -> Result<Vec<u8>, DisplayError> {
    let mut out = Vec::new();
    let mut encoder = WebPEncoder::new_lossless(&mut out);
    let lines = [notes.description(), notes.assumptions_json()].join("\n");
    if !lines.trim().is_empty() {
        let set = encoder.set_exif_metadata(exif_of(lines.trim()));
        set.map_err(|error| DisplayError::encoding("WebP", error))?;
    }
    encoder
        .encode(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::Rgb8)
        .map_err(|error| DisplayError::encoding("WebP", error))?;
    Ok(out)
}

/// Exif with an `ImageDescription` alone: a TIFF header, a directory of one entry, and the text.
fn exif_of(description: &str) -> Vec<u8> {
    const IMAGE_DESCRIPTION: u16 = 0x010E;
    const ASCII: u16 = 2;
    // After the header (8 bytes), the count (2), the entry (12) and the link to no further directory (4).
    const TEXT_START: u32 = 26;
    let mut exif = b"II*\0\x08\0\0\0\x01\0".to_vec();
    exif.extend(IMAGE_DESCRIPTION.to_le_bytes());
    exif.extend(ASCII.to_le_bytes());
    // A text of four bytes and less would lie in the entry itself; spaces make it longer.
    let text = format!("{description:<8}\0");
    exif.extend((text.len() as u32).to_le_bytes());
    exif.extend(TEXT_START.to_le_bytes());
    exif.extend([0; 4]);
    exif.extend(text.bytes());
    exif
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageDecoder, Rgb, codecs::webp::WebPDecoder};
    use std::io::Cursor;

    #[test]
    fn a_webp_decodes_to_the_same_pixels() {
        let picture = RgbImage::from_fn(61, 33, |x, y| Rgb([x as u8 * 3, y as u8 * 7, (x ^ y) as u8]));
        let bytes = encode_webp(&picture, &Notes::default()).unwrap();
        let back = image::load_from_memory_with_format(&bytes, image::ImageFormat::WebP).unwrap();
        assert_eq!(back.into_rgb8(), picture);
    }

    /// A WebP says what it shows and on what assumptions.
    #[test]
    fn a_webp_holds_description_and_assumptions() {
        let notes = Notes::new("a sky", r#"{"turbidity":2.5}"#);
        let bytes = encode_webp(&RgbImage::new(3, 2), &notes).unwrap();
        let exif = WebPDecoder::new(Cursor::new(bytes)).unwrap().exif_metadata().unwrap().unwrap();
        let text = String::from_utf8_lossy(&exif).into_owned();
        assert!(text.ends_with("a sky\n{\"turbidity\":2.5}\0"), "{text}");
        assert_eq!(&exif[..4], b"II*\0");
        let count = u32::from_le_bytes([exif[14], exif[15], exif[16], exif[17]]) as usize;
        let start = u32::from_le_bytes([exif[18], exif[19], exif[20], exif[21]]) as usize;
        assert_eq!(start + count, exif.len());
    }
}
