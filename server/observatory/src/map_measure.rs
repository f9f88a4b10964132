//! What of the sky over a place a map of all places shows.

use crate::night_sky::dark_outside;
use serde::Serialize;
use skyglow_physics::{Horizon, LinearMeasure, Response};
use skyglow_scene::AzimuthFactor;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Azimuths at which the wall that receives most is looked for.
const WALL_COUNT: usize = 64;
/// Waves of the clamped cosine of walls, max(0, cos x) = 1/π + ½ cos x + 2/(3π) cos 2x − 2/(15π) cos 4x + 2/(35π) cos 6x − …: order and
/// part. Of the wall that receives most the first two are enough; a wall that faces away from the light has little beside the others.
const WALL_WAVES: [(u8, f64); 4] =
    [(1, 0.5), (2, 2.0 / (3.0 * PI)), (4, -2.0 / (15.0 * PI)), (6, 2.0 / (35.0 * PI))];

/// What of the sky over a place a map shows. But for [`Self::Slope`] the ground there is level, and hides nothing of the sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum MapMeasure {
    /// The mean luminance within 5° of the zenith, cd m⁻².
    Zenith,
    /// The mean luminance of the sky, cd m⁻².
    Mean,
    /// The horizontal illuminance, lx.
    Horizontal,
    /// Illuminance of the ground as the terrain slopes, of the sky that the terrain does not hide, lx.
    Slope,
    /// Illuminance of a wall that faces north, lx.
    VerticalNorth,
    /// Illuminance of a wall that faces east, lx.
    VerticalEast,
    /// Illuminance of a wall that faces south, lx.
    VerticalSouth,
    /// Illuminance of a wall that faces west, lx.
    VerticalWest,
    /// Illuminance of the wall that receives most, lx.
    VerticalLargest,
    /// The mean illuminance of all walls, lx.
    Cylindrical,
    /// The mean illuminance of a small sphere, lx.
    Spherical,
}

/// What a light does to a measure of the open sky, whatever its azimuth, as a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Table {
    Zenith,
    Mean,
    Horizontal,
    Cylindrical,
    Spherical,
    /// ∫ L cos φ cos(mΔ) dΩ for an order m, by the azimuth Δ from the light: what walls receive of it.
    Wave(u8),
}

/// A sum over all lights at a place: tables, each with its factor by the azimuth of the light.
pub(crate) type Sum = Vec<(Table, AzimuthFactor)>;

impl Table {
    /// The weights of the directions; None for waves.
    pub(crate) fn weights(self, horizon: &Horizon) -> Option<LinearMeasure> {
        Some(match self {
            Self::Zenith => LinearMeasure::zenith(horizon),
            Self::Mean => LinearMeasure::mean(horizon),
            Self::Horizontal => LinearMeasure::horizontal(horizon),
            Self::Cylindrical => LinearMeasure::cylindrical(horizon),
            Self::Spherical => LinearMeasure::spherical(horizon),
            Self::Wave(_) => return None,
        })
    }
}

impl MapMeasure {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Zenith,
        Self::Mean,
        Self::Horizontal,
        Self::Slope,
        Self::VerticalNorth,
        Self::VerticalEast,
        Self::VerticalSouth,
        Self::VerticalWest,
        Self::VerticalLargest,
        Self::Cylindrical,
        Self::Spherical,
    ];

    /// Its name in the interface: that of the number of a sky where that has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Zenith => "zenith",
            Self::Mean => "mean",
            Self::Horizontal => "horizontal",
            Self::Slope => "slope",
            Self::VerticalNorth => "vertical_north",
            Self::VerticalEast => "vertical_east",
            Self::VerticalSouth => "vertical_south",
            Self::VerticalWest => "vertical_west",
            Self::VerticalLargest => "vertical_largest",
            Self::Cylindrical => "cylindrical",
            Self::Spherical => "spherical",
        }
    }

    /// The measure of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|measure| measure.name() == name)
    }

    /// Whether it is a luminance, or else an illuminance.
    pub(crate) const fn is_luminance(self) -> bool {
        matches!(self, Self::Zenith | Self::Mean)
    }

    /// Its unit, in ASCII, where what sees the sky has the unit `of_response`.
    pub fn unit(self, of_response: &str) -> String {
        match self.is_luminance() {
            true => of_response.to_owned(),
            false if of_response == "cd m-2" => "lx".to_owned(),
            false => of_response.trim_end_matches(" sr-1").to_owned(),
        }
    }

    /// The sums over all lights that it is made of.
    pub(crate) fn sums(self) -> Vec<Sum> {
        let even = |table: Table| vec![(table, AzimuthFactor::Even)];
        let wave = |order: u8, north: f64, east: f64| {
            let factor = AzimuthFactor::Wave { order, north: north as f32, east: east as f32 };
            (Table::Wave(order), factor)
        };
        // Of a wall that faces an azimuth.
        let wall = |azimuth_rad: f64| {
            let waves = WALL_WAVES.into_iter().map(|(order, part)| {
                let (sin, cos) = (f64::from(order) * azimuth_rad).sin_cos();
                wave(order, part * cos, part * sin)
            });
            vec![std::iter::once((Table::Cylindrical, AzimuthFactor::Even)).chain(waves).collect()]
        };
        match self {
            Self::Zenith => vec![even(Table::Zenith)],
            Self::Mean => vec![even(Table::Mean)],
            Self::Horizontal => vec![even(Table::Horizontal)],
            Self::Slope => vec![even(Table::Horizontal), vec![wave(1, 0.0, 1.0)], vec![wave(1, 1.0, 0.0)]],
            Self::VerticalNorth => wall(0.0),
            Self::VerticalEast => wall(FRAC_PI_2),
            Self::VerticalSouth => wall(PI),
            Self::VerticalWest => wall(1.5 * PI),
            Self::VerticalLargest => {
                let waves = WALL_WAVES.into_iter().take(2);
                let waves = waves.flat_map(|(m, part)| [vec![wave(m, part, 0.0)], vec![wave(m, 0.0, part)]]);
                std::iter::once(even(Table::Cylindrical)).chain(waves).collect()
            }
            Self::Cylindrical => vec![even(Table::Cylindrical)],
            Self::Spherical => vec![even(Table::Spherical)],
        }
    }

    /// The value under an open sky from those sums at a place.
    pub(crate) fn of_sums(self, sums: &[f32]) -> f32 {
        match (self, sums) {
            (Self::VerticalLargest, &[mean, cos, sin, cos_2, sin_2]) if mean.is_finite() => {
                let facing = |wall: usize| {
                    let azimuth_rad = TAU as f32 * wall as f32 / WALL_COUNT as f32;
                    let ((s, c), (s_2, c_2)) = (azimuth_rad.sin_cos(), (2.0 * azimuth_rad).sin_cos());
                    mean + c * cos + s * sin + c_2 * cos_2 + s_2 * sin_2
                };
                (0..WALL_COUNT).map(facing).fold(mean, f32::max)
            }
            // 0 at least, and no number where the sum is none.
            (_, [first, ..]) => {
                if *first < 0.0 {
                    0.0
                } else {
                    *first
                }
            }
            (_, []) => f32::NAN,
        }
    }

    /// What a response sees of the dark reference outside the air, in the unit of the measure, which the colours of such maps go by,
    /// whatever the air.
    pub fn natural_value(self, response: &Response) -> f64 {
        let radiance = dark_outside().value(response);
        match self {
            Self::Zenith | Self::Mean => radiance,
            Self::Horizontal | Self::Slope => PI * radiance,
            // Walls and spheres see half of that.
            _ => FRAC_PI_2 * radiance,
        }
    }

    /// Ends of those colours, logarithmic between: from a hundredth of that, where light pollution begins to count, to forty times it.
    pub fn colour_range(self, response: &Response) -> (f64, f64) {
        let natural = self.natural_value(response);
        (0.01 * natural, 40.0 * natural)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The wall that receives most of one light faces it, and a wall that faces away from it receives next to nothing.
    #[test]
    fn the_brightest_wall_faces_the_light() {
        for azimuth_deg in [0.0f64, 50.0, 170.0, 300.0] {
            // Of a light at that azimuth that shines along the ground with 1 lx.
            let value = |table: Table, factor: AzimuthFactor| match (table, factor) {
                (Table::Cylindrical, _) => 1.0 / PI,
                (_, AzimuthFactor::Wave { order, north, east }) => {
                    let (sin, cos) = (f64::from(order) * azimuth_deg.to_radians()).sin_cos();
                    f64::from(north) * cos + f64::from(east) * sin
                }
                _ => 0.0,
            };
            let of = |measure: MapMeasure| {
                let sum = |sum: &Sum| sum.iter().map(|(table, factor)| value(*table, *factor)).sum::<f64>();
                let sums: Vec<f32> = measure.sums().iter().map(|of| sum(of) as f32).collect();
                f64::from(measure.of_sums(&sums))
            };
            assert!((of(MapMeasure::VerticalLargest) - 1.03).abs() < 0.01);
            let facing = [
                (MapMeasure::VerticalNorth, 0.0f64),
                (MapMeasure::VerticalEast, 90.0),
                (MapMeasure::VerticalSouth, 180.0),
                (MapMeasure::VerticalWest, 270.0),
            ];
            for (measure, towards_deg) in facing {
                let wanted = (azimuth_deg - towards_deg).to_radians().cos().max(0.0);
                // Where the cosine is cut off, waves up to the sixth miss it by 1/(7π).
                assert!((of(measure) - wanted).abs() < 0.046, "{azimuth_deg} {measure:?}: {}", of(measure));
            }
        }
        assert!(MapMeasure::Slope.of_sums(&[f32::NAN]).is_nan());
    }

    #[test]
    fn measures_are_found_by_their_names() {
        for measure in MapMeasure::ALL {
            assert_eq!(MapMeasure::named(measure.name()), Some(measure));
        }
        assert_eq!(MapMeasure::named("norm"), None);
    }
}
