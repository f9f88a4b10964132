//! The natural sky over all places of a map: the dark reference, or that of an instant at some places far apart, linear in between
//! (`docs/model.md#brightness`).

use crate::{
    brightness_request::{BrightnessRequest, MapLight},
    coarse_places::{self, CoarsePlaces},
    error::ObservatoryError,
    map_measure::{MapMeasure, Sum, Table},
    night_sky::{NightSky, Overhead, SkyTime, dark_sky},
    observatory::Observatory,
    sky_below::SkyBelow,
};
use glam::{DVec3, Vec2};
use skyglow_celestial::Component;
use skyglow_physics::{
    AZIMUTH_COUNT, ELEVATION_COUNT, GeoPoint, Horizon,
    panorama::{azimuth_rad, cos_sr, solid_angle_sr},
};
use skyglow_render::celestial::CelestialTables;
use skyglow_scene::{AzimuthFactor, PlaceLattice, PlaceWindow, Scene, UniformAxis};
use std::f64::consts::PI;

/// Skies of an instant at most, about, over a map known as a whole: the natural sky changes over hundreds of kilometres and kilometres of altitude.
const MAX_SKIES: usize = 144;
/// Step of altitudes at which the dark reference is found, metres.
const DARK_STEP_M: f64 = 500.0;

/// The natural sky over the places of a map.
#[derive(Debug)]
pub(crate) enum NaturalPlaces {
    /// The same in every direction.
    Even {
        altitudes: UniformAxis,
        /// What is seen of it, by altitude.
        values: Vec<f64>,
        /// Of a sky of 1 in every direction.
        one: NaturalSky,
    },
    /// Of an instant.
    Night(CoarsePlaces<NaturalSky>),
}

/// What a response sees of a natural sky.
#[derive(Debug)]
pub(crate) struct NaturalSky {
    /// The sums of the measure without Moon and Sun, and those of Moon and Sun.
    sums: Vec<f64>,
    disc_sums: Vec<f64>,
    /// None in the dark.
    below: Option<SkyBelow>,
    /// Towards Moon and Sun above the horizontal plane, and their irradiance across.
    discs: Vec<(DVec3, f64)>,
}

/// The natural sky at a place, for its ground.
pub(crate) struct NaturalAt<'a> {
    /// The vector irradiance without Moon and Sun: upwards, eastwards, northwards.
    pub(crate) irradiance: [f64; 3],
    pub(crate) around: Vec<(&'a SkyBelow, f64)>,
    /// As [`NaturalSky::discs`].
    pub(crate) discs: Vec<(DVec3, f64)>,
}

impl NaturalPlaces {
    /// For the places of a window; None where artificial light alone is asked for.
    ///
    /// * `observers_m`: lowest and highest altitude of the eye over all of the lattice, metres; None where nobody can be.
    ///
    /// # Errors
    /// [`ObservatoryError::NoCelestialTables`] for an instant.
    pub(crate) fn new(
        observatory: &Observatory,
        scene: &Scene,
        request: &BrightnessRequest,
        (lattice, window): (PlaceLattice, &PlaceWindow),
        observers_m: Option<[f32; 2]>,
    ) -> Result<Option<Self>, ObservatoryError> {
        let MapLight::Total(time) = request.light else { return Ok(None) };
        let tables = observatory.celestial_tables();
        let Some(time) = time else {
            let [lowest_m, highest_m] = observers_m.unwrap_or_default().map(f64::from);
            let altitudes = UniformAxis::between(lowest_m, highest_m, DARK_STEP_M, usize::MAX);
            let value = |node: usize| {
                dark_sky(tables, request.turbidity, altitudes.node_m(node)).value(&request.response)
            };
            let values = (0..altitudes.count).map(value).collect();
            let plane = vec![1.0; ELEVATION_COUNT * AZIMUTH_COUNT];
            let one = NaturalSky::new(&plane, Vec::new(), request.measure);
            return Ok(Some(Self::Even { altitudes, values, one }));
        };
        let tables = tables.ok_or(ObservatoryError::NoCelestialTables)?;
        let stride = coarse_places::stride(scene, lattice, MAX_SKIES);
        let skies = CoarsePlaces::new(lattice, window, stride, |column, row| {
            let altitude_m = f64::from(observatory.eye_at(scene, request, lattice, [column, row]));
            match altitude_m.is_finite() {
                true => {
                    let place = scene.lattice_place(lattice, column, row);
                    NaturalSky::at(tables, (place, altitude_m), time, request).map(Some)
                }
                false => Ok(None),
            }
        })?;
        Ok(Some(Self::Night(skies)))
    }

    /// The sums of the measure at a place of the lattice, for an eye at an altitude, metres; all of them under an open sky.
    pub(crate) fn sums_at(&self, at: [u32; 2], eye_m: f64) -> Vec<f64> {
        match self {
            Self::Even { one, .. } => one.sums.iter().map(|sum| sum * self.even_value(eye_m)).collect(),
            Self::Night(skies) => {
                let around = skies.around(at);
                let count = around.first().map_or(0, |(sky, _)| sky.sums.len());
                let sum = |number: usize| {
                    around
                        .iter()
                        .map(|(sky, weight)| weight * (sky.sums[number] + sky.disc_sums[number]))
                        .sum()
                };
                (0..count).map(sum).collect()
            }
        }
    }

    /// The same for sloping ground.
    pub(crate) fn sky_at(&self, at: [u32; 2], eye_m: f64) -> NaturalAt<'_> {
        let vector = |sums: &[f64], factor: f64| match sums {
            [up, east, north] => [*up, *east, *north].map(|part| factor * part),
            _ => [0.0; 3],
        };
        match self {
            Self::Even { one, .. } => NaturalAt {
                irradiance: vector(&one.sums, self.even_value(eye_m)),
                around: one.below.iter().map(|below| (below, 1.0)).collect(),
                discs: Vec::new(),
            },
            Self::Night(skies) => {
                let around = skies.around(at);
                let mut irradiance = [0.0; 3];
                for (sky, weight) in &around {
                    let of = vector(&sky.sums, *weight);
                    irradiance.iter_mut().zip(of).for_each(|(sum, part)| *sum += part);
                }
                let discs = discs_between(&around);
                let up = |sky: &NaturalSky| sky.sums.first().copied().unwrap_or_default();
                // Low skies are in parts of their own horizontal illuminance.
                let below = around.iter().filter_map(|(sky, weight)| {
                    let share = if irradiance[0] > 0.0 { weight * up(sky) / irradiance[0] } else { 0.0 };
                    Some((sky.below.as_ref()?, share))
                });
                NaturalAt { irradiance, around: below.collect(), discs }
            }
        }
    }

    fn even_value(&self, eye_m: f64) -> f64 {
        let Self::Even { altitudes, values, .. } = self else { return 0.0 };
        let place = ((eye_m - altitudes.first_m) / altitudes.step_m).clamp(0.0, (altitudes.count - 1) as f64);
        let below = (place as usize).min(altitudes.count - 2);
        values[below] + (place - below as f64) * (values[below + 1] - values[below])
    }
}

/// Moon and Sun as places around have them, by their weights: where one of them has set over some, as the nearest has them.
fn discs_between(around: &[(&NaturalSky, f64)]) -> Vec<(DVec3, f64)> {
    let Some((nearest, _)) = around.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else { return Vec::new() };
    if around.iter().any(|(sky, _)| sky.discs.len() != nearest.discs.len()) {
        return nearest.discs.clone();
    }
    let disc = |number: usize| {
        let beam: DVec3 =
            around.iter().map(|(sky, weight)| weight * sky.discs[number].1 * sky.discs[number].0).sum();
        (beam.normalize_or_zero(), beam.length())
    };
    (0..nearest.discs.len()).map(disc).collect()
}

impl NaturalSky {
    fn at(
        tables: &CelestialTables,
        (place, altitude_m): (GeoPoint, f64),
        time: SkyTime,
        request: &BrightnessRequest,
    ) -> Result<Self, ObservatoryError> {
        let horizon = Horizon::flat();
        let turbidity = request.turbidity;
        let over = Overhead { place, altitude_m, horizon: &horizon, turbidity, gaps: None };
        let night = NightSky::new(tables, &over, time, std::slice::from_ref(&request.response))?;
        let mut plane = night.seen().plane(0).to_vec();
        let beams = |component: Component| night.beams_of(component, &request.response);
        if !request.measure.is_luminance() {
            // Stars and planets light surfaces as if each filled the cell around the nearest sample.
            for (direction, value) in [Component::Planets, Component::Stars].into_iter().flat_map(beams) {
                let (row, column) = direction.nearest_sample();
                plane[row * AZIMUTH_COUNT + column] += (value / solid_angle_sr(row)) as f32;
            }
        }
        let discs = [Component::Moon, Component::Sun].into_iter().flat_map(beams);
        let discs = discs.map(|(direction, value)| (direction.enu(), value)).collect();
        Ok(Self::new(&plane, discs, request.measure))
    }

    /// * `plane`: what is seen in every direction, `[row][column]`.
    fn new(plane: &[f32], discs: Vec<(DVec3, f64)>, measure: MapMeasure) -> Self {
        let of = measure.sums();
        let disc_sums = of.iter().map(|sum| discs.iter().map(|disc| sum_of_disc(sum, *disc)).sum()).collect();
        let sums = of.iter().map(|sum| sum_of_plane(sum, plane)).collect();
        Self { sums, disc_sums, below: SkyBelow::new(plane), discs }
    }
}

/// A sum over all lights of a sky by its directions.
fn sum_of_plane(sum: &Sum, plane: &[f32]) -> f64 {
    let part = |(table, factor): &(Table, AzimuthFactor)| match table.weights(&Horizon::flat()) {
        Some(measure) => measure.of(plane),
        None => {
            let towards: Vec<f64> = (0..AZIMUTH_COUNT)
                .map(|column| {
                    let (sin, cos) = azimuth_rad(column).sin_cos();
                    f64::from(factor.towards(Vec2::new(sin as f32, cos as f32)))
                })
                .collect();
            let of_row = |(row, values): (usize, &[f32])| {
                let of_row = values.iter().zip(&towards).map(|(value, towards)| f64::from(*value) * towards);
                cos_sr(row) * of_row.sum::<f64>()
            };
            plane.chunks_exact(AZIMUTH_COUNT).enumerate().map(of_row).sum()
        }
    };
    sum.iter().map(part).sum()
}

/// What Moon or Sun bring to it; nothing to luminances.
fn sum_of_disc(sum: &Sum, (towards, value): (DVec3, f64)) -> f64 {
    let along = towards.truncate().length();
    let part = |(table, factor): &(Table, AzimuthFactor)| match table {
        Table::Zenith | Table::Mean => 0.0,
        Table::Horizontal => towards.z,
        Table::Cylindrical => along / PI,
        Table::Spherical => 0.25,
        Table::Wave(_) => along * f64::from(factor.towards(towards.truncate().normalize_or_zero().as_vec2())),
    };
    value * sum.iter().map(part).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a uniform sky level ground receives π, walls and spheres π/2, slopes have no side; of a disc what its direction says.
    #[test]
    fn skies_have_the_sums_of_measures() {
        let plane = vec![1.0; ELEVATION_COUNT * AZIMUTH_COUNT];
        let disc = (DVec3::new(0.6, 0.0, 0.8), 10.0);
        for (measure, of_sky, of_disc) in [
            (MapMeasure::Zenith, 1.0, 0.0),
            (MapMeasure::Horizontal, PI, 8.0),
            (MapMeasure::Slope, PI, 8.0),
            (MapMeasure::Cylindrical, 0.5 * PI, 6.0 / PI),
            (MapMeasure::Spherical, 0.5 * PI, 2.5),
            (MapMeasure::VerticalEast, 0.5 * PI, 6.04),
            (MapMeasure::VerticalLargest, 0.5 * PI, 6.18),
            (MapMeasure::VerticalWest, 0.5 * PI, 0.04),
        ] {
            let sky = NaturalSky::new(&plane, vec![disc], measure);
            let value = |sums: &[f64]| {
                let sums: Vec<f32> = sums.iter().map(|sum| *sum as f32).collect();
                f64::from(measure.of_sums(&sums))
            };
            assert!((value(&sky.sums) - of_sky).abs() < 1e-3, "{measure:?} {:?}", sky.sums);
            assert!((value(&sky.disc_sums) - of_disc).abs() < 0.01, "{measure:?} {:?}", sky.disc_sums);
        }
    }

    /// Between two skies the Moon is between theirs, and where it has set over one, as the nearer has it.
    #[test]
    fn the_moon_goes_from_sky_to_sky() {
        let plane = vec![0.0; ELEVATION_COUNT * AZIMUTH_COUNT];
        let sky = |discs: Vec<(DVec3, f64)>| NaturalSky::new(&plane, discs, MapMeasure::Slope);
        let (low, high) = (DVec3::new(0.8, 0.0, 0.6), DVec3::new(0.6, 0.0, 0.8));
        let (one, two, set) = (sky(vec![(low, 1.0)]), sky(vec![(high, 3.0)]), sky(Vec::new()));
        let between = discs_between(&[(&one, 0.5), (&two, 0.5)]);
        assert!((between[0].1 * between[0].0 - DVec3::new(1.3, 0.0, 1.5)).length() < 1e-12, "{between:?}");
        assert_eq!(discs_between(&[(&one, 0.6), (&set, 0.4)]), one.discs);
        assert!(discs_between(&[(&one, 0.4), (&set, 0.6)]).is_empty() && discs_between(&[]).is_empty());
    }
}
