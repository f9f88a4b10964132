//! Energy budget at emission: the power of direct and scattered light that reaches space. None does through a cloud.

use super::{
    grid::FieldGrid,
    harmonics::{legendre, pair_index},
    lanes::LANES,
    log_field::LogField,
    optics::{SlantPath, optical_depths, relative_densities},
    setting::SourceSetting,
    source_function::{Moments, USED_LANES},
    transport::zenith_nodes,
};
use crate::{
    atmosphere::AEROSOL_ALBEDO,
    bands::BAND_COUNT,
    emission::{LOBE_COUNT, emitted_shares, lobe_intensities_per_sr},
    phase::{AEROSOL_ASYMMETRY, henyey_greenstein_per_sr, rayleigh_per_sr},
    quadrature::gauss_legendre,
};
use std::f64::consts::{PI, TAU};

/// Top of the atmosphere for escaping light, metres.
const SPACE_ALTITUDE_M: f64 = 200_000.0;
/// Zenith angles a hemisphere for escape.
const ESCAPE_ZENITHS: usize = 16;

/// Budget of direct light, W per watt of the source.
#[derive(Clone, Debug)]
pub(super) struct DirectBudget {
    pub(super) scattered_w: [f64; LANES],
    pub(super) absorbed_w: [f64; LANES],
    pub(super) escaped_w: [f64; LANES],
    /// What arrives at the base of a cloud, and what of it the base reflects.
    pub(super) at_base_w: [f64; LANES],
    pub(super) returned_w: [f64; LANES],
    /// What the source emits above its skyline; 1 under an open sky.
    pub(super) emitted_w: [f64; LANES],
    /// What of the light scattered once escapes without another event.
    pub(super) once_scattered_escaped_w: [f64; LANES],
}

/// Transmission from a point to space per band; 0 where the ground or a cloud is in the way.
fn to_space(setting: &SourceSetting, altitude_m: f64, cos_zenith: f64) -> [f64; BAND_COUNT] {
    if setting.atmosphere.cloud().is_some() {
        return [0.0; BAND_COUNT];
    }
    let path = SlantPath::new(altitude_m, cos_zenith);
    if path.path_down_to_m(setting.ground_altitude_m).is_some() {
        return [0.0; BAND_COUNT];
    }
    let columns_m = path.point(path.path_up_to_m(SPACE_ALTITUDE_M)).columns_m;
    optical_depths(&setting.atmosphere, columns_m).map(|depth| (-depth).exp())
}

/// Budget of direct light, by quadrature over zenith angle and path.
pub(super) fn direct_budget(setting: &SourceSetting) -> DirectBudget {
    let emitted = emitted_shares(setting.blocking_rad);
    let last = 0.5 * PI - setting.blocking_rad;
    let mut budget = DirectBudget {
        scattered_w: [0.0; LANES],
        absorbed_w: [0.0; LANES],
        escaped_w: [0.0; LANES],
        at_base_w: [0.0; LANES],
        returned_w: [0.0; LANES],
        emitted_w: std::array::from_fn(|lane| emitted[lane % LOBE_COUNT]),
        once_scattered_escaped_w: [0.0; LANES],
    };
    let nodes = gauss_legendre(16);
    // The oblique lobe ends at 60°; the horizon is approached finely.
    for (low, high) in [(0.0, PI / 3.0), (PI / 3.0, 0.48 * PI), (0.48 * PI, 0.5 * PI)] {
        // Nothing leaves below the skyline.
        let high = high.min(last);
        if high <= low {
            break;
        }
        for &(x, weight) in &nodes {
            let psi = low + (high - low) * x;
            let ring_sr = weight * (high - low) * TAU * psi.sin();
            add_ray(setting, psi.cos(), ring_sr, &nodes, &mut budget);
        }
    }
    budget
}

/// Adds the direct light in a ring of directions.
fn add_ray(
    setting: &SourceSetting,
    cos_zenith: f64,
    ring_sr: f64,
    nodes: &[(f64, f64)],
    budget: &mut DirectBudget,
) {
    let lobes = lobe_intensities_per_sr(cos_zenith);
    let path = SlantPath::new(setting.source_altitude_m, cos_zenith);
    let cloud = setting.atmosphere.cloud();
    let end_m = match cloud {
        Some(cloud) => path.path_to_base_m(cloud.altitude_m()),
        None => path.path_up_to_m(SPACE_ALTITUDE_M),
    };
    let beta_m = setting.atmosphere.molecule_extinction_per_m();
    let beta_a = setting.atmosphere.aerosol_extinction_per_m();
    // [scattered, absorbed, once scattered and escaped][band]
    let mut sums = [[0.0; BAND_COUNT]; 3];
    let cuts = [0.0, 0.01, 0.06, 0.25, 1.0].map(|share| share * end_m);
    for pair in cuts.windows(2) {
        for &(s, weight) in nodes {
            let length_m = (pair[1] - pair[0]) * weight;
            let point = path.point(pair[0] + (pair[1] - pair[0]) * s);
            let depths = optical_depths(&setting.atmosphere, point.columns_m);
            let escape = escape_after_turn(setting, point.altitude_m, point.cos_zenith);
            for band in 0..BAND_COUNT {
                let (m, a) = (beta_m[band] * point.density[0], beta_a[band] * point.density[1]);
                let light_m = (-depths[band]).exp() * length_m;
                sums[0][band] += light_m * (m + AEROSOL_ALBEDO * a);
                sums[1][band] += light_m * (1.0 - AEROSOL_ALBEDO) * a;
                sums[2][band] += light_m * (m * escape[0][band] + AEROSOL_ALBEDO * a * escape[1][band]);
            }
        }
    }
    let end = path.point(end_m);
    let out = optical_depths(&setting.atmosphere, end.columns_m);
    for lane in 0..USED_LANES {
        let (band, watts) = (lane / LOBE_COUNT, ring_sr * lobes[lane % LOBE_COUNT]);
        budget.scattered_w[lane] += watts * sums[0][band];
        budget.absorbed_w[lane] += watts * sums[1][band];
        budget.once_scattered_escaped_w[lane] += watts * sums[2][band];
        let end_w = watts * (-out[band]).exp();
        match cloud {
            Some(cloud) => {
                budget.at_base_w[lane] += end_w;
                budget.returned_w[lane] += end_w * cloud.plane_albedo(end.cos_zenith);
            }
            None => budget.escaped_w[lane] += end_w,
        }
    }
}

/// Share of light that escapes after a scattering, `[species][band]`; it came along a ray with `cos_zenith`.
fn escape_after_turn(setting: &SourceSetting, altitude_m: f64, cos_zenith: f64) -> [[f64; BAND_COUNT]; 2] {
    let mut share = [[0.0; BAND_COUNT]; 2];
    let sine = (1.0 - cos_zenith * cos_zenith).max(0.0).sqrt();
    let turns = 8;
    for (x, weight) in gauss_legendre(12) {
        // γ = π·x²: half of what haze scatters turns by less than 20°.
        let (sin_gamma, cos_gamma) = (PI * x * x).sin_cos();
        for k in 0..turns {
            let turn = PI * (f64::from(k) + 0.5) / f64::from(turns);
            let out = cos_zenith * cos_gamma + sine * sin_gamma * turn.cos();
            let solid_angle = weight * TAU * x * sin_gamma * TAU / f64::from(turns);
            let through = to_space(setting, altitude_m, out.clamp(-1.0, 1.0));
            for band in 0..BAND_COUNT {
                share[0][band] += through[band] * rayleigh_per_sr(cos_gamma) * solid_angle;
                share[1][band] +=
                    through[band] * henyey_greenstein_per_sr(cos_gamma, AEROSOL_ASYMMETRY) * solid_angle;
            }
        }
    }
    share
}

/// Power of the next order that escapes: what the air of the grid emits, and what the ground reflects
/// (`returned_w`), each without another event. Nothing under a cloud.
pub(super) fn escaping_w(
    setting: &SourceSetting,
    grid: &FieldGrid,
    source: &Moments,
    returned_w: [f64; LANES],
) -> [f64; LANES] {
    if setting.atmosphere.cloud().is_some() {
        return [0.0; LANES];
    }
    let nodes = zenith_nodes(ESCAPE_ZENITHS, 0.0);
    let polar: Vec<Vec<f64>> = nodes.iter().map(|&(mu, _)| legendre(source.degree, mu)).collect();
    // Light travels against the view direction.
    let through: Vec<Vec<[f64; BAND_COUNT]>> = grid
        .layer_m()
        .iter()
        .map(|&z| nodes.iter().map(|&(mu, _)| to_space(setting, z, -mu)).collect())
        .collect();
    let ring_count = grid.ring_count();
    let leaving = LogField::new(
        grid,
        (0..grid.point_count()).map(|point| {
            let values = source.at(point);
            let mut sum = [0.0; LANES];
            for ((polar, &(_, weight)), through) in polar.iter().zip(&nodes).zip(&through[point / ring_count])
            {
                for (lane, sum) in sum.iter_mut().enumerate().take(USED_LANES) {
                    let radiance: f64 = (0..=source.degree)
                        .map(|l| polar[pair_index(l, 0)] * f64::from(values[pair_index(l, 0)][lane]))
                        .sum();
                    *sum += TAU * weight * radiance * through[lane / LOBE_COUNT];
                }
            }
            sum
        }),
    );
    let mut escaped_w = [0.0; LANES];
    let beta_m = setting.atmosphere.molecule_extinction_per_m();
    let beta_a = setting.atmosphere.aerosol_extinction_per_m();
    grid.for_each_volume(|ring, layer, altitude_m, volume_m3| {
        let density = relative_densities(altitude_m);
        let light = leaving.at(ring, layer);
        for lane in 0..USED_LANES {
            let band = lane / LOBE_COUNT;
            escaped_w[lane] +=
                (beta_m[band] * density[0] + beta_a[band] * density[1]) * light[lane] * volume_m3;
        }
    });
    for (x, weight) in gauss_legendre(ESCAPE_ZENITHS) {
        // Lambertian: ∫ 2μ T dμ with μ = x².
        let through = to_space(setting, setting.ground_altitude_m + 1e-3, x * x);
        for lane in 0..USED_LANES {
            escaped_w[lane] += returned_w[lane] * 4.0 * x * x * x * weight * through[lane / LOBE_COUNT];
        }
    }
    escaped_w
}
