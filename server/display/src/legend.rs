//! Compass letters on the sky, and the strip below it that says what the colours mean.

use crate::{
    error::DisplayError,
    false_colour::ColourRange,
    notes::ILLUSTRATIVE,
    options::{PictureOptions, Projection, Sky, Style},
    projection::{COMPASS, View},
    realistic::{MIDDLE_GREY_LUMINANCE_CD_M2, camera_settings},
    text::{Align, Pen},
};
use image::{Rgb, RgbImage};
use skyglow_physics::{Direction, Response};

/// A picture with a legend is at least this wide, pixels.
pub const MIN_WIDTH_PX: u32 = 320;

/// Height of the strip below the sky, in pixels of a picture 1024 pixels wide.
const STRIP_HEIGHT: f32 = 58.0;
/// Height of a line of words below that.
const NOTE_HEIGHT: f32 = 18.0;
const LABEL_RGB: [u8; 3] = [225, 228, 233];

/// Size of everything in the legend, relative to a picture 1024 pixels wide.
fn scale(width_px: u32) -> f32 {
    (width_px as f32 / 1024.0).clamp(1.0, 3.0)
}

/// Height of the strip below the sky, pixels; it has a line more where the light is made up.
pub fn strip_height_px(width_px: u32, illustrative: bool) -> u32 {
    let height = if illustrative { STRIP_HEIGHT + NOTE_HEIGHT } else { STRIP_HEIGHT };
    (height * scale(width_px)).round() as u32
}

/// Draws the compass letters where the directions are seen on the horizon (a little inside on the fisheye).
pub(crate) fn draw_compass(
    canvas: &mut RgbImage,
    options: &PictureOptions,
    view: &View,
    offset_px: u32,
) -> Result<(), DisplayError> {
    let scale = scale(options.width_px);
    for (index, (letters, azimuth_rad)) in COMPASS.into_iter().enumerate() {
        let main = index < 4;
        if !main && options.width_px < 300 {
            continue;
        }
        let pen = Pen::new(if main { 17.0 } else { 12.0 } * scale)?;
        let elevation_rad = match options.projection {
            Projection::Fisheye => 4f64.to_radians(),
            _ => 0.0,
        };
        let Some((x, y)) = view.position_px(Direction { azimuth_rad, elevation_rad }) else { continue };
        let (x, y) = (x as f32 + offset_px as f32, y as f32);
        let line_px = if main { 17.0 } else { 12.0 } * scale;
        if options.projection == Projection::Fisheye {
            pen.draw_with_rim(canvas, letters, (x, y - 0.5 * line_px));
            continue;
        }
        // A mark on the horizon, the letters above it.
        for step in 0..(4.0 * scale) as u32 {
            let (mark_x, mark_y) = (x as u32, (y as u32).saturating_sub(1 + step));
            if mark_x < canvas.width() && mark_y < options.height_px {
                canvas.put_pixel(mark_x, mark_y, Rgb([255; 3]));
            }
        }
        pen.draw_with_rim(canvas, letters, (x, y - line_px - 6.0 * scale));
        if options.projection == Projection::Equirectangular && letters == "N" {
            // North again where the picture closes.
            let right = (offset_px + options.width_px) as f32;
            pen.draw_with_rim(canvas, letters, (right, y - line_px - 6.0 * scale));
        }
    }
    Ok(())
}

/// What a picture shows that its colours do not reach.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Beyond {
    /// Something is darker than the dark end.
    pub(crate) below: bool,
    /// Something is brighter than the bright end.
    pub(crate) above: bool,
}

impl Beyond {
    /// Looks at one luminance.
    #[inline(always)]
    pub(crate) fn note(&mut self, luminance_cd_m2: f64, (dark, bright): (f64, f64)) {
        self.below |= luminance_cd_m2 < dark;
        self.above |= luminance_cd_m2 > bright;
    }
}

/// Draws the strip below the sky: colour bar with both units, or the exposure.
pub(crate) fn draw_strip(
    canvas: &mut RgbImage,
    options: &PictureOptions,
    response: &Response,
    beyond: Beyond,
) -> Result<(), DisplayError> {
    if options.illustrative {
        let scale = scale(options.width_px);
        let top = options.height_px as f32 + STRIP_HEIGHT * scale;
        let middle = 0.5 * canvas.width() as f32;
        Pen::new(12.0 * scale)?.draw(canvas, ILLUSTRATIVE, (middle, top), Align::Centre, LABEL_RGB);
    }
    match options.style {
        Style::FalseColour { colormap, range } => {
            draw_bar(canvas, options, (range, response), beyond, |t| colormap.rgb(t))
        }
        Style::Eye { exposure_ev, adaptation_cd_m2 } => {
            let scale = scale(options.width_px);
            let pen = Pen::new(13.0 * scale)?;
            let top = options.height_px as f32;
            let shift = if exposure_ev == 0.0 { String::new() } else { format!(", {exposure_ev:+.1} EV") };
            let adapted =
                adaptation_cd_m2.map_or(String::new(), |cd_m2| format!(", adapted to {cd_m2:.2e} cd/m²"));
            let words = format!("as the eye sees it{adapted}{shift}");
            pen.draw(canvas, &words, (10.0 * scale, top + 10.0 * scale), Align::Left, LABEL_RGB);
            pen.draw(canvas, light(options.sky), (10.0 * scale, top + 32.0 * scale), Align::Left, LABEL_RGB);
            Ok(())
        }
        Style::Realistic { exposure_ev } => {
            let scale = scale(options.width_px);
            let pen = Pen::new(13.0 * scale)?;
            let grey = MIDDLE_GREY_LUMINANCE_CD_M2 / exposure_ev.exp2();
            let left = 10.0 * scale;
            let top = options.height_px as f32;
            let settings = format!("exposure {exposure_ev:+.1} EV, as {}", camera_settings(exposure_ev));
            let more = format!("{settings}: middle grey is {grey:.2e} cd/m²");
            let fits = left + pen.width_px(&more) < canvas.width() as f32;
            let exposure = if fits { more } else { settings };
            pen.draw(canvas, &exposure, (left, top + 10.0 * scale), Align::Left, LABEL_RGB);
            pen.draw(canvas, light(options.sky), (left, top + 32.0 * scale), Align::Left, LABEL_RGB);
            Ok(())
        }
    }
}

/// What light a picture shows, in words.
fn light(sky: Sky) -> &'static str {
    match sky {
        Sky::Artificial => "artificial light alone",
        Sky::Total => "with the natural sky",
        Sky::TotalOfInstant => "with the natural sky of the time",
    }
}

/// The colour bar: mag/arcsec² above, where the response has magnitudes, and its unit below; a tip at an end beyond which the sky goes.
fn draw_bar(
    canvas: &mut RgbImage,
    options: &PictureOptions,
    (range, response): (ColourRange, &Response),
    beyond: Beyond,
    colour: impl Fn(f64) -> [u8; 3],
) -> Result<(), DisplayError> {
    let scale = scale(options.width_px);
    let pen = Pen::new(13.0 * scale)?;
    let top = options.height_px as f32;
    let (upper_unit, lower_unit) = ("mag/arcsec²", unit_shown(response));
    let left = 16.0 * scale;
    let right = canvas.width() as f32 - pen.width_px(upper_unit) - 40.0 * scale;
    let (bar_top, bar_bottom) = (top + 22.0 * scale, top + 36.0 * scale);
    let length = right - left;
    for x in left as u32..right as u32 {
        let rgb = colour(f64::from((x as f32 + 0.5 - left) / length));
        for y in bar_top as u32..bar_bottom as u32 {
            canvas.put_pixel(x, y, Rgb(rgb));
        }
    }
    let middle = 0.5 * (bar_top as u32 + bar_bottom as u32) as f32;
    let half_height = 0.5 * (bar_bottom as u32 - bar_top as u32) as f32;
    for (is_there, base, outwards, end) in [(beyond.below, left, -1.0, 0.0), (beyond.above, right, 1.0, 1.0)]
    {
        if is_there {
            let length = 10.0 * scale;
            draw_tip(
                canvas,
                (base + outwards * TIP_GAP_PX * scale, middle),
                (outwards * length, half_height),
                colour(end),
            );
        }
    }
    let unit_x = right + 30.0 * scale;
    if response.has_magnitude() {
        pen.draw(canvas, upper_unit, (unit_x, top + 3.0 * scale), Align::Left, LABEL_RGB);
    }
    pen.draw(canvas, lower_unit, (unit_x, bar_bottom + 4.0 * scale), Align::Left, LABEL_RGB);
    if options.width_px >= 640 {
        let note = Pen::new(10.0 * scale)?;
        let light = if options.sky == Sky::Artificial { "artificial" } else { "total" };
        let words = match response {
            Response::Photopic => light.to_owned(),
            other => format!("{light}, {}", other.name()),
        };
        let note_x = unit_x.min(canvas.width() as f32 - note.width_px(&words) - 4.0 * scale);
        note.draw(canvas, &words, (note_x, bar_top + 1.0 * scale), Align::Left, LABEL_RGB);
    }

    let mut mark = |position: f64, label: &str, above: bool| {
        let x = left + length * position as f32;
        let pixel_x = (x as u32).clamp(left as u32, right as u32 - 1);
        let mark_px = (3.0 * scale) as u32;
        for step in 0..mark_px {
            let y = if above { bar_top as u32 - 1 - step } else { bar_bottom as u32 + step };
            canvas.put_pixel(pixel_x, y, Rgb(LABEL_RGB));
        }
        let text_top = if above { top + 3.0 * scale } else { bar_bottom + 4.0 * scale };
        pen.draw(canvas, label, (x, text_top), Align::Centre, LABEL_RGB);
    };
    let (faint, bright) = range.brightness_ends_mag_arcsec2();
    let magnitudes = round_steps(bright, faint, f64::from(length) / f64::from(52.0 * scale));
    for magnitude in magnitudes.into_iter().filter(|_| response.has_magnitude()) {
        mark((faint - magnitude) / (faint - bright), &trimmed(magnitude), true);
    }
    let (low, high) = range.luminance_ends_cd_m2();
    for luminance in luminance_marks_cd_m2(low, high, f64::from(length) / f64::from(64.0 * scale)) {
        mark(range.position(luminance), &power_label(luminance), false);
    }
    Ok(())
}

/// The unit of a response as it is written for people.
fn unit_shown(response: &Response) -> &'static str {
    match response.unit() {
        "cd m-2" => "cd/m²",
        "nW cm-2 sr-1" => "nW/cm²/sr",
        _ => "W/m²/sr",
    }
}

/// Room between the bar and a tip.
const TIP_GAP_PX: f32 = 2.0;

/// A triangle that points to one side: the colour of what lies beyond, with a rim that shows on any ground.
fn draw_tip(
    canvas: &mut RgbImage,
    (base_x, middle_y): (f32, f32),
    (length, half_height): (f32, f32),
    colour: [u8; 3],
) {
    let steps = length.abs().ceil() as u32;
    for step in 0..steps {
        let x = base_x + length.signum() * (step as f32 + 0.5);
        let reach = half_height * (1.0 - (step as f32 + 0.5) / length.abs()).max(0.0);
        for y in (middle_y - reach).floor() as u32..(middle_y + reach).ceil() as u32 {
            let from_rim = reach - (y as f32 + 0.5 - middle_y).abs();
            let rgb = if step == 0 || from_rim < 1.0 { LABEL_RGB } else { colour };
            if x >= 0.0 && (x as u32) < canvas.width() && y < canvas.height() {
                canvas.put_pixel(x as u32, y, Rgb(rgb));
            }
        }
    }
}

/// Round numbers from `low` to `high`, at most about `count` of them.
fn round_steps(low: f64, high: f64, count: f64) -> Vec<f64> {
    let wanted = (high - low) / count.max(1.0);
    let decade = 10f64.powf(wanted.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * decade).into_iter().find(|&s| s >= wanted).unwrap_or(wanted);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

/// Luminances for marks: powers of ten, with 2 and 5 between them where there is room.
fn luminance_marks_cd_m2(low: f64, high: f64, count: f64) -> Vec<f64> {
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let decades = (high / low).log10();
    let mantissas: &[f64] = if 3.0 * decades <= count { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let every = (decades / count).ceil().max(1.0) as i32;
    let inside = |value: &f64| *value >= low * (1.0 - 1e-9) && *value <= high * (1.0 + 1e-9);
    (first..=last)
        .filter(|exponent| exponent.rem_euclid(every) == 0)
        .flat_map(|exponent| mantissas.iter().map(move |m| m * 10f64.powi(exponent)))
        .filter(inside)
        .collect()
}

/// A number without needless digits.
fn trimmed(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// `10⁻⁴`, `2·10⁻³`; plain digits from 0.01 to 1000.
fn power_label(value: f64) -> String {
    if (0.0099..1001.0).contains(&value) {
        return trimmed(value);
    }
    let exponent = (value.log10() + 1e-9).floor() as i32;
    let mantissa = (value / 10f64.powi(exponent)).round() as i32;
    let digits: String = exponent
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            other => other.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(other),
        })
        .collect();
    if mantissa == 1 { format!("10{digits}") } else { format!("{mantissa}·10{digits}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Colormap, DisplayError, fixtures::grey_sky};
    use skyglow_physics::{Horizon, SeenSky};

    fn picture(sky: &SeenSky, horizon: &Horizon, options: &PictureOptions) -> Result<RgbImage, DisplayError> {
        crate::picture(sky, &Response::Photopic, horizon, options)
    }

    #[test]
    fn labels_are_short_and_right() {
        assert_eq!(power_label(1e-4), "10⁻⁴");
        assert_eq!(power_label(2e-3), "2·10⁻³");
        assert_eq!(power_label(0.1), "0.1");
        assert_eq!(power_label(1e-10), "10⁻¹⁰");
        assert_eq!(trimmed(22.0), "22");
        assert_eq!(trimmed(21.5), "21.5");
        assert_eq!(round_steps(15.0, 25.0, 12.0), (15..=25).map(f64::from).collect::<Vec<_>>());
        assert_eq!(round_steps(15.0, 25.0, 5.0), vec![16.0, 18.0, 20.0, 22.0, 24.0]);
    }

    /// The legend is below the sky runs through the colour map and leaves the sky its size.
    #[test]
    fn the_legend_is_below_and_shows_the_map() {
        let panorama = grey_sky(|_, _| 0.0);
        let with = PictureOptions::new(Projection::Equirectangular);
        let without = PictureOptions { legend: false, ..with };
        let (a, b) = (
            picture(&panorama, &Horizon::flat(), &with).unwrap(),
            picture(&panorama, &Horizon::flat(), &without).unwrap(),
        );
        assert_eq!((b.width(), b.height()), (1024, 256));
        assert_eq!((a.width(), a.height()), (1024, 256 + strip_height_px(1024, false)));
        // Along the bar's middle, the first and last colours are the ends of the map.
        let y = 256 + 29;
        let row: Vec<[u8; 3]> = (0..1024).map(|x| a.get_pixel(x, y).0).collect();
        let near = |end: f64| {
            let wanted = Colormap::Inferno.rgb(end);
            row.iter().any(|rgb| (0..3).all(|i| rgb[i].abs_diff(wanted[i]) <= 3))
        };
        for position in [0.0, 0.25, 0.5, 0.75, 1.0] {
            assert!(near(position), "{position}");
        }
        // Labels above and below the bar leave ink.
        let ink = |from: u32, to: u32| {
            (from..to)
                .flat_map(|y| (0..1024).map(move |x| (x, y)))
                .filter(|&(x, y)| a.get_pixel(x, y).0[0] > 140)
                .count()
        };
        assert!(ink(256 + 3, 256 + 19) > 100);
        assert!(ink(256 + 40, 256 + 56) > 100);
        // Compass letters: white ink on a dark sky.
        assert!(ink(220, 256) > 100);
    }

    /// The bar has a tip at an end beyond which the sky goes and at no other.
    #[test]
    fn the_bar_has_tips_only_beyond_the_range() {
        let options =
            PictureOptions { sky: Sky::Artificial, ..PictureOptions::new(Projection::Equirectangular) };
        // Light ink beside the bar, in its height: nothing else is drawn there but the word at its right.
        let tips = |luminance_cd_m2: f64| {
            let panorama = grey_sky(|_, _| luminance_cd_m2);
            let image = picture(&panorama, &Horizon::flat(), &options).unwrap();
            let bar: Vec<u32> =
                (0..1024).filter(|&x| image.get_pixel(x, 256 + 29).0 == Colormap::Inferno.rgb(0.5)).collect();
            assert!(!bar.is_empty());
            let is_ink = |x: u32| (256 + 22..256 + 36).any(|y| image.get_pixel(x, y).0 == LABEL_RGB);
            let right = (1024.0 - Pen::new(13.0).unwrap().width_px("mag/arcsec²") - 40.0) as u32;
            ((2..14).any(is_ink), (right + 2..right + 14).any(is_ink))
        };
        assert_eq!(tips(1e-6), (true, false));
        assert_eq!(tips(1e-3), (false, false));
        assert_eq!(tips(1.0), (false, true));
    }

    /// What the dark-adapted eye sees has no magnitudes, and the legend says who sees.
    #[test]
    fn scotopic_legends_have_no_magnitudes() {
        let sky = grey_sky(|_, _| 1e-3);
        let options = PictureOptions::new(Projection::Equirectangular);
        let ink = |response: &Response| {
            let image = crate::picture(&sky, response, &Horizon::flat(), &options).unwrap();
            let lit = |x: u32, y: u32| image.get_pixel(x, y).0[0] > 140;
            (256 + 3..256 + 19)
                .flat_map(|y| (0..1024).map(move |x| (x, y)))
                .filter(|&(x, y)| lit(x, y))
                .count()
        };
        assert!(ink(&Response::Photopic) > 100);
        assert_eq!(ink(&Response::Scotopic), 0);
        let unseen = crate::picture(&sky, &Response::Sqm, &Horizon::flat(), &options);
        assert!(matches!(unseen, Err(DisplayError::NotSeen { response: "sqm" })));
    }

    /// The legend of made-up light has a line that says so and no other legend has.
    #[test]
    fn only_synthetic_light_is_labelled_so() {
        for (width_px, height_px) in [(1024, 256), (64, 64), (2048, 512)] {
            for style in [Style::default(), Style::Realistic { exposure_ev: 0.0 }] {
                let measured = PictureOptions {
                    width_px,
                    height_px,
                    style,
                    ..PictureOptions::new(Projection::Equirectangular)
                };
                let invented = PictureOptions { illustrative: true, ..measured };
                let draw = |options| picture(&grey_sky(|_, _| 0.0), &Horizon::flat(), options).unwrap();
                let (plain, noted) = (draw(&measured), draw(&invented));
                let line_px = noted.height() - plain.height();
                assert!(line_px >= 18, "{line_px}");
                // All above the line is the same; in the line is ink, and none of it is cut off at the sides.
                assert!(plain.enumerate_pixels().all(|(x, y, pixel)| noted.get_pixel(x, y) == pixel));
                let is_ink = |x: u32, y: u32| noted.get_pixel(x, y).0[0] > 140;
                let ink: Vec<u32> = (plain.height()..noted.height())
                    .flat_map(|y| (0..noted.width()).filter(move |&x| is_ink(x, y)))
                    .collect();
                assert!(ink.len() > 200, "{}", ink.len());
                let (first, last) = (ink.iter().min().unwrap(), ink.iter().max().unwrap());
                assert!(*first >= 3 && *last + 3 < noted.width(), "{first} {last}");
            }
        }
    }

    #[test]
    fn a_tiny_picture_still_has_room_for_its_legend() {
        let options =
            PictureOptions { width_px: 64, height_px: 64, ..PictureOptions::new(Projection::Fisheye) };
        let image = picture(&grey_sky(|_, _| 0.0), &Horizon::flat(), &options).unwrap();
        assert_eq!(image.width(), MIN_WIDTH_PX);
    }
}
