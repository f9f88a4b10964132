//! OpenEXR: linear radiance, 32-bit floats.

use super::{bands_of, samples_of};
use crate::{error::DisplayError, notes::Notes, raster::FloatRaster};
use exr::prelude::{
    AttributeValue, Blocks, Compression, Encoding, Image, Layer, LayerAttributes, LineOrder,
    SpecificChannels, Text, Vec2, WritableImage,
};
use skyglow_physics::Response;
use std::io::Cursor;

/// Scan lines with ZIP: lossless and read by every program.
const ENCODING: Encoding = Encoding {
    compression: Compression::ZIP16,
    blocks: Blocks::ScanLines,
    line_order: LineOrder::Increasing,
};

/// Channels R, G, B in W m⁻² sr⁻¹, and one with the name of the raster's response, each with an attribute (`channelR`, …) that says what it is; where the projection leaves pixels outside the upper
/// hemisphere also A, 1 inside it and 0 elsewhere. Ground that hides the sky is 0 in all but A. Lossless, the same bytes each time.
///
/// # Errors
/// [`DisplayError::Encoding`], only by a defect.
pub fn encode_exr(raster: &FloatRaster<'_>, notes: &Notes) -> Result<Vec<u8>, DisplayError> {
    let mut attributes = LayerAttributes::named("sky");
    attributes.software_name = Some(Text::from("Skyglow"));
    attributes.comments = Some(Text::from(notes.after(&samples_of(raster)).as_str()));
    if !notes.assumptions_json().is_empty() {
        let text = AttributeValue::Text(Text::from(notes.assumptions_json()));
        attributes.other.insert(Text::from("assumptions"), text);
    }
    let response = raster.response().map_or("", Response::name);
    for (channel, (name, unit)) in ["R", "G", "B", response].into_iter().zip(bands_of(raster)) {
        let text = Text::from(format!("{name}, {unit}").as_str());
        attributes.other.insert(Text::from(format!("channel{channel}").as_str()), AttributeValue::Text(text));
    }
    let size = (raster.width_px as usize, raster.height_px as usize);
    let samples = |position: Vec2<usize>| {
        let samples = raster.samples(position.x() as u32, position.y() as u32);
        (samples.unwrap_or_default(), if samples.is_some() { 1.0f32 } else { 0.0 })
    };
    let colours = SpecificChannels::build().with_channel("R").with_channel("G").with_channel("B");
    let mut out = Cursor::new(Vec::new());
    // Each kind of channels is a type of its own.
    macro_rules! write {
        ($channels:expr, $pixel:expr) => {
            Image::from_layer(Layer::new(size, attributes, ENCODING, $channels.with_pixel_fn($pixel)))
                .write()
                .non_parallel()
                .to_buffered(&mut out)
        };
    }
    let written = match (raster.is_all_sky(), response) {
        (true, "") => write!(colours, |at| {
            let ([r, g, b, _], _) = samples(at);
            (r, g, b)
        }),
        (false, "") => write!(colours.with_channel("A"), |at| {
            let ([r, g, b, _], a) = samples(at);
            (r, g, b, a)
        }),
        (true, seen) => write!(colours.with_channel(seen), |at| {
            let ([r, g, b, seen], _) = samples(at);
            (r, g, b, seen)
        }),
        (false, seen) => write!(colours.with_channel("A").with_channel(seen), |at| {
            let ([r, g, b, seen], a) = samples(at);
            (r, g, b, a, seen)
        }),
    };
    written.map_err(|error| DisplayError::encoding("OpenEXR", error))?;
    let mut file = out.into_inner();
    sort_attributes(&mut file).ok_or_else(|| DisplayError::encoding("OpenEXR", "its header is no list"))?;
    Ok(file)
}

/// Bytes before the list of attributes: magic number and version.
const LEADING_BYTES: usize = 8;

/// Puts the attributes of a file's header in the order of their names: the library has them in that of a table of hashes, which is
/// another each time. None where the header is not as it should be.
fn sort_attributes(file: &mut [u8]) -> Option<()> {
    let (mut attributes, mut at) = (Vec::new(), LEADING_BYTES);
    // Each has a name, a type, a length and so many bytes; the list ends with an empty name.
    while *file.get(at)? != 0 {
        let begin = at;
        for _ in 0..2 {
            at += file.get(at..)?.iter().position(|byte| *byte == 0)? + 1;
        }
        let length = u32::from_le_bytes(file.get(at..at + 4)?.try_into().ok()?);
        at += 4 + length as usize;
        attributes.push(file.get(begin..at)?.to_vec());
    }
    attributes.sort_unstable();
    file.get_mut(LEADING_BYTES..at)?.copy_from_slice(&attributes.concat());
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::bands_sky;
    use crate::{Projection, raster::raster};
    use exr::prelude::{ReadChannels, ReadLayers, read};
    use skyglow_physics::{AZIMUTH_COUNT, ELEVATION_COUNT, Horizon, SeenSky, spectrum::RGB_BANDS};

    /// Channel names with their samples, in the file's order (alphabetical).
    fn channels(bytes: &[u8]) -> Vec<(String, Vec<f32>)> {
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .unwrap();
        let list = image.layer_data.channel_data.list;
        list.iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
    }

    /// An EXR decodes to the same floats in channels named r g b.
    #[test]
    fn an_exr_round_trips_in_channels_r_g_b() {
        let panorama = bands_sky(|i| 1e-9 * i as f32);
        let flat = Horizon::flat();
        let raster = raster(&panorama, &flat, Projection::Equirectangular, (256, 64), None).unwrap();
        let channels = channels(&encode_exr(&raster, &Notes::default()).unwrap());
        assert_eq!(channels.iter().map(|c| c.0.as_str()).collect::<Vec<_>>(), ["B", "G", "R"]);
        for pixel in 0..256 * 64 {
            let radiance = raster.samples(pixel as u32 % 256, pixel as u32 / 256).unwrap();
            assert_eq!([channels[2].1[pixel], channels[1].1[pixel], channels[0].1[pixel]], radiance[..3]);
        }
    }

    #[test]
    fn the_channels_of_an_exr_say_their_unit() {
        let (dark, flat) = (bands_sky(|_| 0.0), Horizon::flat());
        let raster = raster(&dark, &flat, Projection::Equirectangular, (64, 16), None).unwrap();
        let bytes = encode_exr(&raster, &Notes::default()).unwrap();
        let header = &exr::meta::MetaData::read_from_buffered(Cursor::new(&bytes), false).unwrap().headers[0];
        for (name, band) in
            [("channelR", "red 600-700"), ("channelG", "green 500-600"), ("channelB", "blue 400-500")]
        {
            let wanted = format!("radiance {band} nm, W m-2 sr-1");
            let found = header.own_attributes.other.get(&Text::from(name));
            assert_eq!(found, Some(&AttributeValue::Text(Text::from(wanted.as_str()))), "{name}");
        }
    }

    /// An EXR says what it shows and on what assumptions.
    #[test]
    fn an_exr_holds_description_and_assumptions() {
        let (dark, flat) = (bands_sky(|_| 0.0), Horizon::flat());
        let raster = raster(&dark, &flat, Projection::Equirectangular, (64, 16), None).unwrap();
        let bytes = encode_exr(&raster, &Notes::new("a sky", r#"{"turbidity":2.5}"#)).unwrap();
        let header = &exr::meta::MetaData::read_from_buffered(Cursor::new(&bytes), false).unwrap().headers[0];
        let comments = header.own_attributes.comments.as_ref().map(Text::to_string);
        assert_eq!(comments, Some(format!("{}. a sky", samples_of(&raster))));
        let found = header.own_attributes.other.get(&Text::from("assumptions"));
        assert_eq!(found, Some(&AttributeValue::Text(Text::from(r#"{"turbidity":2.5}"#))));
    }

    /// The same raster gives the same bytes.
    #[test]
    fn an_exr_has_the_same_bytes_each_time() {
        let (dark, flat) = (bands_sky(|_| 0.0), Horizon::flat());
        let raster = raster(&dark, &flat, Projection::Fisheye, (40, 40), None).unwrap();
        let encode = || encode_exr(&raster, &Notes::new("a sky", r#"{"turbidity":2.5}"#)).unwrap();
        let first = encode();
        assert!((0..20).all(|_| encode() == first));
        assert_eq!(sort_attributes(&mut first[..100].to_vec()), None, "cut off");
    }

    /// An EXR of a fisheye has an alpha that says where sky is.
    #[test]
    fn a_fisheye_exr_has_sky_as_alpha() {
        let (dark, flat) = (bands_sky(|_| 0.0), Horizon::flat());
        let raster = raster(&dark, &flat, Projection::Fisheye, (40, 40), None).unwrap();
        let channels = channels(&encode_exr(&raster, &Notes::default()).unwrap());
        assert_eq!(channels[0].0, "A");
        for (pixel, alpha) in (0..).zip(&channels[0].1) {
            assert_eq!(*alpha == 1.0, raster.samples(pixel % 40, pixel / 40).is_some());
        }
        assert!(!raster.is_all_sky());
    }

    /// A response has a channel of its own, beside A where there is one.
    #[test]
    fn an_exr_holds_what_a_response_sees() {
        let mut responses = RGB_BANDS.to_vec();
        responses.push(Response::Scotopic);
        let count = responses.len() * AZIMUTH_COUNT * ELEVATION_COUNT;
        let seen = SeenSky::from_values(responses, (0..count).map(|i| i as f32).collect()).unwrap();
        let (flat, scotopic) = (Horizon::flat(), Response::Scotopic);
        for (projection, size, names) in [
            (Projection::Equirectangular, (256, 64), vec!["B", "G", "R", "scotopic"]),
            (Projection::Fisheye, (40, 40), vec!["A", "B", "G", "R", "scotopic"]),
        ] {
            let raster = raster(&seen, &flat, projection, size, Some(&scotopic)).unwrap();
            let channels = channels(&encode_exr(&raster, &Notes::default()).unwrap());
            assert_eq!(channels.iter().map(|c| c.0.as_str()).collect::<Vec<_>>(), names);
            let last = &channels.last().unwrap().1;
            for (pixel, value) in last.iter().enumerate() {
                let samples = raster.samples(pixel as u32 % size.0, pixel as u32 / size.0);
                assert_eq!(*value, samples.unwrap_or_default()[3]);
            }
        }
    }
}
