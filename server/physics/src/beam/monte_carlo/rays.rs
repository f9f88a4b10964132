//! The tracer for dusk: paths whose every ray is followed through all air before it.
//!
//! Light scattered once is added up along the whole ray instead of where a free path happens to end, at one random point of every
//! piece of the ray (stratified sampling), so that the lit air far away and high up is always met. One of these points is drawn as the
//! place of the next scattering: half by what is scattered there, half by that over the root of the density, since what is
//! high sees more of the dusk; each is weighted by the mean of both densities. Nothing is left to free paths, so the
//! path's weight falls by what the ray lets into space. Transmittance along a ray is by Simpson's rule.

use super::{Aim, BeamEstimate, BeamTracer, GROUND_M, TOP_M, guided, mean_of_paths};
use crate::{
    geometry::EARTH_RADIUS_M,
    multiple_scattering::monte_carlo::draws::{Random, lambertian_direction, mixed_phase},
};
use glam::DVec3;
use std::f64::consts::PI;

/// Longest piece of a ray, metres; longest rise in one over the altitude, with that of the first; and longest in optical depth.
const LONGEST_M: f64 = 15_000.0;
const RISE: f64 = 0.08;
const FIRST_RISE_M: f64 = 120.0;
const DEPTH: f64 = 0.12;
/// Rays end where less than this is let through.
const MIN_THROUGH: f64 = 1e-7;
/// Paths of a smaller weight survive by chance only.
const MIN_WEIGHT: f64 = 5e-3;
/// Altitude over which the root of the density falls to 1/e, metres, and up to where that counts.
const RISING_M: f64 = 16_000.0;
const HIGHEST_M: f64 = 60_000.0;

/// A place on a ray where light may be scattered.
struct Place {
    at: DVec3,
    /// Share of light scattered there that comes back along the ray, over the phase function's mean.
    chance: f64,
    /// The same with what is high preferred.
    raised: f64,
    /// Shares of extinction that are scattering; None on the ground.
    shares: Option<[f64; 2]>,
}

impl BeamTracer {
    /// As [`Self::estimate`], by whole rays: a path takes longer, and deep in dusk its error is smaller by far.
    pub fn estimate_by_rays(
        &self,
        observer_altitude_m: f64,
        elevation_rad: f64,
        source_zenith_rad: f64,
        azimuth_rad: f64,
        paths: u64,
        seed: u64,
    ) -> BeamEstimate {
        let aim = Aim::new(observer_altitude_m, elevation_rad, source_zenith_rad, azimuth_rad);
        mean_of_paths(paths, seed, |random| self.path(&aim, random))
    }

    /// Light of one path: scattered once, and in all.
    fn path(&self, aim: &Aim, random: &mut Random) -> (f64, f64) {
        let (mut start, mut direction, mut weight) = (aim.observer, aim.view, 1.0);
        let (mut first, mut all) = (0.0, 0.0);
        let mut places = Vec::new();
        for order in 1.. {
            let light = weight * self.along(start, direction, aim.source, random, &mut places);
            all += light;
            if order == 1 {
                first = light;
            }
            let Some((place, factor)) = drawn(&places, random) else { break };
            weight *= factor;
            start = place.at;
            let up = start.normalize();
            if let Some(shares) = place.shares {
                let whole = shares[0] + shares[1];
                let (next, factor) =
                    guided(direction, shares.map(|share| share / whole), up, aim.source, random);
                direction = next;
                weight *= factor;
            } else {
                direction = lambertian_direction(up, random);
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

    /// Light of the beam itself that the air and the ground send back along a ray, and where else light may be scattered into it.
    fn along(
        &self,
        start: DVec3,
        direction: DVec3,
        source: DVec3,
        random: &mut Random,
        places: &mut Vec<Place>,
    ) -> f64 {
        places.clear();
        let (r2, b) = (start.length_squared(), start.dot(direction));
        let root = |altitude_m: f64| b * b - r2 + (EARTH_RADIUS_M + altitude_m).powi(2);
        let to_ground = root(GROUND_M);
        let meets_ground = b < 0.0 && to_ground >= 0.0;
        let end_m =
            if meets_ground { (-b - to_ground.sqrt()).max(0.0) } else { -b + root(TOP_M).max(0.0).sqrt() };
        let altitude_at = |s: f64| (start + direction * s).length() - EARTH_RADIUS_M;
        let extinction_at = |s: f64| self.setting.air.at(altitude_at(s)).extinction_per_m[self.band];
        let turned = direction.dot(source);
        let (mut from_m, mut before, mut light) = (0.0, 1.0, 0.0);
        let mut starting = extinction_at(0.0);
        while from_m < end_m && before > MIN_THROUGH {
            let altitude_m = altitude_at(from_m);
            let slope = ((b + from_m) / (EARTH_RADIUS_M + altitude_m)).abs().max(1e-6);
            let step_m = LONGEST_M
                .min((RISE * altitude_m.max(0.0) + FIRST_RISE_M) / slope)
                .min(DEPTH / starting.max(1e-12));
            let to_m = if from_m + 1.3 * step_m >= end_m { end_m } else { from_m + step_m };
            let length_m = to_m - from_m;
            let (middle, ending) = (extinction_at(from_m + 0.5 * length_m), extinction_at(to_m));
            let depth = (starting + 4.0 * middle + ending) * length_m / 6.0;
            let share = random.unit();
            let at = start + direction * (from_m + share * length_m);
            let here_m = at.length() - EARTH_RADIUS_M;
            let here = self.setting.air.at(here_m);
            let shares = here.scattering_shares().map(|share| share[self.band]);
            // The part of the depth up to there, with extinction linear between both halves' ends.
            let part = |share: f64| part_of_depth(share, starting, middle, ending);
            let passed = depth * part(share) / part(1.0).max(f64::MIN_POSITIVE);
            let chance = here.extinction_per_m[self.band] * length_m * before * (-passed).exp();
            let up = at.normalize();
            light +=
                chance * mixed_phase(shares, turned) * self.sunlight.at(here_m, up.dot(source))[self.band];
            let chance = chance * (shares[0] + shares[1]);
            let raised = chance * (here_m.clamp(0.0, HIGHEST_M) / RISING_M).exp();
            places.push(Place { at, chance, raised, shares: Some(shares) });
            (from_m, before, starting) = (to_m, before * (-depth).exp(), ending);
        }
        if meets_ground && before > MIN_THROUGH {
            let up = (start + direction * end_m).normalize();
            // Off the surface, lest rounding puts the start behind it.
            let at = up * (EARTH_RADIUS_M + GROUND_M + 1e-3);
            let chance = before * self.setting.ground_albedo;
            let facing = up.dot(source).max(0.0);
            light += chance * facing / PI * self.sunlight.at(GROUND_M, up.dot(source))[self.band];
            places.push(Place { at, chance, raised: chance, shares: None });
        }
        light
    }
}

/// ∫ of extinction over the first part of a piece, per length of the piece, linear from its start to its middle and to its end.
fn part_of_depth(share: f64, starting: f64, middle: f64, ending: f64) -> f64 {
    let half = |x: f64, from: f64, to: f64| x * from + x * x * (to - from);
    if share <= 0.5 {
        half(share, starting, middle)
    } else {
        half(0.5, starting, middle) + half(share - 0.5, middle, ending)
    }
}

/// A place drawn, and what is scattered back from all over the density of the draw; None where nothing is.
fn drawn<'a>(places: &'a [Place], random: &mut Random) -> Option<(&'a Place, f64)> {
    let (whole, whole_raised) =
        places.iter().fold((0.0, 0.0), |(sum, raised), place| (sum + place.chance, raised + place.raised));
    let last = places.last()?;
    if whole <= 0.0 || whole_raised <= 0.0 {
        return None;
    }
    let density = |place: &Place| 0.5 * (place.chance / whole + place.raised / whole_raised);
    let mut left = random.unit();
    let found = places.iter().find(|place| {
        left -= density(place);
        left < 0.0
    });
    let place = found.unwrap_or(last);
    let likely = density(place);
    (likely > 0.0).then(|| (place, place.chance / likely))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Band, Turbidity,
        beam::{BeamAir, BeamSetting},
    };

    /// Both tracers agree by day, at the horizon and in dusk, within their errors.
    #[test]
    fn whole_rays_agree_with_free_paths() {
        let setting = BeamSetting::new(BeamAir::new(Turbidity::new(2.5).unwrap()));
        let tracer = BeamTracer::new(setting, Band::MIDDLE);
        for (altitude_m, elevation_deg, zenith_deg, azimuth_deg) in
            [(0.0, 20.0f64, 50.0f64, 120.0f64), (1_500.0, 5.0, 90.0, 20.0), (1_500.0, 90.0, 94.0, 0.0)]
        {
            let [elevation, zenith, azimuth] = [elevation_deg, zenith_deg, azimuth_deg].map(f64::to_radians);
            let one = tracer.estimate(altitude_m, elevation, zenith, azimuth, 60_000, 1);
            let other = tracer.estimate_by_rays(altitude_m, elevation, zenith, azimuth, 6_000, 2);
            let off = other.radiance_per_sr - one.radiance_per_sr;
            let error = one.standard_error_per_sr.hypot(other.standard_error_per_sr);
            assert!(off.abs() < 3.5 * error, "{zenith_deg}: {one:?} {other:?}");
            assert!(other.standard_error_per_sr < 0.05 * other.radiance_per_sr, "{zenith_deg}: {other:?}");
            let off = other.first_order_per_sr / one.first_order_per_sr - 1.0;
            assert!(off.abs() < 0.1, "{zenith_deg}: {one:?} {other:?}");
        }
    }

    /// Parts of a piece's depth: none at its start, Simpson's three values' trapezoids at its end.
    #[test]
    fn parts_of_a_piece_add_up() {
        assert_eq!(part_of_depth(0.0, 3.0, 2.0, 1.0), 0.0);
        assert!((part_of_depth(0.5, 3.0, 2.0, 1.0) - 1.25).abs() < 1e-12);
        assert!((part_of_depth(1.0, 3.0, 2.0, 1.0) - 2.0).abs() < 1e-12);
    }
}
