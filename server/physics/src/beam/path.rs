//! Straight rays cut into steps. Altitudes and depths along a ray depend on its start's altitude and zenith angle alone,
//! so the steps of one serve all azimuths and all zenith angles of the source.

use super::{
    air::BeamAir,
    grid::{Bands, Between, Grid, STORED_ZENITHS},
    sunlight::{LitAltitude, Sunlight, TOP_M},
};
use crate::{bands::BAND_COUNT, geometry::EARTH_RADIUS_M};
use std::f64::consts::PI;

/// Rays end where less than this is let through in every band.
const MIN_TRANSMISSION: f64 = 1e-6;

/// How long steps are.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepRule {
    /// Longest step over the ground, metres.
    pub(super) longest_m: f64,
    /// Longest rise over the altitude above the ground, beside [`Self::first_rise_m`].
    pub(super) rise: f64,
    pub(super) first_rise_m: f64,
    /// Longest in optical depth.
    pub(super) depth: f64,
}

/// For the first order, whose light ends at the shadow.
pub(super) const FINE: StepRule =
    StepRule { longest_m: 10_000.0, rise: 0.05, first_rise_m: 60.0, depth: 0.1 };
/// For later orders, whose light is smooth.
pub(super) const COARSE: StepRule =
    StepRule { longest_m: 45_000.0, rise: 0.2, first_rise_m: 150.0, depth: 0.4 };

/// A piece of a ray.
struct Piece {
    /// Of its middle.
    altitude_m: f64,
    cos_zenith: f64,
    /// Arc from the start to its middle, radians.
    arc_rad: f64,
    /// What the air between start and piece lets through, less what it does to the piece's end.
    weight: [f64; BAND_COUNT],
}

/// Where a ray meets the ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct GroundEnd {
    pub(super) cos_arc: f32,
    pub(super) sin_arc: f32,
    pub(super) through: Bands,
}

/// Cuts a ray; the second is where it meets the ground, if it does.
fn pieces(
    air: &BeamAir,
    ground_m: f64,
    altitude_m: f64,
    cos_zenith: f64,
    rule: StepRule,
) -> (Vec<Piece>, Option<GroundEnd>) {
    let r0 = EARTH_RADIUS_M + altitude_m;
    let altitude_at = |s: f64| {
        let rise = s * (2.0 * r0 * cos_zenith + s);
        altitude_m + rise / ((r0 * r0 + rise).max(0.0).sqrt() + r0)
    };
    // To the sphere at an altitude: the near crossing downwards, the far one upwards.
    let root = |to_m: f64| {
        let c = (altitude_m - to_m) * (r0 + EARTH_RADIUS_M + to_m);
        (r0 * cos_zenith).powi(2) - c
    };
    let to_ground = root(ground_m);
    let meets_ground = cos_zenith < 0.0 && to_ground >= 0.0;
    let end_m = if meets_ground {
        (-r0 * cos_zenith - to_ground.sqrt()).max(0.0)
    } else {
        -r0 * cos_zenith + root(TOP_M.max(altitude_m)).max(0.0).sqrt()
    };
    let sine = (1.0 - cos_zenith * cos_zenith).max(0.0).sqrt();
    let arc_rad = |s: f64| (s * sine).atan2(r0 + s * cos_zenith);
    let cos_at = |s: f64| ((r0 * cos_zenith + s) / (EARTH_RADIUS_M + altitude_at(s))).clamp(-1.0, 1.0);
    let extinction = |s: f64| air.at(altitude_at(s)).extinction_per_m;
    let mut found = Vec::new();
    let (mut from_m, mut before) = (0.0, [1.0; BAND_COUNT]);
    let mut starting = extinction(0.0);
    while from_m < end_m {
        let thickest = starting.iter().fold(0.0f64, |most, &value| most.max(value));
        let height_m = (altitude_at(from_m) - ground_m).max(0.0);
        let step_m = rule
            .longest_m
            .min((rule.rise * height_m + rule.first_rise_m) / cos_at(from_m).abs().max(1e-6))
            .min(rule.depth / thickest.max(1e-12));
        let to_m = if from_m + 1.3 * step_m >= end_m { end_m } else { from_m + step_m };
        let middle_m = 0.5 * (from_m + to_m);
        let (middle, ending) = (extinction(middle_m), extinction(to_m));
        // Simpson's rule.
        let after: [f64; BAND_COUNT] = std::array::from_fn(|band| {
            let sum = starting[band] + 4.0 * middle[band] + ending[band];
            before[band] * (-sum * (to_m - from_m) / 6.0).exp()
        });
        found.push(Piece {
            altitude_m: altitude_at(middle_m),
            cos_zenith: cos_at(middle_m),
            arc_rad: arc_rad(middle_m),
            weight: std::array::from_fn(|band| before[band] - after[band]),
        });
        (from_m, before, starting) = (to_m, after, ending);
        if before.iter().all(|&through| through < MIN_TRANSMISSION) {
            return (found, None);
        }
    }
    let end = meets_ground.then(|| GroundEnd {
        cos_arc: arc_rad(end_m).cos() as f32,
        sin_arc: arc_rad(end_m).sin() as f32,
        through: before.map(|through| through as f32),
    });
    (found, end)
}

/// A step of a [`LitPath`].
#[derive(Clone, Copy, Debug)]
struct LitStep {
    cos_arc: f64,
    sin_arc: f64,
    altitude: LitAltitude,
    /// What is scattered here and comes through, over the phase function, for unit light.
    molecules: Bands,
    aerosol: Bands,
}

/// A ray along which light of the beam is scattered for the first time.
#[derive(Clone, Debug)]
pub(super) struct LitPath {
    steps: Vec<LitStep>,
    end: Option<GroundEnd>,
}

/// A step of a [`DarkPath`].
#[derive(Clone, Copy, Debug)]
pub(super) struct DarkStep {
    pub(super) cos_arc: f32,
    pub(super) sin_arc: f32,
    pub(super) layer: Between,
    pub(super) zenith: Between,
    pub(super) weight: Bands,
}

/// A ray along which a source function adds up.
#[derive(Clone, Debug)]
pub(super) struct DarkPath {
    pub(super) steps: Vec<DarkStep>,
    pub(super) end: Option<GroundEnd>,
}

/// Where the source stands at a ray's start, and the ray's azimuth from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bearing {
    pub(super) cos_source: f64,
    pub(super) sin_source: f64,
    pub(super) cos_azimuth: f64,
}

impl Bearing {
    pub(super) fn new(source_zenith_rad: f64, cos_azimuth: f64) -> Self {
        let (sin_source, cos_source) = source_zenith_rad.sin_cos();
        Self { cos_source, sin_source, cos_azimuth }
    }

    /// Cosine of the scattering angle of a ray with this cosine of the zenith angle: from the source's direction.
    pub(super) fn cos_scattering(&self, cos_zenith: f64) -> f64 {
        let sine = (1.0 - cos_zenith * cos_zenith).max(0.0).sqrt();
        (cos_zenith * self.cos_source + sine * self.sin_source * self.cos_azimuth).clamp(-1.0, 1.0)
    }
}

impl LitPath {
    pub(super) fn new(
        air: &BeamAir,
        light: &Sunlight,
        ground_m: f64,
        altitude_m: f64,
        cos_zenith: f64,
        rule: StepRule,
    ) -> Self {
        let (pieces, end) = pieces(air, ground_m, altitude_m, cos_zenith, rule);
        let steps = pieces
            .iter()
            .map(|piece| {
                let [molecules, aerosol] = air.at(piece.altitude_m).scattering_shares();
                let weighted = |share: [f64; BAND_COUNT]| -> Bands {
                    std::array::from_fn(|band| (share[band] * piece.weight[band]) as f32)
                };
                LitStep {
                    cos_arc: piece.arc_rad.cos(),
                    sin_arc: piece.arc_rad.sin(),
                    altitude: light.altitude(piece.altitude_m),
                    molecules: weighted(molecules),
                    aerosol: weighted(aerosol),
                }
            })
            .collect();
        Self { steps, end }
    }

    pub(super) fn end(&self) -> Option<&GroundEnd> {
        self.end.as_ref()
    }

    /// What molecules and aerosol scatter along the ray, over their phase functions.
    #[inline(always)]
    pub(super) fn scattered(&self, light: &Sunlight, bearing: &Bearing) -> [Bands; 2] {
        let mut sums = [[0.0; BAND_COUNT]; 2];
        let across = bearing.sin_source * bearing.cos_azimuth;
        for step in &self.steps {
            let cosine = step.cos_arc * bearing.cos_source + step.sin_arc * across;
            let Some(log) = light.log_at(&step.altitude, cosine) else { continue };
            for band in 0..BAND_COUNT {
                let light = crate::simd::exponential(log[band]);
                sums[0][band] += step.molecules[band] * light;
                sums[1][band] += step.aerosol[band] * light;
            }
        }
        sums
    }
}

impl DarkPath {
    pub(super) fn new(
        air: &BeamAir,
        grid: &Grid,
        ground_m: f64,
        altitude_m: f64,
        cos_zenith: f64,
        rule: StepRule,
    ) -> Self {
        let (pieces, end) = pieces(air, ground_m, altitude_m, cos_zenith, rule);
        let steps = pieces
            .iter()
            .map(|piece| DarkStep {
                cos_arc: piece.arc_rad.cos() as f32,
                sin_arc: piece.arc_rad.sin() as f32,
                layer: grid.layer_at(piece.altitude_m),
                zenith: Between::even(
                    (piece.cos_zenith.acos() / PI) as f32 * (STORED_ZENITHS - 1) as f32,
                    STORED_ZENITHS,
                ),
                weight: piece.weight.map(|weight| weight as f32),
            })
            .collect();
        Self { steps, end }
    }
}
