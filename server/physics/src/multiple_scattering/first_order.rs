//! Moments of light scattered once, arriving at every place of the grid, by direct quadrature.
//!
//! At a place P the directions form a polar grid about the direction to the source: the radiance grows like
//! 1/θ towards the source, and the factor sin θ of the solid angle takes that away. PathSum each direction the
//! variable is the angle at the source (as in `single_source`), cut where the integrand has a kink. What the base of a
//! cloud reflects is added by [`super::reflected`].

use super::{
    LANES,
    direct::direct_light,
    gathering::{FirstOrderPlace, FirstOrderRule, Gathering, Place},
    grid::FieldGrid,
    optics::{SlantPath, optical_depths, relative_densities},
    reflected::Reflection,
    setting::SourceSetting,
};
use crate::{
    atmosphere::AEROSOL_ALBEDO,
    bands::BAND_COUNT,
    cone::{RayFromSource, sin_blocking},
    emission::LOBE_COUNT,
    geometry::EARTH_RADIUS_M,
    phase::{AEROSOL_ASYMMETRY, henyey_greenstein_per_sr, rayleigh_per_sr},
};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Places nearer to the source than this are moved up and out to it: its light is infinite at the source.
const MIN_PLACE_DISTANCE_M: f64 = 25.0;

/// Size of the bright part of the sky around a source, metres: it fills this over the distance, in radians.
const BRIGHT_SIZE_M: f64 = 5_000.0;

/// Everything first-order about one setting that does not depend on the place.
pub(super) struct FirstOrder<'a> {
    setting: &'a SourceSetting,
    rule: &'a FirstOrderRule,
    source: DVec3,
    source_density: [f64; 2],
    /// Sine of the elevation of the skyline around the source.
    sin_blocking: f64,
    top_altitude_m: f64,
    /// The base of the cloud, lit by the source.
    reflection: Option<Reflection<'a>>,
}

impl<'a> FirstOrder<'a> {
    pub(super) fn new(setting: &'a SourceSetting, rule: &'a FirstOrderRule, top_altitude_m: f64) -> Self {
        Self {
            setting,
            rule,
            source: DVec3::new(0.0, 0.0, EARTH_RADIUS_M + setting.source_altitude_m),
            source_density: relative_densities(setting.source_altitude_m),
            sin_blocking: sin_blocking(setting.blocking_rad),
            top_altitude_m,
            reflection: Reflection::new(setting, rule),
        }
    }

    /// Angles from the source's direction [rad] with weights [rad], seen from `distance_m` away.
    fn polar_angles(&self, distance_m: f64) -> Vec<(f64, f64)> {
        let bright = (BRIGHT_SIZE_M / distance_m).clamp(0.2, 0.5 * PI);
        // Inside, θ = bright·t²: far away most of the light is within a degree or two of the source.
        let inner = self.rule.polar.iter().map(|&(t, weight)| (bright * t * t, bright * 2.0 * t * weight));
        let outer =
            self.rule.polar.iter().map(|&(t, weight)| (bright + (PI - bright) * t, (PI - bright) * weight));
        inner.chain(outer).collect()
    }

    /// The light at place `point` of the grid, moments up to `degree`.
    pub(super) fn at(&self, grid: &FieldGrid, point: usize, degree: usize) -> FirstOrderPlace {
        let (mut distance_m, mut altitude_m) = grid.place_m(point);
        if distance_m.hypot(altitude_m - self.setting.source_altitude_m) < MIN_PLACE_DISTANCE_M {
            distance_m = distance_m.max(0.7 * MIN_PLACE_DISTANCE_M);
            altitude_m = altitude_m.max(self.setting.source_altitude_m + 0.7 * MIN_PLACE_DISTANCE_M);
        }
        let place = Place::new(distance_m, altitude_m);
        let to_source = (self.source - place.position).normalize();
        let beside = DVec3::Y;
        let across = beside.cross(to_source);
        let mut light = Gathering::new(degree);
        let from_source_m = (self.source - place.position).length();
        for (angle, weight) in self.polar_angles(from_source_m) {
            let (sin_polar, cos_polar) = angle.sin_cos();
            for k in 0..self.rule.around {
                let turn = PI * (k as f64 + 0.5) / self.rule.around as f64;
                let (sin_turn, cos_turn) = turn.sin_cos();
                let view = to_source * cos_polar + (across * cos_turn + beside * sin_turn) * sin_polar;
                let Some(radiance) = self.along_ray(&place, view) else { continue };
                // Both halves of the sphere at once: the other one is its mirror image.
                let solid_angle = weight * sin_polar * TAU / self.rule.around as f64;
                light.add(&place, view, &radiance, solid_angle);
            }
        }
        if let Some(reflection) = &self.reflection {
            reflection.add(&place, &mut light);
        }
        light.done()
    }

    /// Radiance per watt [m⁻² sr⁻¹] of what the air scatters once at a place from direction `view`; None where nothing
    /// is lit.
    fn along_ray(&self, place: &Place, view: DVec3) -> Option<[f64; LANES]> {
        let cos_zenith = view.dot(place.up);
        let path = SlantPath::new(place.altitude_m, cos_zenith);
        let ground_m = path.path_down_to_m(self.setting.ground_altitude_m);
        let end_m = ground_m.unwrap_or_else(|| match self.setting.atmosphere.cloud() {
            Some(cloud) => path.path_to_base_m(cloud.altitude_m()),
            None => path.path_up_to_m(self.top_altitude_m),
        });
        // Above the source's horizon plane only, and above its skyline.
        let (height, rate) = (place.position.z - self.source.z, view.z);
        let (low, high) = match (height > 0.0, rate > 0.0) {
            (true, true) => (0.0, end_m),
            (true, false) => (0.0, if rate < 0.0 { (height / -rate).min(end_m) } else { end_m }),
            (false, true) => (-height / rate, end_m),
            (false, false) => return None,
        };
        if high <= low {
            return None;
        }
        let from_source = place.position - self.source;
        let (low, high) = RayFromSource { start_m: from_source, view, up: DVec3::Z }
            .lit_m(self.sin_blocking, (low, high))?;
        let nearest_m = -from_source.dot(view);
        let miss_m = (from_source + view * nearest_m).length().max(1e-3);
        let mut cuts = self.cuts_m(place, &path, nearest_m);
        cuts.retain(|&u| u > low && u < high);
        cuts.extend([low, high]);
        cuts.sort_by(f64::total_cmp);
        let angle = |u: f64| ((u - nearest_m) / miss_m).atan();
        let mut sum = [0.0; LANES];
        for pair in cuts.windows(2) {
            let (from, to) = (angle(pair[0]), angle(pair[1]));
            if to - from < 1e-9 {
                continue;
            }
            for &(x, weight) in &self.rule.along {
                let tangent = (from + (to - from) * x).tan();
                let u = (nearest_m + miss_m * tangent).clamp(pair[0], pair[1]);
                let step = weight * (to - from) * miss_m * (1.0 + tangent * tangent);
                self.add_scattered(&path, from_source + view * u, view, u, step, &mut sum);
            }
        }
        Some(sum)
    }

    /// Where the integrand has a kink: nearest to the source, at the layer of the haze, after one and four mean
    /// free paths of green light, and nearest to the source's vertical.
    fn cuts_m(&self, place: &Place, path: &SlantPath, nearest_m: f64) -> Vec<f64> {
        let density = relative_densities(place.altitude_m);
        let free_path_m = 1.0
            / (self.setting.atmosphere.molecule_extinction_per_m()[1] * density[0]
                + self.setting.atmosphere.aerosol_extinction_per_m()[1] * density[1]);
        let mut cuts = vec![nearest_m, free_path_m, 4.0 * free_path_m];
        for height_m in [3_000.0, 20_000.0] {
            let altitude_m = self.setting.source_altitude_m + height_m;
            cuts.push(path.path_up_to_m(altitude_m));
            cuts.extend(path.path_down_to_m(altitude_m));
        }
        cuts
    }

    /// Adds what is scattered at one point towards the place, through the air between, times the step.
    fn add_scattered(
        &self,
        path: &SlantPath,
        from_source: DVec3,
        view: DVec3,
        path_m: f64,
        step_m: f64,
        sum: &mut [f64; LANES],
    ) {
        if from_source.z <= self.sin_blocking * from_source.length() {
            return;
        }
        let point = path.point(path_m);
        let (lobes, from) =
            direct_light(self.setting, self.source_density, from_source, point.altitude_m, point.density);
        let depths = optical_depths(
            &self.setting.atmosphere,
            [from[0] + point.columns_m[0], from[1] + point.columns_m[1]],
        );
        let cos_gamma = (-from_source.dot(view) / from_source.length()).clamp(-1.0, 1.0);
        let molecules = point.density[0] * rayleigh_per_sr(cos_gamma) * step_m;
        let aerosol = point.density[1]
            * AEROSOL_ALBEDO
            * henyey_greenstein_per_sr(cos_gamma, AEROSOL_ASYMMETRY)
            * step_m;
        let beta_m = self.setting.atmosphere.molecule_extinction_per_m();
        let beta_a = self.setting.atmosphere.aerosol_extinction_per_m();
        for band in 0..BAND_COUNT {
            let scattered = (beta_m[band] * molecules + beta_a[band] * aerosol) * (-depths[band]).exp();
            for lobe in 0..LOBE_COUNT {
                sum[band * LOBE_COUNT + lobe] += scattered * lobes[lobe];
            }
        }
    }
}
