//! The natural sky over a place at an instant: Sun, Moon, planets, stars, starlight, zodiacal light and airglow, each with the light
//! that the same air scatters as artificial light is scattered in (`docs/model.md#night-sky`).

mod bodies;
mod dark;
mod limits;
mod skipping;

pub use bodies::{SeenDisc, SeenPoint};
pub use dark::{dark_outside, dark_sky};
pub use limits::{DirectionLimit, SeenStars};
pub use skipping::{DAY_BOUND, MOON_LOWEST_DEG};

use crate::error::ObservatoryError;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use skipping::Skipping;
use skyglow_celestial::{Component, Heavens, Instant, IrradianceGrid, PointLight, Site};
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, BeamSums, Direction, ELEVATION_COUNT, Gaps, GeoPoint, Horizon, NaturalLight,
    NodeLight, Panorama, Response, SeenSky, SkyPart, Slope, Turbidity,
    beam::apparent_altitude_rad,
    natural_sky::meter_mean_of_points,
    panorama::{azimuth_rad, elevation_rad},
};
use skyglow_render::celestial::{BeamGrid, CelestialTables, SkiesAt};
use std::{f64::consts::FRAC_PI_2, sync::Arc};

/// Highest eye that positions are found for, m: beyond it nothing in the sky moves.
const HIGHEST_SITE_M: f64 = 12_000.0;

/// When a sky is asked for, and what the Sun did to the upper air.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SkyTime {
    /// The instant, to the second.
    pub instant: Instant,
    /// Radio flux of the Sun at 10.7 cm, solar flux units.
    pub solar_flux_sfu: f64,
}

/// Where the eye is, and what is around it.
#[derive(Clone, Copy, Debug)]
pub struct Overhead<'a> {
    /// The place.
    pub place: GeoPoint,
    /// Altitude of the eye above sea level, m.
    pub altitude_m: f64,
    /// Below it the sky is hidden.
    pub horizon: &'a Horizon,
    /// Turbidity at sea level.
    pub turbidity: Turbidity,
    /// Between them clouds hide the sky; None under a clear one.
    pub gaps: Option<&'a Gaps>,
}

/// One component of the natural sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComponentSky {
    /// Which.
    pub component: Component,
    /// Mean luminance within 5° of the zenith, cd m⁻²: scattered light, and of what has a radiance in every direction the direct light.
    pub zenith_luminance_cd_m2: f64,
    /// The same over the visible sky.
    pub mean_luminance_cd_m2: f64,
    /// Illuminance across the beams of its points that stand above the horizon, lx; 0 for what has no points.
    pub direct_illuminance_lx: f64,
}

/// The natural sky over a place at an instant.
#[derive(Clone, Debug)]
pub struct NightSky {
    heavens: Heavens,
    components: Vec<ComponentSky>,
    /// One for each component.
    parts: Vec<SkyPart>,
    seen: SeenSky,
    /// Points that stand above the horizon, by the place of their component; none of stars that do not count.
    points: [Vec<ThroughAir>; Component::ALL.len()],
    /// Means of the points' light over the field of a Sky Quality Meter at the zenith.
    in_meter: Vec<NodeLight>,
    /// Share that comes through the air at every row of the panorama.
    transmittance: [[f64; BAND_COUNT]; ELEVATION_COUNT],
}

impl NightSky {
    /// All components that count, as `responses` see them.
    ///
    /// # Errors
    /// [`ObservatoryError::Celestial`] for a solar flux out of range.
    pub fn new(
        tables: &CelestialTables,
        over: &Overhead<'_>,
        time: SkyTime,
        responses: &[Response],
    ) -> Result<Self, ObservatoryError> {
        Self::with(tables, over, time, responses, Skipping::OfWhatDoesNotCount)
    }

    fn with(
        tables: &CelestialTables,
        over: &Overhead<'_>,
        time: SkyTime,
        responses: &[Response],
        skipping: Skipping,
    ) -> Result<Self, ObservatoryError> {
        let place = over.place;
        let site =
            Site::new(place.latitude_deg(), place.longitude_deg(), over.altitude_m.min(HIGHEST_SITE_M))?;
        let heavens = Heavens::new(site, time.instant, time.solar_flux_sfu)?;
        let maker = Maker { tables, over, heavens: &heavens, looks: looks(tables, over), skies: None };
        let sun = maker.part(Component::Sun);
        let wanted = skipping.wanted(&heavens, sun.as_ref());
        // Once for all components, before they are looked for side by side.
        let has_grid = wanted.iter().any(|component| *component != Component::Moon);
        let skies = has_grid.then(|| tables.skies_at(over.turbidity, over.altitude_m));
        let maker = Maker { skies, ..maker };
        let (points, others) = rayon::join(
            || {
                Component::ALL.map(|component| {
                    let counts = component != Component::Stars || wanted.contains(&component);
                    let points = if counts { heavens.points(component) } else { &[] };
                    points.par_iter().filter_map(|point| maker.through(point)).collect::<Vec<_>>()
                })
            },
            || -> Vec<(Component, SkyPart)> {
                let others = wanted.par_iter();
                others.filter_map(|component| Some((*component, maker.part(*component)?))).collect()
            },
        );
        let sun = sun.map(|part| (Component::Sun, part));
        let found: Vec<(Component, SkyPart)> = sun.into_iter().chain(others).collect();
        let numbers = found
            .par_iter()
            .map(|(component, part)| maker.component(*component, part, &points[component.index()]));
        let components = numbers.collect();
        let parts: Vec<SkyPart> = found.into_iter().map(|(_, part)| part).collect();
        let transmittance = std::array::from_fn(|row| maker.looks[row].transmittance);
        let seen = SeenSky::of(&parts, responses);
        let of_points = |sum: &dyn Fn(&[ThroughAir]) -> [f64; BAND_COUNT]| {
            let light = |component: Component| NodeLight {
                light: Arc::clone(component.light()),
                kernel: sum(&points[component.index()]),
            };
            Component::BODIES.map(light).to_vec()
        };
        let in_meter = of_points(&|points| {
            let beams = points.iter();
            let beams = beams.map(|point| (FRAC_PI_2 - point.direction.elevation_rad, point.irradiance));
            meter_mean_of_points(beams, over.horizon)
        });
        Ok(Self { heavens, components, parts, seen, points, in_meter, transmittance })
    }

    /// What shines outside the air.
    pub fn heavens(&self) -> &Heavens {
        &self.heavens
    }

    /// Components that count, in their order.
    pub fn components(&self) -> &[ComponentSky] {
        &self.components
    }

    /// Their kinds of light with their kernels, dark below the horizon; one for each of [`Self::components`].
    pub fn parts(&self) -> &[SkyPart] {
        &self.parts
    }

    /// Bytes of its points.
    pub(crate) fn points_byte_count(&self) -> usize {
        self.points.iter().map(|points| size_of_val(points.as_slice())).sum()
    }

    /// What comes straight from its points to surfaces.
    pub(crate) fn beams(&self, slope: Slope) -> Vec<BeamSums> {
        let of = |component: Component| {
            let points = &self.points[component.index()];
            let beams = points.iter().map(|point| (point.direction, point.irradiance));
            BeamSums::new(Arc::clone(component.light()), slope, beams)
        };
        Component::BODIES.map(of).to_vec()
    }

    /// For quantities, with its [`Self::beams`].
    pub(crate) fn natural_light<'a>(&'a self, beams: &'a [BeamSums]) -> NaturalLight<'a> {
        NaturalLight { parts: &self.parts, seen: &self.seen, points: &self.in_meter, beams }
    }

    /// What the responses that it was made for see of all of them.
    pub fn seen(&self) -> &SeenSky {
        &self.seen
    }
}

/// The band that stands for V.
const V_BAND: usize = skyglow_physics::Band::MIDDLE.index();

/// A point of light as it comes through the air.
#[derive(Clone, Copy, Debug)]
struct ThroughAir {
    /// Where it is seen, refraction included.
    direction: Direction,
    /// V outside the air.
    magnitude_v: f64,
    /// Across the beam at every node, in the unit of its component.
    irradiance: [f64; BAND_COUNT],
}

/// What a row of the panorama looks through.
#[derive(Clone, Copy)]
struct Look {
    /// Elevation outside the air: refraction lifts what is seen.
    true_elevation_rad: f64,
    transmittance: [f64; BAND_COUNT],
}

fn looks(tables: &CelestialTables, over: &Overhead<'_>) -> [Look; ELEVATION_COUNT] {
    std::array::from_fn(|row| {
        let seen_deg = elevation_rad(row).to_degrees();
        let lift = |true_deg: f64| {
            apparent_altitude_rad(true_deg.to_radians(), over.altitude_m).to_degrees() - true_deg
        };
        let lift_deg = lift(seen_deg - lift(seen_deg));
        let true_elevation_rad = (seen_deg - lift_deg).to_radians();
        let zenith_rad = FRAC_PI_2 - true_elevation_rad;
        let transmittance = tables.transmittance(over.turbidity, zenith_rad, over.altitude_m);
        Look { true_elevation_rad, transmittance }
    })
}

/// Makes parts of one sky.
struct Maker<'a> {
    tables: &'a CelestialTables,
    over: &'a Overhead<'a>,
    heavens: &'a Heavens,
    looks: [Look; ELEVATION_COUNT],
    /// For light on many beams; None where there is none.
    skies: Option<SkiesAt<'a>>,
}

impl Maker<'_> {
    /// The sky of a component, dark below the horizon; None where it gives the tables' zenith angles no light.
    fn part(&self, component: Component) -> Option<SkyPart> {
        let mut kernel = match component {
            Component::Sun | Component::Moon => self.body(component)?,
            _ => self.grid(component),
        };
        if component.is_extended() {
            self.add_direct(component, &mut kernel);
        }
        if let Some(gaps) = self.over.gaps {
            gaps.put_before(&mut kernel, self.onto_level(component));
        }
        self.over.horizon.darken(&mut kernel);
        Some(SkyPart { light: Arc::clone(component.light()), kernel })
    }

    /// What comes straight from the points of a component to level ground under a clear sky.
    fn onto_level(&self, component: Component) -> [f64; BAND_COUNT] {
        let mut sum = [0.0; BAND_COUNT];
        for point in self.heavens.points(component) {
            if let Some((direction, irradiance)) = self.straight(point) {
                let share = direction.elevation_rad.sin();
                sum.iter_mut().zip(irradiance).for_each(|(sum, value)| *sum += share * value);
            }
        }
        sum
    }

    /// Where a point is seen and what the air lets through of it; None below the horizontal plane.
    fn straight(&self, point: &PointLight) -> Option<(Direction, [f64; BAND_COUNT])> {
        let elevation_rad = apparent_altitude_rad(point.direction.elevation_rad, self.over.altitude_m);
        if elevation_rad < 0.0 {
            return None;
        }
        let zenith_rad = FRAC_PI_2 - point.direction.elevation_rad;
        let through = self.tables.transmittance(self.over.turbidity, zenith_rad, self.over.altitude_m);
        let irradiance = std::array::from_fn(|band| through[band] * point.irradiance[band]);
        Some((Direction { elevation_rad, ..point.direction }, irradiance))
    }

    /// Scattered light of Sun or Moon.
    fn body(&self, component: Component) -> Option<Panorama> {
        let point = *self.heavens.points(component).first()?;
        let zenith_rad = FRAC_PI_2 - point.direction.elevation_rad;
        if self.tables.zenith_angles_rad().last().is_none_or(|last| zenith_rad > *last) {
            return None;
        }
        let beam = (zenith_rad, point.direction.azimuth_rad);
        let mut sky = self.tables.beam_sky(self.over.turbidity, beam, self.over.altitude_m);
        let samples = sky.samples_mut().chunks_exact_mut(ELEVATION_COUNT * AZIMUTH_COUNT);
        for (samples, irradiance) in samples.zip(point.irradiance) {
            samples.iter_mut().for_each(|sample| *sample *= irradiance as f32);
        }
        Some(sky)
    }

    /// Scattered light of many beams.
    fn grid(&self, component: Component) -> Panorama {
        let angles = self.tables.zenith_angles_rad();
        let grid = IrradianceGrid::of(self.heavens, component, angles);
        let values = grid.values().iter().map(|value| *value as f32).collect();
        let grid = BeamGrid::new(angles.len(), values);
        grid.zip(self.skies.as_ref()).map_or_else(Panorama::dark, |(grid, skies)| skies.sky(&grid))
    }

    /// Adds what comes through the air without being scattered.
    fn add_direct(&self, component: Component, kernel: &mut Panorama) {
        let rows: Vec<Vec<[f64; BAND_COUNT]>> = (0..ELEVATION_COUNT)
            .into_par_iter()
            .map(|row| {
                let look = self.looks[row];
                let (up, level) = look.true_elevation_rad.max(0.0).sin_cos();
                let outside = |column: usize| {
                    let (east, north) = azimuth_rad(column).sin_cos();
                    let enu = DVec3::new(level * east, level * north, up);
                    let radiance = self.heavens.radiance_outside_enu(component, enu);
                    std::array::from_fn(|band| radiance[band] * look.transmittance[band])
                };
                // A layer of the air looks alike in all directions of a row.
                match component {
                    Component::Airglow => vec![outside(0); AZIMUTH_COUNT],
                    _ => (0..AZIMUTH_COUNT).map(outside).collect(),
                }
            })
            .collect();
        let samples = kernel.samples_mut();
        for (row, columns) in rows.iter().enumerate() {
            for (column, radiance) in columns.iter().enumerate() {
                for (band, value) in radiance.iter().enumerate() {
                    samples[Panorama::index(band, row, column)] += *value as f32;
                }
            }
        }
    }

    fn component(&self, component: Component, part: &SkyPart, points: &[ThroughAir]) -> ComponentSky {
        let [zenith, mean] = part.zenith_and_mean(&Response::Photopic, self.over.horizon);
        let rule = component.light().rule(&Response::Photopic);
        let mut direct = [0.0; BAND_COUNT];
        for point in points {
            direct.iter_mut().zip(point.irradiance).for_each(|(sum, value)| *sum += value);
        }
        ComponentSky {
            component,
            zenith_luminance_cd_m2: zenith,
            mean_luminance_cd_m2: mean,
            direct_illuminance_lx: rule.value(direct),
        }
    }

    /// A point as it comes through the air; None below the horizon.
    fn through(&self, point: &PointLight) -> Option<ThroughAir> {
        let (direction, irradiance) = self.straight(point)?;
        let gap = self.over.gaps.map_or(1.0, |gaps| gaps.towards(direction));
        if gap == 0.0 || self.over.horizon.hides(direction) {
            return None;
        }
        let irradiance = irradiance.map(|value| gap * value);
        Some(ThroughAir { direction, magnitude_v: point.magnitude_v, irradiance })
    }
}

#[cfg(test)]
mod published;
#[cfg(test)]
mod tests;
