//! Computes a celestial table: the field of a turbidity, its views at every sample point, and the error between them.

use super::{
    CelestialTable, LOG_STEP,
    manifest::{BeamSkyError, CelestialAxes, CelestialManifest},
};
use crate::{error::TablesError, progress::Progress};
use rayon::prelude::*;
use skyglow_physics::{
    BAND_COUNT, ELEVATION_COUNT, Turbidity,
    beam::{BeamAir, BeamField, BeamSetting},
    multiple_scattering::DEFAULT_GROUND_ALBEDO,
    panorama::{azimuth_rad, elevation_rad},
};
use std::{
    f64::consts::PI,
    path::{Path, PathBuf},
};

/// ln of the darkest share of radiance that is stored.
const DARKEST_LOG: f64 = -60.0;
/// Skies on which the error is measured, and directions of each.
const ERROR_SKIES: usize = 48;
const ERROR_DIRECTIONS: usize = 24;

/// What a celestial table contains.
#[derive(Clone, Debug, PartialEq)]
pub struct CelestialOptions {
    /// Lambertian albedo of the ground, 0..=1.
    pub ground_albedo: f64,
    /// Sample points.
    pub axes: CelestialAxes,
}

impl Default for CelestialOptions {
    /// Those of the tables that come with the program.
    fn default() -> Self {
        Self { ground_albedo: DEFAULT_GROUND_ALBEDO, axes: CelestialAxes::full() }
    }
}

/// Makes celestial tables of several turbidities in `out` and returns their paths in ascending order.
///
/// # Errors
/// [`TablesError`] naming the file or the parameter.
pub fn precompute_celestial(
    turbidities: &[Turbidity],
    options: &CelestialOptions,
    out: &Path,
    progress: &dyn Progress,
) -> Result<Vec<PathBuf>, TablesError> {
    let turbidities = crate::precompute::ascending(turbidities, out)?;
    progress.begin("skies of beams", turbidities.len() as u64);
    turbidities
        .into_iter()
        .map(|turbidity| {
            let path = CelestialTable::make(turbidity, options)?.write(out)?;
            progress.advance(1);
            Ok(path)
        })
        .collect()
}

impl CelestialTable {
    /// Computes the table of a turbidity.
    ///
    /// # Errors
    /// [`TablesError::Parameter`] for an albedo outside 0..=1.
    pub fn make(turbidity: Turbidity, options: &CelestialOptions) -> Result<Self, TablesError> {
        let setting = BeamSetting::new(BeamAir::new(turbidity)).over(options.ground_albedo)?;
        let field = BeamField::solve(setting);
        let axes = &options.axes;
        let (direct, shadow_rad) = direct(&field, axes);
        let manifest =
            CelestialManifest::new(turbidity.value(), options.ground_albedo, axes.clone(), LOG_STEP);
        let mut table =
            Self::from_parts(manifest, turbidity, scattered(&field, axes), direct, shadow_rad, false);
        table.manifest.measured_error = measure_error(&table, &field);
        table.manifest.checksum = table.data_checksum();
        Ok(table)
    }
}

/// Steps of the scattered light, `[observer_altitude][zenith_angle][band][elevation][azimuth]`.
fn scattered(field: &BeamField, axes: &CelestialAxes) -> Vec<i16> {
    let (zeniths, elevations) = (axes.zenith_angle_deg.len(), axes.elevation_deg.len());
    let directions = axes.direction_count();
    let rows: Vec<Vec<[i16; BAND_COUNT]>> = (0..axes.observer_altitude_m.len() * elevations)
        .into_par_iter()
        .map(|index| {
            let altitude_m = axes.observer_altitude_m[index / elevations];
            let elevation = axes.elevation_deg[index % elevations].to_radians();
            let view = field.view(altitude_m, elevation);
            let mut row = Vec::with_capacity(zeniths * axes.azimuth_count);
            for zenith in axes.zenith_angle_deg.iter().map(|angle| angle.to_radians()) {
                for k in 0..axes.azimuth_count {
                    let azimuth = PI * k as f64 / (axes.azimuth_count - 1) as f64;
                    let cosine =
                        elevation.sin() * zenith.cos() + elevation.cos() * zenith.sin() * azimuth.cos();
                    let phase = field.setting().air.mixed_phase(altitude_m).per_sr(cosine.clamp(-1.0, 1.0));
                    let radiance = view.radiance_per_sr(zenith, azimuth);
                    row.push(std::array::from_fn(|band| {
                        let log = (radiance[band] / phase[band]).max(f64::MIN_POSITIVE).ln();
                        (log.max(DARKEST_LOG) / LOG_STEP).round() as i16
                    }));
                }
            }
            row
        })
        .collect();
    let mut steps = vec![0; axes.sample_counts().iter().product()];
    for (index, row) in rows.iter().enumerate() {
        let (altitude, elevation) = (index / elevations, index % elevations);
        for (at, bands) in row.iter().enumerate() {
            let (zenith, azimuth) = (at / axes.azimuth_count, at % axes.azimuth_count);
            for (band, &value) in bands.iter().enumerate() {
                let image = (altitude * zeniths + zenith) * BAND_COUNT + band;
                steps[image * directions + elevation * axes.azimuth_count + azimuth] = value;
            }
        }
    }
    steps
}

/// The direct beam, `[observer_altitude][point][band]`, and where it is cut off.
fn direct(field: &BeamField, axes: &CelestialAxes) -> (Vec<f32>, Vec<f32>) {
    let (mut direct, mut shadow) = (Vec::new(), Vec::new());
    for &altitude_m in &axes.observer_altitude_m {
        let shadow_rad = field.shadow_rad(altitude_m);
        shadow.push(shadow_rad as f32);
        for k in 0..axes.direct_count {
            let from_edge = 1.0 - k as f64 / (axes.direct_count - 1) as f64;
            // The last point lies on the edge, where rounding must not put it behind.
            let zenith = shadow_rad * (1.0 - from_edge * from_edge) - 1e-9;
            let through = field.transmittance(altitude_m, zenith.max(0.0));
            direct.extend(through.map(|through| (-through.max(1e-300).ln()).max(1e-6).ln() as f32));
        }
    }
    (direct, shadow)
}

/// Compares a table with its field at low-discrepancy points (additive recurrence, Roberts 2018).
fn measure_error(table: &CelestialTable, field: &BeamField) -> BeamSkyError {
    let axes = &table.manifest.axes;
    let largest_m = axes.observer_altitude_m[axes.observer_altitude_m.len() - 1];
    let largest_deg = axes.zenith_angle_deg[axes.zenith_angle_deg.len() - 1];
    let share = |index: usize, step: f64| (0.5 + index as f64 * step).fract();
    let skies: Vec<(f64, f64)> = (0..ERROR_SKIES)
        .map(|index| {
            // Half of them in twilight.
            let t = share(index, 0.754_877_666_2);
            let zenith_deg = if index % 2 == 0 { 84.0 * t } else { 84.0 + (largest_deg - 84.0) * t };
            (zenith_deg.to_radians(), largest_m * share(index, 0.569_840_291))
        })
        .collect();
    let errors: Vec<(usize, f64)> = skies
        .par_iter()
        .enumerate()
        .flat_map_iter(|(sky, &(zenith, altitude_m))| {
            let panorama = table.beam_sky(zenith, 0.0, altitude_m);
            let directions = (0..ERROR_DIRECTIONS).flat_map(|index| {
                let (row, column) = if index == 0 {
                    (ELEVATION_COUNT - 1, 0)
                } else {
                    let at = sky * ERROR_DIRECTIONS + index;
                    let row = (share(at, 0.754_877_666_2) * ELEVATION_COUNT as f64) as usize;
                    (row, (share(at, 0.569_840_291) * 129.0) as usize)
                };
                let exact =
                    field.view(altitude_m, elevation_rad(row)).radiance_per_sr(zenith, azimuth_rad(column));
                std::array::from_fn::<_, BAND_COUNT, _>(|band| {
                    (row, (panorama.radiance_w_m2_sr(band, row, column) / exact[band] - 1.0).abs())
                })
            });
            directions.collect::<Vec<_>>()
        })
        .collect();
    let mut sorted: Vec<f64> = errors.iter().map(|error| error.1).collect();
    sorted.sort_by(f64::total_cmp);
    let at_zenith = errors.iter().filter(|error| error.0 == ELEVATION_COUNT - 1).map(|error| error.1);
    BeamSkyError {
        samples: sorted.len(),
        relative_to: "the radiance of the solver itself in the same direction".to_owned(),
        mean: sorted.iter().sum::<f64>() / sorted.len() as f64,
        median: sorted[sorted.len() / 2],
        p90: sorted[sorted.len() * 9 / 10],
        p99: sorted[sorted.len() * 99 / 100],
        largest: sorted[sorted.len() - 1],
        zenith_largest: at_zenith.fold(0.0, f64::max),
    }
}
