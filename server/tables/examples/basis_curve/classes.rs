//! Classes of places, each as some hundred lights around an observer.

use skyglow_physics::{AZIMUTH_COUNT, single_source::SourceGeometry};

/// A kind of place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    /// One city 40 km away, a dark place else.
    CityFarOff,
    /// Lights all around, from 250 m to 12 km.
    InsideCity,
    /// Cells evenly over the disc of 300 km.
    Spread,
    /// Every distance gives the same light to the zenith, about.
    AllDistances,
    /// The observer 3 000 m above a lit plain.
    AbovePlain,
    /// The observer in a valley with lit ridges.
    Valley,
    /// A coast: everything lies beyond 60 km of sea.
    OverSea,
    /// Sources of any distance and height for any observer, each judged alone.
    AnySource,
}

/// One light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Light {
    /// Where it and the observer are.
    pub(crate) geometry: SourceGeometry,
    /// Column of its azimuth.
    pub(crate) column: usize,
    /// Flux, any unit.
    pub(crate) flux: f64,
}

/// Lights of a class.
const LIGHT_COUNT: usize = 120;

impl Class {
    /// All of them.
    pub(crate) fn all() -> Vec<Class> {
        vec![
            Class::CityFarOff,
            Class::InsideCity,
            Class::Spread,
            Class::AllDistances,
            Class::AbovePlain,
            Class::Valley,
            Class::OverSea,
            Class::AnySource,
        ]
    }

    /// What tables call it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Class::CityFarOff => "one city 40 km away",
            Class::InsideCity => "inside a city",
            Class::Spread => "spread over 300 km",
            Class::AllDistances => "all distances alike",
            Class::AbovePlain => "3 000 m above the lit plain",
            Class::Valley => "valley with lit ridges",
            Class::OverSea => "over the sea, 60 km off",
            Class::AnySource => "any one source",
        }
    }

    /// Its lights, the same every time.
    pub(crate) fn lights(self) -> Vec<Light> {
        (0..LIGHT_COUNT).map(|i| self.light(i)).collect()
    }

    /// Whether each light is a sky of its own.
    pub(crate) fn one_by_one(self) -> bool {
        self == Class::AnySource
    }

    fn light(self, i: usize) -> Light {
        // An additive recurrence spreads evenly over four numbers 0..1.
        let at = |k: i32| (i as f64 * 0.856_674_9_f64.powi(k) + 0.5).fract();
        let (a, b, c, d) = (at(1), at(2), at(3), at(4));
        let any_column = (b * AZIMUTH_COUNT as f64) as usize;
        let (distance_m, column, source_m, observer_m, flux) = match self {
            Class::CityFarOff => {
                // A disc of 6 km radius.
                let (radius_m, angle) = (6_000.0 * a.sqrt(), b * std::f64::consts::TAU);
                let (x_m, y_m) = (40_000.0 + radius_m * angle.cos(), radius_m * angle.sin());
                let turned = y_m.atan2(x_m) / std::f64::consts::TAU * AZIMUTH_COUNT as f64;
                let column = (turned.round() as i64).rem_euclid(AZIMUTH_COUNT as i64) as usize;
                (x_m.hypot(y_m), column, 60.0 * c, 30.0, 1.0)
            }
            Class::InsideCity => (250.0 + 11_750.0 * a.powf(0.7), any_column, 80.0 * c, 40.0, a.powf(0.3)),
            Class::Spread => (300_000.0 * a.sqrt().max(1e-3), any_column, 900.0 * c * c, 300.0, 0.2 + d),
            Class::AllDistances => {
                let distance_m = 250.0 * 1_200f64.powf(a);
                (distance_m, any_column, 300.0 * c, 100.0, (distance_m / 1_000.0).powf(2.5).max(0.2))
            }
            Class::AbovePlain => (3_000.0 + 117_000.0 * a, any_column, 200.0 * c, 3_000.0, 0.2 + d),
            Class::Valley => {
                let distance_m = 1_500.0 + 20_000.0 * a * a;
                (distance_m, any_column, 500.0 + 0.25 * c * distance_m.min(6_000.0), 500.0, 0.2 + d)
            }
            Class::OverSea => (60_000.0 + 200_000.0 * a, any_column / 2, 400.0 * c * c, 0.0, 0.2 + d),
            Class::AnySource => {
                let (distance_m, observer_m) = (250.0 * 1_200f64.powf(a), 6_000.0 * b * b);
                let highest_m = (0.5 * distance_m).min(6_000.0 - observer_m);
                (distance_m, 0, observer_m + highest_m - (observer_m + highest_m) * c, observer_m, 1.0)
            }
        };
        Light {
            geometry: SourceGeometry {
                distance_m: distance_m.max(250.0),
                source_altitude_m: source_m,
                observer_altitude_m: observer_m,
            },
            column,
            flux,
        }
    }
}
