//! Places of the field: zenith angles of the source by altitudes, and directions at each.

use super::{air::BeamAir, sunlight::TOP_M};
use crate::{
    bands::BAND_COUNT,
    geometry::EARTH_RADIUS_M,
    phase::{AEROSOL_ASYMMETRY, henyey_greenstein_per_sr, rayleigh_per_sr},
    quadrature::gauss_legendre,
};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// One value a band.
pub(super) type Bands = [f32; BAND_COUNT];

/// Ranges of zenith angles of the source by their first, and the step in each, degrees; they end at [`LAST_RING_DEG`].
const RING_STEPS_DEG: [(f64, f64); 5] = [(0.0, 10.0), (60.0, 4.0), (80.0, 1.0), (88.0, 0.5), (102.0, 1.0)];
const LAST_RING_DEG: f64 = 124.0;
/// Rings are looked up by a table of this step, degrees; every ring lies on a step.
const LOOKUP_DEG: f64 = 0.5;
/// Altitudes above the ground, metres; the last is the top.
const LAYERS_M: [f64; 28] = [
    0.0, 150.0, 350.0, 600.0, 900.0, 1_300.0, 1_800.0, 2_500.0, 3_300.0, 4_300.0, 5_500.0, 7_000.0, 9_000.0,
    11_000.0, 13_000.0, 15_500.0, 18_000.0, 20_500.0, 23_000.0, 26_000.0, 29_000.0, 33_000.0, 38_000.0,
    44_000.0, 52_000.0, 62_000.0, 76_000.0, TOP_M,
];

/// Zenith angles from which light is gathered, above and below the horizon each.
pub(super) const GATHERED_ZENITHS: usize = 12;
/// Azimuths from which light is gathered, in a half turn.
pub(super) const GATHERED_AZIMUTHS: usize = 16;
/// Directions from which light is gathered.
pub(super) const GATHERED: usize = 2 * GATHERED_ZENITHS * GATHERED_AZIMUTHS;
/// Zenith angles at which the source function is stored, even from 0 to 180°.
pub(super) const STORED_ZENITHS: usize = 25;
/// Azimuths at which it is stored, even from 0 to 180° from the source.
pub(super) const STORED_AZIMUTHS: usize = 13;
/// Directions at which it is stored.
pub(super) const STORED: usize = STORED_ZENITHS * STORED_AZIMUTHS;

/// Between two neighbours: the lower one, and the weight of the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Between {
    pub(super) lower: usize,
    pub(super) weight: f32,
}

impl Between {
    /// Among even steps that start at 0.
    #[inline(always)]
    pub(super) fn even(place: f32, count: usize) -> Self {
        let lower = (place.max(0.0) as usize).min(count - 2);
        Self { lower, weight: (place - lower as f32).clamp(0.0, 1.0) }
    }

    fn among(nodes: &[f64], x: f64) -> Self {
        let lower = nodes.partition_point(|&node| node <= x).saturating_sub(1).min(nodes.len() - 2);
        let share = (x - nodes[lower]) / (nodes[lower + 1] - nodes[lower]);
        Self { lower, weight: share.clamp(0.0, 1.0) as f32 }
    }
}

/// A direction from which light is gathered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gathered {
    pub(super) cos_zenith: f64,
    /// Of the azimuth from the source's.
    pub(super) cos_azimuth: f64,
    /// Solid angle of both mirror images, sr.
    pub(super) weight_sr: f64,
}

/// What of light gathered at one altitude is scattered into the stored directions.
#[derive(Clone, Debug)]
struct Scatterer {
    /// Phase function times solid angle, `[stored][gathered]`.
    molecules: Vec<f32>,
    aerosol: Vec<f32>,
    /// Share of extinction that is scattering by molecules and by aerosol.
    shares: [Bands; 2],
}

/// Places and directions of a field.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub(super) ring_rad: Vec<f64>,
    pub(super) layer_m: Vec<f64>,
    /// Ring at or below each step of [`LOOKUP_DEG`].
    ring_lookup: Vec<usize>,
    /// `[layer][gathered]`, zenith angle by zenith angle.
    pub(super) directions: Vec<Vec<Gathered>>,
    scatterers: Vec<Scatterer>,
}

fn rings_rad() -> Vec<f64> {
    let mut rings = Vec::new();
    for (index, &(from, step)) in RING_STEPS_DEG.iter().enumerate() {
        let to = RING_STEPS_DEG.get(index + 1).map_or(LAST_RING_DEG + step, |next| next.0);
        let count = ((to - from) / step).round() as usize;
        rings.extend((0..count).map(|k| (from + step * k as f64).to_radians()));
    }
    rings
}

/// Directions at an altitude over the ground, crowding on both sides of the horizon, where radiance jumps.
fn directions(altitude_m: f64, ground_m: f64) -> Vec<Gathered> {
    let sine = (EARTH_RADIUS_M + ground_m) / (EARTH_RADIUS_M + altitude_m);
    let horizon = -(1.0 - sine * sine).max(0.0).sqrt();
    let mut found = Vec::with_capacity(GATHERED);
    for (side, size) in [(-1.0, 1.0 + horizon), (1.0, 1.0 - horizon)] {
        for (x, weight) in gauss_legendre(GATHERED_ZENITHS) {
            for k in 0..GATHERED_AZIMUTHS {
                let azimuth = PI * (k as f64 + 0.5) / GATHERED_AZIMUTHS as f64;
                found.push(Gathered {
                    cos_zenith: horizon + side * size * x * x,
                    cos_azimuth: azimuth.cos(),
                    weight_sr: 2.0 * size * x * weight * TAU / GATHERED_AZIMUTHS as f64,
                });
            }
        }
    }
    found
}

/// Phase function times solid angle between all directions, each stored direction's scaled so that even light stays
/// what it is.
fn kernel(directions: &[Gathered], phase: impl Fn(f64) -> f64) -> Vec<f32> {
    let mut values = Vec::with_capacity(STORED * GATHERED);
    for stored in 0..STORED {
        let zenith = PI * (stored / STORED_AZIMUTHS) as f64 / (STORED_ZENITHS - 1) as f64;
        let azimuth = PI * (stored % STORED_AZIMUTHS) as f64 / (STORED_AZIMUTHS - 1) as f64;
        let row: Vec<f64> = directions
            .iter()
            .map(|from| {
                let across = zenith.sin() * (1.0 - from.cos_zenith * from.cos_zenith).max(0.0).sqrt();
                let other = from.cos_azimuth.acos();
                let along = zenith.cos() * from.cos_zenith;
                // The direction and its mirror image.
                let both = phase(along + across * (azimuth - other).cos())
                    + phase(along + across * (azimuth + other).cos());
                0.5 * both * from.weight_sr
            })
            .collect();
        let whole: f64 = row.iter().sum();
        values.extend(row.into_iter().map(|value| (value / whole) as f32));
    }
    values
}

impl Grid {
    pub(super) fn new(air: &BeamAir, ground_m: f64) -> Self {
        let ring_rad = rings_rad();
        let layer_m: Vec<f64> = LAYERS_M.iter().map(|&m| ground_m + m * (TOP_M - ground_m) / TOP_M).collect();
        let lookups = (LAST_RING_DEG / LOOKUP_DEG) as usize;
        let ring_lookup = (0..lookups)
            .map(|k| {
                let angle = (LOOKUP_DEG * k as f64).to_radians() + 1e-9;
                ring_rad.partition_point(|&ring| ring <= angle) - 1
            })
            .collect();
        let directions: Vec<Vec<Gathered>> =
            layer_m.iter().map(|&altitude_m| directions(altitude_m, ground_m)).collect();
        let scatterers = layer_m
            .par_iter()
            .zip(&directions)
            .map(|(&altitude_m, directions)| {
                let shares = air.at(altitude_m).scattering_shares();
                Scatterer {
                    molecules: kernel(directions, rayleigh_per_sr),
                    aerosol: kernel(directions, |cosine| henyey_greenstein_per_sr(cosine, AEROSOL_ASYMMETRY)),
                    shares: shares.map(|share| share.map(|share| share as f32)),
                }
            })
            .collect();
        Self { ring_rad, layer_m, ring_lookup, directions, scatterers }
    }

    pub(super) fn ring_count(&self) -> usize {
        self.ring_rad.len()
    }

    /// Places, `[layer][ring]`.
    pub(super) fn point_count(&self) -> usize {
        self.ring_rad.len() * self.layer_m.len()
    }

    /// Beyond the last ring counts as there.
    #[inline(always)]
    pub(super) fn ring_at(&self, zenith_rad: f32) -> Between {
        let step = (zenith_rad * (180.0 / PI / LOOKUP_DEG) as f32) as usize;
        let lower = self.ring_lookup[step.min(self.ring_lookup.len() - 1)];
        let (from, to) = (self.ring_rad[lower] as f32, self.ring_rad[lower + 1] as f32);
        Between { lower, weight: ((zenith_rad - from) / (to - from)).clamp(0.0, 1.0) }
    }

    pub(super) fn layer_at(&self, altitude_m: f64) -> Between {
        Between::among(&self.layer_m, altitude_m)
    }

    /// The source function over extinction from the light gathered at a place, `[stored]`.
    pub(super) fn scattered(&self, point: usize, light: &[Bands], out: &mut [Bands]) {
        let scatterer = &self.scatterers[point / self.ring_count()];
        let [molecule_share, aerosol_share] = scatterer.shares;
        let rows = scatterer.molecules.chunks_exact(GATHERED).zip(scatterer.aerosol.chunks_exact(GATHERED));
        for (out, (molecules, aerosol)) in out.iter_mut().zip(rows) {
            let mut sums = [[0.0f32; BAND_COUNT]; 2];
            for ((light, m), a) in light.iter().zip(molecules).zip(aerosol) {
                for band in 0..BAND_COUNT {
                    sums[0][band] += m * light[band];
                    sums[1][band] += a * light[band];
                }
            }
            *out = std::array::from_fn(|band| {
                molecule_share[band] * sums[0][band] + aerosol_share[band] * sums[1][band]
            });
        }
    }

    /// Flux onto a horizontal ground from the light gathered there, for unit irradiance outside the air.
    pub(super) fn flux_down(&self, light: &[Bands]) -> [f64; BAND_COUNT] {
        let mut flux = [0.0; BAND_COUNT];
        for (from, light) in self.directions[0].iter().zip(light) {
            let factor = from.weight_sr * from.cos_zenith.max(0.0);
            for (flux, light) in flux.iter_mut().zip(light) {
                *flux += factor * f64::from(*light);
            }
        }
        flux
    }
}
