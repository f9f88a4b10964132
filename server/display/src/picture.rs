//! Pictures for eyes.

use crate::{
    colormap::TABLE_LEN,
    error::DisplayError,
    ground::{GroundMap, TERRAIN_RGB, without_ground},
    legend::{self, Beyond},
    options::{PictureOptions, Projection, Style},
    panels::{Columns, Row},
    projection::View,
    realistic::ToneMap,
    sampler::{Sampler, taps},
};
use image::{Rgb, RgbImage};
use skyglow_physics::{AZIMUTH_COUNT, Direction, ELEVATION_COUNT, Horizon, Panorama};

/// What is neither sky nor ground that hides it: below an open horizon, the corners of a fisheye, the legend's strip.
pub const GROUND_RGB: [u8; 3] = [22, 24, 29];

/// Colours a sky.
enum Painter<'a> {
    FalseColour {
        luminance_cd_m2: Vec<f64>,
        table: Box<[[u8; 3]; TABLE_LEN]>,
        starts: Box<Starts>,
        ends_cd_m2: (f64, f64),
    },
    Realistic {
        sampler: Sampler<'a>,
        tone_map: Box<ToneMap>,
    },
}

/// Where the colours of a table start. No logarithm and no branch per pixel.
struct Starts {
    /// Entry `i` holds luminances from `cd_m2[i]` to below `cd_m2[i + 1]`; the ends are infinite.
    cd_m2: [f64; TABLE_LEN + 1],
    /// Entries for each power of 2, and log2 of where the second starts.
    per_octave: f32,
    second_octave: f32,
}

impl Starts {
    fn new((dark, bright): (f64, f64)) -> Self {
        let steps = (TABLE_LEN - 1) as f64;
        let start = |i: usize| dark * ((i as f64 - 0.5) / steps * (bright / dark).ln()).exp();
        Self {
            cd_m2: std::array::from_fn(|i| match i {
                0 => f64::NEG_INFINITY,
                TABLE_LEN => f64::INFINITY,
                i => start(i),
            }),
            per_octave: (steps / (bright / dark).log2()) as f32,
            second_octave: start(1).log2() as f32,
        }
    }

    /// The entry that holds a luminance.
    #[inline(always)]
    fn entry(&self, luminance_cd_m2: f64) -> usize {
        // Exponent and mantissa of a float give its logarithm to 0.007 octaves, which is less than an entry on any scale that is not
        // too narrow: the guess is right or beside it.
        let bits = (luminance_cd_m2.max(0.0) as f32).to_bits();
        let part = f32::from_bits(bits & 0x007f_ffff | 0x3f80_0000) - 1.0;
        let octave = (bits >> 23) as f32 - 127.0 + part * (1.344 - 0.344 * part);
        let guess = 1.0 + (octave - self.second_octave) * self.per_octave;
        let guess = guess.clamp(0.0, (TABLE_LEN - 1) as f32) as usize;
        let mut entry = guess + usize::from(self.cd_m2[guess + 1] <= luminance_cd_m2);
        entry -= usize::from(self.cd_m2[entry] > luminance_cd_m2);
        if self.cd_m2[entry] <= luminance_cd_m2 && luminance_cd_m2 < self.cd_m2[entry + 1] {
            return entry;
        }
        self.cd_m2[1..TABLE_LEN].partition_point(|&start| start <= luminance_cd_m2)
    }
}

impl<'a> Painter<'a> {
    fn new(panorama: &'a Panorama, options: &PictureOptions) -> Self {
        let added = options.sky.added_radiance_w_m2_sr();
        match options.style {
            Style::FalseColour { colormap, range } => {
                let added_cd_m2 = skyglow_physics::photometry::luminance_cd_m2([added; 3]);
                let (dark, bright) = range.luminance_ends_cd_m2();
                Painter::FalseColour {
                    luminance_cd_m2: (0..ELEVATION_COUNT * AZIMUTH_COUNT)
                        .map(|i| panorama.luminance_cd_m2(i / AZIMUTH_COUNT, i % AZIMUTH_COUNT) + added_cd_m2)
                        .collect(),
                    table: Box::new(colormap.table()),
                    // With room for rounding: the ends themselves are inside.
                    ends_cd_m2: (dark * (1.0 - 1e-9), bright * (1.0 + 1e-9)),
                    starts: Box::new(Starts::new((dark, bright))),
                }
            }
            Style::Realistic { exposure_ev } => Painter::Realistic {
                sampler: Sampler::new(panorama, added),
                tone_map: Box::new(ToneMap::new(exposure_ev)),
            },
        }
    }

    /// The colour of a direction; notes in `beyond` what the colours cannot tell apart from their ends.
    fn rgb(&self, direction: Direction, beyond: &mut Beyond) -> Option<[u8; 3]> {
        match self {
            Painter::FalseColour { luminance_cd_m2, table, starts, ends_cd_m2 } => {
                let taps = taps(direction)?;
                let luminance: f64 =
                    (0..4).map(|tap| taps.weight[tap] * luminance_cd_m2[taps.offset[tap]]).sum();
                beyond.note(luminance, *ends_cd_m2);
                Some(table[starts.entry(luminance)])
            }
            Painter::Realistic { sampler, tone_map } => {
                sampler.radiance_w_m2_sr(direction).map(|radiance| tone_map.rgb(radiance))
            }
        }
    }
}

/// The picture of a panorama: `options.width_px` × `options.height_px` of sky, with the legend's strip below
/// it where one is asked for (the canvas is then at least [`legend::SMALLEST_WIDTH_PX`] wide). Below `horizon` the
/// ground is drawn, by the profile itself and not by the panorama's rows.
///
/// # Errors
/// [`DisplayError`] naming the first option out of its range.
pub fn picture(
    panorama: &Panorama,
    horizon: &Horizon,
    options: &PictureOptions,
) -> Result<RgbImage, DisplayError> {
    options.check()?;
    let panorama = without_ground(panorama, horizon);
    let painter = Painter::new(&panorama, options);
    let mut ground = GroundMap::new(horizon, (options.width_px, options.height_px));
    let view = View::new(options.projection, options.width_px, options.height_px);
    let (canvas_width_px, canvas_height_px) = canvas_size_px(options);
    let offset_px = (canvas_width_px - options.width_px) / 2;
    let mut canvas = RgbImage::from_pixel(canvas_width_px, canvas_height_px, Rgb(GROUND_RGB));
    let mut beyond = Beyond::default();
    let columns = match options.projection {
        Projection::Equirectangular => Columns::new(&view, options.width_px),
        _ => None,
    };
    // Rows and columns of an equirectangular picture are found once.
    if let (Some(columns), Painter::FalseColour { luminance_cd_m2, table, starts, ends_cd_m2 }) =
        (&columns, &painter)
    {
        let azimuth_rad = |x: u32| {
            view.direction_at(f64::from(x) + 0.5, 0.5).map_or(0.0, |direction| direction.azimuth_rad)
        };
        let tops_rad = ground.tops_rad((0..options.width_px).map(azimuth_rad));
        for y in 0..options.height_px {
            let direction = view.direction_at(0.5, f64::from(y) + 0.5);
            let elevation_rad = direction.map_or(0.0, |direction| direction.elevation_rad);
            let Some(row) = Row::new(luminance_cd_m2, elevation_rad) else { continue };
            let first = 3 * (y as usize * canvas_width_px as usize + offset_px as usize);
            let pixels = canvas.as_flat_samples_mut().samples[first..first + 3 * options.width_px as usize]
                .chunks_exact_mut(3);
            for (x, pixel) in pixels.enumerate() {
                let is_ground = match &tops_rad {
                    Some(tops_rad) => ground.is_ground_below(tops_rad[x], elevation_rad),
                    None => false,
                };
                let rgb = if is_ground {
                    TERRAIN_RGB
                } else {
                    let luminance = row.at(columns, x);
                    beyond.note(luminance, *ends_cd_m2);
                    table[starts.entry(luminance)]
                };
                pixel.copy_from_slice(&rgb);
            }
        }
    } else {
        paint_each(&mut canvas, offset_px, options, &view, &painter, &mut ground, &mut beyond);
    }
    ground.draw_skyline(&mut canvas, offset_px);
    if options.legend {
        legend::draw_compass(&mut canvas, options, &view, offset_px)?;
        legend::draw_strip(&mut canvas, options, beyond)?;
    }
    Ok(canvas)
}

/// Every pixel by its own direction.
fn paint_each(
    canvas: &mut RgbImage,
    offset_px: u32,
    options: &PictureOptions,
    view: &View,
    painter: &Painter<'_>,
    ground: &mut GroundMap<'_>,
    beyond: &mut Beyond,
) {
    for y in 0..options.height_px {
        for x in 0..options.width_px {
            let direction = view.direction_at(f64::from(x) + 0.5, f64::from(y) + 0.5);
            if ground.is_ground(direction) {
                canvas.put_pixel(x + offset_px, y, Rgb(TERRAIN_RGB));
            } else if let Some(rgb) = direction.and_then(|direction| painter.rgb(direction, beyond)) {
                canvas.put_pixel(x + offset_px, y, Rgb(rgb));
            }
        }
    }
}

/// Width and height of the whole picture, legend included, pixels.
pub fn canvas_size_px(options: &PictureOptions) -> (u32, u32) {
    if options.legend {
        (
            options.width_px.max(legend::SMALLEST_WIDTH_PX),
            options.height_px + legend::strip_height_px(options.width_px, options.illustrative),
        )
    } else {
        (options.width_px, options.height_px)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Colormap, ColourRange, Projection, Scale, Sky};

    /// Dark but for one bright sample.
    fn beacon(row: usize, column: usize) -> Panorama {
        let mut panorama = Panorama::dark();
        for band in 0..3 {
            panorama.samples_mut()[Panorama::index(band, row, column)] = 1.0;
        }
        panorama
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

    #[test]
    fn a_light_low_in_the_east_is_a_quarter_along_the_bottom_of_the_equirectangular_picture() {
        let image =
            picture(&beacon(0, 64), &Horizon::flat(), &plain(Projection::Equirectangular, 256, 64)).unwrap();
        assert_eq!(image.get_pixel(64, 63).0, [255; 3]);
        assert_eq!(image.pixels().filter(|p| p.0 != [0; 3]).count(), 1);
    }

    #[test]
    fn a_colour_is_that_of_the_last_start_at_or_below_for_any_number() {
        for ends in [(1e-5, 0.1), (3e-9, 2e-3), (0.2, 0.3)] {
            let starts = Starts::new(ends);
            let own = &starts.cd_m2[1..TABLE_LEN];
            let known: Vec<f64> = own.iter().flat_map(|&s| [s.next_down(), s, s.next_up()]).collect();
            let spread = (0..4000).map(|i| ends.0 * 1e-3 * (i as f64 * 0.01).exp());
            for luminance in known.into_iter().chain(spread).chain([0.0, -1e-9, 1e30, f64::MIN_POSITIVE]) {
                let wanted = own.partition_point(|&start| start <= luminance);
                assert_eq!(starts.entry(luminance), wanted, "{luminance:e}");
            }
        }
    }

    #[test]
    fn a_picture_by_rows_and_columns_is_that_of_every_direction() {
        let panorama = Panorama::from_samples(
            (0..Panorama::LEN).map(|i| 1e-9 * (1.0 + ((i * 7919) % 100_003) as f32)).collect(),
        )
        .unwrap();
        let hills = (0..AZIMUTH_COUNT).map(|c| 0.2 * (c as f64 * 0.1).sin().max(0.0)).collect();
        for horizon in [Horizon::flat(), Horizon::new(hills).unwrap()] {
            let options = plain(Projection::Equirectangular, 640, 150);
            let fast = picture(&panorama, &horizon, &options).unwrap();
            let shown = without_ground(&panorama, &horizon);
            let (painter, mut ground) =
                (Painter::new(&shown, &options), GroundMap::new(&horizon, (640, 150)));
            let view = View::new(options.projection, 640, 150);
            let mut slow = RgbImage::from_pixel(640, 150, Rgb(GROUND_RGB));
            paint_each(&mut slow, 0, &options, &view, &painter, &mut ground, &mut Beyond::default());
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

    #[test]
    fn on_the_fisheye_east_is_left_north_is_up_and_the_zenith_in_the_middle() {
        let options = plain(Projection::Fisheye, 256, 256);
        let (x, y) = centre_of_light(&picture(&beacon(20, 64), &Horizon::flat(), &options).unwrap());
        assert!(x < 60.0 && (y - 128.0).abs() < 1.0, "{x} {y}");
        let (x, y) = centre_of_light(&picture(&beacon(20, 0), &Horizon::flat(), &options).unwrap());
        assert!(y < 60.0 && (x - 128.0).abs() < 1.0, "{x} {y}");
        let mut zenith = Panorama::dark();
        for column in 0..AZIMUTH_COUNT {
            zenith.samples_mut()[Panorama::index(1, 63, column)] = 1.0;
        }
        let (x, y) = centre_of_light(&picture(&zenith, &Horizon::flat(), &options).unwrap());
        assert!((x - 128.0).abs() < 1.0 && (y - 128.0).abs() < 1.0, "{x} {y}");
        let image = picture(&zenith, &Horizon::flat(), &options).unwrap();
        assert_eq!(image.get_pixel(2, 2).0, GROUND_RGB);
    }

    #[test]
    fn a_camera_looking_south_east_has_the_east_on_its_left() {
        let projection = Projection::Perspective { azimuth_deg: 135.0, elevation_deg: 10.0, fov_deg: 120.0 };
        let (x, _) = centre_of_light(
            &picture(&beacon(6, 64), &Horizon::flat(), &plain(projection, 400, 200)).unwrap(),
        );
        assert!(x < 150.0, "{x}");
        let image = picture(&beacon(6, 64), &Horizon::flat(), &plain(projection, 400, 200)).unwrap();
        assert_eq!(image.get_pixel(200, 199).0, GROUND_RGB);
    }

    #[test]
    fn the_colour_of_a_known_luminance_is_the_one_of_its_place_on_the_map() {
        let luminance = skyglow_physics::photometry::luminance_cd_m2([1e-6; 3]);
        let panorama = Panorama::from_samples(vec![1e-6; Panorama::LEN]).unwrap();
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
    fn a_dark_artificial_sky_is_the_dark_end_and_the_total_sky_is_22_magnitudes() {
        let mut options = plain(Projection::Equirectangular, 64, 16);
        let range = ColourRange { scale: Scale::Magnitude, min: 20.0, max: 24.0 };
        options.style = Style::FalseColour { colormap: Colormap::Grey, range };
        assert_eq!(picture(&Panorama::dark(), &Horizon::flat(), &options).unwrap().get_pixel(3, 3).0, [0; 3]);
        options.sky = Sky::Total;
        let grey = picture(&Panorama::dark(), &Horizon::flat(), &options).unwrap().get_pixel(3, 3).0[0];
        assert!((127..=128).contains(&grey), "{grey}");
    }

    #[test]
    fn options_out_of_range_are_refused_by_name() {
        let refused = |options: PictureOptions| {
            picture(&Panorama::dark(), &Horizon::flat(), &options).unwrap_err().to_string()
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
