//! From the source function of one order to the radiance of that order at every place of the grid.

use super::{
    grid::{Between, FieldGrid},
    harmonics::{cosines, legendre, pair_count, pair_index},
    lanes::{LANES, Lanes, exp_lanes},
    path::{SteppedPath, Stride, track},
    setting::{Resolution, SourceSetting},
    source_function::{Moments, SourceFunction},
};
use crate::quadrature::gauss_legendre;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Azimuth intervals of the tables that rays are followed with.
const TABLE_AZIMUTHS: usize = 24;

/// The radiance of one order, `[point]`.
#[derive(Clone, Debug)]
pub(super) struct Radiance {
    pub(super) moments: Moments,
    /// Flux through the horizontal from above and from below, m⁻² per watt, `[point]`.
    pub(super) down_flux: Vec<[f64; LANES]>,
    pub(super) up_flux: Vec<[f64; LANES]>,
}

/// ln of the radiance that the ground sends back [m⁻² sr⁻¹ per watt], `[ring]`.
#[derive(Clone, Debug)]
pub(super) struct GroundRadiance(pub(super) Vec<Lanes>);

impl GroundRadiance {
    /// A·E/π from the flux from above in the lowest layer.
    pub(super) fn new(albedo: f64, grid: &FieldGrid, down_flux: &[[f64; LANES]]) -> Self {
        let ln = |flux: f64| (albedo * flux / PI).max(1e-36).ln() as f32;
        Self(down_flux[..grid.ring_count()].iter().map(|flux| flux.map(ln)).collect())
    }

    #[inline]
    fn at(&self, ring: Between) -> Lanes {
        let (near, far) = (&self.0[ring.lower], &self.0[ring.lower + 1]);
        let w = ring.upper_weight as f32;
        exp_lanes(&std::array::from_fn(|lane| near[lane] + w * (far[lane] - near[lane])))
    }
}

/// Directions of a quadrature over the sphere: cosines of zenith angles with weights summing to 2, and
/// azimuths at the middles of equal parts of a half turn.
struct Directions {
    zeniths: Vec<(f64, f64)>,
    /// (cos, sin) of each azimuth, and cos m·azimuth.
    azimuths: Vec<(f64, f64, Vec<f64>)>,
}

impl Directions {
    fn new(resolution: &Resolution) -> Self {
        // Each hemisphere has its own nodes: at the ground radiance jumps at the horizon.
        let half = gauss_legendre(resolution.polar_per_hemisphere);
        let down = half.iter().map(|&(x, weight)| (-x, weight));
        let zeniths = down.chain(half.iter().copied()).collect();
        let azimuths = (0..resolution.azimuths)
            .map(|k| {
                let (sine, cosine) = (PI * (k as f64 + 0.5) / resolution.azimuths as f64).sin_cos();
                (cosine, sine, cosines(resolution.later_degree, cosine))
            })
            .collect();
        Self { zeniths, azimuths }
    }
}

/// What one place gathers over all directions.
#[derive(Clone)]
struct Gathered {
    moments: Vec<[f64; LANES]>,
    down_flux: [f64; LANES],
    up_flux: [f64; LANES],
}

/// Radiance of one order from its source function and what the ground sends back.
pub(super) fn transport(
    setting: &SourceSetting,
    resolution: &Resolution,
    grid: &FieldGrid,
    source: &SourceFunction,
    ground: &GroundRadiance,
) -> Radiance {
    let degree = resolution.later_degree;
    let pairs = pair_count(degree);
    let directions = Directions::new(resolution);
    let empty = Gathered {
        moments: vec![[0.0; LANES]; pairs],
        down_flux: [0.0; LANES],
        up_flux: [0.0; LANES],
    };
    let mut gathered = vec![empty; grid.point_count()];
    for &(cos_zenith, zenith_weight) in &directions.zeniths {
        // Zenith angles turn by less than a degree in 100 km; the source function does not notice.
        let table = source.table(grid, &vec![cos_zenith; grid.layer_count()], TABLE_AZIMUTHS);
        let polar = legendre(degree, cos_zenith);
        gathered.par_iter_mut().enumerate().for_each(|(point, place)| {
            let (distance_m, altitude_m) = grid.place_m(point);
            let from_source_m = distance_m.hypot(altitude_m - setting.source_altitude_m);
            let stride = Stride { first_m: (0.25 * (from_source_m + 40.0)).min(600.0), growth: 0.3 };
            let path = SteppedPath::new(setting, grid, altitude_m, cos_zenith, stride);
            let azimuth_weight = TAU / directions.azimuths.len() as f64;
            let mut modes = vec![[0.0f64; LANES]; degree + 1];
            for (cos_azimuth, sin_azimuth, cosines) in &directions.azimuths {
                let radiance = along(&path, grid, source, &table, ground, distance_m, *cos_azimuth, *sin_azimuth);
                for (mode, cosine) in modes.iter_mut().zip(cosines) {
                    for lane in 0..LANES {
                        mode[lane] += cosine * azimuth_weight * f64::from(radiance[lane]);
                    }
                }
            }
            let flux = if cos_zenith > 0.0 { &mut place.down_flux } else { &mut place.up_flux };
            for lane in 0..LANES {
                flux[lane] += zenith_weight * cos_zenith.abs() * modes[0][lane];
            }
            for l in 0..=degree {
                for m in 0..=l {
                    let factor = zenith_weight * polar[pair_index(l, m)];
                    for lane in 0..LANES {
                        place.moments[pair_index(l, m)][lane] += factor * modes[m][lane];
                    }
                }
            }
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

/// Radiance at the start of a ray, m⁻² sr⁻¹ per watt.
fn along(
    path: &SteppedPath,
    grid: &FieldGrid,
    source: &SourceFunction,
    table: &super::source_function::DirectionTable,
    ground: &GroundRadiance,
    start_m: f64,
    cos_azimuth: f64,
    sin_azimuth: f64,
) -> Lanes {
    let mut sum = [0.0; LANES];
    for step in &path.steps {
        let (distance_m, cosine) = track(start_m, cos_azimuth, sin_azimuth, step.arc_m);
        let Some(ring) = grid.ring_at(distance_m) else { continue };
        let value = source.sample(table, grid, ring, step.layer, cosine);
        for lane in 0..LANES {
            sum[lane] += step.weight[lane] * value[lane];
        }
    }
    if let Some((arc_m, through)) = &path.ground {
        let (distance_m, _) = track(start_m, cos_azimuth, sin_azimuth, *arc_m);
        if let Some(ring) = grid.ring_at(distance_m) {
            let value = ground.at(ring);
            for lane in 0..LANES {
                sum[lane] += through[lane] * value[lane];
            }
        }
    }
    sum
}
