//! Pictures for eyes.

use crate::{
    bodies::{BodyRows, SkyBodies},
    colormap::TABLE_LEN,
    error::DisplayError,
    eye::Seen,
    ground::{GroundMap, Shown, TERRAIN_RGB},
    ink::Ink,
    legend::{self, Beyond},
    lit::LitPicture,
    options::{PictureOptions, Projection},
    painter::Painter,
    panels::{Columns, Row},
    projection::View,
};
use image::{Rgb, RgbImage};
use rayon::prelude::*;
use skyglow_physics::{Direction, Horizon, LitGround, Response, SeenSky};

/// What is neither sky nor ground that hides it: below an open horizon, the corners of a fisheye, the legend's strip.
pub const GROUND_RGB: [u8; 3] = [22, 24, 29];

/// The picture of a sky as a response sees it, or the light-adapted eye in realistic colours: `options.width_px` × `options.height_px` of sky, with the legend's strip below
/// it where one is asked for (the canvas is then at least [`legend::MIN_WIDTH_PX`] wide). Below `horizon` the
/// ground is drawn, by the profile itself and not by the panorama's rows.
///
/// # Errors
/// [`DisplayError`] naming the first option out of its range.
pub fn picture(
    seen: &SeenSky,
    response: &Response,
    horizon: &Horizon,
    options: &PictureOptions,
) -> Result<RgbImage, DisplayError> {
    picture_with(&SkyBodies::default(), None, seen, response, horizon, options)
}

/// [`picture`] with stars, planets, Moon and Sun before the sky, and ground in light, in the styles of the eye and the camera.
///
/// # Errors
/// [`DisplayError`] naming the first option out of its range.
pub fn picture_with(
    bodies: &SkyBodies,
    ground_light: Option<&LitGround>,
    seen: &SeenSky,
    response: &Response,
    horizon: &Horizon,
    options: &PictureOptions,
) -> Result<RgbImage, DisplayError> {
    let (width_px, height_px) = canvas_size_px(options);
    let mut canvas = RgbImage::from_pixel(width_px, height_px, Rgb(GROUND_RGB));
    let given = Given { bodies, ground_light, seen, response, horizon, options };
    let (pixels, _) = canvas.as_flat_samples_mut().samples.as_chunks_mut::<3>();
    let drawn = draw_sky(&given, pixels)?;
    decorate(&mut canvas, drawn, &given)?;
    Ok(canvas)
}

/// What a picture is made of.
pub(crate) struct Given<'a> {
    pub(crate) bodies: &'a SkyBodies,
    pub(crate) ground_light: Option<&'a LitGround>,
    pub(crate) seen: &'a SeenSky,
    pub(crate) response: &'a Response,
    pub(crate) horizon: &'a Horizon,
    pub(crate) options: &'a PictureOptions,
}

/// What is known of a sky that was drawn.
pub(crate) struct Drawn<'a> {
    ground: GroundMap<'a>,
    beyond: Beyond,
    view: View,
    has_skyline: bool,
}

/// Draws sky and ground into the pixels of a canvas, row by row.
pub(crate) fn draw_sky<'a, I: Ink>(given: &Given<'a>, canvas: &mut [I]) -> Result<Drawn<'a>, DisplayError> {
    let Given { bodies, ground_light, seen, response, horizon, options } = *given;
    options.check()?;
    let seen = seen.without_ground(horizon);
    let painter = Painter::new(&seen, response, options, bodies.halos(horizon))?;
    let mut ground = GroundMap::new(horizon, (options.width_px, options.height_px));
    let view = View::new(options.projection, options.width_px, options.height_px);
    let offset_px = offset_px(options);
    let mut beyond = Beyond::default();
    let columns = match options.projection {
        Projection::Equirectangular => Columns::new(&view, options.width_px),
        _ => None,
    };
    // Rows and columns of an equirectangular picture are found once.
    if let (Some(columns), Painter::FalseColour { luminance_cd_m2, table, bins, ends_cd_m2 }) =
        (&columns, &painter)
    {
        let azimuth_rad = |x: u32| {
            view.direction_at(f64::from(x) + 0.5, 0.5).map_or(0.0, |direction| direction.azimuth_rad)
        };
        ground.see_columns((0..options.width_px).map(azimuth_rad));
        for y in 0..options.height_px {
            let direction = view.direction_at(0.5, f64::from(y) + 0.5);
            let elevation_rad = direction.map_or(0.0, |direction| direction.elevation_rad);
            let Some(row) = Row::new(luminance_cd_m2, elevation_rad) else { continue };
            let first = y as usize * canvas_size_px(options).0 as usize + offset_px as usize;
            let pixels = &mut canvas[first..first + options.width_px as usize];
            let shown = ground.next_row(elevation_rad);
            let hides = |x: usize| shown.is_some_and(|shown| shown[x] == Shown::Ground);
            let entries = row.0.map(|luminance_cd_m2| bins.entry(luminance_cd_m2));
            for run in columns.runs() {
                let (left, right) = (entries[run.left], entries[run.right]);
                // Between two samples of one colour lies no other; the first and the last may hide what is beyond them.
                if left == right && (1..TABLE_LEN - 1).contains(&left) {
                    pixels[run.columns.clone()].fill(I::of_bytes(table[left]));
                    continue;
                }
                for x in run.columns.clone().filter(|&x| !hides(x)) {
                    let luminance_cd_m2 = row.at(columns, x);
                    beyond.note(luminance_cd_m2, *ends_cd_m2);
                    pixels[x] = I::of_bytes(table[bins.entry(luminance_cd_m2)]);
                }
            }
            if let Some(shown) = shown {
                let hidden = pixels.iter_mut().zip(shown).filter(|(_, shown)| **shown == Shown::Ground);
                hidden.for_each(|(pixel, _)| *pixel = I::of_bytes(TERRAIN_RGB));
            }
        }
    } else {
        let size_px = (options.width_px, options.height_px);
        let points = if painter.has_stars() { bodies.seen_points(&seen, horizon) } else { Vec::new() };
        let bodies = BodyRows::new(&bodies.discs, &points, &view, size_px, horizon);
        let lit = ground_light.map(|light| LitPicture::new(light, &view, size_px));
        let before = Before { bodies: &bodies, lit: lit.as_ref() };
        paint_each(canvas, options, &view, &painter, &before, &mut ground, &mut beyond);
    }
    let has_skyline = painter.has_skyline() && ground_light.is_none();
    Ok(Drawn { ground, beyond, view, has_skyline })
}

/// Draws the skyline, the compass letters and the legend where they are wanted.
pub(crate) fn decorate(
    canvas: &mut RgbImage,
    drawn: Drawn<'_>,
    given: &Given<'_>,
) -> Result<(), DisplayError> {
    let options = given.options;
    let offset_px = offset_px(options);
    if drawn.has_skyline {
        drawn.ground.draw_skyline(canvas, offset_px);
    }
    if options.legend {
        legend::draw_compass(canvas, options, &drawn.view, offset_px)?;
        legend::draw_strip(canvas, options, given.response, drawn.beyond)?;
    }
    Ok(())
}

/// How far from the canvas's left edge the sky begins, pixels.
fn offset_px(options: &PictureOptions) -> u32 {
    (canvas_size_px(options).0 - options.width_px) / 2
}

/// What stands before the sky.
struct Before<'a> {
    bodies: &'a BodyRows,
    lit: Option<&'a LitPicture<'a>>,
}

/// Every pixel by its own direction, rows in parallel.
fn paint_each<I: Ink>(
    canvas: &mut [I],
    options: &PictureOptions,
    view: &View,
    painter: &Painter<'_>,
    before: &Before<'_>,
    ground: &mut GroundMap<'_>,
    beyond: &mut Beyond,
) {
    let offset_px = offset_px(options) as usize;
    let known = &*ground;
    let paint_row = |(y, row): (usize, &mut [I])| {
        let (mut all_shown, mut beyond) = (Vec::new(), Beyond::default());
        let mut bodies = before.bodies.row(y).iter().peekable();
        for (x, pixel) in (0..options.width_px).zip(&mut row[offset_px..]) {
            let direction = view.direction_at(f64::from(x) + 0.5, y as f64 + 0.5);
            let body = bodies.next_if(|(column, _)| *column == x).map(|(_, light)| light);
            if let Some(lit) = before.lit {
                let ink = direction.and_then(|of| lit_ink(lit, painter, of, (x, y), body, &mut beyond));
                *pixel = ink.unwrap_or(*pixel);
                continue;
            }
            let shown = known.shown(direction);
            all_shown.extend(shown);
            if shown == Some(Shown::Ground) {
                *pixel = I::of_bytes(painter.terrain_rgb());
                continue;
            }
            let ink = direction.and_then(|direction| painter.ink(direction, body, &mut beyond));
            *pixel = ink.unwrap_or(*pixel);
        }
        (all_shown, beyond)
    };
    let rows: Vec<(Vec<Shown>, Beyond)> = canvas
        .par_chunks_exact_mut(canvas_size_px(options).0 as usize)
        .take(options.height_px as usize)
        .enumerate()
        .map(paint_row)
        .collect();
    for (shown, in_row) in rows {
        ground.keep(&shown);
        beyond.below |= in_row.below;
        beyond.above |= in_row.above;
    }
}

/// A pixel of a picture with ground in light, which reaches up to the sky: between it and the horizontal plane the sky goes on.
fn lit_ink<I: Ink>(
    lit: &LitPicture<'_>,
    painter: &Painter<'_>,
    direction: Direction,
    (x, y): (u32, usize),
    body: Option<&Seen>,
    beyond: &mut Beyond,
) -> Option<I> {
    let lamps = lit.lamps(x, y).unwrap_or_default();
    if let Some(ground) = lit.ground(direction) {
        return painter.ground_ink(direction, &ground, &lamps);
    }
    let above = Direction { elevation_rad: direction.elevation_rad.max(0.0), ..direction };
    let body = body.copied().unwrap_or_default();
    let before: Seen = std::array::from_fn(|i| body[i] + lamps[i]);
    painter.ink(above, (before != [0.0; 4]).then_some(&before), beyond)
}

/// Width and height of the whole picture, legend included, pixels.
pub fn canvas_size_px(options: &PictureOptions) -> (u32, u32) {
    if options.legend {
        (
            options.width_px.max(legend::MIN_WIDTH_PX),
            options.height_px + legend::strip_height_px(options.width_px, options.illustrative),
        )
    } else {
        (options.width_px, options.height_px)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Colormap, ColourRange, Projection, Scale, Style, fixtures::grey_sky};
    use skyglow_physics::AZIMUTH_COUNT;

    /// Dark but for one bright sample.
    fn beacon(row: usize, column: usize) -> SeenSky {
        grey_sky(|r, c| if (r, c) == (row, column) { 100.0 } else { 0.0 })
    }

    fn picture(
        seen: &SeenSky,
        horizon: &Horizon,
        options: &PictureOptions,
    ) -> Result<RgbImage, DisplayError> {
        super::picture(seen, &Response::Photopic, horizon, options)
    }

    fn plain(projection: Projection, width_px: u32, height_px: u32) -> PictureOptions {
        PictureOptions {
            width_px,
            height_px,
            legend: false,
            style: Style::FalseColour { colormap: Colormap::Grey, range: ColourRange::default() },
            ..PictureOptions::new(projection)
        }
    }

    /// Mean position of the white pixels.
    fn centre_of_light(picture: &RgbImage) -> (f64, f64) {
        let lit: Vec<(f64, f64)> = picture
            .enumerate_pixels()
            .filter(|(_, _, p)| p.0 == [255; 3])
            .map(|(x, y, _)| (f64::from(x) + 0.5, f64::from(y) + 0.5))
            .collect();
        assert!(!lit.is_empty());
        let n = lit.len() as f64;
        (lit.iter().map(|p| p.0).sum::<f64>() / n, lit.iter().map(|p| p.1).sum::<f64>() / n)
    }

    /// A light low in the east is a quarter along the bottom of the equirectangular picture.
    #[test]
    fn east_is_a_quarter_along_the_equirectangular() {
        let image =
            picture(&beacon(0, 64), &Horizon::flat(), &plain(Projection::Equirectangular, 256, 64)).unwrap();
        assert_eq!(image.get_pixel(64, 63).0, [255; 3]);
        assert_eq!(image.pixels().filter(|p| p.0 != [0; 3]).count(), 1);
    }

    /// A picture by rows and columns is that of every direction.
    #[test]
    fn separable_pictures_equal_direct_ones() {
        let panorama =
            grey_sky(|row, column| 1e-6 * (1.0 + (((row * AZIMUTH_COUNT + column) * 7919) % 100_003) as f64));
        let hills = (0..AZIMUTH_COUNT).map(|c| 0.2 * (c as f64 * 0.1).sin().max(0.0)).collect();
        for horizon in [Horizon::flat(), Horizon::new(hills).unwrap()] {
            let options = plain(Projection::Equirectangular, 640, 150);
            let fast = picture(&panorama, &horizon, &options).unwrap();
            let shown = panorama.without_ground(&horizon);
            let (painter, mut ground) = (
                Painter::new(&shown, &Response::Photopic, &options, Vec::new()).unwrap(),
                GroundMap::new(&horizon, (640, 150)),
            );
            let view = View::new(options.projection, 640, 150);
            let mut slow = RgbImage::from_pixel(640, 150, Rgb(GROUND_RGB));
            paint_each(
                slow.as_flat_samples_mut().samples.as_chunks_mut::<3>().0,
                &options,
                &view,
                &painter,
                &Before { bodies: &BodyRows::default(), lit: None },
                &mut ground,
                &mut Beyond::default(),
            );
            ground.draw_skyline(&mut slow, 0);
            // Sums in another order may fall on the other side of a colour's start.
            let differing = fast.pixels().zip(slow.pixels()).filter(|(a, b)| a != b).count();
            assert!(differing < 10, "{differing}");
        }
    }

    #[test]
    fn a_light_in_the_north_is_in_column_0() {
        let image =
            picture(&beacon(30, 0), &Horizon::flat(), &plain(Projection::Equirectangular, 256, 64)).unwrap();
        assert_eq!(image.get_pixel(0, 63 - 30).0, [255; 3]);
    }

    /// On the fisheye east is left north is up and the zenith in the middle.
    #[test]
    fn fisheye_east_is_left_and_zenith_central() {
        let options = plain(Projection::Fisheye, 256, 256);
        let (x, y) = centre_of_light(&picture(&beacon(20, 64), &Horizon::flat(), &options).unwrap());
        assert!(x < 60.0 && (y - 128.0).abs() < 1.0, "{x} {y}");
        let (x, y) = centre_of_light(&picture(&beacon(20, 0), &Horizon::flat(), &options).unwrap());
        assert!(y < 60.0 && (x - 128.0).abs() < 1.0, "{x} {y}");
        let zenith = grey_sky(|row, _| if row == 63 { 100.0 } else { 0.0 });
        let (x, y) = centre_of_light(&picture(&zenith, &Horizon::flat(), &options).unwrap());
        assert!((x - 128.0).abs() < 1.0 && (y - 128.0).abs() < 1.0, "{x} {y}");
        let image = picture(&zenith, &Horizon::flat(), &options).unwrap();
        assert_eq!(image.get_pixel(2, 2).0, GROUND_RGB);
    }

    /// A camera looking south east has the east on its left.
    #[test]
    fn a_camera_to_the_south_east_has_east_left() {
        let projection = Projection::Perspective { azimuth_deg: 135.0, elevation_deg: 10.0, fov_deg: 120.0 };
        let (x, _) = centre_of_light(
            &picture(&beacon(6, 64), &Horizon::flat(), &plain(projection, 400, 200)).unwrap(),
        );
        assert!(x < 150.0, "{x}");
        let image = picture(&beacon(6, 64), &Horizon::flat(), &plain(projection, 400, 200)).unwrap();
        assert_eq!(image.get_pixel(200, 199).0, GROUND_RGB);
    }

    /// The colour of a known luminance is the one of its place on the map.
    #[test]
    fn known_luminances_have_their_map_colours() {
        let luminance = 7e-4;
        let panorama = grey_sky(|_, _| luminance);
        for scale in [Scale::Luminance, Scale::Magnitude] {
            let range = ColourRange::of(scale);
            let mut options = plain(Projection::Equirectangular, 64, 16);
            options.style = Style::FalseColour { colormap: Colormap::Viridis, range };
            let image = picture(&panorama, &Horizon::flat(), &options).unwrap();
            let expected = Colormap::Viridis.rgb(range.position(luminance));
            let got = image.get_pixel(11, 7).0;
            assert!((0..3).all(|i| got[i].abs_diff(expected[i]) <= 2), "{got:?} {expected:?}");
        }
    }

    #[test]
    fn options_out_of_range_are_refused_by_name() {
        let refused = |options: PictureOptions| {
            picture(&grey_sky(|_, _| 0.0), &Horizon::flat(), &options).unwrap_err().to_string()
        };
        assert!(refused(plain(Projection::Fisheye, 0, 100)).contains("width is 0"));
        assert!(refused(plain(Projection::Fisheye, 100, 50_000)).contains("height_px is 50000"));
        let huge = refused(plain(Projection::Fisheye, 4096, 4096));
        assert_eq!(huge, "height_px is 4096 px; allowed is 16 to 2048 px");
        let narrow = Projection::Perspective { azimuth_deg: 0.0, elevation_deg: 0.0, fov_deg: 180.0 };
        assert!(refused(plain(narrow, 100, 100)).contains("fov is 180"));
        let mut bright = plain(Projection::Fisheye, 100, 100);
        bright.style = Style::Realistic { exposure_ev: f64::NAN };
        assert!(refused(bright).contains("exposure"));
    }
}
