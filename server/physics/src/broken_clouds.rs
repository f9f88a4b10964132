//! Broken clouds: a flat layer of cloud with gaps, as the mean of all patterns or as one pattern of fractal value noise
//! (`docs/model.md#broken-clouds`).
//!
//!   L = (1 − m)·[c·L_below + (1 − c)·L_clear] + m·L_overcast
//!
//! m is the share of cloud in the direction, c the cover; in the mean of all patterns, of clouds that have a thickness,
//!
//!   m = 1 − (1 − c)^(1 + 0.1·cot e),   e: elevation
//!
//! What air above the layer scatters has had to find a gap on its way up too;
//! L_below is what air below it scatters, of which only the sum with what the layer reflects is known, L_overcast:
//!
//!   L_below ≈ min(L_clear, L_overcast / (1 + (sin e / 0.35)²))

use crate::{
    bands::BAND_COUNT,
    error::{PhysicsError, check_range},
    geometry::EARTH_RADIUS_M,
    panorama::{AZIMUTH_COUNT, Direction, ELEVATION_COUNT, Panorama, elevation_rad, solid_angle_sr},
    quadrature::R2,
    value_noise::octaves,
};
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Size of the largest clouds and gaps of a pattern, metres.
const CLOUD_SIZE_M: f64 = 2_000.0;
/// Octaves of a pattern: the finest is 60 m.
const OCTAVES: u32 = 6;
/// Width of a cloud's edge, in values of the noise.
const EDGE: f64 = 0.04;
/// Samples of a pattern that its threshold is found from, each way, and how many sizes of a cloud lie between two.
const THRESHOLD_SAMPLES: usize = 96;
const THRESHOLD_STEP: f64 = 0.73;
/// Rays through a sample of the panorama each way, and below the elevation where the layer is seen at a slant.
const RAYS: usize = 2;
const SLANT_RAYS: usize = 6;
const SLANT_RAD: f64 = 0.35;
/// Sine of the elevation at which half of what comes from under the layer is scattered by air, not reflected.
const HALF_BELOW_SINE: f64 = 0.35;
/// How much more cloud artificial light meets at a slant than overhead, in the mean of all patterns: a fit to light traced through
/// clouds 450 m thick.
const SLANT_CLOSING: f64 = 0.1;

/// How much of the sky a layer of cloud covers, and which sky of that cover is meant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BrokenClouds {
    cover: f64,
    pattern: Option<u32>,
}

impl BrokenClouds {
    /// Checks the cover, 0..=1. `pattern` names one sky of that cover; None is the mean of all of them.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming `cloud_cover`.
    pub fn new(cover: f64, pattern: Option<u32>) -> Result<Self, PhysicsError> {
        Ok(Self { cover: check_range("cloud_cover", cover, 0.0, 1.0, "")?, pattern })
    }

    /// Share of the layer that is cloud, 0..=1.
    pub fn cover(self) -> f64 {
        self.cover
    }

    /// One sky of that cover; None for the mean of all.
    pub fn pattern(self) -> Option<u32> {
        self.pattern
    }

    /// Radiance of artificial light in a direction, mean over all patterns, given it under a clear sky and under a closed layer.
    pub fn mean_radiance(self, clear: f64, overcast: f64, elevation_rad: f64) -> f64 {
        let below = clear.min(share_below(elevation_rad) * overcast);
        let gap = self.cover * below + (1.0 - self.cover) * clear;
        let share = mean_gap_share(self.cover, elevation_rad);
        share * gap + (1.0 - share) * overcast
    }

    /// A closed layer.
    pub const CLOSED: BrokenClouds = BrokenClouds { cover: 1.0, pattern: None };

    /// The gaps that an eye sees in a layer whose base is `above_eye_m` above it.
    ///
    /// * `transmittance`: share of the light from above that comes through a cloud, the same in every direction. A layer that takes
    ///   nothing has 1 less its albedo.
    pub fn gaps(self, above_eye_m: f64, transmittance: f64) -> Gaps {
        let (cover, transmittance) = (self.cover as f32, transmittance as f32);
        let Some(pattern) = self.pattern.filter(|_| 0.0 < self.cover && self.cover < 1.0) else {
            let shares = vec![1.0 - cover; ELEVATION_COUNT * AZIMUTH_COUNT];
            return Gaps { cover, transmittance, shares, is_mean: true };
        };
        let layer = Layer::new(self.cover, u64::from(pattern), above_eye_m.max(1.0));
        let share = |at: usize| layer.gap_share(at / AZIMUTH_COUNT, at % AZIMUTH_COUNT) as f32;
        Gaps {
            cover,
            transmittance,
            shares: (0..ELEVATION_COUNT * AZIMUTH_COUNT).into_par_iter().map(share).collect(),
            is_mean: false,
        }
    }
}

/// One pattern over an eye.
pub(crate) struct Layer {
    pattern: u64,
    /// Noise above it is cloud.
    threshold: f64,
    above_eye_m: f64,
}

impl Layer {
    pub(crate) fn new(cover: f64, pattern: u64, above_eye_m: f64) -> Self {
        let layer = Self { pattern, threshold: 0.0, above_eye_m };
        let at = |place: usize| place as f64 * THRESHOLD_STEP * CLOUD_SIZE_M;
        let count = THRESHOLD_SAMPLES * THRESHOLD_SAMPLES;
        let mut values: Vec<f64> = (0..count)
            .map(|place| layer.noise(at(place / THRESHOLD_SAMPLES), at(place % THRESHOLD_SAMPLES)))
            .collect();
        let rank = ((1.0 - cover) * count as f64) as usize;
        let (_, threshold, _) = values.select_nth_unstable_by(rank.min(count - 1), f64::total_cmp);
        Self { threshold: *threshold, ..layer }
    }

    /// The pattern at a place of the layer, metres east and north of a corner of it.
    pub(crate) fn noise(&self, east_m: f64, north_m: f64) -> f64 {
        // The noise varies most at the points of its lattice: the eye stands elsewhere for every pattern.
        let [x, y] = R2.map(|step| step * (self.pattern + 1) as f64);
        octaves(x + east_m / CLOUD_SIZE_M, y + north_m / CLOUD_SIZE_M, OCTAVES, self.pattern << 8)
    }

    /// Share of gaps in a sample of the panorama.
    fn gap_share(&self, row: usize, column: usize) -> f64 {
        let step_rad = FRAC_PI_2 / ELEVATION_COUNT as f64;
        let lowest_rad = row as f64 * step_rad;
        let rays = if lowest_rad < SLANT_RAD { SLANT_RAYS } else { RAYS };
        let within = |ray: usize| (ray as f64 + 0.5) / rays as f64;
        let mut sum = 0.0;
        for up in 0..rays {
            let away_m = self.away_m(lowest_rad + within(up) * step_rad);
            for across in 0..rays {
                let azimuth_rad = (column as f64 - 0.5 + within(across)) * TAU / AZIMUTH_COUNT as f64;
                sum += 1.0 - self.cloud(away_m * azimuth_rad.sin(), away_m * azimuth_rad.cos());
            }
        }
        sum / (rays * rays) as f64
    }

    /// How far off, along the ground, a ray meets the layer.
    fn away_m(&self, elevation_rad: f64) -> f64 {
        let cosine = EARTH_RADIUS_M * elevation_rad.cos() / (EARTH_RADIUS_M + self.above_eye_m);
        EARTH_RADIUS_M * (cosine.acos() - elevation_rad)
    }

    /// 1 in a cloud, 0 in a gap, with a soft edge.
    fn cloud(&self, east_m: f64, north_m: f64) -> f64 {
        let over = ((self.noise(east_m, north_m) - self.threshold) / EDGE + 0.5).clamp(0.0, 1.0);
        over * over * (3.0 - 2.0 * over)
    }
}

/// Share of gaps at an elevation for artificial light, mean over all patterns.
fn mean_gap_share(cover: f64, elevation_rad: f64) -> f64 {
    (1.0 - cover).powf(1.0 + SLANT_CLOSING / elevation_rad.tan())
}

/// What of light under a layer of cloud air scatters, the rest is reflected: a fit to the first order of scattering.
fn share_below(elevation_rad: f64) -> f64 {
    let slant = elevation_rad.sin() / HALF_BELOW_SINE;
    1.0 / (1.0 + slant * slant)
}

/// What is seen in a gap.
fn through_gap(clear: f32, overcast: f32, cover: f32, share_below: f32) -> f32 {
    let below = clear.min(share_below * overcast);
    cover * below + (1.0 - cover) * clear
}

/// Its derivatives by the clear and by the overcast sky.
fn slopes_through_gap(clear: f32, overcast: f32, cover: f32, share_below: f32) -> [f32; 2] {
    if clear <= share_below * overcast { [1.0, 0.0] } else { [1.0 - cover, cover * share_below] }
}

/// What skies without clouds and under a closed layer have in one of broken clouds, sample by sample: Σ slope·sky over both is that sky
/// (it is homogeneous of the first degree).
#[derive(Clone, Debug, PartialEq)]
pub struct CoverSlopes {
    /// ∂L/∂L_clear, `[band][row][column]`.
    pub by_clear: Vec<f32>,
    /// ∂L/∂L_overcast, `[band][row][column]`.
    pub by_overcast: Vec<f32>,
}

/// Gaps over an eye.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaps {
    cover: f32,
    /// Share of the light from above that comes through a cloud.
    transmittance: f32,
    /// Share of each sample of the panorama that no cloud covers, 0..=1, `[row][column]`.
    shares: Vec<f32>,
    /// Whether they are the mean of all patterns.
    is_mean: bool,
}

impl Gaps {
    /// Share of a sample that no cloud covers.
    pub fn share(&self, row: usize, column: usize) -> f64 {
        f64::from(self.shares[row * AZIMUTH_COUNT + column])
    }

    /// That of the sample of a direction above the horizon.
    pub fn towards(&self, direction: Direction) -> f64 {
        let (row, column) = direction.nearest_sample();
        self.share(row, column)
    }

    /// Puts clouds before a natural sky over an open horizon: they send down what they let through of the illuminance from above,
    /// alike in every direction.
    ///
    /// * `beams`: what comes straight from points of light to level ground, at every node.
    pub fn put_before(&self, sky: &mut Panorama, beams: [f64; BAND_COUNT]) {
        let onto_level: Vec<f64> =
            (0..ELEVATION_COUNT).map(|row| elevation_rad(row).sin() * solid_angle_sr(row)).collect();
        for (plane, beam) in sky.samples_mut().chunks_exact_mut(self.shares.len()).zip(beams) {
            let rows = plane.chunks_exact(AZIMUTH_COUNT).zip(&onto_level);
            let scattered: f64 =
                rows.map(|(row, weight)| weight * row.iter().copied().map(f64::from).sum::<f64>()).sum();
            let cloud = self.transmittance * ((scattered + beam) / PI) as f32;
            plane.iter_mut().zip(&self.shares).for_each(|(sample, share)| {
                *sample = share * *sample + (1.0 - share) * cloud;
            });
        }
    }

    /// Radiance of artificial light from the air below and above the layer where no cloud is in sight, given it under a clear sky
    /// and under a closed layer, at a row of the panorama.
    pub fn of_air(&self, clear: f32, overcast: f32, row: usize) -> f32 {
        through_gap(clear, overcast, self.cover, share_below(elevation_rad(row)) as f32)
    }

    /// Turns artificial light under a clear sky into that under these clouds, given that under a closed layer.
    pub fn cover(&self, clear: &mut Panorama, overcast: &Panorama) {
        let samples = clear.samples_mut().iter_mut().zip(overcast.samples());
        for ((sample, cloud), (share, below)) in samples.zip(self.samples()) {
            let gap = through_gap(*sample, *cloud, self.cover, below);
            *sample = share * gap + (1.0 - share) * cloud;
        }
    }

    /// What a change of either sky does to that under these clouds.
    pub fn slopes(&self, clear: &Panorama, overcast: &Panorama) -> CoverSlopes {
        let samples = clear.samples().iter().zip(overcast.samples()).zip(self.samples());
        let slopes = samples.map(|((clear, cloud), (share, below))| {
            let [by_clear, by_overcast] = slopes_through_gap(*clear, *cloud, self.cover, below);
            (share * by_clear, share * by_overcast + (1.0 - share))
        });
        let (by_clear, by_overcast) = slopes.unzip();
        CoverSlopes { by_clear, by_overcast }
    }

    /// Share of gaps for artificial light and share below the layer at every sample of a panorama.
    fn samples(&self) -> impl Iterator<Item = (f32, f32)> {
        let mean = |row| mean_gap_share(f64::from(self.cover), elevation_rad(row)) as f32;
        let of_row = |(row, shares): (usize, &[f32])| {
            let below = share_below(elevation_rad(row)) as f32;
            let mean = self.is_mean.then(|| mean(row));
            shares.iter().map(|share| (mean.unwrap_or(*share), below)).collect::<Vec<_>>()
        };
        let plane: Vec<_> = self.shares.chunks_exact(AZIMUTH_COUNT).enumerate().flat_map(of_row).collect();
        (0..BAND_COUNT).flat_map(move |_| plane.clone())
    }
}

#[cfg(test)]
#[path = "broken_clouds_tests.rs"]
mod tests;
