//! Reading terrain rasters, and giving each lit pixel its altitude.

use super::gdal_open::{gdal_reason, open_file};
use super::georeference;
use super::land_cover_files::probes;
use super::options::{IngestOptions, IngestProgress, IngestStage};
use super::radiance::RadianceRaster;
use super::tally::Tally;
use super::units::metres_in;
use crate::error::SceneError;
use crate::ground::Ground;
use crate::metadata::TerrainReport;
use crate::morton;
use crate::terrain::{Terrain, TerrainRaster, TerrainRasterBuilder};
use gdal::raster::RasterBand;
use gdal::spatial_ref::SpatialRef;
use skyglow_physics::GeoPoint;
use std::path::Path;

/// Elevations outside this are voids, whatever the file says (deepest shore and highest peak with room).
const PLAUSIBLE_M: std::ops::RangeInclusive<f64> = -12_000.0..=9_000.0;
/// Stored numbers that elevation models have for voids, whether they say so or not. No ground on land lies there, and a sea bed
/// this deep counts as sea level anyway.
const VOIDS: [f64; 5] = [-32_767.0, -32_768.0, -9_999.0, -99_999.0, 32_767.0];
/// With more of its samples higher than any peak the unit of a raster is not the one that it was taken to have.
const MAX_IMPLAUSIBLE_SHARE: f64 = 1e-3;
/// Lit pixels without terrain, one in so many, are worth a warning.
const MISSING_SHARE: u64 = 100;
/// Stored numbers beyond this fill gaps.
const MAX_STORED: f64 = 1e9;
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
    Ok(TerrainFiles { terrain: Terrain::joined(layers), report })
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
    let (unit_m, said) = unit_m(&band, &crs, options).map_err(refuse)?;
    if unit_m != 1.0 {
        report.units.push(said.clone());
    }
    let (scale, offset) = (unit_m * band.scale().unwrap_or(1.0), unit_m * band.offset().unwrap_or(0.0));
    let no_data = band.no_data_value();
    let (width, height) = (grid.width as usize, grid.height as usize);
    let mut builder = TerrainRasterBuilder::new(grid);
    let rows_at_once = (STRIP_VALUES / width).clamp(1, height.min(256));
    let mut values = vec![0f64; width * rows_at_once];
    let (mut valid_count, mut too_high, mut heights) = (0u64, 0u64, vec![0f32; width]);
    let mut highest_m = 0f64;
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
                let is_gap = no_data.is_some_and(|value| stored == value || stored as f32 == value as f32)
                    || VOIDS.contains(&stored)
                    || !stored.is_finite()
                    || stored.abs() > MAX_STORED;
                if !is_gap && elevation_m > *PLAUSIBLE_M.end() {
                    too_high += 1;
                    highest_m = highest_m.max(elevation_m);
                }
                let is_void = is_gap || !PLAUSIBLE_M.contains(&elevation_m);
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
    if too_high as f64 > MAX_IMPLAUSIBLE_SHARE * (valid_count + too_high) as f64 {
        return Err(refuse(format!(
            "{too_high} of its samples are higher than any peak, up to {highest_m:.0} m, so its unit is not {said}: give --terrain-units, ft \
             perhaps"
        )));
    }
    if valid_count == 0 {
        return Err(refuse("it holds no elevation: every sample is void".to_owned()));
    }
    builder.finish().map_err(SceneError::io(path))
}

/// Metres in the raster's unit of elevation, and the unit in words: of the options, the band, or the vertical part of the CRS.
fn unit_m(band: &RasterBand<'_>, crs: &SpatialRef, options: &IngestOptions) -> Result<(f64, String), String> {
    if let Some(own) = &options.terrain_units {
        return Ok((metres_in(own).unwrap_or(1.0), own.clone()));
    }
    let of_band = band.unit();
    if !of_band.is_empty() {
        return metres_in(&of_band).map(|unit_m| (unit_m, of_band.clone())).ok_or_else(|| {
            format!(
                "its elevations are in \"{of_band}\", which is no length that is known; give --terrain-units"
            )
        });
    }
    match vertical_unit(crs) {
        Some((name, unit_m)) if unit_m > 0.0 => Ok((unit_m, name)),
        _ => Ok((1.0, "metres, as nothing says otherwise".to_owned())),
    }
}

/// Name and metres of the unit of a CRS's vertical part.
fn vertical_unit(crs: &SpatialRef) -> Option<(String, f64)> {
    let name = crs.get_attr_value("VERT_CS|UNIT", 0).ok().flatten()?;
    let metres = crs.get_attr_value("VERT_CS|UNIT", 1).ok().flatten()?.parse().ok()?;
    Some((name, metres))
}

/// Sets the altitude of each lit pixel and reports how much of it is known.
///
/// # Errors
/// [`SceneError::Refused`] where terrain was given and nothing of the raster lies on it or near: it is of another region.
pub(super) fn set_altitudes(
    files: &TerrainFiles,
    light: &mut RadianceRaster,
    options: &IngestOptions,
    progress: &mut dyn FnMut(IngestProgress),
) -> Result<(), SceneError> {
    if files.terrain.is_empty() {
        light.report.warnings.push("there is no terrain: all lights are taken at sea level".to_owned());
        return Ok(());
    }
    let mut report = files.report.clone();
    for unit in &report.units {
        let warning = format!("the terrain is in {unit}: it was put in metres");
        if !light.report.warnings.contains(&warning) {
            light.report.warnings.push(warning);
        }
    }
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
    let is_known = |place| !matches!(files.terrain.ground(place), Ground::Unknown);
    if report.missing.count == lit
        && let Some(path) = options.terrain.first()
        && !probes(&light.grid).any(is_known)
    {
        let reason = "the terrain knows nothing of the ground of the raster, nor of any within 5 km of it: it lies elsewhere, or is void there; give that of the region, or \
                      none and all lights are taken at sea level";
        return Err(SceneError::Refused { path: path.clone(), reason: reason.to_owned() });
    }
    if report.missing.count * MISSING_SHARE > lit {
        light.report.warnings.push(format!(
            "{} of {lit} lit pixels have no terrain within 5 km and are taken at sea level",
            report.missing.count
        ));
    }
    light.report.terrain = Some(report);
    Ok(())
}
