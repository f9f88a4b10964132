//! The error of a pack, measured when it is made: single sources between the sample points, evaluated as an
//! engine would, against the converged integral.

use crate::{
    axes::lagrange_taps,
    fit::Basis,
    images::{HALF_COLUMN_COUNT, PIXEL_COUNT},
    manifest::MeasuredError,
    pack::Pack,
    precompute::offset_axis,
    resident::ResidentTables,
};
use rayon::prelude::*;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT, Turbidity,
    panorama::{azimuth_rad, elevation_rad},
    single_source::{SourceGeometry, radiance_per_watt_of},
};

/// Coefficients of a source over a basis, scale included, `[band][lobe][basis]`: what the engine's mix and
/// coefficient passes compute for a source on ring 0.
fn coefficients(tables: &ResidentTables, observer_altitude_m: f64, offset_m: f64) -> Vec<f64> {
    let taps = lagrange_taps(&tables.observer_altitude_m, observer_altitude_m, 4);
    let position = tables.offset_axis[0].position(offset_m);
    let low = (position as usize).min(tables.offset_count - 2);
    let t = position - low as f64;
    let mut out = Vec::with_capacity(BAND_COUNT * LOBE_COUNT * tables.basis_count);
    for band in 0..BAND_COUNT {
        for lobe in 0..LOBE_COUNT {
            let node = |observer, side| tables.node_index(observer, lobe, band, 0, low + side);
            let log_scale: f64 = taps
                .iter()
                .map(|&(o, w)| {
                    let value = |side| f64::from(tables.log_scale[node(o, side)]);
                    w * (value(0) * (1.0 - t) + value(1) * t)
                })
                .sum();
            for k in 0..tables.basis_count {
                let shape: f64 = taps
                    .iter()
                    .map(|&(o, w)| {
                        let value =
                            |side| f64::from(tables.shape[node(o, side) * tables.basis_count + k].to_f32());
                        w * (value(0) * (1.0 - t) + value(1) * t)
                    })
                    .sum();
                out.push(log_scale.exp() * shape);
            }
        }
    }
    out
}

/// Measures a pack on `sources` single sources, each in 40 directions, all bands and lobes that carry light.
pub(crate) fn measure_error(
    pack: &Pack,
    basis: &Basis,
    sources: usize,
    advance: &(dyn Fn() + Sync),
) -> MeasuredError {
    let manifest = pack.manifest();
    let Ok(turbidity) = Turbidity::new(manifest.turbidity) else {
        return MeasuredError::NONE;
    };
    let atmosphere = Atmosphere::new(turbidity);
    let per_source: Vec<(Vec<f64>, Vec<f64>)> = (1..=sources)
        .into_par_iter()
        .map(|i| {
            let spread = |ratio: f64| (i as f64 * ratio).fract();
            let distance_m = 250.0 * 1_200f64.powf(spread(0.819_172_5));
            let observer_altitude_m = 6_000.0 * spread(0.671_043_6).powi(2);
            // Sources from sea level to a slope of one half above the observer.
            let highest_m = (0.5 * distance_m).min(6_000.0 - observer_altitude_m);
            let offset_m = -observer_altitude_m + (observer_altitude_m + highest_m) * spread(0.549_700_5);
            let tables = pack.resident(&[distance_m]);
            debug_assert_eq!(tables.offset_axis[0], offset_axis(&manifest.axes, distance_m));
            let c = coefficients(&tables, observer_altitude_m, offset_m);
            let geometry = SourceGeometry {
                distance_m,
                source_altitude_m: observer_altitude_m + offset_m,
                observer_altitude_m,
            };
            let truth = |row, column| {
                radiance_per_watt_of(&atmosphere, &geometry, azimuth_rad(column), elevation_rad(row), 1e-6)
            };
            let zenith = truth(ELEVATION_COUNT - 1, 64);
            let (mut errors, mut zenith_errors) = (Vec::new(), Vec::new());
            for direction in 0..40usize {
                let row = if direction < 4 {
                    ELEVATION_COUNT - 1
                } else {
                    (direction * 25 + i * 7) % ELEVATION_COUNT
                };
                let column = (direction * 53 + i * 31) % HALF_COLUMN_COUNT;
                let exact = truth(row, column);
                for band in 0..BAND_COUNT {
                    for lobe in 0..LOBE_COUNT {
                        let floor = exact[band][lobe].max(1e-3 * zenith[band][lobe]);
                        // Below this a source of a gigawatt is invisible.
                        if floor < 1e-22 {
                            continue;
                        }
                        let start = (band * LOBE_COUNT + lobe) * basis.count;
                        let value: f64 = (0..basis.count)
                            .map(|k| {
                                let sample =
                                    basis.functions[k * PIXEL_COUNT + row * HALF_COLUMN_COUNT + column];
                                c[start + k] * f64::from(sample)
                            })
                            .sum();
                        let error = (value.max(0.0) - exact[band][lobe]).abs() / floor;
                        if direction < 4 { zenith_errors.push(error) } else { errors.push(error) }
                    }
                }
            }
            advance();
            (errors, zenith_errors)
        })
        .collect();
    let mut errors: Vec<f64> = per_source.iter().flat_map(|(errors, _)| errors.iter().copied()).collect();
    let zenith: Vec<f64> = per_source.iter().flat_map(|(_, zenith)| zenith.iter().copied()).collect();
    errors.sort_by(f64::total_cmp);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    MeasuredError {
        sources,
        samples: errors.len() + zenith.len(),
        mean: mean(&errors),
        p99: errors.get(errors.len() * 99 / 100).copied().unwrap_or(0.0),
        zenith_mean: mean(&zenith),
    }
}
