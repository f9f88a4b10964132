//! What a light does to a measure of the open sky, by altitude of the place, distance, height of the light over the place and
//! skyline: a table of the packs' own numbers, for sums over all lights at many places. Under clouds lights near the base count by
//! their depth ([`LightShare`]).

use super::InfluenceSolver;
use crate::error::ObservatoryError;
use rayon::prelude::*;
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, GeoPoint, Horizon, LinearMeasure, blocking::BLOCKING_COUNT,
    panorama::azimuth_rad, spectrum::SpectralRule,
};
use skyglow_render::{RenderError, light_share::LightShare, request::RenderRequest};
use skyglow_scene::{PlaceKernel, PolarCell, PolarGrid, RING_COUNT, UniformAxis};
use skyglow_tables::clouds::ceiling_m;
use std::{
    f64::consts::{FRAC_PI_2, PI},
    sync::Arc,
};

/// Step of the altitudes of places, metres: between them the zenith is linear to 0.3 %.
const ALTITUDE_STEP_M: f64 = 250.0;
/// Smallest step of the heights of lights over places, metres: a fifth of the nearest distance.
const OFFSET_STEP_M: f64 = 50.0;
/// Both under clouds, where what counts of a light falls off over the last 100 m below the base.
const STEPS_UNDER_CLOUDS_M: [f64; 2] = [50.0, 25.0];
/// Most heights of lights over places: each has a column of a grid.
const MAX_OFFSETS: usize = AZIMUTH_COUNT;

/// Places and lights that a table is to be for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelRange {
    /// Lowest and highest altitude of observers, metres above sea level, within the packs' range.
    pub observers_m: [f64; 2],
    /// Lowest and highest altitude of lights, metres above sea level, at least 0.
    pub lights_m: [f64; 2],
}

impl KernelRange {
    /// Altitudes of places and heights of lights over them; lights above clouds do not count.
    fn axes(&self, cloud_m: f64) -> (UniformAxis, UniformAxis) {
        let [altitude_step_m, offset_step_m] =
            if cloud_m.is_finite() { STEPS_UNDER_CLOUDS_M } else { [ALTITUDE_STEP_M, OFFSET_STEP_M] };
        let ([lowest_m, highest_m], [low_m, high_m]) = (self.observers_m, self.lights_m);
        let first_m = low_m.min(cloud_m) - highest_m;
        let last_m = high_m.min(cloud_m) - lowest_m;
        (
            UniformAxis::between(lowest_m, highest_m, altitude_step_m, usize::MAX),
            UniformAxis::between(first_m, last_m, offset_step_m, MAX_OFFSETS - 1),
        )
    }
}

/// What a light is to do.
#[derive(Clone, Copy, Debug)]
pub enum KernelOf<'a> {
    /// To a measure that is the same whatever the azimuth of the light.
    Measure(&'a LinearMeasure),
    /// ∫ L cos φ cos(mΔ) dΩ for an order m, Δ from the azimuth of the light: a wave of what walls around a place receive.
    Wave(u8),
}

/// The table for a request's air, lamps and emission; its grid, place and altitude do not matter. The turbidity is to be one of
/// the packs': between them skies are no sums over lights.
///
/// * `of`: what of the sky. `rule`: what sees the light, of each light by itself: lights of different colour at the eye do not quite add up.
/// * `skylines`: whether lights behind skylines are to be told apart, which the packs must know.
///
/// # Errors
/// As [`InfluenceSolver::cells`].
pub fn place_kernel(
    solver: &InfluenceSolver,
    request: &RenderRequest,
    (of, rule): (KernelOf<'_>, &SpectralRule),
    range: &KernelRange,
    skylines: bool,
) -> Result<PlaceKernel, ObservatoryError> {
    let cloud_m = request.cloud_base_m.map_or(f64::INFINITY, f64::from);
    let (altitudes, offsets) = range.axes(cloud_m);
    let blocking_count = if skylines { BLOCKING_COUNT } else { 1 };
    let of_altitude = |altitude: usize| {
        let observer_altitude_m = altitudes.node_m(altitude).min(range.observers_m[1]);
        let mut polar = lights_at_every_node(observer_altitude_m, offsets, blocking_count);
        // A light that no table knows under the clouds is as the highest that one knows, by the share of it that counts.
        let share = |cell: &PolarCell| f64::from(LightShare::of(cell, observer_altitude_m, cloud_m).share);
        let shares: Vec<f64> = polar.cells.iter().map(share).collect();
        polar
            .cells
            .iter_mut()
            .for_each(|cell| cell.altitude_m = cell.altitude_m.min(ceiling_m(cloud_m) as f32));
        let request = RenderRequest { polar: Arc::new(polar), observer_altitude_m, ..request.clone() };
        let cells: Vec<f64> = match of {
            KernelOf::Measure(measure) => {
                let cells = solver.kernels(&request, measure)?;
                cells.into_iter().map(|kernel| rule.value(kernel.map(|value| value.max(0.0)))).collect()
            }
            KernelOf::Wave(order) => {
                let cells_per_column = RING_COUNT * blocking_count;
                waves(solver, &request, order, rule, cells_per_column)?
            }
        };
        // Cells are by offset, then ring, then blocking angle.
        let of_ring = |ring: usize| (0..offsets.count).map(move |offset| offset * RING_COUNT + ring);
        let values = (0..RING_COUNT).flat_map(of_ring).flat_map(|at| {
            let of_skylines = &cells[at * blocking_count..(at + 1) * blocking_count];
            let shares = &shares[at * blocking_count..(at + 1) * blocking_count];
            of_skylines.iter().zip(shares).map(|(value, share)| (value * share) as f32).collect::<Vec<f32>>()
        });
        Ok(values.collect())
    };
    let values: Vec<Vec<f32>> =
        (0..altitudes.count).into_par_iter().map(of_altitude).collect::<Result<_, ObservatoryError>>()?;
    PlaceKernel::new(altitudes, offsets, blocking_count, values.concat()).ok_or_else(|| {
        RenderError::BadPolarGrid { reason: "a watt at every node has other cells".to_owned() }.into()
    })
}

/// Waves of a grid whose columns have as many cells each. A sky is the same on both sides of its light, so of a light at azimuth θ
/// the weight 1 + cos(mθ') sees K₀ + K_m cos(mθ), and a quarter of a wave later K₀ + K_m sin(mθ). What sees the light sees only what
/// is not below 0: K_m is the difference of what it sees of K₀ + K_m and of K₀.
fn waves(
    solver: &InfluenceSolver,
    request: &RenderRequest,
    order: u8,
    rule: &SpectralRule,
    cells_per_column: usize,
) -> Result<Vec<f64>, ObservatoryError> {
    let m = f64::from(order);
    let even = solver.kernels(request, &LinearMeasure::cylindrical(&Horizon::flat()))?;
    let cos = solver.kernels(request, &LinearMeasure::wall_wave(order, 0.0))?;
    let sin = solver.kernels(request, &LinearMeasure::wall_wave(order, FRAC_PI_2 / m.max(1.0)))?;
    let cells = even.iter().zip(cos).zip(sin).enumerate();
    let wave = |(at, ((even, cos), sin)): (usize, ((&[f64; BAND_COUNT], _), [f64; BAND_COUNT]))| {
        let cos: [f64; BAND_COUNT] = cos;
        let (sin_azimuth, cos_azimuth) = (m * azimuth_rad(at / cells_per_column)).sin_cos();
        let even = even.map(|value| (PI * value).max(0.0));
        let with_wave: [f64; BAND_COUNT] = std::array::from_fn(|band| {
            let wave = (cos[band] - even[band]) * cos_azimuth + (sin[band] - even[band]) * sin_azimuth;
            (even[band] + wave).max(0.0)
        });
        rule.value(with_wave) - rule.value(even)
    };
    Ok(cells.map(wave).collect())
}

/// A grid with a watt at every ring and blocking angle, those of each offset in a column of its own: a measure of the open sky knows no azimuth.
fn lights_at_every_node(observer_altitude_m: f64, offsets: UniformAxis, blocking_count: usize) -> PolarGrid {
    let mut cells = Vec::with_capacity(offsets.count * RING_COUNT * blocking_count);
    let mut azimuth_start = vec![0u32];
    for column in 0..AZIMUTH_COUNT {
        if column < offsets.count {
            let altitude_m = (observer_altitude_m + offsets.node_m(column)).max(0.0) as f32;
            for ring in 0..RING_COUNT as u32 {
                let cell = |blocking| PolarCell { ring, flux_dnb_w: 1.0, altitude_m, blocking };
                cells.extend((0..blocking_count as u32).map(cell));
            }
        }
        azimuth_start.push(cells.len() as u32);
    }
    PolarGrid {
        observer: GeoPoint::from_rad_unchecked(0.0, 0.0),
        azimuth_start,
        flux_dnb_w: cells.len() as f64,
        cells,
        near: Vec::new(),
        coverage: 1.0,
    }
}
