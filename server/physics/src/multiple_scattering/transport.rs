//! From the source function of one order to the radiance of that order at every place of the grid.

use super::{
    grid::FieldGrid,
    harmonics::{cosines, legendre, pair_count, pair_index},
    lanes::{LANES, Lanes},
    path::{SteppedPath, Stride, track},
    setting::{Resolution, SourceSetting},
    source_function::{DirectionTable, Moments, SourceFunction},
    surfaces::Surfaces,
    wide::dispatch_wide,
};
use crate::{geometry::EARTH_RADIUS_M, quadrature::gauss_legendre};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Azimuth intervals of the tables that rays are followed with.
const TABLE_AZIMUTHS: usize = 24;
/// Size of the bright part of the sky around a source, metres: it fills this over the distance, in radians.
const BRIGHT_SIZE_M: f64 = 10_000.0;
/// Zenith angles below a cloud over those under a clear sky: light that comes from afar fills a strip above the
/// horizon that narrows like the base's height over the distance (5 % at 20 km from the source below a base at 1 km
/// with as many as under a clear sky, 3 % with twice as many; the field is half as high and costs no more).
const OVERCAST_ZENITHS: usize = 2;
/// First step of paths from places farther from the source than four times this, metres: those of one layer share
/// their steps.
const FAR_FIRST_STEP_M: f64 = 600.0;

/// The radiance of one order, `[point]`.
#[derive(Clone, Debug)]
pub(super) struct Radiance {
    pub(super) moments: Moments,
    /// Flux through the horizontal from above, m⁻² per watt, `[point]`.
    pub(super) down_flux: Vec<[f64; LANES]>,
    /// Flux through the horizontal from below, m⁻² per watt, `[point]`.
    pub(super) up_flux: Vec<[f64; LANES]>,
}

/// Cosines of zenith angles with weights summing to 2, above and below the horizon of a ground, whose zenith angle has
/// the cosine `horizon` ≤ 0: there radiance jumps, and nodes crowd on both sides (μ = horizon ± x²), where the haze of a far
/// source glows. From 1 000 m up the horizon is 1° down: with nodes that crowd at 0 instead, fields 50 to 200 km away in
/// thick haze were 1.6 to 6.8 % darker than with twice as many, and with these 0.7 to 1.3 %.
pub(super) fn zenith_nodes(per_hemisphere: usize, horizon: f64) -> Vec<(f64, f64)> {
    let half = gauss_legendre(per_hemisphere);
    let (below, above) = (1.0 + horizon, 1.0 - horizon);
    let up = half.iter().map(|&(x, weight)| (horizon + above * x * x, 2.0 * above * x * weight));
    let down = half.iter().map(|&(x, weight)| (horizon - below * x * x, 2.0 * below * x * weight));
    down.chain(up).collect()
}

/// Cosine of the zenith angle of the horizon from an altitude, 0 on the ground.
fn horizon_cosine(altitude_m: f64, ground_altitude_m: f64) -> f64 {
    let sine = (EARTH_RADIUS_M + ground_altitude_m) / (EARTH_RADIUS_M + altitude_m.max(ground_altitude_m));
    -(1.0 - sine * sine).max(0.0).sqrt()
}

/// An azimuth of the quadrature: its cosine, sine, weight [rad], and cos m·azimuth.
struct Azimuth {
    cosine: f64,
    sine: f64,
    weight: f64,
    cosines: Vec<f64>,
}

/// Azimuths over a half turn seen from `distance_m` away, weights summing to 2π for both halves; half of them
/// crowd within the bright part around the source, which is at azimuth π.
fn azimuths(nodes: &[(f64, f64)], distance_m: f64, degree: usize) -> Vec<Azimuth> {
    let bright = (BRIGHT_SIZE_M / distance_m.max(1.0)).clamp(0.25, 0.5 * PI);
    let inner = nodes.iter().map(|&(t, weight)| (bright * t * t, bright * 2.0 * t * weight));
    let outer = nodes.iter().map(|&(t, weight)| (bright + (PI - bright) * t, (PI - bright) * weight));
    inner
        .chain(outer)
        .map(|(from_source, weight)| {
            let (sine, cosine) = (PI - from_source).sin_cos();
            Azimuth { cosine, sine, weight: 2.0 * weight, cosines: cosines(degree, cosine) }
        })
        .collect()
}

/// What one place gathers over all directions.
#[derive(Clone)]
struct Gathered {
    moments: Vec<[f64; LANES]>,
    down_flux: [f64; LANES],
    up_flux: [f64; LANES],
}

fn stride(first_m: f64) -> Stride {
    Stride { first_m, growth: 0.3 }
}

/// Radiance of one order from its source function and what the ground and the base of a cloud send back.
pub(super) fn transport(
    setting: &SourceSetting,
    resolution: &Resolution,
    grid: &FieldGrid,
    source: &SourceFunction,
    surfaces: &Surfaces,
) -> Radiance {
    let degree = resolution.later_degree;
    let pairs = pair_count(degree);
    let azimuth_nodes = gauss_legendre(resolution.azimuths / 2);
    let rings: Vec<Vec<Azimuth>> =
        (0..grid.ring_count()).map(|ring| azimuths(&azimuth_nodes, grid.place_m(ring).0, degree)).collect();
    let empty =
        Gathered { moments: vec![[0.0; LANES]; pairs], down_flux: [0.0; LANES], up_flux: [0.0; LANES] };
    let mut gathered = vec![empty; grid.point_count()];
    let refined = if setting.atmosphere.cloud().is_some() { OVERCAST_ZENITHS } else { 1 };
    let per_hemisphere = refined * resolution.polar_per_hemisphere;
    // [layer][node]
    let nodes: Vec<Vec<(f64, f64)>> = grid
        .layer_m()
        .iter()
        .map(|&altitude_m| {
            zenith_nodes(per_hemisphere, horizon_cosine(altitude_m, setting.ground_altitude_m))
        })
        .collect();
    for node in 0..2 * per_hemisphere {
        // A ray's zenith angle turns by less than a degree in 100 km, and within the haze those of the layers' nodes are as
        // near one another; the source function does not notice.
        let cosines: Vec<f64> = nodes.iter().map(|nodes| nodes[node].0).collect();
        let table = source.table(grid, &cosines, TABLE_AZIMUTHS);
        let polar: Vec<Vec<f64>> = cosines.iter().map(|&cosine| legendre(degree, cosine)).collect();
        let far_paths: Vec<SteppedPath> = grid
            .layer_m()
            .par_iter()
            .zip(&cosines)
            .map(|(&altitude_m, &cosine)| {
                SteppedPath::new(setting, grid, altitude_m, cosine, stride(FAR_FIRST_STEP_M))
            })
            .collect();
        gathered.par_iter_mut().enumerate().for_each(|(point, place)| {
            let layer = point / rings.len();
            let (cosine, weight) = nodes[layer][node];
            let (distance_m, altitude_m) = grid.place_m(point);
            let from_source_m = distance_m.hypot(altitude_m - setting.source_altitude_m);
            let first_m = (0.25 * (from_source_m + 40.0)).min(FAR_FIRST_STEP_M);
            let near_path;
            let path = if first_m < FAR_FIRST_STEP_M {
                near_path = SteppedPath::new(setting, grid, altitude_m, cosine, stride(first_m));
                &near_path
            } else {
                &far_paths[layer]
            };
            let sky = Sky { path, grid, source, table: &table, surfaces, distance_m };
            let zenith = Zenith { cosine, weight, legendre: &polar[layer] };
            gather(&sky, &zenith, &rings[point % rings.len()], degree, place);
        });
    }
    Radiance {
        moments: Moments {
            degree,
            values: gathered.iter().flat_map(|p| p.moments.iter().map(|m| m.map(|v| v as f32))).collect(),
        },
        down_flux: gathered.iter().map(|p| p.down_flux).collect(),
        up_flux: gathered.iter().map(|p| p.up_flux).collect(),
    }
}

/// What rays of one zenith angle from one place go through.
struct Sky<'a> {
    path: &'a SteppedPath,
    grid: &'a FieldGrid,
    source: &'a SourceFunction,
    table: &'a DirectionTable,
    surfaces: &'a Surfaces,
    /// Of the place from the source's vertical, metres.
    distance_m: f64,
}

/// A zenith angle of the quadrature.
struct Zenith<'a> {
    cosine: f64,
    weight: f64,
    legendre: &'a [f64],
}

dispatch_wide!(
    /// Adds what comes from all azimuths of one zenith angle to what a place gathers.
    gather,
    gather_wide,
    gather_body,
    (sky: &Sky<'_>, zenith: &Zenith<'_>, azimuths: &[Azimuth], degree: usize, place: &mut Gathered)
);

#[inline(always)]
fn gather_body(
    sky: &Sky<'_>,
    zenith: &Zenith<'_>,
    azimuths: &[Azimuth],
    degree: usize,
    place: &mut Gathered,
) {
    let mut modes = vec![[0.0f64; LANES]; degree + 1];
    for azimuth in azimuths {
        let radiance = sky.along(azimuth.cosine, azimuth.sine);
        for (mode, cosine) in modes.iter_mut().zip(&azimuth.cosines) {
            for (sum, value) in mode.iter_mut().zip(radiance) {
                *sum += cosine * azimuth.weight * f64::from(value);
            }
        }
    }
    for (sum, value) in place.down_flux.iter_mut().zip(modes[0]) {
        *sum += zenith.weight * zenith.cosine.max(0.0) * value;
    }
    for (sum, value) in place.up_flux.iter_mut().zip(modes[0]) {
        *sum += zenith.weight * (-zenith.cosine).max(0.0) * value;
    }
    for l in 0..=degree {
        for (m, mode) in modes.iter().enumerate().take(l + 1) {
            let factor = zenith.weight * zenith.legendre[pair_index(l, m)];
            for (sum, value) in place.moments[pair_index(l, m)].iter_mut().zip(mode) {
                *sum += factor * value;
            }
        }
    }
}

impl Sky<'_> {
    /// Radiance at the start of a ray, m⁻² sr⁻¹ per watt.
    #[inline(always)]
    fn along(&self, cos_azimuth: f64, sin_azimuth: f64) -> Lanes {
        let mut sum = [0.0; LANES];
        for step in &self.path.steps {
            let (distance_m, cosine) = track(self.distance_m, cos_azimuth, sin_azimuth, step.arc_m);
            let Some(ring) = self.grid.ring_at(distance_m) else { continue };
            let value = self.source.sample(self.table, self.grid, ring, &step.layer, cosine);
            for lane in 0..LANES {
                sum[lane] += step.weight[lane] * value[lane];
            }
        }
        if let Some(end) = &self.path.end {
            let (distance_m, _) = track(self.distance_m, cos_azimuth, sin_azimuth, end.arc_m);
            if let Some(ring) = self.grid.ring_at(distance_m) {
                let value = self.surfaces.at(end.surface, ring);
                for lane in 0..LANES {
                    sum[lane] += end.through[lane] * value[lane];
                }
            }
        }
        sum
    }
}
