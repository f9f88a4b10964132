//! Pictures for screens that go above white: perceptual quantizer (PQ; SMPTE ST 2084, ITU-R BT.2100-2) in the primaries of BT.2020.
//!
//! White of a picture for every screen is [`SDR_WHITE_CD_M2`]; stars, planets, Moon, Sun and lamps go up to [`PEAK_CD_M2`], the sky does
//! not. Luminances are those that a screen shows: a rendering, never those of the sky.

use crate::{
    bodies::SkyBodies,
    error::DisplayError,
    ink::Ink,
    options::PictureOptions,
    picture::{GROUND_RGB, Given, canvas_size_px, decorate, draw_sky},
    realistic::{SrgbBytes, decode_srgb},
};
use image::{Rgb, RgbImage};
use skyglow_physics::{Horizon, LitGround, Response, SeenSky};

/// White of a picture for every screen, cd m⁻² (ITU-R BT.2408-8, HDR reference white).
pub const SDR_WHITE_CD_M2: f64 = 203.0;
/// The brightest light of a picture, cd m⁻²: what screens that go above white commonly reach.
pub const PEAK_CD_M2: f64 = 1000.0;
/// What the perceptual quantizer has for 1, cd m⁻².
pub const PQ_FULL_CD_M2: f64 = 10_000.0;
/// Bits of a sample that count: with 12 no step is seen (ITU-R BT.2100-2), and files are a third smaller than with 16.
pub const SIGNIFICANT_BITS: u32 = 12;

/// Constants of the perceptual quantizer (ITU-R BT.2100-2, table 4).
const M1: f64 = 2610.0 / 16_384.0;
const M2: f64 = 2523.0 / 4096.0 * 128.0;
const C1: f64 = 3424.0 / 4096.0;
const C2: f64 = 2413.0 / 4096.0 * 32.0;
const C3: f64 = 2392.0 / 4096.0 * 32.0;

/// Linear BT.2020 of linear BT.709, whose primaries sRGB has (ITU-R BT.2087-0).
const BT2020_FROM_BT709: [[f64; 3]; 3] =
    [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]];

/// A luminance in the perceptual quantizer, 0..=1: its inverse electro-optical transfer function.
pub fn pq(luminance_cd_m2: f64) -> f64 {
    let power = (luminance_cd_m2 / PQ_FULL_CD_M2).clamp(0.0, 1.0).powf(M1);
    ((C1 + C2 * power) / (1.0 + C3 * power)).powf(M2)
}

/// The luminance of a sample, cd m⁻²: the quantizer's electro-optical transfer function.
pub fn luminance_cd_m2(sample: u16) -> f64 {
    let power = (f64::from(sample) / f64::from(u16::MAX)).powf(1.0 / M2);
    PQ_FULL_CD_M2 * ((power - C1).max(0.0) / (C2 - C3 * power)).powf(1.0 / M1)
}

/// A picture of 16-bit samples R, G, B in the perceptual quantizer and the primaries of BT.2020.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HdrImage {
    /// Width, pixels.
    pub width_px: u32,
    /// Height, pixels.
    pub height_px: u32,
    pixels: Vec<[u16; 3]>,
}

impl HdrImage {
    /// Samples of a pixel.
    ///
    /// # Panics
    /// Outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [u16; 3] {
        self.pixels[(y * self.width_px + x) as usize]
    }

    /// Rows from the top.
    pub fn pixels(&self) -> &[[u16; 3]] {
        &self.pixels
    }

    #[cfg(test)]
    pub(crate) fn from_fn(width_px: u32, height_px: u32, pixel: impl Fn(u32, u32) -> [u16; 3]) -> Self {
        let pixels = (0..height_px).flat_map(|y| (0..width_px).map(move |x| (x, y)));
        Self { width_px, height_px, pixels: pixels.map(|(x, y)| pixel(x, y)).collect() }
    }
}

/// The picture of [`crate::picture_with`] for screens that go above white.
///
/// # Errors
/// [`DisplayError`] naming the first option out of its range.
pub fn hdr_picture_with(
    bodies: &SkyBodies,
    ground_light: Option<&LitGround>,
    seen: &SeenSky,
    response: &Response,
    horizon: &Horizon,
    options: &PictureOptions,
) -> Result<HdrImage, DisplayError> {
    let (width_px, height_px) = canvas_size_px(options);
    let mut pixels = vec![HdrInk::of_bytes(GROUND_RGB); width_px as usize * height_px as usize];
    let given = Given { bodies, ground_light, seen, response, horizon, options };
    let drawn = draw_sky(&given, &mut pixels)?;
    // Letters and lines are drawn over bytes, and taken from there.
    let mut canvas =
        RgbImage::from_fn(width_px, height_px, |x, y| Rgb(pixels[(y * width_px + x) as usize].rgb));
    decorate(&mut canvas, drawn, &given)?;
    let pixels = pixels
        .iter()
        .zip(canvas.pixels())
        .map(|(ink, shown)| if shown.0 == ink.rgb { ink.pq } else { HdrInk::of_bytes(shown.0).pq });
    Ok(HdrImage { width_px, height_px, pixels: pixels.collect() })
}

/// A pixel for screens that go above white, and for every screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct HdrInk {
    pq: [u16; 3],
    rgb: [u8; 3],
}

impl HdrInk {
    /// Of linear sRGB of parts of [`SDR_WHITE_CD_M2`].
    fn samples(linear: [f64; 3]) -> [u16; 3] {
        BT2020_FROM_BT709.map(|row| {
            let channel: f64 = row.iter().zip(linear).map(|(m, value)| m * value).sum();
            sample(pq(channel * SDR_WHITE_CD_M2))
        })
    }
}

/// A part of 1 to the bits that count, repeated below them as ISO/IEC 15948 scales samples.
fn sample(part: f64) -> u16 {
    let counted = (part * f64::from((1u32 << SIGNIFICANT_BITS) - 1)).round() as u16;
    (counted << (16 - SIGNIFICANT_BITS)) | (counted >> (2 * SIGNIFICANT_BITS - 16))
}

impl Ink for HdrInk {
    /// Lights go above white as far as they outshine what is behind them, and as they near white themselves.
    fn of(linear: [f64; 3], lights: f64, bytes: &SrgbBytes) -> Self {
        let brightest = linear.iter().copied().fold(0.0, f64::max);
        let gain = 1.0 + (PEAK_CD_M2 / SDR_WHITE_CD_M2 - 1.0) * lights * brightest;
        Self {
            pq: Self::samples(linear.map(|channel| channel * gain)),
            rgb: linear.map(|channel| bytes.of(channel)),
        }
    }

    fn of_bytes(rgb: [u8; 3]) -> Self {
        Self { pq: Self::samples(rgb.map(|byte| decode_srgb(f64::from(byte) / 255.0))), rgb }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Disc, PointLight, Projection, Style, fixtures::grey_sky, picture_with, projection::View};
    use skyglow_physics::Direction;

    /// Published values: signals of 100, 203, 1 000, 4 000 and 10 000 cd/m² (ITU-R BT.2408-8 has 51, 58, 75, 90 and 100 %).
    #[test]
    fn the_quantizer_has_its_published_values() {
        for (light, signal) in [
            (0.0, 0.0),
            (100.0, 0.5081),
            (203.0, 0.5807),
            (1_000.0, 0.7518),
            (4_000.0, 0.9026),
            (10_000.0, 1.0),
        ] {
            assert!((pq(light) - signal).abs() < 1e-4, "{light}: {}", pq(light));
        }
        for light in [0.05, 1.0, 60.0, 203.0, 999.0] {
            let back = luminance_cd_m2(sample(pq(light)));
            assert!((back / light - 1.0).abs() < 0.01, "{light}: {back}");
        }
        assert_eq!((sample(0.0), sample(1.0)), (0, u16::MAX));
    }

    /// White is 203 cd/m² in every channel, and the lights' white the peak.
    #[test]
    fn white_is_203_and_lights_are_brighter() {
        let bytes = SrgbBytes::default();
        for (lights, wanted) in [(0.0, SDR_WHITE_CD_M2), (1.0, PEAK_CD_M2), (0.5, 601.5)] {
            let ink = HdrInk::of([1.0; 3], lights, &bytes);
            assert_eq!(ink.rgb, [255; 3]);
            for sample in ink.pq {
                let found = luminance_cd_m2(sample);
                assert!((found / wanted - 1.0).abs() < 0.01, "{lights}: {found}");
            }
        }
        assert_eq!(HdrInk::of_bytes([255; 3]).pq, HdrInk::of([1.0; 3], 0.0, &bytes).pq);
        // Red of sRGB is inside BT.2020.
        let [red, green, blue] = HdrInk::of_bytes([255, 0, 0]).pq.map(luminance_cd_m2);
        assert!((red / 127.4 - 1.0).abs() < 0.01 && (green / 14.0 - 1.0).abs() < 0.02 && blue > 2.0, "{red}");
    }

    fn looking(azimuth_deg: f64, elevation_deg: f64) -> Direction {
        Direction { azimuth_rad: azimuth_deg.to_radians(), elevation_rad: elevation_deg.to_radians() }
    }

    /// The Moon and a bright star go above white in both styles, the sky around them has the picture's own colours.
    #[test]
    fn moon_and_stars_alone_go_above_white() {
        let (moon_at, star_at) = (looking(90.0, 30.0), looking(70.0, 20.0));
        let moon = Disc {
            direction: moon_at,
            radius_rad: 0.26f64.to_radians(),
            lit_cd_m2: [2.4e3, 2.5e3, 2.6e3, 6e3],
            dark_cd_m2: [0.0; 4],
            lit_share: 1.0,
            bright_limb_rad: 0.0,
        };
        let star = PointLight {
            direction: star_at,
            illuminance_lx: [2.5e-6, 2.54e-6, 2.8e-6, 5.8e-6],
            limit_mag: 0.0,
        };
        let bodies = SkyBodies { points: vec![star], discs: vec![moon] };
        let sky = grey_sky(|_, _| 1e-3);
        let projection = Projection::Perspective { azimuth_deg: 85.0, elevation_deg: 25.0, fov_deg: 40.0 };
        for style in [
            Style::Eye { exposure_ev: 0.0, adaptation_cd_m2: Some(1e-3) },
            Style::Realistic { exposure_ev: 0.0 },
        ] {
            let options = PictureOptions { style, ..PictureOptions::new(projection) };
            let (photopic, flat) = (Response::Photopic, Horizon::flat());
            let high = hdr_picture_with(&bodies, None, &sky, &photopic, &flat, &options).unwrap();
            let standard = picture_with(&bodies, None, &sky, &photopic, &flat, &options).unwrap();
            assert_eq!((high.width_px, high.height_px), standard.dimensions());
            let view = View::new(projection, options.width_px, options.height_px);
            let at = |direction| {
                let (x, y) = view.position_px(direction).unwrap();
                (high.pixel(x as u32, y as u32), standard.get_pixel(x as u32, y as u32).0)
            };
            let [moon, star] = [moon_at, star_at].map(|of| luminance_cd_m2(at(of).0[1]));
            // A dazzled eye sees even the Moon short of white.
            assert!((800.0..1010.0).contains(&moon), "{moon}");
            assert!(star > SDR_WHITE_CD_M2 && star < moon + 10.0, "{star}");
            let lights = |x: u32, y: u32| {
                let near = |of| view.position_px(of).map(|(a, b)| (a - f64::from(x)).hypot(b - f64::from(y)));
                [moon_at, star_at].into_iter().filter_map(near).any(|away| away < 40.0)
            };
            // Elsewhere samples are those of the bytes, but for what bytes round.
            for (x, y, pixel) in standard.enumerate_pixels().filter(|(x, y, _)| !lights(*x, *y)) {
                let (of_bytes, found) = (HdrInk::of_bytes(pixel.0).pq, high.pixel(x, y));
                let close = (0..3).all(|i| f64::from(of_bytes[i].abs_diff(found[i])) < 0.02 * 65_535.0);
                assert!(close, "{x} {y}: {found:?}, {of_bytes:?}");
            }
        }
    }
}
