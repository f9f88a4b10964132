//! What stands around a light: the highest terrain between it and some distance, by the same line of sight as the
//! observer's horizon (`skyline.rs`), read off on the way out.
//!
//! A light lies on the ground, at its own altitude, and looks from there: ground that rises from it evenly, as a slope
//! does on the bilinear surface, hides what leaves below the slope. What is nearer than some distance is no wall, since
//! a raster's light is spread over its pixel: see [`nearest_wall_m`].

use super::Terrain;
use super::ray::{NEAREST_GROUND_M, Ray, Slack};
use super::skyline::{Stride, View, look_along};
use glam::DVec3;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};

/// Distance [m] from a light's centre within which terrain does not hide it: an eighth of the side of its pixel [m].
///
/// The lamps are spread over the pixel, and what stands close to the centre has lamps on all its sides. More must not
/// be left out: against 25 lamps, each on its own ground, in a pixel of 463 m on 90 m terrain in the Alps, an eighth
/// lowers the mean angle by 6 %, a quarter by 9 %, the whole side by 24 % (`examples/skyline_samples.rs`). Terrain
/// coarser than the light needs no rule of its own: between its samples it is a slope and no wall.
pub(crate) fn nearest_wall_m(pixel_size_m: f64) -> f64 {
    (0.125 * pixel_size_m).max(NEAREST_GROUND_M)
}

/// A light's view of the terrain around it.
pub(crate) struct SourceSight<'a> {
    frame: LocalFrame,
    altitude_m: f64,
    nearest_m: f64,
    views: Vec<View<'a>>,
    stride: Stride,
    slack: Slack,
}

impl Terrain {
    /// The view from a light at a place and an altitude [m], past terrain nearer than `nearest_m`.
    pub(crate) fn around_source(&self, place: GeoPoint, altitude_m: f64, nearest_m: f64) -> SourceSight<'_> {
        let frame = LocalFrame::at(place);
        let views = self.views(&frame, altitude_m);
        let nearest_m = nearest_m.max(NEAREST_GROUND_M);
        SourceSight { frame, altitude_m, nearest_m, views, stride: Stride::FINE, slack: Slack::default() }
    }
}

impl SourceSight<'_> {
    /// The same view with less care, in a fraction of the time: angles come out at most 1 % and 0.007° too low, half of
    /// what a byte tells apart, and great circles are taken as straight over longer stretches.
    pub(crate) fn hasty(self) -> Self {
        Self { stride: Stride::COARSE, slack: Slack { relative: 0.01, absolute: 1.2e-4 }, ..self }
    }

    /// Whether no terrain is above the light's horizontal plane.
    pub(crate) fn is_open(&self) -> bool {
        self.views.is_empty()
    }

    /// tan e of the highest terrain towards an azimuth [rad]: within each of some ascending distances [m] from the
    /// light. Values therefore ascend too. None is below `floor`, at least 0, and no time is spent below it.
    pub(crate) fn tangents<const N: usize>(
        &self,
        azimuth_rad: f64,
        floor: f64,
        distances_m: &[f64; N],
    ) -> [f64; N] {
        let mut tangents = [floor; N];
        self.look(azimuth_rad, floor, distances_m, |index, tangent| tangents[index] = tangent);
        tangents
    }

    /// Whether terrain towards an azimuth [rad], within a distance [m], is higher than a line of sight that leaves
    /// the light at an elevation of tangent `above`, at least 0.
    pub(crate) fn is_higher_than(&self, above: f64, azimuth_rad: f64, distance_m: f64) -> bool {
        let mut is_higher = false;
        self.look(azimuth_rad, above, &[distance_m], |_, tangent| is_higher = tangent > above);
        is_higher
    }

    /// Tells of each distance by its index the tangent of the highest terrain within it, at least `floor`.
    fn look(&self, azimuth_rad: f64, floor: f64, distances_m: &[f64], mut tell: impl FnMut(usize, f64)) {
        let (sin_az, cos_az) = azimuth_rad.sin_cos();
        let forward = self.frame.north * cos_az + self.frame.east * sin_az;
        let point = |distance_m: f64| -> DVec3 {
            let (sin_arc, cos_arc) = (distance_m / EARTH_RADIUS_M).sin_cos();
            self.frame.up * cos_arc + forward * sin_arc
        };
        let (mut tangent, mut from_m) = (floor, self.nearest_m);
        for (index, &to_m) in distances_m.iter().enumerate() {
            for view in self.views.iter().filter(|view| view.lies_towards(azimuth_rad)) {
                let band_m = (from_m.max(view.reach_m.0), to_m.min(view.reach_m.1));
                if band_m.0 < band_m.1 {
                    let is_covered = |distance_m: f64| {
                        let place = GeoPoint::from_vector(point(distance_m));
                        view.earlier.iter().any(|layer| layer.bilinear_m(0, place).is_some())
                    };
                    let cover: Option<&dyn Fn(f64) -> bool> =
                        if view.earlier.is_empty() { None } else { Some(&is_covered) };
                    let mut ray =
                        Ray::new(view.layer, self.altitude_m, tangent, cover).with_slack(self.slack);
                    look_along(&mut ray, view, band_m, self.stride, &self.frame, &point);
                    tangent = ray.tangent();
                }
            }
            tell(index, tangent);
            from_m = from_m.max(to_m);
        }
    }
}

#[cfg(test)]
#[path = "source_sight_tests.rs"]
mod tests;
