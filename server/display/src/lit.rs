//! Ground in light, and lamps on it, by pixel of a picture.

use crate::{eye::Seen, options::PictureOptions, options::Projection, projection::View};
use skyglow_physics::{Direction, LitGround};
use std::f64::consts::{PI, TAU};

/// Width of a lamp in the eye, standard deviation of a Gaussian: some 1.4′, narrower than stars, which eyes see that are wide open.
const LAMP_BLUR_RAD: f64 = 4e-4;
/// A lamp is drawn at least so wide, pixels.
const MIN_BLUR_PX: f64 = 0.5;
/// Light below this is not drawn, cd m⁻².
const DARK_CD_M2: f64 = 2e-5;
/// Lines of ground of a picture at most.
const MAX_LINES: f64 = 4096.0;
/// Elevation of the camera, up or down, from which it may see ground all around, degrees.
const STEEP_DEG: f64 = 45.0;

/// Ground of a picture.
pub(crate) struct LitPicture<'a> {
    ground: &'a LitGround,
    width_px: usize,
    /// Light of lamps by pixel; empty where there are none.
    lamps: Vec<[f32; 4]>,
}

impl<'a> LitPicture<'a> {
    pub(crate) fn new(ground: &'a LitGround, view: &View, (width_px, height_px): (u32, u32)) -> Self {
        let mut picture = Self { ground, width_px: width_px as usize, lamps: Vec::new() };
        if !ground.lamps.is_empty() {
            picture.lamps = vec![[0.0; 4]; picture.width_px * height_px as usize];
        }
        for (direction, illuminance_lx) in &ground.lamps {
            picture.add(view.position_px(*direction), illuminance_lx, view.pixel_rad());
        }
        picture
    }

    fn add(&mut self, centre: Option<(f64, f64)>, illuminance_lx: &Seen, pixel_rad: f64) {
        let Some((x, y)) = centre else { return };
        let blur_px = (LAMP_BLUR_RAD / pixel_rad).max(MIN_BLUR_PX);
        let blur_rad = blur_px * pixel_rad;
        let peak = illuminance_lx.map(|lx| lx / (TAU * blur_rad * blur_rad));
        let brightest = peak[1].max(peak[3]);
        if brightest <= DARK_CD_M2 {
            return;
        }
        let reach_px = blur_px * (2.0 * (brightest / DARK_CD_M2).ln()).sqrt();
        let height_px = self.lamps.len() / self.width_px;
        let range = |centre: f64, side: usize| {
            let end = |at: f64| at.clamp(0.0, side as f64) as usize;
            end((centre - reach_px).floor())..end((centre + reach_px).ceil())
        };
        let along = |at: usize, centre: f64| {
            let away = (at as f64 + 0.5 - centre) / blur_px;
            (-0.5 * away * away).exp()
        };
        for row in range(y, height_px) {
            let of_row = along(row, y);
            for column in range(x, self.width_px) {
                let part = of_row * along(column, x);
                let light = &mut self.lamps[row * self.width_px + column];
                light.iter_mut().zip(peak).for_each(|(sum, peak)| *sum += (peak * part) as f32);
            }
        }
    }

    /// What is seen of the ground in a direction; None where there is sky.
    pub(crate) fn ground(&self, direction: Direction) -> Option<Seen> {
        self.ground.light(direction)
    }

    /// What lamps add in a pixel.
    pub(crate) fn lamps(&self, x: u32, y: usize) -> Option<Seen> {
        self.lamps.get(y * self.width_px + x as usize).map(|light| light.map(f64::from))
    }
}

impl PictureOptions {
    /// Azimuths along which a picture shows ground: the first, radians clockwise from north, the step between them, and how many.
    pub fn azimuths(&self) -> (f64, f64, usize) {
        let view = View::new(self.projection, self.width_px, self.height_px);
        let (middle_rad, half_rad) = match self.projection {
            Projection::Perspective { azimuth_deg, elevation_deg, .. } if elevation_deg.abs() < STEEP_DEG => {
                let middle_rad = azimuth_deg.to_radians();
                (middle_rad, self.half_width_rad(&view, middle_rad))
            }
            _ => (PI, PI),
        };
        let step_rad = match self.projection {
            Projection::Equirectangular => TAU / f64::from(self.width_px),
            Projection::Fisheye => view.pixel_rad() * (2.0 / PI),
            Projection::Perspective { .. } => view.pixel_rad(),
        };
        let step_rad = step_rad.max(2.0 * half_rad / MAX_LINES);
        let count = (2.0 * half_rad / step_rad).ceil();
        (middle_rad - half_rad, 2.0 * half_rad / count, count as usize + 1)
    }

    /// tan of the lowest elevation that a picture shows.
    pub fn lowest_tangent(&self) -> f64 {
        if !matches!(self.projection, Projection::Perspective { .. }) {
            return 0.0;
        }
        let view = View::new(self.projection, self.width_px, self.height_px);
        let (width, bottom) = (f64::from(self.width_px), f64::from(self.height_px));
        let edge = (0..=32).flat_map(|step| {
            let part = f64::from(step) / 32.0;
            [(part * width, bottom), (part * width, 0.0), (0.0, part * bottom), (width, part * bottom)]
        });
        let elevations_rad = edge.filter_map(|(x, y)| view.direction_at(x, y)).map(|of| of.elevation_rad);
        // A pixel more; the nadir is inside of a picture that looks straight down, whose edge is not lowest.
        let lowest_rad = elevations_rad.fold(PI / 2.0, f64::min) - 2.0 * view.pixel_rad();
        let is_steep = matches!(self.projection, Projection::Perspective { elevation_deg, .. } if elevation_deg < -STEEP_DEG);
        if is_steep || lowest_rad <= -0.49 * PI { f64::NEG_INFINITY } else { lowest_rad.tan() }
    }

    /// Largest difference of azimuth between the middle and the edge of a perspective.
    fn half_width_rad(&self, view: &View, middle_rad: f64) -> f64 {
        let (width, height) = (f64::from(self.width_px), f64::from(self.height_px));
        let edge = (0..=32).flat_map(|step| {
            let part = f64::from(step) / 32.0;
            [(0.0, part * height), (width, part * height), (part * width, height), (part * width, 0.0)]
        });
        let away = edge.filter_map(|(x, y)| view.direction_at(x, y)).map(|direction| {
            let away = (direction.azimuth_rad - middle_rad).rem_euclid(TAU);
            away.min(TAU - away)
        });
        // A pixel more, and never all but a sliver.
        let widest = away.fold(0.0, f64::max) + 2.0 * view.pixel_rad();
        if widest > 0.9 * PI { PI } else { widest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Colormap, GroundStyle, Style, fixtures::grey_sky, picture::picture_with};
    use skyglow_physics::{Horizon, LitLine, Response};

    const LOOKING_EAST: Projection =
        Projection::Perspective { azimuth_deg: 90.0, elevation_deg: 0.0, fov_deg: 60.0 };

    fn options(projection: Projection) -> PictureOptions {
        PictureOptions {
            legend: false,
            style: Style::Eye { exposure_ev: 0.0, adaptation_cd_m2: None },
            ground: GroundStyle::Lit,
            ..PictureOptions::new(projection)
        }
    }

    /// Level ground of a luminance, up to the horizon.
    fn plain(options: &PictureOptions, luminance_cd_m2: f32) -> LitGround {
        let (first_azimuth_rad, step_rad, count) = options.azimuths();
        let line = LitLine {
            tangents: vec![-1.0, 0.0],
            light: vec![[luminance_cd_m2; 4]; 2],
            is_behind_ridge: vec![false; 2],
        };
        LitGround { first_azimuth_rad, step_rad, lines: vec![line; count], lamps: Vec::new() }
    }

    fn drawn(ground: &LitGround, options: &PictureOptions) -> image::RgbImage {
        let sky = grey_sky(|_, _| 1e-3);
        let bodies = crate::SkyBodies::default();
        picture_with(&bodies, Some(ground), &sky, &Response::Photopic, &Horizon::flat(), options).unwrap()
    }

    /// A perspective has lines from edge to edge, other pictures all around.
    #[test]
    fn lines_reach_the_edges() {
        let options = options(LOOKING_EAST);
        let (first_rad, step_rad, count) = options.azimuths();
        let last_rad = first_rad + step_rad * (count - 1) as f64;
        assert!((first_rad.to_degrees() - 60.0).abs() < 0.5 && (last_rad.to_degrees() - 120.0).abs() < 0.5);
        assert!(step_rad.to_degrees() < 0.1 && count > 600);
        let (first_rad, step_rad, count) = PictureOptions::new(Projection::Fisheye).azimuths();
        assert!((first_rad + step_rad * (count - 1) as f64 - TAU).abs() < 1e-9 && first_rad == 0.0);
    }

    /// Below the horizon there is ground in its light, above it the sky, and brighter ground is brighter.
    #[test]
    fn ground_is_below_the_horizon() {
        let options = options(LOOKING_EAST);
        let [dark, bright] = [1e-4, 1e-1].map(|luminance| drawn(&plain(&options, luminance), &options));
        let middle = options.height_px / 2;
        for x in [0, 300, options.width_px - 1] {
            assert_eq!(dark.get_pixel(x, middle - 5), bright.get_pixel(x, middle - 5));
            let [below_dark, below_bright] =
                [&dark, &bright].map(|image| image.get_pixel(x, middle + 50).0[1]);
            assert!(below_bright > below_dark + 50, "{below_dark} {below_bright}");
        }
    }

    /// Ground as bright as the sky looks as bright, whatever the eye is adapted to.
    #[test]
    fn an_eye_sees_ground_as_it_sees_the_sky() {
        for adaptation_cd_m2 in [None, Some(1e-4), Some(1e-2), Some(1.0)] {
            let style = Style::Eye { exposure_ev: 0.0, adaptation_cd_m2 };
            let options = PictureOptions { style, ..options(LOOKING_EAST) };
            let sky = grey_sky(|_, _| 1e-3);
            let mut ground = plain(&options, 0.0);
            let light: [f32; 4] = std::array::from_fn(|i| sky.plane(i)[0]);
            ground.lines.iter_mut().for_each(|line| line.light.fill(light));
            let picture = drawn(&ground, &options);
            let middle = options.height_px / 2;
            let [above, below] = [middle - 3, middle + 3].map(|y| picture.get_pixel(300, y).0[1]);
            assert!(above.abs_diff(below) <= 2, "{adaptation_cd_m2:?}: {above} {below}");
        }
    }

    /// A lamp brightens where it stands, and nothing far from it.
    #[test]
    fn lamps_shine_where_they_stand() {
        let options = options(LOOKING_EAST);
        let ground = plain(&options, 1e-4);
        let lamp = Direction { azimuth_rad: 1.6, elevation_rad: -0.05 };
        let with = LitGround { lamps: vec![(lamp, [1e-5; 4])], ..ground.clone() };
        let [without, with] = [&ground, &with].map(|ground| drawn(ground, &options));
        let view = View::new(options.projection, options.width_px, options.height_px);
        let (x, y) = view.position_px(lamp).unwrap();
        let at = |image: &image::RgbImage, x: f64, y: f64| image.get_pixel(x as u32, y as u32).0[1];
        assert!(at(&with, x, y) > at(&without, x, y) + 60);
        assert_eq!(at(&with, x + 40.0, y), at(&without, x + 40.0, y));
    }

    /// False colours show no ground in light.
    #[test]
    fn false_colours_refuse_lit_ground() {
        let style = Style::FalseColour { colormap: Colormap::Grey, range: Default::default() };
        let options = PictureOptions { style, ..options(LOOKING_EAST) };
        assert!(options.check().unwrap_err().to_string().contains("ground"));
    }
}
