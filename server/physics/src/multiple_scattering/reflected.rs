//! Moments of the source's light that the base of a cloud reflects, at every place of the grid, by two weighted quadratures
//! (the weights as in multiple importance sampling, Veach and Guibas 1995).
//!
//! The base is bright above the source, over a width like the source's depth below it, and a place sees most of what
//! is above itself. So the integral over the base is split by weights that add up to 1,
//!
//!   w = d_P⁴/(d_S⁴ + d_P⁴)  with the distances d_S, d_P of a point of the base from the source and from the place,
//!
//! and each part is taken in the variables in which it is even: the first (w) over the directions in which light
//! leaves the source, so that no power is lost however far away the place is, the second (1 − w) over the directions
//! of the place's own sky.

use super::{
    LANES,
    direct::direct_light,
    gathering::{FirstOrderRule, Gathering, Place},
    optics::{SlantPath, optical_depths, relative_densities},
    setting::SourceSetting,
};
use crate::{
    cloud::CloudBase,
    cone::sin_blocking,
    emission::{LOBE_COUNT, lobe_intensities_per_sr},
    geometry::EARTH_RADIUS_M,
};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI, TAU};

/// Nearest points of the base that count as beams' ends, metres: one nearer is the place itself.
const MIN_DISTANCE_M: f64 = 1e-3;

/// Light of the source that meets the base: where, and what is reflected.
struct Beam {
    end: DVec3,
    /// The vertical there.
    up: DVec3,
    /// The direction in which the light goes.
    along: DVec3,
    /// 1/π times the power that arrives, of both halves of the sphere, sr⁻¹ per watt.
    intensity: [f64; LANES],
}

/// The lit base of one setting.
pub(super) struct Reflection<'a> {
    setting: &'a SourceSetting,
    rule: &'a FirstOrderRule,
    cloud: CloudBase,
    source: DVec3,
    source_density: [f64; 2],
    base_density: [f64; 2],
    sin_blocking: f64,
    beams: Vec<Beam>,
}

/// Spreads a value for each band over its lobes.
fn by_lane(depths: &[f64], lobes: [f64; LOBE_COUNT]) -> [f64; LANES] {
    let mut out = [0.0; LANES];
    for (band, depth) in depths.iter().enumerate() {
        for (lobe, value) in lobes.iter().enumerate() {
            out[band * LOBE_COUNT + lobe] = value * (-depth).exp();
        }
    }
    out
}

/// The share of a point of the base that is taken by beams of the source, 0..=1.
fn beam_share(from_source_m2: f64, from_place_m2: f64) -> f64 {
    let (source4, place4) = (from_source_m2 * from_source_m2, from_place_m2 * from_place_m2);
    place4 / (source4 + place4)
}

impl<'a> Reflection<'a> {
    /// None under a clear sky.
    pub(super) fn new(setting: &'a SourceSetting, rule: &'a FirstOrderRule) -> Option<Self> {
        let cloud = setting.atmosphere.cloud()?;
        let mut reflection = Self {
            setting,
            rule,
            cloud,
            source: DVec3::new(0.0, 0.0, EARTH_RADIUS_M + setting.source_altitude_m),
            source_density: relative_densities(setting.source_altitude_m),
            base_density: relative_densities(cloud.altitude_m()),
            sin_blocking: sin_blocking(setting.blocking_rad),
            beams: Vec::new(),
        };
        reflection.beams = reflection.beams();
        Some(reflection)
    }

    /// Cosines of the zenith angle at the source with weights: even in the angle up to 60°, where one lobe ends, and
    /// crowding at the horizon or the skyline.
    fn cosines_at_source(&self) -> Vec<(f64, f64)> {
        let steepest = (FRAC_PI_2 - self.setting.blocking_rad).clamp(0.0, FRAC_PI_3);
        let mut cosines: Vec<(f64, f64)> = self
            .rule
            .polar
            .iter()
            .map(|&(x, weight)| (steepest * x, steepest * weight))
            .map(|(angle, weight)| (angle.cos(), weight * angle.sin()))
            .collect();
        let flat = 0.5 - self.sin_blocking;
        if flat > 0.0 {
            let low =
                self.rule.polar.iter().map(|&(x, w)| (self.sin_blocking + flat * x * x, flat * 2.0 * x * w));
            cosines.extend(low);
        }
        cosines
    }

    fn beams(&self) -> Vec<Beam> {
        let mut beams = Vec::new();
        for (cosine, weight) in self.cosines_at_source() {
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            let path = SlantPath::new(self.setting.source_altitude_m, cosine);
            let length_m = path.path_to_base_m(self.cloud.altitude_m());
            let depths = optical_depths(&self.setting.atmosphere, path.point(length_m).columns_m);
            let solid_angle = weight * TAU / self.rule.around as f64;
            let response = solid_angle / PI;
            let intensity = by_lane(&depths, lobe_intensities_per_sr(cosine).map(|f| f * response));
            for k in 0..self.rule.around {
                let (sin_turn, cos_turn) = (PI * (k as f64 + 0.5) / self.rule.around as f64).sin_cos();
                let along = DVec3::new(sine * cos_turn, sine * sin_turn, cosine);
                let end = self.source + along * length_m;
                beams.push(Beam { end, up: end.normalize(), along, intensity });
            }
        }
        beams
    }

    /// Adds the light of the base at a place.
    pub(super) fn add(&self, place: &Place, light: &mut Gathering) {
        self.add_beams(place, light);
        // Up to the zenith, crowding at the horizon, where the base is far away; and from the lowest sky over the ground.
        let dip = (EARTH_RADIUS_M + self.setting.ground_altitude_m) / (EARTH_RADIUS_M + place.altitude_m);
        let lowest = (1.0 - dip * dip).max(0.0).sqrt();
        for &(x, weight) in &self.rule.polar {
            self.add_cone(place, x * x, 2.0 * x * weight, light);
            // The lowest rays graze the ground.
            self.add_cone(place, -0.999 * lowest * x, 0.999 * lowest * weight, light);
        }
    }

    /// The first part: beams of the source, each a point of light on the base.
    fn add_beams(&self, place: &Place, light: &mut Gathering) {
        for beam in &self.beams {
            let to_beam = beam.end - place.position;
            let distance2 = to_beam.length_squared();
            let distance_m = distance2.sqrt();
            if distance_m < MIN_DISTANCE_M {
                continue;
            }
            let view = to_beam / distance_m;
            let path = SlantPath::new(place.altitude_m, view.dot(place.up).clamp(-1.0, 1.0));
            let facing = view.dot(beam.up);
            if facing <= 0.0 || path.path_down_to_m(self.setting.ground_altitude_m).is_some() {
                continue;
            }
            let depths = optical_depths(&self.setting.atmosphere, path.point(distance_m).columns_m);
            let share = beam_share((beam.end - self.source).length_squared(), distance2);
            let reflectance = self.cloud.reflectance(beam.along.dot(beam.up), facing, -beam.along.dot(view));
            let mut radiance = by_lane(&depths, [reflectance * share * facing / distance2; LOBE_COUNT]);
            for (value, intensity) in radiance.iter_mut().zip(beam.intensity) {
                *value *= intensity;
            }
            light.add(place, view, &radiance, 1.0);
        }
    }

    /// The second part: a cone of directions of the place's sky, `weight` wide in the cosine of the zenith angle.
    fn add_cone(&self, place: &Place, cos_zenith: f64, weight: f64, light: &mut Gathering) {
        if weight <= 0.0 {
            return;
        }
        let path = SlantPath::new(place.altitude_m, cos_zenith);
        let length_m = path.path_to_base_m(self.cloud.altitude_m());
        let to_here = path.point(length_m).columns_m;
        let sine = (1.0 - cos_zenith * cos_zenith).max(0.0).sqrt();
        let solid_angle = weight * TAU / self.rule.around as f64;
        for k in 0..self.rule.around {
            let (sin_turn, cos_turn) = (PI * (k as f64 + 0.5) / self.rule.around as f64).sin_cos();
            let view = place.up * cos_zenith + (place.outward * cos_turn + DVec3::Y * sin_turn) * sine;
            let end = place.position + view * length_m;
            let from_source = end - self.source;
            let distance2 = from_source.length_squared();
            if from_source.z <= self.sin_blocking * distance2.sqrt() {
                continue;
            }
            let altitude_m = self.cloud.altitude_m();
            let (lobes, from) =
                direct_light(self.setting, self.source_density, from_source, altitude_m, self.base_density);
            let columns_m = [from[0] + to_here[0], from[1] + to_here[1]];
            let depths = optical_depths(&self.setting.atmosphere, columns_m);
            let (along, up) = (from_source / distance2.sqrt(), end.normalize());
            let facing = along.dot(up).max(0.0);
            let share = 1.0 - beam_share(distance2, length_m * length_m);
            let reflectance = self.cloud.reflectance(facing, view.dot(up).max(0.0), -along.dot(view));
            let response = reflectance / PI * facing * share;
            light.add(place, view, &by_lane(&depths, lobes.map(|f| f * response)), solid_angle);
        }
    }
}
