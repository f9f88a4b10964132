//! Directions from pixels, and pixels from directions.

use crate::options::Projection;
use skyglow_physics::Direction;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A projection set up for one size of picture. Positions count from the upper left corner of the picture;
/// the centre of pixel (x, y) is at (x + ½, y + ½).
#[derive(Clone, Copy, Debug)]
pub struct View {
    projection: Projection,
    width_px: f64,
    height_px: f64,
    /// Right, down and forward of the camera in (east, north, up), and its distance from the picture plane.
    camera: Option<([[f64; 3]; 3], f64)>,
}

/// Columns right, down and forward of a camera, in (east, north, up).
fn camera_axes(azimuth_rad: f64, elevation_rad: f64) -> [[f64; 3]; 3] {
    let (sin_az, cos_az) = azimuth_rad.sin_cos();
    let (sin_el, cos_el) = elevation_rad.sin_cos();
    let right = [cos_az, -sin_az, 0.0];
    let down = [sin_az * sin_el, cos_az * sin_el, -cos_el];
    let forward = [sin_az * cos_el, cos_az * cos_el, sin_el];
    [right, down, forward]
}

impl View {
    /// A view of `width_px` × `height_px` pixels.
    pub fn new(projection: Projection, width_px: u32, height_px: u32) -> Self {
        let camera = match projection {
            Projection::Perspective { azimuth_deg, elevation_deg, fov_deg } => Some((
                camera_axes(azimuth_deg.to_radians(), elevation_deg.to_radians()),
                0.5 * f64::from(width_px) / (0.5 * fov_deg.to_radians()).tan(),
            )),
            _ => None,
        };
        Self { projection, width_px: f64::from(width_px), height_px: f64::from(height_px), camera }
    }

    /// Pixels from the picture's centre to the horizon of a fisheye.
    fn fisheye_radius_px(&self) -> f64 {
        0.5 * self.width_px.min(self.height_px)
    }

    /// Angle that a pixel in the middle of the picture subtends along its height, radians.
    pub fn pixel_rad(&self) -> f64 {
        match (self.projection, self.camera) {
            (Projection::Fisheye, _) => FRAC_PI_2 / self.fisheye_radius_px(),
            (_, Some((_, focal_length_px))) => 1.0 / focal_length_px,
            _ => FRAC_PI_2 / self.height_px,
        }
    }

    /// The direction seen at a position in pixels; None where the projection shows no direction. Directions
    /// below the horizon are returned as such (negative elevation); azimuths are not wrapped.
    pub fn direction_at(&self, x_px: f64, y_px: f64) -> Option<Direction> {
        let (half_width, half_height) = (0.5 * self.width_px, 0.5 * self.height_px);
        match self.projection {
            Projection::Equirectangular => Some(Direction {
                azimuth_rad: (x_px - 0.5) / self.width_px * TAU,
                elevation_rad: FRAC_PI_2 * (1.0 - y_px / self.height_px),
            }),
            Projection::Fisheye => {
                let (left, up) = (half_width - x_px, half_height - y_px);
                let zenith_angle_rad = FRAC_PI_2 * (left * left + up * up).sqrt() / self.fisheye_radius_px();
                (zenith_angle_rad <= FRAC_PI_2).then(|| Direction {
                    // East is left: azimuth grows counter-clockwise from the top.
                    azimuth_rad: left.atan2(up),
                    elevation_rad: FRAC_PI_2 - zenith_angle_rad,
                })
            }
            Projection::Perspective { .. } => {
                let (axes, focal_length_px) = self.camera?;
                let local = [x_px - half_width, y_px - half_height, focal_length_px];
                let enu: [f64; 3] =
                    std::array::from_fn(|i| (0..3).map(|axis| local[axis] * axes[axis][i]).sum());
                Some(Direction {
                    azimuth_rad: enu[0].atan2(enu[1]),
                    elevation_rad: enu[2].atan2((enu[0] * enu[0] + enu[1] * enu[1]).sqrt()),
                })
            }
        }
    }

    /// The position in pixels where a direction is seen; None outside the picture or behind the camera.
    /// Inverse of [`Self::direction_at`].
    pub fn position_px(&self, direction: Direction) -> Option<(f64, f64)> {
        let Direction { azimuth_rad, elevation_rad } = direction;
        let (half_width, half_height) = (0.5 * self.width_px, 0.5 * self.height_px);
        let (x, y) = match self.projection {
            Projection::Equirectangular => (
                (azimuth_rad / TAU).rem_euclid(1.0) * self.width_px + 0.5,
                (1.0 - elevation_rad / FRAC_PI_2) * self.height_px,
            ),
            Projection::Fisheye => {
                let radius_px = (FRAC_PI_2 - elevation_rad) / FRAC_PI_2 * self.fisheye_radius_px();
                let (sin, cos) = azimuth_rad.sin_cos();
                (half_width - radius_px * sin, half_height - radius_px * cos)
            }
            Projection::Perspective { .. } => {
                let (axes, focal_length_px) = self.camera?;
                let enu = direction.enu();
                let local = axes.map(|axis| axis[0] * enu.x + axis[1] * enu.y + axis[2] * enu.z);
                if local[2] <= 1e-6 {
                    return None;
                }
                let scale = focal_length_px / local[2];
                (half_width + scale * local[0], half_height + scale * local[1])
            }
        };
        let inside = (0.0..=self.width_px).contains(&x) && (0.0..=self.height_px).contains(&y);
        inside.then_some((x, y))
    }
}

/// The eight compass letters with their azimuths, radians; the four main ones first.
pub const COMPASS: [(&str, f64); 8] = [
    ("N", 0.0),
    ("E", FRAC_PI_2),
    ("S", PI),
    ("W", 3.0 * FRAC_PI_2),
    ("NE", 0.25 * PI),
    ("SE", 0.75 * PI),
    ("SW", 1.25 * PI),
    ("NW", 1.75 * PI),
];

#[cfg(test)]
mod tests {
    use super::*;

    fn looking(azimuth_deg: f64, elevation_deg: f64) -> Direction {
        Direction { azimuth_rad: azimuth_deg.to_radians(), elevation_rad: elevation_deg.to_radians() }
    }

    /// The equirectangular zenith is at the top and north in column 0.
    #[test]
    fn equirectangular_zenith_is_top_north_column_0() {
        let view = View::new(Projection::Equirectangular, 256, 64);
        let top_left = view.direction_at(0.5, 0.5).unwrap();
        assert!(top_left.azimuth_rad.abs() < 1e-12);
        assert!((top_left.elevation_rad.to_degrees() - 63.5 * 90.0 / 64.0).abs() < 1e-9);
        let east = view.direction_at(64.5, 63.5).unwrap();
        assert!((east.azimuth_rad.to_degrees() - 90.0).abs() < 1e-9);
        assert!((east.elevation_rad.to_degrees() - 0.5 * 90.0 / 64.0).abs() < 1e-9);
    }

    #[test]
    fn the_fisheye_has_north_up_and_east_left() {
        let view = View::new(Projection::Fisheye, 200, 200);
        let close = |direction, (x, y): (f64, f64)| {
            let (px, py) = view.position_px(direction).unwrap();
            assert!((px - x).abs() < 1e-6 && (py - y).abs() < 1e-6, "{px} {py}, expected {x} {y}");
        };
        close(looking(123.0, 90.0), (100.0, 100.0));
        close(looking(0.0, 0.0), (100.0, 0.0));
        close(looking(90.0, 0.0), (0.0, 100.0));
        close(looking(180.0, 0.0), (100.0, 200.0));
        close(looking(270.0, 0.0), (200.0, 100.0));
        // Equidistant: 45 degrees up is half way.
        close(looking(90.0, 45.0), (50.0, 100.0));
        assert!(view.direction_at(1.0, 1.0).is_none());
    }

    /// The perspective has its azimuth in the centre and clockwise to the right.
    #[test]
    fn the_perspective_runs_clockwise_to_the_right() {
        let projection = Projection::Perspective { azimuth_deg: 90.0, elevation_deg: 30.0, fov_deg: 90.0 };
        let view = View::new(projection, 400, 300);
        let centre = view.direction_at(200.0, 150.0).unwrap();
        assert!((centre.azimuth_rad.to_degrees() - 90.0).abs() < 1e-9);
        assert!((centre.elevation_rad.to_degrees() - 30.0).abs() < 1e-9);
        assert!(view.direction_at(300.0, 150.0).unwrap().azimuth_rad > centre.azimuth_rad);
        assert!(view.direction_at(200.0, 100.0).unwrap().elevation_rad > centre.elevation_rad);
        assert!(view.position_px(looking(270.0, 0.0)).is_none());
        // Half the field of view from the centre to the edge of the middle row.
        let level = View::new(
            Projection::Perspective { azimuth_deg: 0.0, elevation_deg: 0.0, fov_deg: 90.0 },
            400,
            300,
        );
        let edge = level.direction_at(400.0, 150.0).unwrap();
        assert!((edge.azimuth_rad.to_degrees() - 45.0).abs() < 1e-9);
    }

    /// Pixel and direction are inverse in every projection.
    #[test]
    fn projections_invert_exactly() {
        for projection in [
            Projection::Equirectangular,
            Projection::Fisheye,
            Projection::Perspective { azimuth_deg: 200.0, elevation_deg: 40.0, fov_deg: 70.0 },
        ] {
            let view = View::new(projection, 320, 240);
            for (x, y) in [(10.5, 120.5), (160.5, 60.5), (200.5, 119.5), (199.5, 200.5)] {
                if let Some(direction) = view.direction_at(x, y) {
                    let (px, py) = view.position_px(direction).unwrap();
                    assert!((px - x).abs() < 1e-6 && (py - y).abs() < 1e-6, "{projection:?} {x} {y}");
                }
            }
        }
    }
}
