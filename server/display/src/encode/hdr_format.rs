//! PNG for screens that go above white: the third edition's way (W3C 2025), code points of ITU-T H.273 in a chunk `cICP`.

use crate::{
    error::DisplayError,
    hdr::{HdrImage, PQ_FULL_CD_M2, SIGNIFICANT_BITS, luminance_cd_m2},
    notes::Notes,
};
use png::chunk::{ChunkType, cICP, cLLI};

/// Primaries of BT.2020, transfer of SMPTE ST 2084, no matrix, full range.
const CODE_POINTS: [u8; 4] = [9, 16, 0, 1];
/// Samples' bits that count.
const SIGNIFICANT_BITS_CHUNK: ChunkType = ChunkType(*b"sBIT");
/// Steps of light levels in a cd m⁻².
const LEVELS_PER_CD_M2: f64 = 10_000.0;

/// A picture as 16-bit RGB PNG with its code points, the brightest light of a pixel and the mean.
///
/// # Errors
/// [`DisplayError::Encoding`], only by a defect.
pub fn encode_hdr_png(picture: &HdrImage, notes: &Notes) -> Result<Vec<u8>, DisplayError> {
    let failed = |error: png::EncodingError| DisplayError::encoding("PNG", error);
    let mut out = Vec::with_capacity(3 * picture.pixels().len() + 1024);
    let mut encoder = png::Encoder::new(&mut out, picture.width_px, picture.height_px);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Paeth);
    for (keyword, text) in [("Description", notes.description()), ("Assumptions", notes.assumptions_json())] {
        if !text.is_empty() {
            encoder.add_text_chunk(keyword.to_owned(), text.to_owned()).map_err(failed)?;
        }
    }
    let mut writer = encoder.write_header().map_err(failed)?;
    // The library reads these chunks and writes none of them.
    writer.write_chunk(cICP, &CODE_POINTS).map_err(failed)?;
    writer.write_chunk(cLLI, &light_levels(picture)).map_err(failed)?;
    writer.write_chunk(SIGNIFICANT_BITS_CHUNK, &[SIGNIFICANT_BITS as u8; 3]).map_err(failed)?;
    let bytes: Vec<u8> = picture.pixels().iter().flatten().flat_map(|sample| sample.to_be_bytes()).collect();
    writer.write_image_data(&bytes).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(out)
}

/// The brightest channel of a pixel, and its mean over the picture, as `cLLI` has them (CTA-861.3-A).
fn light_levels(picture: &HdrImage) -> [u8; 8] {
    let brightest = picture.pixels().iter().map(|pixel| pixel.iter().copied().max().unwrap_or(0));
    let (mut most, mut sum) = (0, 0.0);
    for sample in brightest {
        most = most.max(sample);
        sum += luminance_cd_m2(sample);
    }
    let mean = sum / picture.pixels().len().max(1) as f64;
    let [most, mean] = [luminance_cd_m2(most), mean].map(|light| {
        let level = light.clamp(0.0, PQ_FULL_CD_M2) * LEVELS_PER_CD_M2;
        (level.round() as u32).to_be_bytes()
    });
    std::array::from_fn(|i| if i < 4 { most[i] } else { mean[i - 4] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hdr::pq;

    /// A decoder that is not ours finds the code points, the levels and every sample.
    #[test]
    fn an_hdr_png_decodes_to_the_same_samples() {
        let full = |light: f64| (pq(light) * 65_535.0).round() as u16;
        let picture = HdrImage::from_fn(37, 21, |x, y| {
            if (x, y) == (20, 7) { [full(1000.0); 3] } else { [x as u16 * 5, y as u16 * 300, 9_000] }
        });
        let notes = Notes::new("a sky", r#"{"turbidity":2.5}"#);
        let file = encode_hdr_png(&picture, &notes).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        let info = reader.info().clone();
        let points = info.coding_independent_code_points.unwrap();
        assert_eq!((points.color_primaries, points.transfer_function), (9, 16));
        assert_eq!((points.matrix_coefficients, points.is_video_full_range_image), (0, true));
        let levels = info.content_light_level.unwrap();
        assert!(levels.max_content_light_level.abs_diff(10_000_000) < 20_000);
        assert!(levels.max_frame_average_light_level < 20_000_000 / (37 * 21) * 3);
        assert_eq!((info.bit_depth, info.srgb), (png::BitDepth::Sixteen, None));
        assert_eq!(info.sbit.as_deref(), Some(&[12u8, 12, 12][..]));
        assert_eq!(info.uncompressed_latin1_text.len(), 2);
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let wanted: Vec<u8> = picture.pixels().iter().flatten().flat_map(|v| v.to_be_bytes()).collect();
        assert_eq!(bytes, wanted);
    }
}
