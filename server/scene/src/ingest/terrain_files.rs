//! Reading terrain rasters, and giving each lit pixel its altitude.

use super::gdal_open::{gdal_reason, open_file};
use super::georeference;
use super::options::{IngestOptions, IngestProgress, IngestStage};
use super::radiance::RadianceRaster;
use super::tally::Tally;
use crate::error::SceneError;
use crate::ground::Ground;
use crate::metadata::TerrainReport;
use crate::morton;
use crate::terrain::{Terrain, TerrainRaster, TerrainRasterBuilder};
use skyglow_physics::GeoPoint;
use std::path::Path;

/// Elevations outside this are voids, whatever the file says (deepest shore and highest peak with room).
const PLAUSIBLE_M: std::ops::RangeInclusive<f64> = -12_000.0..=9_000.0;
/// The elevation that SRTM and its kin use for voids.
const SRTM_VOIDS: [f64; 2] = [-32_767.0, -32_768.0];
/// Values read at once.
const STRIP_VALUES: usize = 1 << 21;

/// The terrain of all files.
pub(super) struct TerrainFiles {
    pub(super) terrain: Terrain,
    report: TerrainReport,
}

/// Reads the files.
pub(super) fn read(
    options: &IngestOptions,
    progress: &mut dyn FnMut(IngestProgress),
) -> Result<TerrainFiles, SceneError> {
    let paths = &options.terrain;
    let mut report = TerrainReport {
        files: paths.len() as u64,
        minimum_m: f64::INFINITY,
        maximum_m: f64::NEG_INFINITY,
        ..TerrainReport::default()
    };
    let mut layers = Vec::new();
    for (index, path) in paths.iter().enumerate() {
        progress(IngestProgress {
            stage: IngestStage::Terrain,
            done: index as u64,
            total: paths.len() as u64,
        });
        layers.push(read_layer(path, options, &mut report)?);
    }
    progress(IngestProgress {
        stage: IngestStage::Terrain,
        done: paths.len() as u64,
        total: paths.len() as u64,
    });
    Ok(TerrainFiles { terrain: Terrain::new(layers), report })
}

fn read_layer(
    path: &Path,
    options: &IngestOptions,
    report: &mut TerrainReport,
) -> Result<TerrainRaster, SceneError> {
    let refuse = |reason: String| SceneError::Refused { path: path.to_owned(), reason };
    let dataset = open_file(path, &["GTiff", "COG", "SRTMHGT"])?;
    if dataset.raster_count() != 1 {
        let reason = format!("terrain has one band, this raster has {}", dataset.raster_count());
        return Err(refuse(reason));
    }
    options.check_size(dataset.raster_size()).map_err(refuse)?;
    let band = dataset.rasterband(1).map_err(|e| refuse(gdal_reason(e)))?;
    if band.band_type() == gdal::raster::GdalDataType::UInt8 {
        return Err(refuse("it holds 8-bit numbers, as a picture does, not elevations".to_owned()));
    }
    let crs = dataset
        .spatial_ref()
        .ok()
        .filter(|crs| crs.is_geographic() || crs.is_projected() || crs.is_compound());
    let crs = crs.ok_or_else(|| {
        refuse("the terrain has no coordinate reference system, so its place on Earth is unknown".to_owned())
    })?;
    let geotransform = dataset
        .geo_transform()
        .map_err(|_| refuse("the terrain is not georeferenced: it has no geotransform".to_owned()))?;
    let grid = georeference::grid(&geotransform, &crs, dataset.raster_size()).map_err(refuse)?;
    let (scale, offset, no_data) =
        (band.scale().unwrap_or(1.0), band.offset().unwrap_or(0.0), band.no_data_value());
    let (width, height) = (grid.width as usize, grid.height as usize);
    let mut builder = TerrainRasterBuilder::new(grid);
    let rows_at_once = (STRIP_VALUES / width).clamp(1, height.min(256));
    let mut values = vec![0f64; width * rows_at_once];
    let (mut valid_count, mut heights) = (0u64, vec![0f32; width]);
    for first_row in (0..height).step_by(rows_at_once) {
        let rows = rows_at_once.min(height - first_row);
        let part = &mut values[..rows * width];
        band.read_into_slice((0, first_row as isize), (width, rows), (width, rows), part, None).map_err(
            |error| {
                let reason =
                    format!("it is truncated or broken near row {first_row} ({})", gdal_reason(error));
                SceneError::Unreadable { path: path.to_owned(), reason }
            },
        )?;
        for line in values[..rows * width].chunks_exact(width) {
            for (height_m, &stored) in heights.iter_mut().zip(line) {
                let elevation_m = stored * scale + offset;
                let is_void = no_data == Some(stored)
                    || SRTM_VOIDS.contains(&stored)
                    || !PLAUSIBLE_M.contains(&elevation_m);
                if is_void {
                    report.void_samples += 1;
                    *height_m = f32::NAN;
                } else {
                    valid_count += 1;
                    report.minimum_m = report.minimum_m.min(elevation_m);
                    report.maximum_m = report.maximum_m.max(elevation_m);
                    *height_m = elevation_m as f32;
                }
            }
            builder.push_row(&heights).map_err(SceneError::io(path))?;
        }
    }
    if valid_count == 0 {
        return Err(refuse("it holds no elevation: every sample is void".to_owned()));
    }
    builder.finish().map_err(SceneError::io(path))
}

/// Sets the altitude of each lit pixel and reports how much of it is known.
pub(super) fn set_altitudes(
    files: &TerrainFiles,
    light: &mut RadianceRaster,
    progress: &mut dyn FnMut(IngestProgress),
) {
    if files.terrain.is_empty() {
        light.report.warnings.push("there is no terrain: all lights are taken at sea level".to_owned());
        return;
    }
    let mut report = files.report.clone();
    let (mut nearest, mut missing) = (Tally::default(), Tally::default());
    let total = light.pixels.len();
    for index in 0..total {
        if index % 65_536 == 0 {
            progress(IngestProgress {
                stage: IngestStage::Altitude,
                done: index as u64,
                total: total as u64,
            });
        }
        let (column, row) = morton::decode(light.pixels.codes[index]);
        let place = GeoPoint::from_vector(light.grid.center(column, row));
        let ground = files.terrain.ground(place);
        match ground {
            Ground::Here { .. } => report.covered += 1,
            Ground::Nearest { .. } => nearest.add(column, row),
            Ground::Unknown => missing.add(column, row),
        }
        report.below_sea_level += u64::from(ground.elevation_m().is_some_and(|e| e < 0.0));
        light.pixels.altitude_m[index] = ground.altitude_m() as f32;
    }
    progress(IngestProgress { stage: IngestStage::Altitude, done: total as u64, total: total as u64 });
    report.nearest = nearest.finish(&light.grid);
    report.missing = missing.finish(&light.grid);
    let lit = total.max(1) as u64;
    if report.missing.count * 2 > lit {
        light.report.warnings.push(format!(
            "{} of {lit} lit pixels have no terrain within 5 km and are taken at sea level",
            report.missing.count
        ));
    }
    light.report.terrain = Some(report);
}
