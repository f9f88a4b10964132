//! Backward Monte Carlo through clouds as bodies: every order of scattering in air, drops, ground, by paths from the observer
//! (Marchuk et al. 1980) with next-event estimation (Coveyou et al. 1967).
//!
//! Free paths and directions of drops are drawn as light has them, so weights hardly grow over many of them. Direct light that air
//! scatters into a ray is an integral along it, estimated by one equiangular sample for every ray (Kulla and Fajardo 2012); direct light
//! that drops or surfaces send on is added where the path meets them.

use super::{
    super::{
        optics::{SlantPath, columns_to_space_m, optical_depths, relative_densities},
        setting::SourceSetting,
    },
    cloud_cells::{CloudField, Clouds, between_spheres, sphere_m},
    draws::{Random, lambertian_direction, mixed_phase, path_of_depth_m, scattered_direction, turned},
};
use crate::{
    atmosphere::AEROSOL_ALBEDO,
    bands::Band,
    cone::sin_blocking,
    drop_reflectance::DROP_ASYMMETRY,
    emission::{EmissionMix, LOBE_COUNT, lobe_intensities_per_sr},
    geometry::EARTH_RADIUS_M,
    phase::henyey_greenstein_per_sr,
};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Top of the atmosphere for paths, metres.
const TOP_ALTITUDE_M: f64 = 100_000.0;
/// A light nearer than this counts as so far away, metres, as everywhere in the program.
const MIN_DISTANCE_M: f64 = 250.0;
/// Optical depth through clouds at which direct light counts as gone.
const OPAQUE_DEPTH: f64 = 30.0;
/// Russian roulette: paths of a smaller weight survive by chance only.
const MIN_WEIGHT: f64 = 0.1;
/// Rays shorter than this [m] have the integral of direct light along them taken by chance only, at least so often.
const LONG_RAY_M: f64 = 1_000.0;
const MIN_CHANCE: f64 = 0.05;
const MAX_VERTICES: usize = 5_000;
/// Rays leave a surface from this far off it, metres.
const OFF_SURFACE_M: f64 = 1e-4;
/// Paths of one random stream; streams are summed in order, whatever thread ran them.
const STREAM_PATHS: u64 = 1_024;

/// A town: a level disc of lights, as bright everywhere, as an observer sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Town {
    /// Of its centre from the observer, metres.
    pub distance_m: f64,
    /// Of the disc, metres; 0 is a point.
    pub radius_m: f64,
    /// How its lights send out their light.
    pub emission: EmissionMix,
}

impl Town {
    /// How far away lights are that stand for equal shares of it, metres: `rings` by `around` of them.
    pub fn distances_m(&self, rings: usize, around: usize) -> Vec<f64> {
        if self.radius_m <= 0.0 {
            return vec![self.distance_m.max(MIN_DISTANCE_M)];
        }
        let share = |at: usize, of: usize| (at as f64 + 0.5) / of as f64;
        let at = |i: usize| self.light_m(share(i / around, rings), share(i % around, around));
        (0..rings * around).map(at).collect()
    }

    /// How far a light of it is away, metres, by two numbers in 0..1.
    fn light_m(&self, across: f64, around: f64) -> f64 {
        let from_centre_m = self.radius_m * across.sqrt();
        let (sine, cosine) = (TAU * around).sin_cos();
        (self.distance_m + from_centre_m * cosine).hypot(from_centre_m * sine).max(MIN_DISTANCE_M)
    }
}

/// Radiance with its standard error, per watt, m⁻² sr⁻¹.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanRadiance {
    /// Mean over paths.
    pub radiance_per_m2_sr: f64,
    /// Standard error of the mean.
    pub standard_error_per_m2_sr: f64,
}

/// A tracer of one band through air with clouds, over the ground of a setting whose own air is clear.
#[derive(Clone, Debug)]
pub struct CloudTracer {
    setting: SourceSetting,
    clouds: Option<CloudField>,
    molecules_per_m: f64,
    aerosol_per_m: f64,
    band: usize,
    observer_m: f64,
    source: DVec3,
    source_density: [f64; 2],
}

/// One path as it is followed.
struct Walk<'a> {
    clouds: Option<Clouds<'a>>,
    lobes: [f64; LOBE_COUNT],
    position: DVec3,
    direction: DVec3,
    weight: f64,
    sum: f64,
}

/// What a ray meets first.
enum Event {
    Air {
        density: [f64; 2],
    },
    Drop,
    /// A Lambertian surface: its bright side faces up (1) or down (−1).
    Surface {
        albedo: f64,
        side: f64,
    },
}

impl CloudTracer {
    /// A tracer of a band, of a setting, for an observer at an altitude [m]; `clouds` None is the clear sky.
    pub fn new(setting: SourceSetting, clouds: Option<CloudField>, band: Band, observer_m: f64) -> Self {
        Self {
            setting,
            clouds,
            molecules_per_m: setting.atmosphere.molecule_extinction_per_m()[band.index()],
            aerosol_per_m: setting.atmosphere.aerosol_extinction_per_m()[band.index()],
            band: band.index(),
            observer_m,
            source: DVec3::Z * (EARTH_RADIUS_M + setting.source_altitude_m),
            source_density: relative_densities(setting.source_altitude_m),
        }
    }

    /// Estimates the radiance at an elevation, mean over all azimuths and all patterns of the clouds, from `paths` paths (rounded up
    /// to whole streams). The same seed gives the same numbers on any number of threads.
    pub fn estimate(&self, town: &Town, elevation_rad: f64, paths: u64, seed: u64) -> MeanRadiance {
        let streams = paths.div_ceil(STREAM_PATHS).max(1);
        let of_stream = |stream: u64| {
            let mut random = Random::new(seed, stream);
            (0..STREAM_PATHS).fold([0.0; 2], |[sum, squares], _| {
                let value = self.trace(town, elevation_rad, &mut random);
                [sum + value, squares + value * value]
            })
        };
        let sums: Vec<[f64; 2]> = (0..streams).into_par_iter().map(of_stream).collect();
        let count = (streams * STREAM_PATHS) as f64;
        let [mean, squares] = [0, 1].map(|which| sums.iter().map(|sum| sum[which]).sum::<f64>() / count);
        MeanRadiance {
            radiance_per_m2_sr: mean,
            standard_error_per_m2_sr: ((squares - mean * mean).max(0.0) / count).sqrt(),
        }
    }

    /// One path: what it contributes.
    fn trace(&self, town: &Town, elevation_rad: f64, random: &mut Random) -> f64 {
        // The light on the z axis, the observer so far from it, looking anywhere around.
        let distance_m = town.light_m(random.unit(), random.unit());
        let (sine, cosine) = (distance_m / EARTH_RADIUS_M).sin_cos();
        let (up, towards) = (DVec3::new(sine, 0.0, cosine), DVec3::new(-cosine, 0.0, sine));
        let (sin_az, cos_az) = (TAU * random.unit()).sin_cos();
        let (sin_el, cos_el) = elevation_rad.sin_cos();
        let mut walk = Walk {
            clouds: self.clouds.as_ref().map(|clouds| clouds.drawn(random)),
            lobes: town.emission.weights(),
            position: up * (EARTH_RADIUS_M + self.observer_m),
            direction: (towards * cos_az + DVec3::Y * sin_az) * cos_el + up * sin_el,
            weight: 1.0,
            sum: 0.0,
        };
        for _ in 0..MAX_VERTICES {
            if !self.step(&mut walk, random) {
                break;
            }
            if walk.weight < MIN_WEIGHT {
                if random.unit() * MIN_WEIGHT >= walk.weight {
                    break;
                }
                walk.weight = MIN_WEIGHT;
            }
        }
        walk.sum
    }

    /// Follows a path to its next event; false where it ends.
    fn step(&self, walk: &mut Walk<'_>, random: &mut Random) -> bool {
        let radius_m = walk.position.length();
        let cos_zenith = walk.direction.dot(walk.position) / radius_m;
        let path = SlantPath::new(radius_m - EARTH_RADIUS_M, cos_zenith);
        let ground_m = path.path_down_to_m(self.setting.ground_altitude_m);
        let mut end_m = ground_m.unwrap_or_else(|| path.path_up_to_m(TOP_ALTITUDE_M));
        let mut event = ground_m.map(|_| Event::Surface { albedo: self.setting.ground_albedo, side: 1.0 });
        if let Some(clouds) = &walk.clouds {
            if let Some(albedo) = clouds.field().lid_albedo() {
                if let Some((lid_m, side)) = lid_met(walk, clouds, radius_m, cos_zenith, end_m) {
                    (end_m, event) = (lid_m, Some(Event::Surface { albedo, side }));
                }
            } else if let Some(drop_m) = drop_met(walk, clouds, radius_m, cos_zenith, end_m, random) {
                (end_m, event) = (drop_m, Some(Event::Drop));
            }
        }
        if end_m <= 1e-6 {
            return false;
        }
        self.add_air_light(walk, &path, end_m, random);
        let depth_at = |u: f64| optical_depths(&self.setting.atmosphere, path.point(u).columns_m)[self.band];
        let (drawn, whole) = (-random.unit().ln(), depth_at(end_m));
        if drawn < whole {
            end_m = path_of_depth_m(drawn, whole, end_m, depth_at);
            event = Some(Event::Air { density: path.point(end_m).density });
        }
        walk.position += walk.direction * end_m;
        let Some(event) = event else { return false };
        match event {
            Event::Air { density } => {
                let (m, a) = (self.molecules_per_m * density[0], self.aerosol_per_m * density[1]);
                let (next, factor) = self.draw_direction(walk, [m, AEROSOL_ALBEDO * a], random);
                walk.weight *= factor / (m + a);
                walk.direction = next;
            }
            Event::Drop => {
                if let Some((light_per_m2, from_source)) = self.direct(walk, walk.position) {
                    let cosine = (-from_source.dot(walk.direction)).clamp(-1.0, 1.0);
                    walk.sum += walk.weight * light_per_m2 * henyey_greenstein_per_sr(cosine, DROP_ASYMMETRY);
                }
                walk.direction = henyey_greenstein_direction(walk.direction, random);
            }
            Event::Surface { albedo, side } => {
                let normal = walk.position.normalize() * side;
                walk.position += normal * OFF_SURFACE_M;
                if let Some((light_per_m2, from_source)) = self.direct(walk, walk.position) {
                    let facing = (-from_source.dot(normal)).max(0.0);
                    walk.sum += walk.weight * light_per_m2 * facing * albedo / PI;
                }
                walk.weight *= albedo;
                walk.direction = lambertian_direction(normal, random);
            }
        }
        walk.weight > 0.0
    }

    /// Draws where light that air scatters into a path came from, half of the time evenly in the angle from the source's direction, and
    /// the weight of the draw, m⁻¹ (balance heuristic, Veach and Guibas 1995).
    fn draw_direction(&self, walk: &Walk<'_>, scatterers: [f64; 2], random: &mut Random) -> (DVec3, f64) {
        let total = scatterers[0] + scatterers[1];
        let to_source = (self.source - walk.position).normalize();
        let next = if random.unit() < 0.5 {
            turned(to_source, (PI * random.unit()).cos(), TAU * random.unit())
        } else {
            scattered_direction(walk.direction, scatterers, random)
        };
        let cosine = next.dot(to_source).clamp(-1.0, 1.0);
        let even = 1.0 / (PI * TAU * (1.0 - cosine * cosine).sqrt().max(1e-9));
        let scattering = mixed_phase(scatterers, next.dot(walk.direction));
        (next, scattering / (0.5 * (even + scattering / total)))
    }

    /// Adds the direct light that air along a ray scatters into it.
    fn add_air_light(&self, walk: &mut Walk<'_>, path: &SlantPath, end_m: f64, random: &mut Random) {
        let chance = (end_m / LONG_RAY_M).clamp(MIN_CHANCE, 1.0);
        if chance < 1.0 && random.unit() >= chance {
            return;
        }
        let from_source = walk.position - self.source;
        let nearest_m = -from_source.dot(walk.direction);
        let miss_m = (from_source + walk.direction * nearest_m).length().max(1e-3);
        let angle = |u: f64| ((u - nearest_m) / miss_m).atan();
        let (low, high) = (angle(0.0), angle(end_m));
        let tangent = (low + (high - low) * random.unit()).tan();
        let path_m = (nearest_m + miss_m * tangent).clamp(0.0, end_m);
        let Some((light_per_m2, from_source)) = self.direct(walk, walk.position + walk.direction * path_m)
        else {
            return;
        };
        let point = path.point(path_m);
        let depth = optical_depths(&self.setting.atmosphere, point.columns_m)[self.band];
        let scatterers =
            [self.molecules_per_m * point.density[0], AEROSOL_ALBEDO * self.aerosol_per_m * point.density[1]];
        let per_density_m = (high - low) * miss_m * (1.0 + tangent * tangent);
        let scattered = mixed_phase(scatterers, -from_source.dot(walk.direction));
        walk.sum += walk.weight * (-depth).exp() * light_per_m2 * scattered * per_density_m / chance;
    }

    /// Direct light at a point, m⁻² per watt, and the unit vector from its source; None where there is none.
    fn direct(&self, walk: &Walk<'_>, position: DVec3) -> Option<(f64, DVec3)> {
        let from_source = position - self.source;
        let distance_m = from_source.length();
        let unit = from_source / distance_m;
        if unit.z <= sin_blocking(self.setting.blocking_rad) {
            return None;
        }
        let mut depth = 0.0;
        if let Some(clouds) = &walk.clouds {
            depth = self.cloud_depth(clouds, position, -unit, distance_m)?;
        }
        let radius_m = position.length();
        let altitude_m = radius_m - EARTH_RADIUS_M;
        let out = columns_to_space_m(self.setting.source_altitude_m, unit.z, self.source_density);
        let cos_here = (unit.dot(position) / radius_m).clamp(0.0, 1.0);
        let rest = columns_to_space_m(altitude_m, cos_here, relative_densities(altitude_m));
        let columns_m = [(out[0] - rest[0]).max(0.0), (out[1] - rest[1]).max(0.0)];
        depth += optical_depths(&self.setting.atmosphere, columns_m)[self.band];
        let lobes = lobe_intensities_per_sr(unit.z);
        let intensity: f64 = lobes.iter().zip(walk.lobes).map(|(lobe, weight)| lobe * weight).sum();
        Some((intensity * (-depth).exp() / (distance_m * distance_m), unit))
    }

    /// Optical depth through clouds on the way to the source; None where nothing comes through.
    fn cloud_depth(
        &self,
        clouds: &Clouds<'_>,
        position: DVec3,
        to_source: DVec3,
        distance_m: f64,
    ) -> Option<f64> {
        let radius_m = position.length();
        let cos_zenith = to_source.dot(position) / radius_m;
        let field = clouds.field();
        let base_m = EARTH_RADIUS_M + field.base_m();
        if field.lid_albedo().is_some() {
            let (down_m, _) = sphere_m(radius_m, cos_zenith, base_m)?;
            let is_below = radius_m <= base_m;
            return (is_below || !clouds.covers(position + to_source * down_m)).then_some(0.0);
        }
        let spheres_m = (base_m, EARTH_RADIUS_M + field.top_m());
        let mut depth = 0.0;
        for part in between_spheres(radius_m, cos_zenith, spheres_m, distance_m).into_iter().flatten() {
            depth += clouds.follow(position, to_source, part, OPAQUE_DEPTH).err()?;
        }
        Some(depth)
    }
}

/// Where a ray meets a lid [m], and whether from below (−1) or above (1).
fn lid_met(
    walk: &Walk<'_>,
    clouds: &Clouds<'_>,
    radius_m: f64,
    cos_zenith: f64,
    end_m: f64,
) -> Option<(f64, f64)> {
    let lid_m = EARTH_RADIUS_M + clouds.field().base_m();
    let (in_m, out_m) = sphere_m(radius_m, cos_zenith, lid_m)?;
    let met = |(at_m, _): &(f64, f64)| {
        *at_m > 0.1 * OFF_SURFACE_M && *at_m < end_m && clouds.covers(walk.position + walk.direction * *at_m)
    };
    [(in_m, 1.0), (out_m, -1.0)].into_iter().find(met)
}

/// Where a ray is scattered by a drop, metres.
fn drop_met(
    walk: &Walk<'_>,
    clouds: &Clouds<'_>,
    radius_m: f64,
    cos_zenith: f64,
    end_m: f64,
    random: &mut Random,
) -> Option<f64> {
    let field = clouds.field();
    let spheres_m = (EARTH_RADIUS_M + field.base_m(), EARTH_RADIUS_M + field.top_m());
    let mut wanted = -random.unit().ln();
    for part in between_spheres(radius_m, cos_zenith, spheres_m, end_m).into_iter().flatten() {
        match clouds.follow(walk.position, walk.direction, part, wanted) {
            Ok(at_m) => return Some(at_m),
            Err(depth) => wanted -= depth,
        }
    }
    None
}

/// A direction after a scattering by a drop.
fn henyey_greenstein_direction(direction: DVec3, random: &mut Random) -> DVec3 {
    let g = DROP_ASYMMETRY;
    let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * random.unit());
    let cosine = ((1.0 + g * g - s * s) / (2.0 * g)).clamp(-1.0, 1.0);
    turned(direction, cosine, TAU * random.unit())
}

#[cfg(test)]
#[path = "through_clouds_tests.rs"]
mod tests;
