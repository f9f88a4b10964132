//! Lights by the named place that is nearest in units of its own radius (multiplicatively weighted Voronoi diagram, Aurenhammer &
//! Edelsbrunner 1984).

use super::balls::{Ball, Owners};
use glam::DVec3;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};
use skyglow_scene::NamedPlace;
use std::f64::consts::PI;

/// Radii of a place within which lights belong to it.
pub const TOWN_REACH: f64 = 3.0;
/// Radius of a place without inhabitants, metres: about two pixels of the satellite.
const LEAST_RADIUS_M: f64 = 1_000.0;
/// Inhabitants of built-up land, m⁻².
const INHABITANTS_PER_M2: f64 = 3e-3;

/// Radius of a named place, metres: 1 km, and that of a disc that has room for its inhabitants at 3 000 to the square kilometre.
pub fn town_radius_m(population: Option<u64>) -> f64 {
    LEAST_RADIUS_M + (population.unwrap_or(0) as f64 / (PI * INHABITANTS_PER_M2)).sqrt()
}

/// A named place on the sphere.
pub(super) struct Town {
    direction: DVec3,
    radius_m: f64,
}

impl Town {
    pub(super) fn new(place: &NamedPlace) -> Self {
        let (latitude_rad, longitude_rad) =
            (place.latitude_deg.to_radians(), place.longitude_deg.to_radians());
        let direction = GeoPoint::from_rad_unchecked(latitude_rad, longitude_rad).unit_vector();
        Self { direction, radius_m: town_radius_m(place.population) }
    }
}

/// Named places; of two as near the first counts.
pub(super) struct Towns(pub(super) Vec<Town>);

impl Owners for Towns {
    fn of_ball(&self, ball: &Ball, candidates: &[u32]) -> Vec<u32> {
        let radii = |candidate: u32, margin_m: f64| {
            let town = &self.0[candidate as usize];
            (ball.distance_m(town.direction) + margin_m) / town.radius_m
        };
        // No light of the ball is farther from the nearest place than this, nor counts beyond the reach.
        let farthest = candidates.iter().map(|&town| radii(town, ball.radius_m)).fold(TOWN_REACH, f64::min);
        // What rounding makes of a bound that is met exactly must not matter.
        let farthest = farthest * (1.0 + 1e-9);
        candidates.iter().copied().filter(|&town| radii(town, -ball.radius_m) <= farthest).collect()
    }

    fn of_light(&self, light: DVec3, candidates: &[u32], owners: &mut Vec<u32>) {
        let radii = |&town: &u32| {
            let Town { direction, radius_m } = &self.0[town as usize];
            EARTH_RADIUS_M * direction.distance(light) / radius_m
        };
        let nearest = candidates.iter().map(|town| (radii(town), *town)).min_by(|a, b| a.0.total_cmp(&b.0));
        owners.extend(nearest.filter(|(radii, _)| *radii <= TOWN_REACH).map(|(_, town)| town));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn town(latitude_deg: f64, longitude_deg: f64, population: u64) -> Town {
        Town::new(&NamedPlace {
            name: String::new(),
            latitude_deg,
            longitude_deg,
            population: Some(population),
        })
    }

    fn owner(towns: &Towns, latitude_deg: f64, longitude_deg: f64) -> Option<u32> {
        let all: Vec<u32> = (0..towns.0.len() as u32).collect();
        let mut owners = Vec::new();
        let light = GeoPoint::from_deg(latitude_deg, longitude_deg).unwrap().unit_vector();
        towns.of_light(light, &all, &mut owners);
        owners.first().copied()
    }

    /// A city of a million reaches to 34 km, a village of which nothing is known to 3 km; between two the nearer in own radii counts.
    #[test]
    fn a_light_belongs_to_the_nearest_in_radii() {
        assert!((town_radius_m(Some(1_000_000)) - 11_301.0).abs() < 1.0);
        assert_eq!(town_radius_m(None), 1_000.0);
        let towns = Towns(vec![town(0.0, 0.0, 1_000_000), town(0.0, 0.2, 10_000)]);
        // A degree is 111 km: the small town, 22 km away, has what is within 3.3 km of it towards the city.
        assert_eq!(owner(&towns, 0.0, 0.16), Some(0));
        assert_eq!(owner(&towns, 0.0, 0.18), Some(1));
        assert_eq!(owner(&towns, 0.3, 0.0), Some(0));
        assert_eq!(owner(&towns, 0.32, 0.0), None);
        // Across the antimeridian.
        assert_eq!(owner(&Towns(vec![town(0.0, 179.99, 0)]), 0.0, -179.995), Some(0));
    }

    proptest! {
        /// Candidates left out of a ball own none of its lights.
        #[test]
        fn balls_keep_every_owner(
            towns in prop::collection::vec((45.0f64..46.0, 8.0f64..9.5, 0u64..2_000_000), 1..40),
            lights in prop::collection::vec((45.0f64..46.0, 8.0f64..9.5), 1..40),
            tight in 0.0f64..1.0,
        ) {
            let towns = Towns(towns.into_iter().map(|(lat, lon, population)| town(lat, lon, population)).collect());
            let light = |&(lat, lon): &(f64, f64)| {
                GeoPoint::from_deg(45.5 + tight * (lat - 45.5), 8.7 + tight * (lon - 8.7)).unwrap().unit_vector()
            };
            let lights: Vec<DVec3> = lights.iter().map(light).collect();
            let all: Vec<u32> = (0..towns.0.len() as u32).collect();
            let kept = towns.of_ball(&Ball::around(&lights), &all);
            for light in lights {
                let (mut of_all, mut of_kept) = (Vec::new(), Vec::new());
                towns.of_light(light, &all, &mut of_all);
                if !kept.is_empty() {
                    towns.of_light(light, &kept, &mut of_kept);
                }
                prop_assert_eq!(of_all, of_kept);
            }
        }
    }
}
