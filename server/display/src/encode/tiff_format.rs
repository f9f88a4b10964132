//! TIFF: linear radiance, 32-bit float samples.

use super::{bands_of, samples_of};
use crate::{error::DisplayError, notes::Notes, raster::FloatRaster};
use flate2::{Compression, write::ZlibEncoder};
use std::io::{Cursor, Write};
use tiff::{
    TiffResult,
    encoder::{Rational, TiffEncoder},
    tags::{CompressionMethod, PhotometricInterpretation, Predictor, ResolutionUnit, SampleFormat, Tag},
};

/// An extra sample that is no transparency.
const UNSPECIFIED: u16 = 0;
/// GDAL's own tag: names and units of the bands.
const GDAL_METADATA: Tag = Tag::Unknown(42112);
/// A strip has as many rows as this takes, in bytes before compression.
const STRIP_BYTES: usize = 1_000_000;

/// Float32 bands R, G, B in W m⁻² sr⁻¹, and a fourth of what the raster's response sees, deflated, named with their unit as GDAL reads it; pixels that show nothing of
/// the upper hemisphere are NaN, which the GDAL no-data tag says too; ground that hides the sky is 0. There is no georeference: columns are azimuths or projected directions, not places.
///
/// # Errors
/// [`DisplayError::Encoding`], only by a defect.
pub fn encode_tiff(raster: &FloatRaster<'_>, notes: &Notes) -> Result<Vec<u8>, DisplayError> {
    let mut out = Cursor::new(Vec::new());
    write(raster, notes, &mut out).map_err(|error| DisplayError::encoding("TIFF", error))?;
    Ok(out.into_inner())
}

/// Writes strip after strip; the encoder of the library has all samples at once.
fn write(raster: &FloatRaster<'_>, notes: &Notes, out: &mut Cursor<Vec<u8>>) -> TiffResult<()> {
    let bands = bands_of(raster);
    let row_bytes = bands.len() * size_of::<f32>() * raster.width_px as usize;
    let rows_per_strip = STRIP_BYTES.div_ceil(row_bytes);
    let mut encoder = TiffEncoder::new(out)?;
    let mut directory = encoder.image_directory()?;
    directory.write_tag(Tag::ImageWidth, raster.width_px)?;
    directory.write_tag(Tag::ImageLength, raster.height_px)?;
    directory.write_tag(Tag::Compression, CompressionMethod::Deflate.to_u16())?;
    directory.write_tag(Tag::Predictor, Predictor::None.to_u16())?;
    directory.write_tag(Tag::PhotometricInterpretation, PhotometricInterpretation::RGB.to_u16())?;
    directory.write_tag(Tag::RowsPerStrip, rows_per_strip as u32)?;
    directory.write_tag(Tag::SamplesPerPixel, bands.len() as u16)?;
    if raster.response().is_some() {
        directory.write_tag(Tag::ExtraSamples, &[UNSPECIFIED][..])?;
    }
    directory.write_tag(Tag::XResolution, Rational { n: 1, d: 1 })?;
    directory.write_tag(Tag::YResolution, Rational { n: 1, d: 1 })?;
    directory.write_tag(Tag::ResolutionUnit, ResolutionUnit::None.to_u16())?;
    directory.write_tag(Tag::Software, "Skyglow")?;
    directory.write_tag(Tag::ImageDescription, notes.after(&samples_of(raster)).as_str())?;
    directory.write_tag(GDAL_METADATA, gdal_metadata(&bands, notes).as_str())?;
    directory.write_tag(Tag::GdalNodata, "nan")?;
    let (mut offsets, mut lengths) = (Vec::new(), Vec::new());
    for first in (0..raster.height_px).step_by(rows_per_strip) {
        let rows = first..raster.height_px.min(first + rows_per_strip as u32);
        let mut strip = ZlibEncoder::new(Vec::new(), Compression::fast());
        let mut samples = Vec::with_capacity(row_bytes * rows.len());
        for (y, x) in rows.flat_map(|y| (0..raster.width_px).map(move |x| (y, x))) {
            let pixel = raster.samples(x, y).unwrap_or([f32::NAN; 4]);
            // In the order of this machine, as all numbers of the file.
            samples.extend(pixel.iter().take(bands.len()).flat_map(|sample| sample.to_ne_bytes()));
        }
        strip.write_all(&samples)?;
        let strip = strip.finish()?;
        offsets.push(u32::try_from(directory.write_data(&strip[..])?)?);
        lengths.push(u32::try_from(strip.len())?);
    }
    directory.write_tag(Tag::BitsPerSample, &vec![8 * size_of::<f32>() as u16; bands.len()][..])?;
    directory.write_tag(Tag::SampleFormat, &vec![SampleFormat::IEEEFP.to_u16(); bands.len()][..])?;
    directory.write_tag(Tag::StripOffsets, &offsets[..])?;
    directory.write_tag(Tag::StripByteCounts, &lengths[..])?;
    directory.finish()
}

/// Description and unit of each band, and the assumptions, as GDAL writes them.
fn gdal_metadata(bands: &[(String, &str)], notes: &Notes) -> String {
    let mut items: String = bands
        .iter()
        .enumerate()
        .map(|(sample, (name, unit))| {
            format!(
                "  <Item name=\"DESCRIPTION\" sample=\"{sample}\" role=\"description\">{name}, {unit}</Item>\n  \
                 <Item name=\"UNITTYPE\" sample=\"{sample}\" role=\"unittype\">{unit}</Item>\n"
            )
        })
        .collect();
    if !notes.assumptions_json().is_empty() {
        let escaped =
            notes.assumptions_json().replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        items.push_str(&format!("  <Item name=\"ASSUMPTIONS\">{escaped}</Item>\n"));
    }
    format!("<GDALMetadata>\n{items}</GDALMetadata>")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::bands_sky;
    use crate::{Projection, raster::raster};
    use flate2::read::ZlibDecoder;
    use skyglow_physics::{AZIMUTH_COUNT, ELEVATION_COUNT, Horizon, Response, SeenSky, spectrum::RGB_BANDS};
    use std::io::Read;
    use tiff::decoder::{Decoder, DecodingResult};

    #[test]
    fn the_bands_of_a_tiff_are_named_with_their_unit() {
        let size = Projection::Equirectangular.default_raster_size_px();
        let (dark, flat) = (bands_sky(|_| 0.0), Horizon::flat());
        let raster = raster(&dark, &flat, Projection::Equirectangular, size, None).unwrap();
        let mut decoder =
            Decoder::new(Cursor::new(encode_tiff(&raster, &Notes::default()).unwrap())).unwrap();
        let metadata = decoder.get_tag_ascii_string(GDAL_METADATA).unwrap();
        for (sample, band) in ["red 600-700 nm", "green 500-600 nm", "blue 400-500 nm"].iter().enumerate() {
            let item = format!("sample=\"{sample}\" role=\"description\">radiance {band}, W m-2 sr-1</Item>");
            assert!(metadata.contains(&item), "{metadata}");
        }
        assert_eq!(metadata.matches("role=\"unittype\">W m-2 sr-1<").count(), 3);
    }

    /// A TIFF says what it shows and on what assumptions.
    #[test]
    fn a_tiff_holds_description_and_assumptions() {
        let size = Projection::Equirectangular.default_raster_size_px();
        let (dark, flat) = (bands_sky(|_| 0.0), Horizon::flat());
        let raster = raster(&dark, &flat, Projection::Equirectangular, size, None).unwrap();
        let notes = Notes::new("a sky", r#"{"attribution":"A & B <c>"}"#);
        let mut decoder = Decoder::new(Cursor::new(encode_tiff(&raster, &notes).unwrap())).unwrap();
        let description = decoder.get_tag_ascii_string(Tag::ImageDescription).unwrap();
        assert_eq!(description, format!("{}. a sky", samples_of(&raster)));
        let metadata = decoder.get_tag_ascii_string(GDAL_METADATA).unwrap();
        let item = r#"<Item name="ASSUMPTIONS">{"attribution":"A &amp; B &lt;c&gt;"}</Item>"#;
        assert!(metadata.contains(item), "{metadata}");
    }

    /// A TIFF decodes to the same floats and nan outside the sky.
    #[test]
    fn a_tiff_round_trips_with_nan_outside_the_sky() {
        let panorama = bands_sky(|i| 1e-9 * i as f32);
        let flat = Horizon::flat();
        // The last has several strips.
        for (projection, size) in [
            (Projection::Equirectangular, (256, 64)),
            (Projection::Fisheye, (50, 50)),
            (Projection::Fisheye, (701, 299)),
        ] {
            let raster = raster(&panorama, &flat, projection, size, None).unwrap();
            let bytes = encode_tiff(&raster, &Notes::default()).unwrap();
            let mut decoder = Decoder::new(Cursor::new(bytes)).unwrap();
            assert_eq!(decoder.dimensions().unwrap(), size);
            let DecodingResult::F32(values) = decoder.read_image().unwrap() else {
                panic!("not float32");
            };
            assert_eq!(values.len(), 3 * (size.0 * size.1) as usize);
            for (pixel, value) in (0..).zip(values.chunks(3)) {
                match raster.samples(pixel % size.0, pixel / size.0) {
                    Some(samples) => assert_eq!(value, &samples[..3]),
                    None => assert!(value.iter().all(|v| v.is_nan())),
                }
            }
        }
    }

    /// With a response there is a fourth band of what it sees.
    #[test]
    fn a_tiff_holds_what_a_response_sees() {
        let mut responses = RGB_BANDS.to_vec();
        responses.push(Response::Sqm);
        let count = responses.len() * AZIMUTH_COUNT * ELEVATION_COUNT;
        let seen = SeenSky::from_values(responses, (0..count).map(|i| i as f32).collect()).unwrap();
        let (flat, sqm) = (Horizon::flat(), Response::Sqm);
        let raster = raster(&seen, &flat, Projection::Equirectangular, (256, 64), Some(&sqm)).unwrap();
        let bytes = encode_tiff(&raster, &Notes::default()).unwrap();
        let mut decoder = Decoder::new(Cursor::new(&bytes)).unwrap();
        let metadata = decoder.get_tag_ascii_string(GDAL_METADATA).unwrap();
        assert!(metadata.contains("sample=\"3\" role=\"description\">seen by sqm, cd m-2<"), "{metadata}");
        // The decoder gives colours alone: the strip itself has all samples.
        let [offset, length] =
            [Tag::StripOffsets, Tag::StripByteCounts].map(|tag| decoder.get_tag_u32(tag).unwrap() as usize);
        let mut strip = Vec::new();
        ZlibDecoder::new(&bytes[offset..offset + length]).read_to_end(&mut strip).unwrap();
        let values: Vec<f32> =
            strip.chunks_exact(4).map(|sample| f32::from_ne_bytes(sample.try_into().unwrap())).collect();
        assert_eq!(values.len(), 4 * 256 * 64);
        let sqm = seen.seen_by(&Response::Sqm).unwrap();
        for (pixel, value) in values.chunks(4).enumerate() {
            assert_eq!(value[3], sqm[(63 - pixel / 256) * 256 + pixel % 256]);
        }
    }
}
