//! TIFF: linear radiance, three 32-bit float samples a pixel.

use super::{BAND_NAMES, RADIANCE_UNIT, SAMPLES};
use crate::{error::DisplayError, notes::Notes, raster::FloatRaster};
use std::io::Cursor;
use tiff::{
    encoder::{Compression, DeflateLevel, TiffEncoder, colortype::RGB32Float},
    tags::Tag,
};

/// GDAL's own tag: names and units of the bands.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

/// Three float32 bands R, G, B in W m⁻² sr⁻¹, deflated, named with their unit as GDAL reads it; pixels that show nothing of
/// the upper hemisphere are NaN, which the GDAL no-data tag says too; ground that hides the sky is 0. There is no georeference: columns are azimuths or projected directions, not places.
///
/// # Errors
/// [`DisplayError::Encoding`], only by a defect.
pub fn encode_tiff(raster: &FloatRaster, notes: &Notes) -> Result<Vec<u8>, DisplayError> {
    let samples: Vec<f32> = raster
        .radiance_w_m2_sr
        .iter()
        .zip(&raster.has_sky)
        .flat_map(|(radiance, &sky)| if sky { *radiance } else { [f32::NAN; 3] })
        .collect();
    let mut out = Cursor::new(Vec::new());
    let write = |out: &mut Cursor<Vec<u8>>| -> tiff::TiffResult<()> {
        let mut encoder = TiffEncoder::new(out)?.with_compression(Compression::Deflate(DeflateLevel::Fast));
        let mut image = encoder.new_image::<RGB32Float>(raster.width_px, raster.height_px)?;
        image.encoder().write_tag(Tag::Software, "Skyglow")?;
        image.encoder().write_tag(Tag::ImageDescription, notes.after(SAMPLES).as_str())?;
        image.encoder().write_tag(GDAL_METADATA, gdal_metadata(notes).as_str())?;
        image.encoder().write_tag(Tag::GdalNodata, "nan")?;
        image.write_data(&samples)
    };
    write(&mut out).map_err(|error| DisplayError::encoding("TIFF", error))?;
    Ok(out.into_inner())
}

/// Description and unit of each band, and the assumptions, as GDAL writes them.
fn gdal_metadata(notes: &Notes) -> String {
    let mut items: String = BAND_NAMES
        .iter()
        .enumerate()
        .map(|(sample, name)| {
            format!(
                "  <Item name=\"DESCRIPTION\" sample=\"{sample}\" role=\"description\">{name}, {RADIANCE_UNIT}</Item>\n  \
                 <Item name=\"UNITTYPE\" sample=\"{sample}\" role=\"unittype\">{RADIANCE_UNIT}</Item>\n"
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
    use crate::{Projection, Sky, raster::raster};
    use skyglow_physics::{Horizon, Panorama};
    use tiff::decoder::{Decoder, DecodingResult};

    #[test]
    fn the_bands_of_a_tiff_are_named_with_their_unit() {
        let size = Projection::Equirectangular.default_raster_size_px();
        let raster =
            raster(&Panorama::dark(), &Horizon::flat(), Projection::Equirectangular, size, Sky::Artificial)
                .unwrap();
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
        let raster =
            raster(&Panorama::dark(), &Horizon::flat(), Projection::Equirectangular, size, Sky::Artificial)
                .unwrap();
        let notes = Notes::new("a sky", r#"{"attribution":"A & B <c>"}"#);
        let mut decoder = Decoder::new(Cursor::new(encode_tiff(&raster, &notes).unwrap())).unwrap();
        let description = decoder.get_tag_ascii_string(Tag::ImageDescription).unwrap();
        assert_eq!(description, format!("{SAMPLES}. a sky"));
        let metadata = decoder.get_tag_ascii_string(GDAL_METADATA).unwrap();
        let item = r#"<Item name="ASSUMPTIONS">{"attribution":"A &amp; B &lt;c&gt;"}</Item>"#;
        assert!(metadata.contains(item), "{metadata}");
    }

    /// A TIFF decodes to the same floats and nan outside the sky.
    #[test]
    fn a_tiff_round_trips_with_nan_outside_the_sky() {
        let samples = (0..Panorama::LEN).map(|i| 1e-9 * i as f32).collect();
        let panorama = Panorama::from_samples(samples).unwrap();
        for (projection, size) in [(Projection::Equirectangular, (256, 64)), (Projection::Fisheye, (50, 50))]
        {
            let raster = raster(&panorama, &Horizon::flat(), projection, size, Sky::Artificial).unwrap();
            let bytes = encode_tiff(&raster, &Notes::default()).unwrap();
            let mut decoder = Decoder::new(Cursor::new(bytes)).unwrap();
            assert_eq!(decoder.dimensions().unwrap(), size);
            let DecodingResult::F32(values) = decoder.read_image().unwrap() else {
                panic!("not float32");
            };
            for (pixel, value) in values.chunks(3).enumerate() {
                if raster.has_sky[pixel] {
                    assert_eq!(value, raster.radiance_w_m2_sr[pixel]);
                } else {
                    assert!(value.iter().all(|v| v.is_nan()));
                }
            }
        }
    }
}
