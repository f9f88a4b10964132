//! Backward Monte Carlo with next-event estimation (Coveyou et al. 1967): paths from the observer to the source.
//!
//! Every vertex of a path (a scattering or a point of the ground or of the base of a cloud) adds the direct light of the source there.
//! Two choices keep the variance finite although that light grows like 1/d²: distances along a ray are drawn half
//! from free paths and half equiangularly about the source (Kulla and Fajardo 2012), directions half from the
//! phase function and half evenly in the angle from the source's direction; each draw is weighted by the mean
//! of both densities (balance heuristic, Veach and Guibas 1995).

use super::{
    super::{
        optics::{SlantPath, columns_to_space_m, optical_depths, relative_densities},
        setting::SourceSetting,
    },
    Estimate, SEPARATE_ORDERS,
    draws::{Random, lambertian_direction, mixed_phase, path_of_depth_m, scattered_direction, turned},
};
use crate::{
    atmosphere::AEROSOL_ALBEDO,
    bands::Band,
    cloud::CloudBase,
    cone::sin_blocking,
    emission::{LOBE_COUNT, lobe_intensities_per_sr},
    geometry::EARTH_RADIUS_M,
    single_source::SourceGeometry,
};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Top of the atmosphere for paths, metres.
const TOP_ALTITUDE_M: f64 = 100_000.0;
/// Russian roulette: from this order on a path survives each vertex with this probability.
const ROULETTE_FROM: usize = 6;
const SURVIVAL: f64 = 0.7;
const MAX_VERTICES: usize = 400;
/// Paths continue this far below the base of a cloud, metres.
const OFF_BASE_M: f64 = 1e-4;
/// Paths of one random stream; streams are summed in order, whatever thread ran them.
const STREAM_PATHS: u64 = 1_024;

/// A tracer of one setting, band and geometry.
#[derive(Clone, Debug)]
pub struct Tracer {
    setting: SourceSetting,
    molecules_per_m: f64,
    aerosol_per_m: f64,
    band: usize,
    observer: DVec3,
    observer_frame: [DVec3; 3],
    source: DVec3,
    source_density: [f64; 2],
}

/// A drawn point on a ray.
struct Hit {
    path_m: f64,
    altitude_m: f64,
    density: [f64; 2],
    /// Transmission over density of the draw: for the air m (times a coefficient m⁻¹), for a surface a number.
    weight: f64,
    /// The surface that is hit, if it is not the air.
    surface: Option<Wall>,
}

/// A Lambertian surface that a ray ends on.
#[derive(Clone, Copy)]
struct Wall {
    altitude_m: f64,
    albedo: f64,
    /// 1 where its bright side faces up, −1 where it faces down.
    side: f64,
}

impl Tracer {
    /// A tracer of a band of a setting, seen from `geometry` (whose source altitude must be the setting's).
    ///
    /// # Panics
    /// Under a cloud that is not Lambertian.
    pub fn new(setting: SourceSetting, band: Band, geometry: &SourceGeometry) -> Self {
        super::check_base(&setting);
        // The source on the z axis, the observer in the plane y = 0.
        let (sine, cosine) = (geometry.distance_m / EARTH_RADIUS_M).sin_cos();
        let up = DVec3::new(sine, 0.0, cosine);
        let towards = DVec3::new(-cosine, 0.0, sine);
        Self {
            setting,
            molecules_per_m: setting.atmosphere.molecule_extinction_per_m()[band.index()],
            aerosol_per_m: setting.atmosphere.aerosol_extinction_per_m()[band.index()],
            band: band.index(),
            observer: up * (EARTH_RADIUS_M + geometry.observer_altitude_m),
            observer_frame: [towards, DVec3::Y, up],
            source: DVec3::new(0.0, 0.0, EARTH_RADIUS_M + setting.source_altitude_m),
            source_density: relative_densities(setting.source_altitude_m),
        }
    }

    /// Estimates the radiance at one direction from `paths` paths (rounded up to whole streams).
    /// The same seed gives the same numbers on any number of threads.
    pub fn estimate(&self, relative_azimuth_rad: f64, elevation_rad: f64, paths: u64, seed: u64) -> Estimate {
        let [towards, beside, up] = self.observer_frame;
        let (sin_az, cos_az) = relative_azimuth_rad.sin_cos();
        let (sin_el, cos_el) = elevation_rad.sin_cos();
        let view = towards * (cos_el * cos_az) + beside * (cos_el * sin_az) + up * sin_el;
        let streams = paths.div_ceil(STREAM_PATHS).max(1);
        let sums: Vec<_> = (0..streams)
            .into_par_iter()
            .map(|stream| {
                let mut random = Random::new(seed, stream);
                let mut orders = [[0.0; LOBE_COUNT]; SEPARATE_ORDERS];
                let mut squares = [0.0; LOBE_COUNT];
                for _ in 0..STREAM_PATHS {
                    let path = self.trace(view, &mut random);
                    for lobe in 0..LOBE_COUNT {
                        let mut higher = 0.0;
                        for (order, value) in path.iter().enumerate() {
                            orders[order][lobe] += value[lobe];
                            higher += if order > 0 { value[lobe] } else { 0.0 };
                        }
                        squares[lobe] += higher * higher;
                    }
                }
                (orders, squares)
            })
            .collect();
        let count = (streams * STREAM_PATHS) as f64;
        let mut orders = [[0.0; LOBE_COUNT]; SEPARATE_ORDERS];
        let mut squares = [0.0; LOBE_COUNT];
        for (stream_orders, stream_squares) in &sums {
            for lobe in 0..LOBE_COUNT {
                for order in 0..SEPARATE_ORDERS {
                    orders[order][lobe] += stream_orders[order][lobe] / count;
                }
                squares[lobe] += stream_squares[lobe] / count;
            }
        }
        Estimate::from_sums(orders, squares, count)
    }

    /// One path: its contribution to each order and lobe.
    fn trace(&self, view: DVec3, random: &mut Random) -> [[f64; LOBE_COUNT]; SEPARATE_ORDERS] {
        let mut orders = [[0.0; LOBE_COUNT]; SEPARATE_ORDERS];
        let (mut position, mut direction, mut weight) = (self.observer, view, 1.0);
        for vertex in 0..MAX_VERTICES {
            let Some(hit) = self.draw_point(position, direction, random) else { break };
            position += direction * hit.path_m;
            let normal = position.normalize() * hit.surface.map_or(1.0, |wall| wall.side);
            let scatterers =
                [self.molecules_per_m * hit.density[0], AEROSOL_ALBEDO * self.aerosol_per_m * hit.density[1]];
            weight *= hit.weight;
            if let Some((light, from_source)) = self.direct(position, hit.altitude_m) {
                let response = match hit.surface {
                    Some(wall) => wall.albedo / PI * (-from_source.dot(normal)).max(0.0),
                    None => mixed_phase(scatterers, -from_source.dot(direction)),
                };
                let order = vertex.min(SEPARATE_ORDERS - 1);
                for lobe in 0..LOBE_COUNT {
                    orders[order][lobe] += weight * response * light[lobe];
                }
            }
            let (next, factor) = match hit.surface {
                Some(wall) => (lambertian_direction(normal, random), wall.albedo),
                None => self.draw_direction(position, direction, scatterers, random),
            };
            if hit.surface.is_some_and(|wall| wall.side < 0.0) {
                // Off the base, lest rounding puts the next ray's start above it.
                position += normal * OFF_BASE_M;
            }
            weight *= factor;
            direction = next;
            if weight <= 0.0 {
                break;
            }
            if vertex + 1 >= ROULETTE_FROM {
                if random.unit() > SURVIVAL {
                    break;
                }
                weight /= SURVIVAL;
            }
        }
        orders
    }

    /// Direct light at a point, per lobe [m⁻²], and the unit vector S→P; None in the Earth's shadow and behind
    /// the skyline.
    fn direct(&self, position: DVec3, altitude_m: f64) -> Option<([f64; LOBE_COUNT], DVec3)> {
        let from_source = position - self.source;
        let distance2 = from_source.length_squared();
        let unit = from_source / distance2.sqrt();
        if unit.z <= sin_blocking(self.setting.blocking_rad) {
            return None;
        }
        let out = columns_to_space_m(self.setting.source_altitude_m, unit.z, self.source_density);
        let cos_here = unit.dot(position.normalize()).clamp(0.0, 1.0);
        let rest = columns_to_space_m(altitude_m, cos_here, relative_densities(altitude_m));
        let depths = optical_depths(
            &self.setting.atmosphere,
            [(out[0] - rest[0]).max(0.0), (out[1] - rest[1]).max(0.0)],
        );
        let through = (-depths[self.band]).exp() / distance2;
        Some((lobe_intensities_per_sr(unit.z).map(|f| f * through), unit))
    }

    /// Draws where a ray is scattered or meets a surface. None above the base of a cloud.
    fn draw_point(&self, position: DVec3, direction: DVec3, random: &mut Random) -> Option<Hit> {
        let radius = position.length();
        let path = SlantPath::new(radius - EARTH_RADIUS_M, direction.dot(position) / radius);
        let ground_m = path.path_down_to_m(self.setting.ground_altitude_m);
        let cloud = self.setting.atmosphere.cloud();
        let top_m = cloud.map_or(TOP_ALTITUDE_M, CloudBase::altitude_m);
        let end_m = ground_m.unwrap_or_else(|| path.path_up_to_m(top_m));
        if end_m <= 1e-6 {
            return None;
        }
        let ground = Wall {
            altitude_m: self.setting.ground_altitude_m,
            albedo: self.setting.ground_albedo,
            side: 1.0,
        };
        let base = cloud.map(|cloud| Wall { altitude_m: top_m, albedo: cloud.albedo(), side: -1.0 });
        let wall = ground_m.map(|_| ground).or(base);
        let depth_at = |u: f64| {
            let point = path.point(u);
            (optical_depths(&self.setting.atmosphere, point.columns_m)[self.band], point)
        };
        let whole = depth_at(end_m).0;
        // Rays that end on a surface may draw it with the probability that light gets there.
        let scattered_share = 1.0 - (-whole).exp();
        if let Some(wall) = wall.filter(|_| random.unit() >= scattered_share) {
            let altitude_m = wall.altitude_m;
            let density = relative_densities(altitude_m);
            return Some(Hit { path_m: end_m, altitude_m, density, weight: 1.0, surface: Some(wall) });
        }
        let air_probability = if wall.is_some() { scattered_share } else { 1.0 };
        let from_source = position - self.source;
        let nearest_m = -from_source.dot(direction);
        let miss_m = (from_source + direction * nearest_m).length().max(1e-3);
        let angle = |u: f64| ((u - nearest_m) / miss_m).atan();
        let (low, high) = (angle(0.0), angle(end_m));
        let path_m = if random.unit() < 0.5 {
            let tangent = (low + (high - low) * random.unit()).tan();
            (nearest_m + miss_m * tangent).clamp(0.0, end_m)
        } else {
            let wanted = -(-random.unit() * scattered_share).ln_1p();
            path_of_depth_m(wanted, whole, end_m, |u| depth_at(u).0)
        };
        let (depth, point) = depth_at(path_m);
        let extinction = self.molecules_per_m * point.density[0] + self.aerosol_per_m * point.density[1];
        let through = (-depth).exp();
        let beside = (path_m - nearest_m) / miss_m;
        let equiangular = 1.0 / ((high - low) * miss_m * (1.0 + beside * beside));
        let free = extinction * through / scattered_share;
        let weight = through / (0.5 * (equiangular + free) * air_probability);
        Some(Hit { path_m, altitude_m: point.altitude_m, density: point.density, weight, surface: None })
    }

    /// Draws where light that is scattered into `direction` came from, and the weight of the draw, m⁻¹.
    fn draw_direction(
        &self,
        position: DVec3,
        direction: DVec3,
        scatterers: [f64; 2],
        random: &mut Random,
    ) -> (DVec3, f64) {
        let total = scatterers[0] + scatterers[1];
        let to_source = (self.source - position).normalize();
        let next = if random.unit() < 0.5 {
            turned(to_source, (PI * random.unit()).cos(), TAU * random.unit())
        } else {
            scattered_direction(direction, scatterers, random)
        };
        let cosine = next.dot(to_source).clamp(-1.0, 1.0);
        let even = 1.0 / (PI * TAU * (1.0 - cosine * cosine).sqrt().max(1e-9));
        let scattering = mixed_phase(scatterers, next.dot(direction));
        (next, scattering / (0.5 * (even + scattering / total)))
    }
}
