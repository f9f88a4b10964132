//! Influences as the bytes of a file: what the HTTP interface answers and the command line writes.

use crate::{
    accept::InfluenceFormat,
    answers::{Assumptions, InfluenceAnswer, InfluentialPixel, PartAnswer, influential_pixels, measure_name},
    parquet_table::ParquetTableError,
    request::InfluenceListRequest,
};
use serde::Serialize;
use serde_json::{Map, Value, json};
use skyglow_display::notes;
use skyglow_observatory::{InfluenceMap, Measure};
use skyglow_scene::{RasterError, RasterMetadata};
use thiserror::Error;

/// A defect of the program: what is asked was checked before.
#[derive(Debug, Error)]
pub enum InfluenceFileError {
    /// A document.
    #[error("writing JSON failed: {0}")]
    Json(#[from] serde_json::Error),
    /// A table.
    #[error("writing CSV failed: {0}")]
    Csv(#[from] csv::Error),
    /// A raster.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// Parquet.
    #[error(transparent)]
    Parquet(#[from] ParquetTableError),
}

/// Encodes a map of influences; takes milliseconds to a second.
///
/// # Errors
/// [`InfluenceFileError`], only by a defect.
pub fn encode_influences(
    assumptions: Assumptions,
    map: &InfluenceMap,
    request: &InfluenceListRequest,
    format: InfluenceFormat,
) -> Result<Vec<u8>, InfluenceFileError> {
    let measure = &request.request.measure;
    match format {
        InfluenceFormat::Json => {
            let boundary = request.boundary.as_ref().map(|area| &area.boundary);
            let answer = InfluenceAnswer::new(assumptions, map, measure, request.limit, boundary);
            Ok(serde_json::to_vec(&answer)?)
        }
        InfluenceFormat::GeoJson => geojson(assumptions, map, request),
        InfluenceFormat::Csv => {
            influence_table(map, &measure.unit(request.request.sky.response.unit()), request.limit)
        }
        InfluenceFormat::Tiff => geotiff(&assumptions, map, measure),
    }
}

/// A point for each pixel, and beside the features what they depend on.
fn geojson(
    assumptions: Assumptions,
    map: &InfluenceMap,
    request: &InfluenceListRequest,
) -> Result<Vec<u8>, InfluenceFileError> {
    let measure = &request.request.measure;
    let total = map.total().influence;
    let place = |pixel: &InfluentialPixel| [pixel.longitude_deg, pixel.latitude_deg];
    let mut collection = feature_collection(influential_pixels(map, total, request.limit), place)?;
    let boundary = request.boundary.as_ref().map(|area| PartAnswer::new(map.within(&area.boundary), total));
    let facts = json!({
        "measure": measure_name(measure),
        "unit": measure.unit(request.request.sky.response.unit()),
        "total": total,
        "boundary": boundary,
        "assumptions": assumptions,
    });
    if let Value::Object(facts) = facts {
        collection.extend(facts);
    }
    Ok(serde_json::to_vec(&collection)?)
}

/// A GeoJSON FeatureCollection of points with all that is said of each.
///
/// * `place`: longitude and latitude, degrees.
///
/// # Errors
/// [`InfluenceFileError::Json`], only by a defect.
pub fn feature_collection<T: Serialize>(
    rows: Vec<T>,
    place: impl Fn(&T) -> [f64; 2],
) -> Result<Map<String, Value>, InfluenceFileError> {
    let feature = |row: T| -> Result<Value, serde_json::Error> {
        Ok(json!({
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": place(&row)},
            "properties": serde_json::to_value(row)?,
        }))
    };
    let features: Vec<Value> = rows.into_iter().map(feature).collect::<Result<_, _>>()?;
    let mut collection = Map::new();
    collection.insert("type".to_owned(), "FeatureCollection".into());
    collection.insert("features".to_owned(), features.into());
    Ok(collection)
}

/// A row for each record under the names of its fields, which are there without records too.
///
/// # Errors
/// [`InfluenceFileError::Csv`], only by a defect.
pub fn csv_table<T: Serialize + Default>(rows: Vec<T>) -> Result<Vec<u8>, InfluenceFileError> {
    let is_empty = rows.is_empty();
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in if is_empty { vec![T::default()] } else { rows } {
        writer.serialize(row)?;
    }
    let mut table = writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
    if is_empty {
        let end = table.iter().position(|byte| *byte == b'\n').map_or(table.len(), |end| end + 1);
        table.truncate(end);
    }
    Ok(table)
}

/// A row for each pixel; the column of influences carries their unit in its name.
fn influence_table(map: &InfluenceMap, unit: &str, limit: usize) -> Result<Vec<u8>, InfluenceFileError> {
    Ok(with_unit(&csv_table(influential_pixels(map, map.total().influence, limit))?, unit))
}

/// A table whose column of influences carries their unit in its name.
pub fn with_unit(table: &[u8], unit: &str) -> Vec<u8> {
    // `cd m-2 sr0.5` becomes `cd_m2_sr0_5`.
    let influence = format!(",influence_{},", unit.replace('-', "").replace([' ', '.'], "_"));
    let end = table.iter().position(|byte| *byte == b'\n').unwrap_or(table.len());
    let names = String::from_utf8_lossy(&table[..end]).replacen(",influence,", &influence, 1);
    [names.as_bytes(), &table[end..]].concat()
}

fn geotiff(
    assumptions: &Assumptions,
    map: &InfluenceMap,
    measure: &Measure,
) -> Result<Vec<u8>, InfluenceFileError> {
    let numbers: Vec<u32> = map.pixels().iter().map(|pixel| pixel.number).collect();
    let observer = &assumptions.observer;
    let shows = format!(
        "influence of each lit pixel on the sky at {:.5}, {:.5}: {}",
        observer.latitude_deg,
        observer.longitude_deg,
        measure_name(measure)
    );
    let description = notes::description(shows, assumptions.scene.illustrative);
    let unit = measure.unit(&assumptions.response.unit);
    let assumptions = serde_json::to_string(assumptions)?;
    let notes = [("TIFFTAG_SOFTWARE", "Skyglow"), ("ASSUMPTIONS", assumptions.as_str())];
    let words = RasterMetadata { description: &description, unit: &unit, notes: &notes };
    Ok(map.open_scene().pixels_geotiff(&numbers, map.influence(), &words)?)
}
