//! Ground that hides the sky: what is seen in its place, and what lies just above it.

use image::{Rgb, RgbImage};
use skyglow_physics::{Direction, Horizon};

/// Ground that hides the sky: a neutral brown-grey, lighter than the dark end of every colour map but Viridis' and
/// without the saturated hue of that one, so that it is not taken for a dark sky.
pub const TERRAIN_RGB: [u8; 3] = [58, 54, 49];
/// The same by night, as an eye sees it: darker than any sky.
pub const DARK_TERRAIN_RGB: [u8; 3] = [2, 2, 3];
/// The line along its upper edge: light and as neutral, so that the edge is seen before any colour.
pub const SKYLINE_RGB: [u8; 3] = [164, 156, 144];

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shown {
    Sky,
    Ground,
    /// Corners of a fisheye.
    Nothing,
}

/// The ground of a picture, by pixel; nothing is kept of a picture whose horizon is flat.
#[derive(Clone, Debug)]
pub(crate) struct GroundMap<'a> {
    horizon: Option<&'a Horizon>,
    shown: Vec<Shown>,
    size_px: (u32, u32),
    /// Elevation of the ground in each column of an equirectangular picture, radians, and the highest of all.
    tops_rad: Vec<f64>,
    highest_rad: f64,
}

impl<'a> GroundMap<'a> {
    /// For a picture of `size_px` whose pixels come row by row.
    pub(crate) fn new(horizon: &'a Horizon, size_px: (u32, u32)) -> Self {
        let horizon = (!horizon.is_flat()).then_some(horizon);
        let pixels = horizon.map_or(0, |_| size_px.0 as usize * size_px.1 as usize);
        let shown = Vec::with_capacity(pixels);
        Self { horizon, shown, size_px, tops_rad: Vec::new(), highest_rad: f64::NEG_INFINITY }
    }

    /// What a direction shows; None where nothing hides the sky.
    #[inline]
    pub(crate) fn shown(&self, direction: Option<Direction>) -> Option<Shown> {
        let horizon = self.horizon?;
        Some(match direction {
            Some(direction) if horizon.hides(direction) => Shown::Ground,
            Some(direction) if direction.elevation_rad >= 0.0 => Shown::Sky,
            _ => Shown::Nothing,
        })
    }

    /// Keeps what the next pixels show.
    pub(crate) fn keep(&mut self, shown: &[Shown]) {
        self.shown.extend_from_slice(shown);
    }

    /// Looks along the columns of an equirectangular picture, before [`Self::next_row`].
    pub(crate) fn see_columns(&mut self, azimuths_rad: impl Iterator<Item = f64>) {
        if let Some(horizon) = self.horizon {
            self.tops_rad = azimuths_rad.map(|azimuth_rad| horizon.elevation_at_rad(azimuth_rad)).collect();
            self.highest_rad = self.tops_rad.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        }
    }

    /// What the next row of such a picture shows, which has an elevation; None where all of it is sky.
    pub(crate) fn next_row(&mut self, elevation_rad: f64) -> Option<&[Shown]> {
        self.horizon?;
        let first = self.shown.len();
        if elevation_rad >= self.highest_rad {
            self.shown.resize(first + self.tops_rad.len(), Shown::Sky);
            return None;
        }
        let shown = |&top_rad: &f64| if elevation_rad < top_rad { Shown::Ground } else { Shown::Sky };
        self.shown.extend(self.tops_rad.iter().map(shown));
        Some(&self.shown[first..])
    }

    /// Draws the line along the upper edge of the ground, on the ground's side, at `offset_px` from the left.
    pub(crate) fn draw_skyline(&self, canvas: &mut RgbImage, offset_px: u32) {
        let (width, height) = self.size_px;
        let thickness_px = (f64::from(width) / 1024.0).round().max(1.0) as u32;
        let at = |x: u32, y: u32| self.shown.get((y * width + x) as usize).copied();
        // Above the first ground there is no edge.
        let first = self.shown.iter().position(|&shown| shown == Shown::Ground).unwrap_or(self.shown.len());
        for y in first as u32 / width..height {
            for x in 0..width {
                if at(x, y) != Some(Shown::Ground) {
                    continue;
                }
                let is_edge = (1..=thickness_px).any(|step| {
                    let left = x.checked_sub(step).map(|x| (x, y));
                    let up = y.checked_sub(step).map(|y| (x, y));
                    let right = (x + step < width).then_some((x + step, y));
                    let down = (y + step < height).then_some((x, y + step));
                    [left, up, right, down].into_iter().flatten().any(|(x, y)| at(x, y) == Some(Shown::Sky))
                });
                if is_edge {
                    canvas.put_pixel(x + offset_px, y, Rgb(SKYLINE_RGB));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Colormap, PictureOptions, Projection, Style, fixtures::grey_sky, picture, picture::GROUND_RGB,
    };
    use skyglow_physics::{AZIMUTH_COUNT, Response, SeenSky};
    use std::f64::consts::FRAC_PI_2;

    /// A hill in the east: 30° high at azimuth 90°, linear to 0 at 45° and 135°.
    fn hill() -> Horizon {
        let elevation_deg = |column: usize| (30.0 - 30.0 / 32.0 * (column as f64 - 64.0).abs()).max(0.0);
        Horizon::new((0..AZIMUTH_COUNT).map(|column| elevation_deg(column).to_radians()).collect()).unwrap()
    }

    fn bright_behind(horizon: &Horizon) -> SeenSky {
        crate::fixtures::grey_sky(|row, column| if horizon.hides_sample(row, column) { 0.0 } else { 1e-3 })
    }

    const PROJECTIONS: [Projection; 3] = [
        Projection::Equirectangular,
        Projection::Fisheye,
        Projection::Perspective { azimuth_deg: 90.0, elevation_deg: 20.0, fov_deg: 90.0 },
    ];

    /// Ground has its colour up to the profile and a lighter line in every projection.
    #[test]
    fn ground_fills_up_to_the_profile_with_a_line() {
        let horizon = hill();
        for projection in PROJECTIONS {
            let options = PictureOptions { legend: false, ..PictureOptions::new(projection) };
            let image = picture(&bright_behind(&horizon), &Response::Photopic, &horizon, &options).unwrap();
            let view = crate::projection::View::new(projection, options.width_px, options.height_px);
            let at = |azimuth_deg: f64, elevation_deg: f64| {
                let direction = Direction {
                    azimuth_rad: azimuth_deg.to_radians(),
                    elevation_rad: elevation_deg.to_radians(),
                };
                let (x, y) = view.position_px(direction).unwrap();
                image.get_pixel(x as u32, y as u32).0
            };
            let sky = at(90.0, 45.0);
            assert!(sky != TERRAIN_RGB && sky != SKYLINE_RGB, "{projection:?}");
            for azimuth_deg in [75.0, 90.0, 110.0] {
                let top_deg = horizon.elevation_at_rad(f64::to_radians(azimuth_deg)).to_degrees();
                // Finer than a row of 1.4°, and the sky has one colour down to the line.
                assert_eq!(at(azimuth_deg, top_deg - 1.0), TERRAIN_RGB, "{projection:?} {azimuth_deg}");
                assert_eq!(at(azimuth_deg, top_deg + 0.4), sky, "{projection:?} {azimuth_deg}");
            }
            assert!(image.pixels().any(|pixel| pixel.0 == SKYLINE_RGB), "{projection:?}");
        }
    }

    /// A flat horizon changes no pixel and dark samples show no ground.
    #[test]
    fn a_flat_horizon_changes_no_pixel() {
        for projection in PROJECTIONS {
            let options = PictureOptions::new(projection);
            let image =
                picture(&grey_sky(|_, _| 0.0), &Response::Photopic, &Horizon::flat(), &options).unwrap();
            assert!(image.pixels().all(|pixel| pixel.0 != TERRAIN_RGB));
        }
    }

    /// A camera sees ground below the horizontal plane too and the corners of a fisheye stay.
    #[test]
    fn cameras_see_ground_and_fisheye_corners_stay() {
        let horizon = Horizon::new(vec![0.1; AZIMUTH_COUNT]).unwrap();
        let options = PictureOptions { legend: false, ..PictureOptions::new(PROJECTIONS[2]) };
        let image = picture(&bright_behind(&horizon), &Response::Photopic, &horizon, &options).unwrap();
        assert_eq!(image.get_pixel(512, options.height_px - 1).0, TERRAIN_RGB);
        let options = PictureOptions { legend: false, ..PictureOptions::new(Projection::Fisheye) };
        let image = picture(&bright_behind(&horizon), &Response::Photopic, &horizon, &options).unwrap();
        assert_eq!(image.get_pixel(2, 2).0, GROUND_RGB);
    }

    /// Ground is told from the dark end of every colour map by lightness or by its lack of hue.
    #[test]
    fn ground_differs_from_the_dark_end_of_every_map() {
        let lightness = |rgb: [u8; 3]| {
            let [r, g, b] = rgb.map(|c| (f64::from(c) / 255.0).powf(2.2));
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let saturation = |rgb: [u8; 3]| rgb.iter().max().unwrap() - rgb.iter().min().unwrap();
        for map in Colormap::ALL {
            let dark = map.rgb(0.0);
            let ratio = (lightness(TERRAIN_RGB) + 0.01) / (lightness(dark) + 0.01);
            assert!(
                ratio > 1.8 || saturation(dark) > saturation(TERRAIN_RGB) + 40,
                "{map:?} {dark:?} {ratio}"
            );
        }
        assert!(lightness(SKYLINE_RGB) > 5.0 * lightness(TERRAIN_RGB));
    }

    #[test]
    fn light_is_not_drawn_over_ground() {
        let horizon = Horizon::new(vec![FRAC_PI_2; AZIMUTH_COUNT]).unwrap();
        let options = PictureOptions {
            style: Style::Realistic { exposure_ev: 0.0 },
            legend: false,
            ..PictureOptions::new(Projection::Equirectangular)
        };
        let image = picture(&grey_sky(|_, _| 1e-3), &Response::Photopic, &horizon, &options).unwrap();
        assert!(image.pixels().all(|pixel| pixel.0 == TERRAIN_RGB));
    }
}
