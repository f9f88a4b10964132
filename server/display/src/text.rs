//! Text on pictures, in the Hack typeface (MIT and Bitstream Vera licences).

use crate::error::DisplayError;
use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use image::{Rgb, RgbImage};
use std::sync::OnceLock;

/// Where a text's reference point lies in it, horizontally.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Align {
    /// The text starts there.
    Left,
    /// The text is centred there.
    Centre,
}

/// A typeface at one size.
pub(crate) struct Pen {
    font: &'static FontRef<'static>,
    size_px: f32,
}

impl Pen {
    /// The typeface with lines `size_px` high.
    pub(crate) fn new(size_px: f32) -> Result<Self, DisplayError> {
        static FONT: OnceLock<Option<FontRef<'static>>> = OnceLock::new();
        let font = FONT
            .get_or_init(|| FontRef::try_from_slice(epaint_default_fonts::HACK_REGULAR).ok())
            .as_ref()
            .ok_or_else(|| DisplayError::encoding("text", "the embedded typeface is unreadable"))?;
        Ok(Self { font, size_px })
    }

    /// Width of a text, pixels.
    pub(crate) fn width_px(&self, text: &str) -> f32 {
        let font = self.font.as_scaled(PxScale::from(self.size_px));
        text.chars().map(|c| font.h_advance(font.glyph_id(c))).sum()
    }

    /// Whether the typeface has every character.
    #[cfg(test)]
    pub(crate) fn has(&self, text: &str) -> bool {
        text.chars().all(|c| self.font.glyph_id(c).0 != 0)
    }

    /// Draws `text` with its upper edge at `top_px`, kept inside the picture's width.
    pub(crate) fn draw(
        &self,
        picture: &mut RgbImage,
        text: &str,
        place_px: (f32, f32),
        align: Align,
        colour: [u8; 3],
    ) {
        stamp(picture, &self.ink(picture.width(), text, place_px, align), (0, 0), colour);
    }

    /// The same with a dark rim, readable on any sky.
    pub(crate) fn draw_with_rim(&self, picture: &mut RgbImage, text: &str, centre_top_px: (f32, f32)) {
        let ink = self.ink(picture.width(), text, centre_top_px, Align::Centre);
        for offset in [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, 1), (-1, 1), (1, -1)] {
            stamp(picture, &ink, offset, [0, 0, 0]);
        }
        stamp(picture, &ink, (0, 0), [255, 255, 255]);
    }

    /// The pixels of a text in a picture `width_px` wide.
    fn ink(&self, width_px: u32, text: &str, (x_px, top_px): (f32, f32), align: Align) -> Vec<Ink> {
        let font = self.font.as_scaled(PxScale::from(self.size_px));
        let text_px = self.width_px(text);
        let start_px = if align == Align::Centre { x_px - 0.5 * text_px } else { x_px };
        let mut pen_px = start_px.min(width_px as f32 - text_px - 1.0).max(1.0);
        let mut ink = Vec::new();
        for character in text.chars() {
            let id = font.glyph_id(character);
            let glyph = id.with_scale_and_position(self.size_px, point(pen_px, top_px + font.ascent()));
            pen_px += font.h_advance(id);
            let Some(outline) = self.font.outline_glyph(glyph) else { continue };
            let origin = outline.px_bounds().min;
            outline.draw(|dx, dy, coverage| {
                if coverage > 0.0 {
                    let (x, y) = (origin.x as i32 + dx as i32, origin.y as i32 + dy as i32);
                    ink.push(Ink { x, y, coverage: coverage.min(1.0) });
                }
            });
        }
        ink
    }
}

/// How much of a pixel a text covers.
struct Ink {
    x: i32,
    y: i32,
    coverage: f32,
}

/// Draws ink with an offset; what lies beside the picture is left out.
fn stamp(picture: &mut RgbImage, ink: &[Ink], (right, down): (i32, i32), colour: [u8; 3]) {
    for &Ink { x, y, coverage } in ink {
        let place = u32::try_from(x + right).ok().zip(u32::try_from(y + down).ok());
        if let Some(pixel) = place.and_then(|(x, y)| picture.get_pixel_mut_checked(x, y)) {
            *pixel = Rgb(std::array::from_fn(|i| {
                let (below, above) = (f32::from(pixel.0[i]), f32::from(colour[i]));
                (below + (above - below) * coverage + 0.5) as u8
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The typeface has every character that legends use.
    #[test]
    fn the_typeface_has_every_legend_character() {
        let pen = Pen::new(13.0).unwrap();
        assert!(pen.has("0123456789.+-−NESW mag/arcsec² cd/m² 10⁰¹²³⁴⁵⁶⁷⁸⁹⁻ EV"));
    }

    /// Text leaves ink where it is drawn and nowhere else.
    #[test]
    fn text_leaves_ink_only_where_it_is_drawn() {
        let mut picture = RgbImage::new(80, 40);
        Pen::new(14.0).unwrap().draw(&mut picture, "N", (40.0, 10.0), Align::Centre, [255; 3]);
        let ink: Vec<(u32, u32)> =
            picture.enumerate_pixels().filter(|(_, _, p)| p.0[0] > 128).map(|(x, y, _)| (x, y)).collect();
        assert!(ink.len() > 10);
        assert!(ink.iter().all(|&(x, y)| (34..=46).contains(&x) && (10..=25).contains(&y)), "{ink:?}");
    }
}
