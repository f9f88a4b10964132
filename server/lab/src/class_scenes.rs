//! Skies of classes of places, as rasters have them: areas of 15″ pixels at some altitudes, the same every time.
//!
//! Two observers a class, one at or near an altitude that packs hold and one between two of those. Sources stand at few
//! altitudes, so that the reference has a field for each.

use crate::lit_areas::{LitAreas, level_m, level_of_share_m, turned_m};
use skyglow_bench::scenes::{LitPixel, PIXEL_SIDE_M, sources_of_pixels};
use skyglow_physics::PointSource;
use skyglow_render::synthetic::Noise;
use std::f64::consts::TAU;

/// A kind of place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// One city 40 km away, a dark place else.
    CityFarOff,
    /// Lights all around, to 8 km.
    InsideCity,
    /// Towns and lone pixels evenly over the disc of 300 km.
    Spread,
    /// Every distance gives the same light to the zenith, about.
    AllDistances,
    /// The observer 3 000 m above a lit plain.
    AbovePlain,
    /// The observer in a valley with lit ridges, up to 14° high.
    Valley,
    /// A coast: everything lies beyond 60 km of sea.
    OverSea,
}

/// One sky of a class.
#[derive(Clone, Debug)]
pub struct ClassScene {
    /// Its class.
    pub class: Class,
    /// Altitude of the observer's eye, metres.
    pub observer_altitude_m: f64,
    /// Its light.
    pub sources: Vec<PointSource>,
}

impl Class {
    /// All of them.
    pub const ALL: [Class; 7] = [
        Class::CityFarOff,
        Class::InsideCity,
        Class::Spread,
        Class::AllDistances,
        Class::AbovePlain,
        Class::Valley,
        Class::OverSea,
    ];

    /// What files call it.
    pub fn name(self) -> &'static str {
        match self {
            Class::CityFarOff => "city-40-km-off",
            Class::InsideCity => "inside-a-city",
            Class::Spread => "spread-over-300-km",
            Class::AllDistances => "all-distances-alike",
            Class::AbovePlain => "3000-m-above-plain",
            Class::Valley => "valley-lit-ridges",
            Class::OverSea => "60-km-over-sea",
        }
    }

    /// The class of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|class| class.name() == name)
    }

    /// Altitudes of the ground where the observer is: one near those of packs, one between them.
    fn observer_altitudes_m(self) -> [f64; 2] {
        match self {
            Class::CityFarOff => [10.0, 480.0],
            Class::InsideCity => [42.0, 492.0],
            Class::Spread => [302.0, 950.0],
            Class::AllDistances => [302.0, 102.0],
            Class::AbovePlain => [2_900.0, 3_500.0],
            Class::Valley => [702.0, 502.0],
            Class::OverSea => [2.0, 150.0],
        }
    }

    /// Its two skies.
    pub fn scenes(self) -> [ClassScene; 2] {
        self.observer_altitudes_m().map(|observer_altitude_m| ClassScene {
            class: self,
            observer_altitude_m,
            sources: sources_of_pixels(self.pixels(observer_altitude_m)),
        })
    }

    fn pixels(self, observer_altitude_m: f64) -> Vec<LitPixel> {
        let mut noise = Noise::new(11 + self as u64);
        let mut map = LitAreas::default();
        match self {
            Class::CityFarOff => {
                map.town(&mut noise, [39_000.0, 9_000.0], 6_000.0, 1.0, |place| level_m(&[0.0, 60.0], place));
            }
            Class::InsideCity => {
                // The city stands on the ground that the observer stands on.
                let base_m = observer_altitude_m - 42.0;
                map.town(&mut noise, [1_500.0, -900.0], 8_000.0, 1.0, |[east_m, north_m]| {
                    let slope = 0.5 + (east_m + 0.6 * north_m) / 12_000.0;
                    base_m + level_of_share_m(&[0.0, 40.0, 80.0], slope)
                });
            }
            Class::Spread => map.region(&mut noise, &[0.0, 100.0, 300.0, 600.0, 900.0]),
            Class::AllDistances => {
                for _ in 0..70 {
                    let distance_m = 250.0 * 1_190f64.powf(noise.unit());
                    let brightness = (distance_m / 1_000.0).powf(2.5).max(0.2);
                    let pixels = (distance_m / 3_000.0).clamp(1.0, 12.0);
                    let at = turned_m(distance_m, TAU * noise.unit());
                    let radius_m = (0.3 + 0.35 * pixels.sqrt()) * PIXEL_SIDE_M;
                    let levels = [0.0, 100.0, 300.0];
                    map.town(&mut noise, at, radius_m, brightness / pixels, |place| level_m(&levels, place));
                }
            }
            Class::AbovePlain => {
                for _ in 0..80 {
                    let at = turned_m(3_000.0 + 117_000.0 * noise.unit(), TAU * noise.unit());
                    let radius_m = 300.0 + 1_200.0 * noise.unit();
                    let brightness = 0.2 + noise.unit();
                    map.town(&mut noise, at, radius_m, brightness, |place| {
                        level_m(&[0.0, 100.0, 300.0], place)
                    });
                }
            }
            Class::Valley => {
                let floor_m = observer_altitude_m - 2.0;
                for _ in 0..320 {
                    let share = noise.unit();
                    let [east_m, north_m] = turned_m(1_500.0 + 20_000.0 * share * share, TAU * noise.unit());
                    let highest_m = 0.25 * east_m.hypot(north_m).min(6_000.0);
                    let steps = [0.0, 100.0, 300.0, 700.0, 1_500.0];
                    let reached = steps.iter().filter(|&&step_m| step_m <= highest_m).count();
                    let altitude_m =
                        floor_m + steps[((noise.unit() * reached as f64) as usize).min(reached - 1)];
                    map.put([east_m, north_m], altitude_m, 0.2 + noise.unit());
                }
            }
            Class::OverSea => {
                for _ in 0..60 {
                    let at = turned_m(62_000.0 + 198_000.0 * noise.unit(), 0.5 * TAU * noise.unit());
                    let radius_m = 300.0 + 2_200.0 * noise.unit();
                    let brightness = 0.2 + noise.unit();
                    map.town(&mut noise, at, radius_m, brightness, |place| {
                        level_m(&[0.0, 100.0, 300.0], place)
                    });
                }
            }
        }
        map.lit()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn altitudes_m(scene: &ClassScene) -> Vec<f64> {
        let mut altitudes: Vec<f64> = scene.sources.iter().map(|source| source.altitude_m).collect();
        altitudes.sort_by(f64::total_cmp);
        altitudes.dedup();
        altitudes
    }

    /// Scenes of classes are areas of pixels at few altitudes, and the same every time.
    #[test]
    fn class_scenes_are_reproducible_pixel_areas() {
        for class in Class::ALL {
            assert_eq!(Class::from_name(class.name()), Some(class));
            for (scene, again) in class.scenes().iter().zip(class.scenes()) {
                assert_eq!(scene.sources, again.sources);
                let altitudes = altitudes_m(scene);
                println!(
                    "{} {}: {} sources at {altitudes:?}",
                    class.name(),
                    scene.observer_altitude_m,
                    scene.sources.len()
                );
                assert!(altitudes.len() >= 2 && altitudes.len() <= 5, "{altitudes:?}");
                assert!((250..10_000).contains(&scene.sources.len()), "{}", scene.sources.len());
            }
        }
    }

    /// The valley has lights high above, and the sea none near.
    #[test]
    fn valley_lights_are_high_and_sea_lights_far() {
        let [valley, _] = Class::Valley.scenes();
        let highest_deg = valley
            .sources
            .iter()
            .map(|source| {
                ((source.altitude_m - valley.observer_altitude_m) / source.distance_m).atan().to_degrees()
            })
            .fold(0.0, f64::max);
        assert!((12.0..16.0).contains(&highest_deg), "{highest_deg}");
        let [sea, _] = Class::OverSea.scenes();
        assert!(sea.sources.iter().all(|source| source.distance_m > 59_000.0 && source.azimuth_rad < 3.2));
    }
}
