//! Backward Monte Carlo with next-event estimation (Coveyou et al. 1967): the reference solution of fields of beams. It shares
//! with them the air, the light of the beam itself and phase functions.
//!
//! Free paths are drawn by delta tracking (Woodcock et al. 1965) in air as thick as at sea level everywhere. In twilight
//! light comes from low in the source's azimuth: half of the directions are drawn around that one, and weighted by the mean of both
//! densities (balance heuristic, Veach and Guibas 1995). Deep in dusk hardly any of these paths meets light: `rays` has another
//! tracer for that.

mod rays;

use super::{
    field::{BeamSetting, GROUND_M},
    sunlight::{Sunlight, TOP_M},
};
use crate::{
    bands::Band,
    geometry::EARTH_RADIUS_M,
    multiple_scattering::monte_carlo::draws::{
        Random, lambertian_direction, mixed_phase, scattered_direction, turned,
    },
    phase::henyey_greenstein_per_sr,
};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Paths of one random stream; streams are summed in order, whatever thread ran them.
const STREAM_PATHS: u64 = 1_024;
/// Paths of a smaller weight survive by chance only.
const MIN_WEIGHT: f64 = 0.02;
/// Asymmetry of the draw of directions around the source's azimuth, and their middle's elevation as a sine.
const GUIDE_ASYMMETRY: f64 = 0.75;
const GUIDE_RISE: f64 = 0.1;

/// Radiance of a beam's sky in one direction, with standard errors, sr⁻¹.
#[derive(Clone, Copy, Debug)]
pub struct BeamEstimate {
    /// Of all orders.
    pub radiance_per_sr: f64,
    /// Standard error of it.
    pub standard_error_per_sr: f64,
    /// Of light scattered once.
    pub first_order_per_sr: f64,
}

/// A tracer of one setting and band.
#[derive(Clone, Debug)]
pub struct BeamTracer {
    setting: BeamSetting,
    sunlight: Sunlight,
    band: usize,
    thickest_per_m: f64,
}

/// An observer, and unit vectors along the view and to the source; the observer's vertical is z.
struct Aim {
    observer: DVec3,
    view: DVec3,
    source: DVec3,
}

impl Aim {
    fn new(observer_altitude_m: f64, elevation_rad: f64, source_zenith_rad: f64, azimuth_rad: f64) -> Self {
        let (sin_zenith, cos_zenith) = source_zenith_rad.sin_cos();
        let (sin_elevation, cos_elevation) = elevation_rad.sin_cos();
        let (sin_azimuth, cos_azimuth) = azimuth_rad.sin_cos();
        Self {
            observer: DVec3::Z * (EARTH_RADIUS_M + observer_altitude_m),
            view: DVec3::new(cos_elevation * cos_azimuth, cos_elevation * sin_azimuth, sin_elevation),
            source: DVec3::new(sin_zenith, 0.0, cos_zenith),
        }
    }
}

/// The mean of so many paths, each of which gives light scattered once and all.
fn mean_of_paths(paths: u64, seed: u64, path: impl Fn(&mut Random) -> (f64, f64) + Sync) -> BeamEstimate {
    let streams = paths.div_ceil(STREAM_PATHS).max(1);
    let sums: Vec<[f64; 3]> = (0..streams)
        .into_par_iter()
        .map(|stream| {
            let mut random = Random::new(seed, stream);
            let mut sums = [0.0; 3];
            for _ in 0..STREAM_PATHS {
                let (first, all) = path(&mut random);
                sums[0] += first;
                sums[1] += all;
                sums[2] += all * all;
            }
            sums
        })
        .collect();
    let count = (streams * STREAM_PATHS) as f64;
    let mean = |at: usize| sums.iter().map(|sums| sums[at]).sum::<f64>() / count;
    let (first, all, square) = (mean(0), mean(1), mean(2));
    BeamEstimate {
        radiance_per_sr: all,
        standard_error_per_sr: ((square - all * all).max(0.0) / count).sqrt(),
        first_order_per_sr: first,
    }
}

/// Where a flight ends.
enum Event {
    Space,
    Ground(DVec3),
    Air(DVec3),
}

impl BeamTracer {
    /// A tracer of a band of a setting.
    pub fn new(setting: BeamSetting, band: Band) -> Self {
        let sunlight = Sunlight::new(&setting.air);
        let band = band.index();
        let thickest_per_m = setting.air.at(GROUND_M).extinction_per_m[band];
        Self { setting, sunlight, band, thickest_per_m }
    }

    /// Estimates a sky in one direction from `paths` paths (rounded up to whole streams). The same seed gives the same numbers
    /// on any number of threads.
    pub fn estimate(
        &self,
        observer_altitude_m: f64,
        elevation_rad: f64,
        source_zenith_rad: f64,
        azimuth_rad: f64,
        paths: u64,
        seed: u64,
    ) -> BeamEstimate {
        let aim = Aim::new(observer_altitude_m, elevation_rad, source_zenith_rad, azimuth_rad);
        mean_of_paths(paths, seed, |random| self.trace(aim.observer, aim.view, aim.source, random))
    }

    /// Light of one path: scattered once, and in all.
    fn trace(&self, observer: DVec3, view: DVec3, source: DVec3, random: &mut Random) -> (f64, f64) {
        let (mut place, mut direction, mut weight) = (observer, view, 1.0);
        let (mut first, mut all) = (0.0, 0.0);
        for order in 1.. {
            let light = match self.flight(place, direction, random) {
                Event::Space => break,
                Event::Ground(at) => {
                    let up = at.normalize();
                    weight *= self.setting.ground_albedo;
                    let facing = up.dot(source).max(0.0);
                    (place, direction) = (at, lambertian_direction(up, random));
                    weight * facing / PI * self.sunlight.at(GROUND_M, up.dot(source))[self.band]
                }
                Event::Air(at) => {
                    place = at;
                    let altitude_m = at.length() - EARTH_RADIUS_M;
                    let up = at.normalize();
                    let shares = self.setting.air.at(altitude_m).scattering_shares().map(|s| s[self.band]);
                    let direct = self.sunlight.at(altitude_m, up.dot(source))[self.band];
                    let light = weight * mixed_phase(shares, direction.dot(source)) * direct;
                    let (next, factor) = guided(direction, shares, up, source, random);
                    direction = next;
                    weight *= factor;
                    light
                }
            };
            all += light;
            if order == 1 {
                first = light;
            }
            if weight < MIN_WEIGHT {
                if random.unit() * MIN_WEIGHT >= weight {
                    break;
                }
                weight = MIN_WEIGHT;
            }
        }
        (first, all)
    }

    /// Flies until something is met.
    fn flight(&self, start: DVec3, direction: DVec3, random: &mut Random) -> Event {
        let (r2, b) = (start.length_squared(), start.dot(direction));
        let root = |altitude_m: f64| b * b - r2 + (EARTH_RADIUS_M + altitude_m).powi(2);
        let to_ground = root(GROUND_M);
        let ground_m = if b < 0.0 && to_ground >= 0.0 { -b - to_ground.sqrt() } else { f64::INFINITY };
        let end_m = -b + root(TOP_M).max(0.0).sqrt();
        let mut path_m = 0.0;
        loop {
            path_m -= random.unit().ln() / self.thickest_per_m;
            if path_m >= ground_m {
                // Off the surface, lest rounding puts the start behind it.
                let at = start + direction * ground_m;
                return Event::Ground(at.normalize() * (EARTH_RADIUS_M + GROUND_M + 1e-3));
            }
            if path_m >= end_m {
                return Event::Space;
            }
            let at = start + direction * path_m;
            let extinction = self.setting.air.at(at.length() - EARTH_RADIUS_M).extinction_per_m[self.band];
            if random.unit() * self.thickest_per_m < extinction {
                return Event::Air(at);
            }
        }
    }
}

/// The next direction, and what weights it: what is scattered over the density of the draw.
fn guided(direction: DVec3, shares: [f64; 2], up: DVec3, source: DVec3, random: &mut Random) -> (DVec3, f64) {
    let level = (source - up * up.dot(source)).normalize_or(up.any_orthonormal_vector());
    let guide = (level + up * GUIDE_RISE).normalize();
    let next = if random.unit() < 0.5 {
        scattered_direction(direction, shares, random)
    } else {
        let g = GUIDE_ASYMMETRY;
        let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * random.unit());
        turned(guide, ((1.0 + g * g - s * s) / (2.0 * g)).clamp(-1.0, 1.0), TAU * random.unit())
    };
    let phase = mixed_phase(shares, direction.dot(next));
    let whole = (shares[0] + shares[1]).max(f64::MIN_POSITIVE);
    let density = 0.5 * phase / whole + 0.5 * henyey_greenstein_per_sr(guide.dot(next), GUIDE_ASYMMETRY);
    (next, phase / density)
}
