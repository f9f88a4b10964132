//! Lights by the areas that they lie in.

use super::balls::{Ball, Owners};
use glam::DVec3;
use skyglow_physics::GeoPoint;
use skyglow_scene::Boundary;

/// Areas, each with a circle around it.
pub(super) struct Areas<'a> {
    areas: Vec<(&'a Boundary, DVec3, f64)>,
}

impl<'a> Areas<'a> {
    pub(super) fn new(areas: &[&'a Boundary]) -> Self {
        let with_circle = |area: &&'a Boundary| {
            let (middle, radius_m) = area.circle();
            (*area, middle, radius_m)
        };
        Self { areas: areas.iter().map(with_circle).collect() }
    }
}

impl Owners for Areas<'_> {
    fn of_ball(&self, ball: &Ball, candidates: &[u32]) -> Vec<u32> {
        let meets = |&area: &u32| {
            let (_, middle, radius_m) = self.areas[area as usize];
            ball.distance_m(middle) <= ball.radius_m + radius_m
        };
        candidates.iter().copied().filter(meets).collect()
    }

    fn of_light(&self, light: DVec3, candidates: &[u32], owners: &mut Vec<u32>) {
        let place = GeoPoint::from_vector(light);
        owners.extend(candidates.iter().copied().filter(|&area| self.areas[area as usize].0.contains(place)));
    }
}
