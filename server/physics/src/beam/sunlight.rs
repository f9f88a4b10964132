//! What of a parallel beam reaches any place of the air: along refracted rays, outside the Earth's shadow.
//!
//! Rays are followed back from a place towards the source: dh/ds = cos z and dz/ds = −sin z·(1/r + n′/n) with z the
//! ray's zenith angle. Bent by δ, a ray that arrives at z comes from a source at the true zenith angle ζ = z + δ. Radiance is the same
//! along a ray, so the irradiance at right angles to it is T·(sin z dz)/(sin ζ dζ) of that outside the air: bent
//! rays spread, which dims what grazes the Earth to a half and less (Link 1969).

use super::air::BeamAir;
use crate::{bands::BAND_COUNT, geometry::EARTH_RADIUS_M};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Top of the air, metres.
pub(super) const TOP_M: f64 = 100_000.0;
/// Lower ends of ranges of altitudes with the step between levels in each, metres.
const LEVEL_STEPS: [(f64, f64); 3] = [(0.0, 250.0), (15_000.0, 500.0), (50_000.0, 2_000.0)];
/// Step of zenith angles, radians, and how many: to 125°.
const ANGLE_STEP: f64 = PI / 1_800.0;
const ANGLE_COUNT: usize = 1_251;
/// Rays are followed into the ground to here, so that the table goes on smoothly behind the shadow's edge, metres.
const DEEPEST_M: f64 = -4_000.0;
/// Directions above the horizontal of a level.
const UPWARD_COUNT: usize = 60;
/// ln of no light.
const DARK: f32 = -300.0;

/// ln of the irradiance at right angles to the beam, for 1 outside the air.
#[derive(Clone, Debug)]
pub(super) struct Sunlight {
    level_m: Vec<f64>,
    /// `[level][angle]`.
    log: Vec<[f32; BAND_COUNT]>,
    /// Square of the angle beyond that of sea level at which the shadow begins, `[level]`.
    shadow2: Vec<f64>,
    sea_level_shadow_rad: f64,
}

/// Where an altitude lies among levels, and where its shadow begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct LitAltitude {
    level: usize,
    weight: f32,
    cos_shadow: f64,
}

/// A ray that arrives at a level.
struct Arrival {
    /// Zenith angle there, apparent.
    zenith_rad: f64,
    /// True zenith angle of its source.
    true_rad: f64,
    depth: [f64; BAND_COUNT],
}

/// Follows a ray back to the top of the air.
fn follow(air: &BeamAir, altitude_m: f64, zenith_rad: f64) -> Arrival {
    let (mut h, mut z, mut bent) = (altitude_m, zenith_rad, 0.0);
    let mut depth = [0.0; BAND_COUNT];
    // Rays at the top go up at once.
    while h < TOP_M || z > FRAC_PI_2 {
        let step_m = ((100.0 + 0.03 * h.max(0.0)) / z.cos().abs()).min(6_000.0);
        let slope = |h: f64, z: f64| {
            let (bend, _) = air.refraction(h);
            (z.cos(), -z.sin() / (EARTH_RADIUS_M + h), bend * z.sin())
        };
        let (dh, dz, db) = slope(h, z);
        let half_m = 0.5 * step_m;
        let (middle_h, middle_z) = (h + dh * half_m, z + (dz + db) * half_m);
        let (dh, dz, db) = slope(middle_h, middle_z);
        let extinction = air.at(middle_h).extinction_per_m;
        for (depth, extinction) in depth.iter_mut().zip(extinction) {
            *depth += extinction * step_m;
        }
        // The ray turns down by what it is bent, seen from the place towards the source away from the vertical.
        (h, z, bent) = (h + dh * step_m, z + (dz + db) * step_m, bent + db * step_m);
    }
    Arrival { zenith_rad, true_rad: zenith_rad + bent, depth }
}

/// Zenith angle at a level of the ray whose lowest point is at `lowest_m`, beyond the horizontal.
fn grazing_zenith(air: &BeamAir, level_m: f64, lowest_m: f64) -> f64 {
    let reach = |altitude_m: f64| (1.0 + air.refraction(altitude_m).1) * (EARTH_RADIUS_M + altitude_m);
    PI - (reach(lowest_m) / reach(level_m)).min(1.0).asin()
}

fn levels_m() -> Vec<f64> {
    let mut levels = Vec::new();
    for (index, &(from_m, step_m)) in LEVEL_STEPS.iter().enumerate() {
        let to_m = LEVEL_STEPS.get(index + 1).map_or(TOP_M + 1.0, |next| next.0);
        let count = ((to_m - from_m) / step_m).ceil() as usize;
        levels.extend((0..count).map(|k| from_m + step_m * k as f64));
    }
    levels
}

impl Sunlight {
    pub(super) fn new(air: &BeamAir) -> Self {
        let level_m = levels_m();
        let rows: Vec<(Vec<[f32; BAND_COUNT]>, f64)> =
            level_m.par_iter().map(|&altitude_m| row(air, altitude_m, &level_m)).collect();
        let sea_level_shadow_rad = rows[0].1;
        Self {
            level_m,
            shadow2: rows.iter().map(|row| (row.1 - sea_level_shadow_rad).powi(2)).collect(),
            sea_level_shadow_rad,
            log: rows.into_iter().flat_map(|row| row.0).collect(),
        }
    }

    /// Where an altitude lies; below sea level counts as there, above the top as there.
    pub(super) fn altitude(&self, altitude_m: f64) -> LitAltitude {
        let last = self.level_m.len() - 2;
        let level = self.level_m.partition_point(|&m| m <= altitude_m).saturating_sub(1).min(last);
        let gap_m = self.level_m[level + 1] - self.level_m[level];
        let weight = ((altitude_m - self.level_m[level]) / gap_m).clamp(0.0, 1.0);
        let shadow2 = self.shadow2[level] + weight * (self.shadow2[level + 1] - self.shadow2[level]);
        let cos_shadow = (self.sea_level_shadow_rad + shadow2.sqrt()).cos();
        LitAltitude { level, weight: weight as f32, cos_shadow }
    }

    /// ln of the light at an altitude where the source is at a true zenith angle of that cosine; None in the shadow.
    #[inline(always)]
    pub(super) fn log_at(&self, at: &LitAltitude, cos_zenith: f64) -> Option<[f32; BAND_COUNT]> {
        if cos_zenith < at.cos_shadow {
            return None;
        }
        let place = cos_zenith.clamp(-1.0, 1.0).acos() / ANGLE_STEP;
        let angle = (place as usize).min(ANGLE_COUNT - 2);
        let across = (place - angle as f64) as f32;
        let row = &self.log[at.level * ANGLE_COUNT + angle..][..2];
        let above = &self.log[(at.level + 1) * ANGLE_COUNT + angle..][..2];
        Some(std::array::from_fn(|band| {
            let low = row[0][band] + across * (row[1][band] - row[0][band]);
            let high = above[0][band] + across * (above[1][band] - above[0][band]);
            low + at.weight * (high - low)
        }))
    }

    /// True zenith angle at which the shadow begins, radians.
    pub(super) fn shadow_rad(&self, altitude_m: f64) -> f64 {
        self.altitude(altitude_m).cos_shadow.acos()
    }

    /// The light itself; 0 in the shadow.
    pub(super) fn at(&self, altitude_m: f64, cos_zenith: f64) -> [f64; BAND_COUNT] {
        self.log_at(&self.altitude(altitude_m), cos_zenith)
            .map_or([0.0; BAND_COUNT], |log| log.map(|log| f64::from(log).exp()))
    }
}

/// One level: ln of its light at every angle, and the angle at which the shadow begins there.
fn row(air: &BeamAir, altitude_m: f64, level_m: &[f64]) -> (Vec<[f32; BAND_COUNT]>, f64) {
    let mut zenith_rad: Vec<f64> = (0..=UPWARD_COUNT)
        .map(|k| FRAC_PI_2 * (1.0 - (1.0 - k as f64 / UPWARD_COUNT as f64).powi(2)))
        .collect();
    // Lowest points: close below the level, and at the levels below it and into the ground.
    let close = (1..10).map(|k| altitude_m - 2.5 * f64::from(k * k));
    let lower = level_m.iter().rev().copied().filter(|&m| m < altitude_m - 250.0);
    let ground = (0..=16).map(|k| DEEPEST_M * f64::from(k) / 16.0).filter(|&m| m < altitude_m - 250.0);
    let lowest_m = close.filter(|&m| m > DEEPEST_M).chain(lower.filter(|&m| m > 0.0)).chain(ground);
    zenith_rad.extend(lowest_m.map(|m| grazing_zenith(air, altitude_m, m)));
    zenith_rad.sort_by(f64::total_cmp);
    let arrivals: Vec<Arrival> = zenith_rad.iter().map(|&z| follow(air, altitude_m, z)).collect();
    let last = arrivals.len() - 1;
    let points: Vec<(f64, [f64; BAND_COUNT])> = arrivals
        .iter()
        .enumerate()
        .map(|(index, arrival)| {
            let (before, after) = (&arrivals[index.saturating_sub(1)], &arrivals[(index + 1).min(last)]);
            let narrowing = (after.zenith_rad - before.zenith_rad) / (after.true_rad - before.true_rad);
            let around = if index == 0 { 1.0 } else { arrival.zenith_rad.sin() / arrival.true_rad.sin() };
            let spread = (narrowing * around).max(1e-6).ln();
            (arrival.true_rad, arrival.depth.map(|depth| spread - depth))
        })
        .collect();
    let shadow_zenith = grazing_zenith(air, altitude_m, 0.0);
    let shadow_rad = follow(air, altitude_m, shadow_zenith).true_rad;
    let angles = (0..ANGLE_COUNT).map(|k| {
        let angle = ANGLE_STEP * k as f64;
        if angle > points[last].0 {
            return [DARK; BAND_COUNT];
        }
        let upper = points.partition_point(|point| point.0 <= angle).clamp(1, last);
        let ((a0, low), (a1, high)) = (points[upper - 1], points[upper]);
        let weight = (angle - a0) / (a1 - a0);
        std::array::from_fn(|band| ((low[band] + weight * (high[band] - low[band])) as f32).max(DARK))
    });
    (angles.collect(), shadow_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Turbidity, beam::MoleculeProfile, quadrature::integrate_adaptive};

    /// Straight rays through exponential air agree with quadrature, and the shadow begins behind the ground.
    #[test]
    fn straight_light_agrees_with_quadrature() {
        let profile = MoleculeProfile::Exponential {
            ozone_dobson: 0.0,
            scale_height_m: 8_000.0,
            extinction_550_per_m: 13.558e-6,
            top_m: 90_000.0,
        };
        let air = BeamAir::with_profile(Turbidity::new(2.0).unwrap(), profile, false, [550.0; BAND_COUNT]);
        let light = Sunlight::new(&air);
        for (altitude_m, zenith_deg) in [
            (0.0, 10.0f64),
            (0.0, 75.0),
            (2_100.0, 88.0),
            (20_000.0, 93.1),
            (40_333.0, 94.0),
            (60_000.0, 96.0),
        ] {
            let mu = zenith_deg.to_radians().cos();
            let r0 = EARTH_RADIUS_M + altitude_m;
            let end_m = -r0 * mu + ((r0 * mu).powi(2) + (EARTH_RADIUS_M + TOP_M).powi(2) - r0 * r0).sqrt();
            let depth = integrate_adaptive(0.0, end_m, 1e-8, 0.0, |s| {
                air.at((r0 * r0 + 2.0 * r0 * mu * s + s * s).sqrt() - EARTH_RADIUS_M).extinction_per_m
            })[0];
            let got = light.at(altitude_m, mu)[0];
            assert!((got.ln() / -depth - 1.0).abs() < 5e-3, "{altitude_m} {zenith_deg}: {got} {depth}");
        }
        assert_eq!(light.at(1_000.0, 92f64.to_radians().cos())[0], 0.0);
    }

    /// A source that is truly 0.4° below the horizontal is seen from sea level, and one at 0.7° is not; the Sun's disc is
    /// flattened by a sixth at the horizon.
    #[test]
    fn refraction_lifts_and_flattens_the_sun() {
        let air = BeamAir::new(Turbidity::new(1.0).unwrap());
        let horizontal = follow(&air, 0.0, FRAC_PI_2);
        let lifted_arcmin = (horizontal.true_rad - FRAC_PI_2).to_degrees() * 60.0;
        assert!((30.0..37.0).contains(&lifted_arcmin), "{lifted_arcmin}");
        let higher = follow(&air, 0.0, FRAC_PI_2 - 0.5f64.to_radians());
        let flat = 0.5f64.to_radians() / (horizontal.true_rad - higher.true_rad);
        assert!((0.78..0.88).contains(&flat), "{flat}");
        let light = Sunlight::new(&air);
        assert!(light.at(0.0, 90.4f64.to_radians().cos())[0] > 0.0);
        assert_eq!(light.at(0.0, 90.7f64.to_radians().cos())[0], 0.0);
    }
}
