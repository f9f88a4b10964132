//! Forward Monte Carlo with expected-value scoring: paths from the source, counted where they cross view rays.
//!
//! A view ray turned about the source's vertical sweeps out a hyperboloid; all its copies see the same sky. By
//! that symmetry the radiance of the ray is, over all crossings of photon paths with the surface,
//!
//!   L = (1/2π) Σ w·e^{−τ(X,P)}·Σβp(γ)·e^{−τ(P,O)} / (ρ·|ω·(v × φ̂)|)
//!
//! with w the photon path's weight and ω its direction, ρ the distance of the crossing P from the vertical, v the
//! copy of the view direction through P and φ̂ the horizontal around the vertical: ρ·|v × φ̂| du dφ is the
//! element of the surface, and |ω·n| what of it a photon path sees. Photon paths are counted along their whole length,
//! whether or not the light is scattered before.
//!
//! Under a cloud the photon paths that arrive at the base are counted too, in a narrow ring about the source's vertical
//! through the point where the view ray meets the base: E = Σ w·e^{−τ}/ring's area, L = E·A/π·e^{−τ(P,O)}.

use super::{
    super::{
        optics::{SlantPath, optical_depths},
        setting::SourceSetting,
    },
    Estimate, SEPARATE_ORDERS,
    crossing::{Detector, Ray},
    draws::{Random, lambertian_direction, mixed_phase, path_of_depth_m, scattered_direction},
};
use crate::{
    atmosphere::AEROSOL_ALBEDO,
    bands::Band,
    cloud::CloudBase,
    cone::sin_blocking,
    emission::{LOBE_COUNT, lobe_intensities_per_sr},
    geometry::EARTH_RADIUS_M,
};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Top of the atmosphere for photon paths, metres.
const TOP_ALTITUDE_M: f64 = 100_000.0;
/// Russian roulette: photon paths of a smaller weight survive by chance only.
const MIN_WEIGHT: f64 = 0.05;
/// Paths of one random stream; streams are summed in order, whatever thread ran them.
const STREAM_PATHS: u64 = 4_096;

/// A tracer of one setting and band.
#[derive(Clone, Debug)]
pub struct ForwardTracer {
    setting: SourceSetting,
    band: usize,
    molecules_per_m: f64,
    aerosol_per_m: f64,
    lamp_radius_m: f64,
}

/// A photon path at its last event: place, direction, weight per lobe, and how often it was scattered before.
struct PhotonPath {
    start: DVec3,
    direction: DVec3,
    weight: [f64; LOBE_COUNT],
    order: usize,
}

type Tally = [[f64; LOBE_COUNT]; SEPARATE_ORDERS];

impl ForwardTracer {
    /// A tracer of a band of a setting.
    ///
    /// # Panics
    /// Under a cloud that is not Lambertian.
    pub fn new(setting: SourceSetting, band: Band) -> Self {
        super::check_base(&setting);
        Self {
            setting,
            band: band.index(),
            molecules_per_m: setting.atmosphere.molecule_extinction_per_m()[band.index()],
            aerosol_per_m: setting.atmosphere.aerosol_extinction_per_m()[band.index()],
            lamp_radius_m: 0.0,
        }
    }

    /// The same for a level disc of that radius [m] around the source instead of a point, as bright everywhere: a town.
    /// It stays symmetric about the source's vertical, so view rays are treated alike.
    pub fn with_lamp_radius_m(self, lamp_radius_m: f64) -> Self {
        Self { lamp_radius_m, ..self }
    }

    /// Where a path starts. A point lamp draws no numbers for it.
    fn start(&self, random: &mut Random) -> DVec3 {
        if self.lamp_radius_m <= 0.0 {
            return DVec3::ZERO;
        }
        let from_axis_m = self.lamp_radius_m * random.unit().sqrt();
        let (sine, cosine) = (TAU * random.unit()).sin_cos();
        DVec3::new(from_axis_m * cosine, from_axis_m * sine, 0.0)
    }

    /// Estimates the radiance at every detector from the same `paths` paths (rounded up to whole streams); the
    /// estimates of different detectors are therefore correlated, those of other seeds are not.
    /// The same seed gives the same numbers on any number of threads.
    pub fn estimate(&self, detectors: &[Detector], paths: u64, seed: u64) -> Vec<Estimate> {
        let rays: Vec<Ray> =
            detectors.iter().map(|detector| Ray::new(&self.setting, self.band, detector)).collect();
        let streams = paths.div_ceil(STREAM_PATHS).max(1);
        let sums: Vec<_> = (0..streams)
            .into_par_iter()
            .map(|stream| {
                let mut random = Random::new(seed, stream);
                let mut tallies: Vec<Tally> = vec![[[0.0; LOBE_COUNT]; SEPARATE_ORDERS]; rays.len()];
                let mut squares = vec![[0.0; LOBE_COUNT]; rays.len()];
                let mut caught = vec![[0.0; LOBE_COUNT]; rays.len()];
                for _ in 0..STREAM_PATHS {
                    self.trace(&rays, &mut tallies, &mut caught, &mut random);
                    for (square, caught) in squares.iter_mut().zip(&mut caught) {
                        for lobe in 0..LOBE_COUNT {
                            square[lobe] += caught[lobe] * caught[lobe];
                            caught[lobe] = 0.0;
                        }
                    }
                }
                (tallies, squares)
            })
            .collect();
        let count = (streams * STREAM_PATHS) as f64;
        (0..rays.len())
            .map(|ray| {
                let mut orders = [[0.0; LOBE_COUNT]; SEPARATE_ORDERS];
                let mut squares = [0.0; LOBE_COUNT];
                for (tallies, stream_squares) in &sums {
                    for lobe in 0..LOBE_COUNT {
                        for order in 0..SEPARATE_ORDERS {
                            orders[order][lobe] += tallies[ray][order][lobe] / count;
                        }
                        squares[lobe] += stream_squares[ray][lobe] / count;
                    }
                }
                Estimate::from_sums(orders, squares, count)
            })
            .collect()
    }

    /// Follows one path from the source to its end.
    fn trace(
        &self,
        rays: &[Ray],
        tallies: &mut [Tally],
        caught: &mut [[f64; LOBE_COUNT]],
        random: &mut Random,
    ) {
        // ψ half evenly in angle and half as the Lambertian lobe: every lobe is met, none too rarely.
        let psi = if random.unit() < 0.5 { FRAC_PI_2 * random.unit() } else { random.unit().sqrt().acos() };
        let (sine, cosine) = psi.sin_cos();
        let density = 0.5 / (FRAC_PI_2 * TAU * sine.max(1e-12)) + 0.5 * cosine / (0.5 * TAU);
        let (turn_y, turn_x) = (TAU * random.unit()).sin_cos();
        let mut photon = PhotonPath {
            start: self.start(random),
            direction: DVec3::new(sine * turn_x, sine * turn_y, cosine),
            weight: if cosine > sin_blocking(self.setting.blocking_rad) {
                lobe_intensities_per_sr(cosine).map(|f| f / density)
            } else {
                [0.0; LOBE_COUNT]
            },
            order: 0,
        };
        let center = DVec3::new(0.0, 0.0, -EARTH_RADIUS_M - self.setting.source_altitude_m);
        loop {
            let from_center = photon.start - center;
            let radius = from_center.length();
            let path = SlantPath::new(radius - EARTH_RADIUS_M, photon.direction.dot(from_center) / radius);
            let ground_m = path.path_down_to_m(self.setting.ground_altitude_m);
            let cloud = self.setting.atmosphere.cloud();
            let top_m = cloud.map_or(TOP_ALTITUDE_M, CloudBase::altitude_m);
            let end_m = ground_m.unwrap_or_else(|| path.path_up_to_m(top_m));
            for (index, ray) in rays.iter().enumerate() {
                self.catch(ray, &photon, &path, end_m, &mut tallies[index], &mut caught[index]);
            }
            let depth_at =
                |u: f64| optical_depths(&self.setting.atmosphere, path.point(u).columns_m)[self.band];
            let (drawn, whole) = (-random.unit().ln(), depth_at(end_m));
            let at_base = cloud.filter(|_| ground_m.is_none());
            if at_base.is_some() {
                let arrival = photon.start + photon.direction * end_m;
                for (index, ray) in rays.iter().enumerate() {
                    let reflected_per_w = ray.base_radiance_per_w(arrival) * (-whole).exp();
                    Self::count(&photon, reflected_per_w, &mut tallies[index], &mut caught[index]);
                }
            }
            if drawn >= whole {
                let (side, albedo) = match (ground_m, at_base) {
                    (Some(_), _) => (1.0, self.setting.ground_albedo),
                    (None, Some(cloud)) => (-1.0, cloud.albedo()),
                    (None, None) => return,
                };
                photon.start += photon.direction * end_m;
                let normal = (photon.start - center).normalize() * side;
                // Off the surface, lest rounding puts the start behind it.
                photon.start += normal * 1e-4;
                photon.direction = lambertian_direction(normal, random);
                photon.weight = photon.weight.map(|w| w * albedo);
            } else {
                let path_m = path_of_depth_m(drawn, whole, end_m, depth_at);
                let density = path.point(path_m).density;
                let (m, a) = (self.molecules_per_m * density[0], self.aerosol_per_m * density[1]);
                photon.start += photon.direction * path_m;
                photon.direction = scattered_direction(photon.direction, [m, AEROSOL_ALBEDO * a], random);
                photon.weight = photon.weight.map(|w| w * (m + AEROSOL_ALBEDO * a) / (m + a));
            }
            photon.order += 1;
            let most = photon.weight.iter().fold(0.0f64, |a, &b| a.max(b));
            if most < MIN_WEIGHT {
                if random.unit() * MIN_WEIGHT >= most {
                    return;
                }
                photon.weight = photon.weight.map(|w| w * MIN_WEIGHT / most);
            }
        }
    }

    /// Counts where a photon path crosses the surface that a view ray sweeps out.
    fn catch(
        &self,
        ray: &Ray,
        photon: &PhotonPath,
        path: &SlantPath,
        end_m: f64,
        tally: &mut Tally,
        caught: &mut [f64; LOBE_COUNT],
    ) {
        for crossing in ray.crossings(photon.start, photon.direction, end_m).into_iter().flatten() {
            let point = path.point(crossing.photon_m);
            let seen = ray.path.point(crossing.view_m);
            let columns_m = [point.columns_m[0] + seen.columns_m[0], point.columns_m[1] + seen.columns_m[1]];
            let through = (-optical_depths(&self.setting.atmosphere, columns_m)[self.band]).exp();
            let scatterers = [
                self.molecules_per_m * point.density[0],
                AEROSOL_ALBEDO * self.aerosol_per_m * point.density[1],
            ];
            let value = through * mixed_phase(scatterers, crossing.cos_gamma) / (TAU * crossing.facing_m);
            Self::count(photon, value, tally, caught);
        }
    }

    /// Counts light of a photon path that continues to the observer, `per_weight` of it.
    fn count(photon: &PhotonPath, per_weight: f64, tally: &mut Tally, caught: &mut [f64; LOBE_COUNT]) {
        if per_weight <= 0.0 {
            return;
        }
        for lobe in 0..LOBE_COUNT {
            let value = per_weight * photon.weight[lobe];
            tally[photon.order.min(SEPARATE_ORDERS - 1)][lobe] += value;
            if photon.order > 0 {
                caught[lobe] += value;
            }
        }
    }
}
