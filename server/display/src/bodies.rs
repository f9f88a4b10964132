//! Stars, planets and the Moon in a picture: points blurred by the eye, drawn where it sees them (Crumey 2014), and discs at their true
//! size with their phase.

use crate::{
    eye::Seen,
    glare::{Glare, Halo, even_background_cd_m2},
    projection::View,
};
use skyglow_physics::{
    Direction, Horizon, Response, SeenSky,
    photometry::naked_eye_limit_mag,
    sampler::{Sampler, taps},
};
use std::{borrow::Cow, f64::consts::PI};

/// Width of a star in the dark-adapted eye, standard deviation of a Gaussian: some 4′.
const EYE_BLUR_RAD: f64 = 1.1e-3;
/// A star is drawn at least so wide, pixels.
const MIN_BLUR_PX: f64 = 0.6;
/// Light below this is not drawn, cd m⁻²: a tenth of the darkest sky.
const DARK_CD_M2: f64 = 2e-5;
/// Samples of a pixel of a disc, along each side.
const DISC_SAMPLES: u32 = 4;

/// Lights in the sky that are points or discs, as the observer sees them through the air.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkyBodies {
    /// Stars and planets.
    pub points: Vec<PointLight>,
    /// Moon and Sun.
    pub discs: Vec<Disc>,
}

impl SkyBodies {
    /// Moon and Sun where no ground hides them, as sources of glare.
    pub(crate) fn halos(&self, horizon: &Horizon) -> Vec<Halo> {
        halos(&self.discs, horizon)
    }

    /// The points that the naked eye sees before a sky, which holds all light there is, and the veil that the eye makes of it.
    pub fn seen_points(&self, sky: &SeenSky, horizon: &Horizon) -> Vec<PointLight> {
        let Some(behind) = Behind::of(sky, &self.discs, horizon).filter(|_| !self.points.is_empty()) else {
            return Vec::new();
        };
        let background = |direction| behind.background_cd_m2(direction);
        self.points.iter().filter(|point| point.is_seen(horizon, background)).copied().collect()
    }
}

/// What the eye has behind stars: a sky of all light there is, and the veil that the eye makes of it.
#[derive(Clone, Debug)]
pub struct Behind<'a> {
    sky: Cow<'a, SeenSky>,
    glare: Glare<1>,
    halos: Vec<Halo<1>>,
}

impl<'a> Behind<'a> {
    /// A sky with Moon and Sun before it; None for one without luminance.
    pub fn of(sky: &'a SeenSky, discs: &[Disc], horizon: &Horizon) -> Option<Self> {
        let halos: Vec<Halo<1>> = halos(discs, horizon).iter().map(Halo::photopic).collect();
        let sky = sky.without_ground(horizon);
        let glare = Glare::new([sky.seen_by(&Response::Photopic)?], &halos);
        Some(Self { sky, glare, halos })
    }

    /// The even background that hides as much, cd m⁻²; None below the horizontal plane.
    pub fn background_cd_m2(&self, direction: Direction) -> Option<f64> {
        let plane = self.sky.seen_by(&Response::Photopic)?;
        let [luminance_cd_m2] = Sampler::new([plane]).values(direction)?;
        let near = self.halos.iter().filter_map(|halo| halo.near(direction)).map(|[more]| more);
        let [veil_cd_m2] = self.glare.at(&taps(direction)?);
        Some(even_background_cd_m2(luminance_cd_m2, veil_cd_m2 + near.sum::<f64>()))
    }
}

/// Moon and Sun where no ground hides them, as sources of glare.
fn halos(discs: &[Disc], horizon: &Horizon) -> Vec<Halo> {
    let is_seen = |disc: &&Disc| disc.direction.elevation_rad >= 0.0 && !horizon.hides(disc.direction);
    let halo = |disc: &Disc| {
        let solid_angle_sr = PI * disc.radius_rad * disc.radius_rad;
        let mean =
            |i: usize| disc.lit_share * disc.lit_cd_m2[i] + (1.0 - disc.lit_share) * disc.dark_cd_m2[i];
        let illuminance_lx = std::array::from_fn(|i| solid_angle_sr * mean(i));
        Halo::new(disc.direction, disc.radius_rad, illuminance_lx)
    };
    discs.iter().filter(is_seen).map(halo).collect()
}

/// A point of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it is seen.
    pub direction: Direction,
    /// X, Y, Z and scotopic illuminance of a surface that faces it, lx.
    pub illuminance_lx: Seen,
    /// V that the naked eye's limit on the sky behind it is compared with.
    pub limit_mag: f64,
}

impl PointLight {
    /// Whether it stands above the horizon and is bright enough to be seen on the sky behind it.
    fn is_seen(&self, horizon: &Horizon, background_cd_m2: impl Fn(Direction) -> Option<f64>) -> bool {
        let behind = background_cd_m2(self.direction);
        behind.is_some_and(|behind_cd_m2| self.limit_mag <= naked_eye_limit_mag(behind_cd_m2))
            && !horizon.hides(self.direction)
    }
}

/// A disc, of which a part may be dark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Where its centre is seen.
    pub direction: Direction,
    /// Apparent radius, radians.
    pub radius_rad: f64,
    /// Luminance of the lit part.
    pub lit_cd_m2: Seen,
    /// Luminance of the dark part: earthshine.
    pub dark_cd_m2: Seen,
    /// Lit part of the disc, 0..=1.
    pub lit_share: f64,
    /// Direction of the bright limb on the sky, radians from up towards growing azimuth.
    pub bright_limb_rad: f64,
}

/// What bodies add to a picture, by row: column and light, ascending.
#[derive(Default)]
pub(crate) struct BodyRows(Vec<Vec<(u32, Seen)>>);

impl BodyRows {
    /// Discs above the horizon, and points that are seen.
    pub(crate) fn new(
        discs: &[Disc],
        points: &[PointLight],
        view: &View,
        (width_px, height_px): (u32, u32),
        horizon: &Horizon,
    ) -> Self {
        let mut rows = Self(vec![Vec::new(); height_px as usize]);
        let size_px = (f64::from(width_px), f64::from(height_px));
        for disc in discs {
            rows.add_disc(disc, view, size_px, horizon);
        }
        for point in points {
            rows.add_point(point, view, size_px);
        }
        for row in &mut rows.0 {
            row.sort_by_key(|(x, _)| *x);
            // Lights of one pixel add up.
            row.dedup_by(|next, kept| {
                let same = next.0 == kept.0;
                if same {
                    kept.1 = std::array::from_fn(|i| kept.1[i] + next.1[i]);
                }
                same
            });
        }
        rows
    }

    /// What is added in a row.
    pub(crate) fn row(&self, y: usize) -> &[(u32, Seen)] {
        self.0.get(y).map_or(&[], Vec::as_slice)
    }

    fn add_point(&mut self, point: &PointLight, view: &View, size_px: (f64, f64)) {
        let Some(centre) = view.position_px(point.direction) else { return };
        let blur_px = (EYE_BLUR_RAD / view.pixel_rad()).max(MIN_BLUR_PX);
        let peak = point.illuminance_lx.map(|lx| lx / (std::f64::consts::TAU * EYE_BLUR_RAD * EYE_BLUR_RAD));
        let brightest = peak[1].max(peak[3]);
        if brightest <= DARK_CD_M2 {
            return;
        }
        let reach_px = blur_px * (2.0 * (brightest / DARK_CD_M2).ln()).sqrt();
        self.for_pixels(centre, reach_px, size_px, |x, y| {
            let square = (f64::from(x) + 0.5 - centre.0).powi(2) + (f64::from(y) + 0.5 - centre.1).powi(2);
            let part = (-0.5 * square / (blur_px * blur_px)).exp();
            Some(peak.map(|peak| peak * part))
        });
    }

    fn add_disc(&mut self, disc: &Disc, view: &View, size_px: (f64, f64), horizon: &Horizon) {
        let Some(centre) = view.position_px(disc.direction) else { return };
        // Stretched pixels, near the edge of a perspective and high up in an equirectangular picture, need more room.
        let stretch = 2.0 / disc.direction.elevation_rad.cos().max(0.05);
        let reach_px = 2.0 + stretch * disc.radius_rad / view.pixel_rad();
        let (sin_limb, cos_limb) = disc.bright_limb_rad.sin_cos();
        self.for_pixels(centre, reach_px, size_px, |x, y| {
            let mut sum: Seen = [0.0; 4];
            for sample in 0..DISC_SAMPLES * DISC_SAMPLES {
                let inside = |at: u32| (f64::from(at) + 0.5) / f64::from(DISC_SAMPLES);
                let (right, down) = (inside(sample % DISC_SAMPLES), inside(sample / DISC_SAMPLES));
                let at = view.direction_at(f64::from(x) + right, f64::from(y) + down);
                let Some(at) = at.filter(|at| !horizon.hides(*at)) else { continue };
                let Some([across, up]) = disc.position(at) else { continue };
                let (limb, along) = (up * cos_limb + across * sin_limb, across * cos_limb - up * sin_limb);
                let terminator = (1.0 - 2.0 * disc.lit_share) * (1.0 - along * along).max(0.0).sqrt();
                let light = if limb >= terminator { &disc.lit_cd_m2 } else { &disc.dark_cd_m2 };
                sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
            }
            let count = f64::from(DISC_SAMPLES * DISC_SAMPLES);
            (sum != [0.0; 4]).then(|| sum.map(|sum| sum / count))
        });
    }

    /// Calls `light` for every pixel of the picture within a square around a centre.
    fn for_pixels(
        &mut self,
        (x, y): (f64, f64),
        reach_px: f64,
        (width_px, height_px): (f64, f64),
        mut light: impl FnMut(u32, u32) -> Option<Seen>,
    ) {
        let range = |centre: f64, side: f64| {
            (centre - reach_px).floor().clamp(0.0, side) as u32
                ..(centre + reach_px).ceil().clamp(0.0, side) as u32
        };
        for row in range(y, height_px) {
            for column in range(x, width_px) {
                if let Some(light) = light(column, row) {
                    self.0[row as usize].push((column, light));
                }
            }
        }
    }
}

impl Disc {
    /// Where a direction lies on the disc in its radii, towards growing azimuth and up; None beside it.
    fn position(&self, at: Direction) -> Option<[f64; 2]> {
        let away = at.enu() - self.direction.enu();
        let (sin_azimuth, cos_azimuth) = self.direction.azimuth_rad.sin_cos();
        let (sin_elevation, cos_elevation) = self.direction.elevation_rad.sin_cos();
        let across = away.x * cos_azimuth - away.y * sin_azimuth;
        let up = -sin_elevation * (away.x * sin_azimuth + away.y * cos_azimuth) + cos_elevation * away.z;
        let position = [across / self.radius_rad, up / self.radius_rad];
        (position[0] * position[0] + position[1] * position[1] <= 1.0).then_some(position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PictureOptions, Projection, Style, fixtures::grey_sky, picture::picture_with};
    use skyglow_physics::{AZIMUTH_COUNT, Response};

    /// A half Moon lights as its disc does, and nothing is behind a hill.
    #[test]
    fn a_hidden_moon_does_not_glare() {
        let moon = Disc {
            direction: looking(60.0, 30.0),
            radius_rad: 0.26f64.to_radians(),
            lit_cd_m2: [2500.0; 4],
            dark_cd_m2: [0.0; 4],
            lit_share: 0.5,
            bright_limb_rad: 0.0,
        };
        let bodies = SkyBodies { discs: vec![moon], ..SkyBodies::default() };
        let halo = Halo::new(moon.direction, moon.radius_rad, [0.0809; 4]);
        let beside = looking(60.0, 31.0);
        let [found] = bodies.halos(&Horizon::flat())[..] else { panic!("one halo") };
        let [found, wanted] = [found, halo].map(|halo| halo.near(beside).unwrap()[1]);
        assert!((found / wanted - 1.0).abs() < 0.01, "{found} {wanted}");
        let hill = Horizon::new(vec![0.7; AZIMUTH_COUNT]).unwrap();
        assert!(bodies.halos(&hill).is_empty());
    }

    fn looking(azimuth_deg: f64, elevation_deg: f64) -> Direction {
        Direction { azimuth_rad: azimuth_deg.to_radians(), elevation_rad: elevation_deg.to_radians() }
    }

    fn star(magnitude: f64, direction: Direction) -> PointLight {
        let lux = 2.54e-6 * 10f64.powf(-0.4 * magnitude);
        PointLight {
            direction,
            illuminance_lx: [0.95 * lux, lux, 1.09 * lux, 2.3 * lux],
            limit_mag: magnitude,
        }
    }

    fn seen(bodies: &SkyBodies, luminance_cd_m2: f64, projection: Projection) -> image::RgbImage {
        let options = PictureOptions {
            legend: false,
            style: Style::Eye { exposure_ev: 0.0, adaptation_cd_m2: None },
            ..PictureOptions::new(projection)
        };
        let sky = grey_sky(|_, _| luminance_cd_m2);
        picture_with(bodies, None, &sky, &Response::Photopic, &Horizon::flat(), &options).unwrap()
    }

    fn brightness(image: &image::RgbImage, direction: Direction, projection: Projection) -> u8 {
        let (x, y) = View::new(projection, image.width(), image.height()).position_px(direction).unwrap();
        image.get_pixel(x as u32, y as u32).0[1]
    }

    /// A star of the fifth magnitude is there under a dark sky and not in a city, one of the first in both.
    #[test]
    fn stars_are_drawn_where_the_eye_sees_them() {
        let (faint, bright) = (looking(100.0, 50.0), looking(220.0, 30.0));
        let bodies = SkyBodies { points: vec![star(5.0, faint), star(1.0, bright)], discs: Vec::new() };
        for (luminance_cd_m2, faint_shows) in [(2e-4, true), (2e-2, false)] {
            let with = seen(&bodies, luminance_cd_m2, Projection::Fisheye);
            let without = seen(&SkyBodies::default(), luminance_cd_m2, Projection::Fisheye);
            let shows = |at| {
                brightness(&with, at, Projection::Fisheye) > brightness(&without, at, Projection::Fisheye) + 3
            };
            assert_eq!((shows(faint), shows(bright)), (faint_shows, true), "{luminance_cd_m2}");
        }
        // Brighter ones are larger.
        let lit = |magnitude| {
            let bodies = SkyBodies { points: vec![star(magnitude, bright)], discs: Vec::new() };
            let dark = seen(&SkyBodies::default(), 2e-4, Projection::Fisheye);
            seen(&bodies, 2e-4, Projection::Fisheye)
                .pixels()
                .zip(dark.pixels())
                .filter(|(a, b)| a != b)
                .count()
        };
        assert!(lit(-4.0) > lit(1.0) && lit(1.0) > lit(4.0) && lit(4.0) > 0);
    }

    /// Glare hides faint stars next to the Moon, and far from it none; a hill before the Moon brings them back.
    #[test]
    fn glare_hides_faint_stars() {
        let moon = Disc {
            direction: looking(90.0, 30.0),
            radius_rad: 0.26f64.to_radians(),
            lit_cd_m2: [2.5e3; 4],
            dark_cd_m2: [0.0; 4],
            lit_share: 1.0,
            bright_limb_rad: 0.0,
        };
        let near = [2.0, 4.0, 8.0].map(|away_deg| star(5.5, looking(90.0, 30.0 + away_deg)));
        let (bright, far) = (star(0.0, looking(90.0, 34.0)), star(5.5, looking(270.0, 60.0)));
        let points = [&near[..], &[bright, far]].concat();
        let count = |discs: &[Disc], horizon: &Horizon| {
            let bodies = SkyBodies { points: points.clone(), discs: discs.to_vec() };
            bodies.seen_points(&grey_sky(|_, _| 3e-4), horizon)
        };
        assert_eq!(count(&[], &Horizon::flat()).len(), points.len());
        assert_eq!(count(&[moon], &Horizon::flat()), [bright, far]);
        // Who counts stars finds the same background, and an even sky's own veil in none of it.
        let sky = grey_sky(|_, _| 3e-4);
        let behind = |discs: &[Disc], direction| {
            Behind::of(&sky, discs, &Horizon::flat()).unwrap().background_cd_m2(direction).unwrap()
        };
        assert!((behind(&[], near[0].direction) / 3e-4 - 1.0).abs() < 0.02);
        assert!(behind(&[moon], near[0].direction) > 10.0 * behind(&[moon], far.direction));
        let hill = Horizon::new(vec![31f64.to_radians(); skyglow_physics::AZIMUTH_COUNT]).unwrap();
        assert_eq!(count(&[moon], &hill).len(), points.len());
    }

    /// Half a Moon has half of the full one's white pixels, on the side of the bright limb.
    #[test]
    fn the_moon_has_its_phase() {
        let projection = Projection::Perspective { azimuth_deg: 90.0, elevation_deg: 30.0, fov_deg: 5.0 };
        let moon = |lit_share| Disc {
            direction: looking(90.0, 30.0),
            radius_rad: 0.26f64.to_radians(),
            lit_cd_m2: [2e3, 2e3, 2e3, 4e3],
            dark_cd_m2: [1e-3; 4],
            lit_share,
            bright_limb_rad: std::f64::consts::FRAC_PI_2,
        };
        let whites = |lit_share| {
            let image =
                seen(&SkyBodies { points: Vec::new(), discs: vec![moon(lit_share)] }, 1e-4, projection);
            let middle = image.width() / 2;
            let white = image.enumerate_pixels().filter(|(_, _, pixel)| pixel.0[1] > 200);
            white.fold(
                [0; 2],
                |[left, right], (x, _, _)| if x < middle { [left + 1, right] } else { [left, right + 1] },
            )
        };
        let (full, half) = (whites(1.0), whites(0.5));
        let radius_px = 0.5 * 1024.0 / (2.5f64.to_radians()).tan() * 0.26f64.to_radians();
        let area_px = std::f64::consts::PI * radius_px * radius_px;
        assert!((f64::from(full[0] + full[1]) / area_px - 1.0).abs() < 0.05, "{full:?} {area_px}");
        assert!(half[1] > 9 * full[1] / 10 && half[0] < full[0] / 20, "{half:?} {full:?}");
    }

    #[test]
    fn hidden_stars_are_not_drawn() {
        let horizon = Horizon::new(vec![0.5; skyglow_physics::AZIMUTH_COUNT]).unwrap();
        let options = PictureOptions {
            legend: false,
            style: Style::Eye { exposure_ev: 0.0, adaptation_cd_m2: None },
            ..PictureOptions::new(Projection::Fisheye)
        };
        let draw = |elevation_deg| {
            let bodies =
                SkyBodies { points: vec![star(0.0, looking(40.0, elevation_deg))], discs: Vec::new() };
            picture_with(&bodies, None, &grey_sky(|_, _| 2e-4), &Response::Photopic, &horizon, &options)
                .unwrap()
        };
        let none = picture_with(
            &SkyBodies::default(),
            None,
            &grey_sky(|_, _| 2e-4),
            &Response::Photopic,
            &horizon,
            &options,
        );
        assert!(draw(20.0) == none.unwrap() && draw(20.0) != draw(60.0));
    }
}
