//! The error of a pack, measured when it is computed: single sources between the sample points, evaluated as the
//! renderer does, against the f64 oracle (the converged integral).

use crate::{
    clouds::clamped_below_clouds_m,
    curvature::log_scale_at,
    layout::{HALF_COLUMN_COUNT, image_index},
    manifest::{LobeError, MeasuredError},
    multiple::MultipleTable,
    pack::Pack,
    resident::{FREQUENCY_COUNT, ResidentTables},
};
use rayon::prelude::*;
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT, Lobe,
    interpolation::Stencil,
    panorama::{azimuth_rad, elevation_rad},
    single_source::{SourceGeometry, radiance_per_watt_of},
};

/// Coefficients of a source over a basis, scale included, `[band][lobe][basis]`: what the renderer's mix and
/// coefficient passes compute for a source on ring 0.
fn coefficients(tables: &ResidentTables, observer_altitude_m: f64, offset_m: f64) -> Vec<f64> {
    let observers = Stencil::lagrange(&tables.observer_altitude_m, observer_altitude_m);
    let position = tables.offset_axis[0].position(offset_m);
    let low = (position as usize).min(tables.offset_count - 2);
    let t = position - low as f64;
    let mut out = Vec::with_capacity(BAND_COUNT * LOBE_COUNT * tables.basis_count);
    for band in 0..BAND_COUNT {
        for lobe in 0..LOBE_COUNT {
            let node = |observer, side| tables.shape_index(observer, lobe, band, 0, low + side);
            let at = |offset: usize| -> f64 {
                observers.sum(|o| f64::from(tables.log_scale[tables.scale_index(o, lobe, band, 0, offset)]))
            };
            let log_scale = log_scale_at(&tables.offset_axis[0], position, at);
            for k in 0..tables.basis_count {
                let shape = observers.sum(|observer| {
                    let value = |side| {
                        f64::from(tables.shape[node(observer, side) * tables.basis_count + k].to_f32())
                    };
                    value(0) * (1.0 - t) + value(1) * t
                });
                out.push(log_scale.exp() * shape);
            }
        }
    }
    out
}

/// B_k at a row and column from its spectrum: (1/256)·Σ_f F[f]·cos(fθ) over both signs of f.
fn basis_sample(tables: &ResidentTables, k: usize, row: usize, column: usize) -> f64 {
    let spectrum = &tables.basis_spectrum[tables.spectrum_index(k, row, 0)..][..FREQUENCY_COUNT];
    let theta = azimuth_rad(column);
    let sum: f64 = spectrum
        .iter()
        .enumerate()
        .map(|(f, &value)| {
            let copies = if f == 0 || f == FREQUENCY_COUNT - 1 { 1.0 } else { 2.0 };
            copies * f64::from(value) * (f as f64 * theta).cos()
        })
        .sum();
    sum / AZIMUTH_COUNT as f64
}

/// Directions tried a source, the first four of them in the highest row.
const DIRECTION_COUNT: usize = 40;
const ZENITH_DIRECTIONS: usize = 4;
/// Errors are relative to at least this part of the source's mean radiance over the directions tried.
const FLOOR_OVER_MEAN: f64 = 1e-3;
/// Below this [m⁻² sr⁻¹] a source of a gigawatt is invisible.
const INVISIBLE_PER_M2_SR: f64 = 1e-22;

/// Errors of one source, `[lobe]`: away from the zenith, and at it.
type SourceErrors = [(Vec<f64>, Vec<f64>); LOBE_COUNT];

/// Measures a pack of an atmosphere on `sources` single sources, each in 40 directions, all bands and lobes that carry
/// light.
///
/// The f64 oracle is the converged first order and, where scattering is multiple, the table of the orders after it.
pub(crate) fn measure_error(
    pack: &Pack,
    atmosphere: &Atmosphere,
    multiple: Option<&MultipleTable>,
    sources: usize,
    advance: &(dyn Fn() + Sync),
) -> MeasuredError {
    let every: Vec<SourceErrors> = (1..=sources)
        .into_par_iter()
        .map(|i| {
            let errors = source_errors(pack, atmosphere, multiple, i);
            advance();
            errors
        })
        .collect();
    let lobes = Lobe::ALL
        .iter()
        .map(|lobe| {
            let collect = |zenith: bool| {
                let mut values: Vec<f64> = every
                    .iter()
                    .flat_map(|errors| {
                        let (away, at) = &errors[lobe.index()];
                        if zenith { at.clone() } else { away.clone() }
                    })
                    .collect();
                values.sort_by(f64::total_cmp);
                values
            };
            let (away, at) = (collect(false), collect(true));
            let rank = |values: &[f64], part: f64| {
                values.get((values.len() as f64 * part) as usize).copied().unwrap_or(0.0)
            };
            LobeError {
                lobe: lobe.name().to_owned(),
                samples: away.len() + at.len(),
                mean: away.iter().sum::<f64>() / away.len().max(1) as f64,
                median: rank(&away, 0.5),
                p90: rank(&away, 0.9),
                p99: rank(&away, 0.99),
                zenith_median: rank(&at, 0.5),
            }
        })
        .collect();
    MeasuredError {
        sources,
        relative_to: "max(reference, a thousandth of the mean over the directions tried)".to_owned(),
        lobes,
    }
}

/// Source `i` of an even spread over distance, observer altitude and offset.
fn source_errors(
    pack: &Pack,
    atmosphere: &Atmosphere,
    multiple: Option<&MultipleTable>,
    i: usize,
) -> SourceErrors {
    let spread = |ratio: f64| (i as f64 * ratio).fract();
    let distance_m = 250.0 * 1_200f64.powf(spread(0.819_172_5));
    let ceiling_m = clamped_below_clouds_m(6_000.0, atmosphere.cloud());
    let observer_altitude_m = ceiling_m * spread(0.671_043_6).powi(2);
    let highest_m = (0.5 * distance_m).min(ceiling_m - observer_altitude_m);
    let offset_m = -observer_altitude_m + (observer_altitude_m + highest_m) * spread(0.549_700_5);
    let tables = pack.resident(&[distance_m]);
    let c = coefficients(&tables, observer_altitude_m, offset_m);
    let geometry =
        SourceGeometry { distance_m, source_altitude_m: observer_altitude_m + offset_m, observer_altitude_m };
    let directions: Vec<(usize, usize)> = (0..DIRECTION_COUNT)
        .map(|d| {
            let row =
                if d < ZENITH_DIRECTIONS { ELEVATION_COUNT - 1 } else { (d * 25 + i * 7) % ELEVATION_COUNT };
            (row, (d * 53 + i * 31) % HALF_COLUMN_COUNT)
        })
        .collect();
    let reference: Vec<_> = directions
        .iter()
        .map(|&(row, column)| {
            let (azimuth, elevation) = (azimuth_rad(column), elevation_rad(row));
            let mut reference = radiance_per_watt_of(atmosphere, &geometry, azimuth, elevation, 1e-6);
            if let Some(table) = multiple {
                let more = table.radiance_per_watt(&geometry, row, column);
                for (band, lobes) in reference.iter_mut().enumerate() {
                    for (lobe, value) in lobes.iter_mut().enumerate() {
                        *value += more[image_index(lobe, band)];
                    }
                }
            }
            reference
        })
        .collect();
    let mut errors: SourceErrors = Default::default();
    for band in 0..BAND_COUNT {
        for lobe in 0..LOBE_COUNT {
            let mean = reference.iter().map(|t| t[band][lobe]).sum::<f64>() / DIRECTION_COUNT as f64;
            if mean < INVISIBLE_PER_M2_SR {
                continue;
            }
            let start = (band * LOBE_COUNT + lobe) * tables.basis_count;
            for (d, &(row, column)) in directions.iter().enumerate() {
                let value: f64 = (0..tables.basis_count)
                    .map(|k| c[start + k] * basis_sample(&tables, k, row, column))
                    .sum();
                let exact = reference[d][band][lobe];
                let error = (value.max(0.0) - exact).abs() / exact.max(FLOOR_OVER_MEAN * mean);
                let (away, at) = &mut errors[lobe];
                if d < ZENITH_DIRECTIONS { at.push(error) } else { away.push(error) }
            }
        }
    }
    errors
}
