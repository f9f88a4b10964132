//! Backward Monte Carlo: light followed from the eye to the source, one path at a time. Slow and independent.
//!
//! Every vertex of a path (a scattering or a point of the ground) asks the source for its direct light. Two
//! choices keep the variance finite although that light grows like 1/d²: distances along a ray are drawn half
//! from free paths and half equiangularly about the source (Kulla & Fajardo 2012), directions half from the
//! phase function and half evenly in the angle from the source's direction; each draw is weighted by the mean
//! of both densities (balance heuristic).

use super::{
    optics::{SlantPath, columns_to_space_m, optical_depths, relative_densities},
    setting::SourceSetting,
};
use crate::{
    atmosphere::AEROSOL_ALBEDO,
    bands::Band,
    emission::{LOBE_COUNT, lobe_intensities_per_sr},
    geometry::EARTH_RADIUS_M,
    phase::{AEROSOL_ASYMMETRY, henyey_greenstein_per_sr, rayleigh_per_sr},
    single_source::SourceGeometry,
};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Where the air ends for paths, metres.
const TOP_ALTITUDE_M: f64 = 100_000.0;
/// From this order on a path survives with at most this probability a vertex.
const ROULETTE_FROM: usize = 6;
const LONGEST_PATH: usize = 400;
/// Paths of one random stream; streams are summed in order, whatever thread ran them.
const STREAM_PATHS: u64 = 1_024;
/// Orders that are told apart.
pub const TOLD_ORDERS: usize = 12;

/// Radiance of orders two and more with its standard error, per lobe, m⁻² sr⁻¹ per watt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Mean over paths.
    pub radiance_per_m2_sr: [f64; LOBE_COUNT],
    /// Standard error of the mean.
    pub standard_error_per_m2_sr: [f64; LOBE_COUNT],
    /// Mean of order `i + 1` alone (the last one holds all later ones), `[order][lobe]`. Order 1 is a check
    /// against `single_source` and is not part of the mean.
    pub by_order_per_m2_sr: [[f64; LOBE_COUNT]; TOLD_ORDERS],
}

/// xoshiro256++ (Blackman & Vigna), seeded by SplitMix64.
struct Random([u64; 4]);

impl Random {
    fn new(seed: u64, stream: u64) -> Self {
        let mut state = seed ^ stream.wrapping_mul(0xD134_2543_DE82_EF95);
        Self(std::array::from_fn(|_| {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            z ^ (z >> 31)
        }))
    }

    /// Even in 0..1, neither end included.
    fn unit(&mut self) -> f64 {
        let s = &mut self.0;
        let result = s[0].wrapping_add(s[3]).rotate_left(23).wrapping_add(s[0]);
        let t = s[1] << 17;
        s[2] ^= s[0];
        s[3] ^= s[1];
        s[1] ^= s[2];
        s[0] ^= s[3];
        s[2] ^= t;
        s[3] = s[3].rotate_left(45);
        ((result >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }
}

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
    /// Transmission over density of the draw: for the air m (times a coefficient m⁻¹), for the ground a number.
    weight: f64,
    on_ground: bool,
}

impl Tracer {
    /// A tracer of a band of a setting, seen from `geometry` (whose source altitude must be the setting's).
    pub fn new(setting: SourceSetting, band: Band, geometry: &SourceGeometry) -> Self {
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
    pub fn estimate(
        &self,
        relative_azimuth_rad: f64,
        elevation_rad: f64,
        paths: u64,
        seed: u64,
    ) -> Estimate {
        let [towards, beside, up] = self.observer_frame;
        let (sin_az, cos_az) = relative_azimuth_rad.sin_cos();
        let (sin_el, cos_el) = elevation_rad.sin_cos();
        let view = towards * (cos_el * cos_az) + beside * (cos_el * sin_az) + up * sin_el;
        let streams = paths.div_ceil(STREAM_PATHS).max(1);
        let sums: Vec<_> = (0..streams)
            .into_par_iter()
            .map(|stream| {
                let mut random = Random::new(seed, stream);
                let mut orders = [[0.0; LOBE_COUNT]; TOLD_ORDERS];
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
        let mut orders = [[0.0; LOBE_COUNT]; TOLD_ORDERS];
        let mut squares = [0.0; LOBE_COUNT];
        for (stream_orders, stream_squares) in &sums {
            for lobe in 0..LOBE_COUNT {
                for order in 0..TOLD_ORDERS {
                    orders[order][lobe] += stream_orders[order][lobe] / count;
                }
                squares[lobe] += stream_squares[lobe] / count;
            }
        }
        let mean: [f64; LOBE_COUNT] =
            std::array::from_fn(|lobe| orders[1..].iter().map(|order| order[lobe]).sum());
        Estimate {
            radiance_per_m2_sr: mean,
            standard_error_per_m2_sr: std::array::from_fn(|lobe| {
                ((squares[lobe] - mean[lobe] * mean[lobe]).max(0.0) / count).sqrt()
            }),
            by_order_per_m2_sr: orders,
        }
    }

    /// One path: its contribution to each order and lobe.
    fn trace(&self, view: DVec3, random: &mut Random) -> [[f64; LOBE_COUNT]; TOLD_ORDERS] {
        let mut orders = [[0.0; LOBE_COUNT]; TOLD_ORDERS];
        let (mut position, mut direction, mut weight) = (self.observer, view, 1.0);
        for vertex in 0..LONGEST_PATH {
            let Some(hit) = self.draw_point(position, direction, random) else { break };
            position += direction * hit.path_m;
            let normal = position.normalize();
            let scatterers = [
                self.molecules_per_m * hit.density[0],
                AEROSOL_ALBEDO * self.aerosol_per_m * hit.density[1],
            ];
            weight *= hit.weight;
            if let Some((light, from_source)) = self.direct(position, hit.altitude_m) {
                let response = if hit.on_ground {
                    self.setting.ground_albedo / PI * (-from_source.dot(normal)).max(0.0)
                } else {
                    mixed_phase(scatterers, -from_source.dot(direction))
                };
                let order = vertex.min(TOLD_ORDERS - 1);
                for lobe in 0..LOBE_COUNT {
                    orders[order][lobe] += weight * response * light[lobe];
                }
            }
            let (next, factor) = if hit.on_ground {
                let (sine2, turn) = (random.unit(), TAU * random.unit());
                (turned(normal, (1.0 - sine2).sqrt(), turn), self.setting.ground_albedo)
            } else {
                self.draw_direction(position, direction, scatterers, random)
            };
            weight *= factor;
            direction = next;
            if weight <= 0.0 {
                break;
            }
            if vertex + 1 >= ROULETTE_FROM {
                const SURVIVAL: f64 = 0.7;
                if random.unit() > SURVIVAL {
                    break;
                }
                weight /= SURVIVAL;
            }
        }
        orders
    }

    /// Direct light at a point, per lobe [m⁻²], and the unit vector S→P; None in the Earth's shadow.
    fn direct(&self, position: DVec3, altitude_m: f64) -> Option<([f64; LOBE_COUNT], DVec3)> {
        let from_source = position - self.source;
        let distance2 = from_source.length_squared();
        let unit = from_source / distance2.sqrt();
        if unit.z <= 0.0 {
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

    /// Draws where a ray is scattered or meets the ground.
    fn draw_point(&self, position: DVec3, direction: DVec3, random: &mut Random) -> Option<Hit> {
        let radius = position.length();
        let path = SlantPath::new(radius - EARTH_RADIUS_M, direction.dot(position) / radius);
        let ground_m = path.path_down_to_m(self.setting.ground_altitude_m);
        let end_m = ground_m.unwrap_or_else(|| path.path_up_to_m(TOP_ALTITUDE_M));
        if end_m <= 1e-6 {
            return None;
        }
        let depth_at = |u: f64| {
            let point = path.point(u);
            (optical_depths(&self.setting.atmosphere, point.columns_m)[self.band], point)
        };
        let whole = depth_at(end_m).0;
        // Rays that end on the ground may draw the ground with the probability that light gets there.
        let scattered_share = 1.0 - (-whole).exp();
        if ground_m.is_some() && random.unit() >= scattered_share {
            let altitude_m = self.setting.ground_altitude_m;
            let density = relative_densities(altitude_m);
            return Some(Hit { path_m: end_m, altitude_m, density, weight: 1.0, on_ground: true });
        }
        let air_probability = if ground_m.is_some() { scattered_share } else { 1.0 };
        let from_source = position - self.source;
        let nearest_m = -from_source.dot(direction);
        let miss_m = (from_source + direction * nearest_m).length().max(1e-3);
        let angle = |u: f64| ((u - nearest_m) / miss_m).atan();
        let (low, high) = (angle(0.0), angle(end_m));
        let path_m = if random.unit() < 0.5 {
            let tangent = (low + (high - low) * random.unit()).tan();
            (nearest_m + miss_m * tangent).clamp(0.0, end_m)
        } else {
            // Depth drawn, path by bisection and secants.
            let wanted = -(-random.unit() * scattered_share).ln_1p();
            let (mut a, mut b, mut depth_a, mut depth_b) = (0.0, end_m, 0.0, whole);
            for k in 0..60 {
                let share = if k % 3 == 2 { 0.5 } else { ((wanted - depth_a) / (depth_b - depth_a)).clamp(0.02, 0.98) };
                let middle = a + (b - a) * share;
                let depth = depth_at(middle).0;
                if depth < wanted { (a, depth_a) = (middle, depth) } else { (b, depth_b) = (middle, depth) }
                if b - a < 1e-5 * b + 1e-3 {
                    break;
                }
            }
            0.5 * (a + b)
        };
        let (depth, point) = depth_at(path_m);
        let extinction = self.molecules_per_m * point.density[0] + self.aerosol_per_m * point.density[1];
        let through = (-depth).exp();
        let beside = (path_m - nearest_m) / miss_m;
        let equiangular = 1.0 / ((high - low) * miss_m * (1.0 + beside * beside));
        let free = extinction * through / scattered_share;
        let weight = through / (0.5 * (equiangular + free) * air_probability);
        Some(Hit { path_m, altitude_m: point.altitude_m, density: point.density, weight, on_ground: false })
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
        } else if random.unit() * total < scatterers[0] {
            turned(direction, rayleigh_cosine(random), TAU * random.unit())
        } else {
            let g = AEROSOL_ASYMMETRY;
            let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * random.unit());
            turned(direction, ((1.0 + g * g - s * s) / (2.0 * g)).clamp(-1.0, 1.0), TAU * random.unit())
        };
        let cosine = next.dot(to_source).clamp(-1.0, 1.0);
        let even = 1.0 / (PI * TAU * (1.0 - cosine * cosine).sqrt().max(1e-9));
        let scattering = mixed_phase(scatterers, next.dot(direction));
        (next, scattering / (0.5 * (even + scattering / total)))
    }
}

/// Σ coefficient·phase, m⁻¹ sr⁻¹. Rays are followed against the light, so no turn is cos γ = 1 here too.
fn mixed_phase(scatterers: [f64; 2], cos_gamma: f64) -> f64 {
    let cos_gamma = cos_gamma.clamp(-1.0, 1.0);
    scatterers[0] * rayleigh_per_sr(cos_gamma)
        + scatterers[1] * henyey_greenstein_per_sr(cos_gamma, AEROSOL_ASYMMETRY)
}

/// The cosine of a Rayleigh turn by rejection.
fn rayleigh_cosine(random: &mut Random) -> f64 {
    loop {
        let cosine = 2.0 * random.unit() - 1.0;
        if 2.0 * random.unit() < 1.0 + cosine * cosine {
            return cosine;
        }
    }
}

/// The unit vector at an angle from `axis`, turned about it.
fn turned(axis: DVec3, cosine: f64, turn: f64) -> DVec3 {
    let (a, b) = axis.any_orthonormal_pair();
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    (axis * cosine + (a * turn.cos() + b * turn.sin()) * sine).normalize()
}
