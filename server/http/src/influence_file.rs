//! Influences as the bytes of a file: what the HTTP interface answers and the command line writes.

use crate::{
    accept::InfluenceFormat,
    answers::{Assumptions, InfluenceAnswer, InfluentialPixel, PartAnswer, influential_pixels, measure_name},
    request::InfluenceAsk,
};
use serde::Serialize;
use serde_json::{Value, json};
use skyglow_display::notes::ILLUSTRATIVE;
use skyglow_engine::{InfluenceMap, Measure};
use skyglow_scene::{RasterError, RasterWords};
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
}

/// Encodes a map of influences; takes milliseconds to a second.
///
/// # Errors
/// [`InfluenceFileError`], only by a defect.
pub fn encode_influences(
    assumptions: Assumptions,
    map: &InfluenceMap,
    ask: &InfluenceAsk,
    format: InfluenceFormat,
) -> Result<Vec<u8>, InfluenceFileError> {
    let measure = &ask.query.measure;
    match format {
        InfluenceFormat::Json => {
            let answer = InfluenceAnswer::new(assumptions, map, measure, ask.limit, ask.boundary.as_ref());
            Ok(serde_json::to_vec(&answer)?)
        }
        InfluenceFormat::GeoJson => geojson(assumptions, map, ask),
        InfluenceFormat::Csv => csv_table(map, measure, ask.limit),
        InfluenceFormat::Tiff => geotiff(&assumptions, map, measure),
    }
}

/// A point for each pixel, and beside the features what they depend on.
fn geojson(
    assumptions: Assumptions,
    map: &InfluenceMap,
    ask: &InfluenceAsk,
) -> Result<Vec<u8>, InfluenceFileError> {
    let measure = &ask.query.measure;
    let total = map.total().influence;
    let feature = |pixel: InfluentialPixel| -> Result<Value, serde_json::Error> {
        let coordinates = [pixel.longitude_deg, pixel.latitude_deg];
        Ok(json!({
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": coordinates},
            "properties": serde_json::to_value(pixel)?,
        }))
    };
    let features: Vec<Value> =
        influential_pixels(map, total, ask.limit).into_iter().map(feature).collect::<Result<_, _>>()?;
    #[derive(Serialize)]
    struct Collection<'a> {
        r#type: &'a str,
        measure: &'a str,
        unit: &'a str,
        total: f64,
        boundary: Option<PartAnswer>,
        assumptions: Assumptions,
        features: Vec<Value>,
    }
    Ok(serde_json::to_vec(&Collection {
        r#type: "FeatureCollection",
        measure: measure_name(measure),
        unit: measure.unit(),
        total,
        boundary: ask.boundary.as_ref().map(|boundary| PartAnswer::new(map.within(boundary), total)),
        assumptions,
        features,
    })?)
}

/// A row for each pixel; the column of influences carries their unit in its name.
fn csv_table(map: &InfluenceMap, measure: &Measure, limit: usize) -> Result<Vec<u8>, InfluenceFileError> {
    let influence = match measure {
        Measure::Norm => "influence_cd_m2_sr0_5",
        Measure::Horizontal => "influence_lx",
        Measure::Zenith | Measure::Mean | Measure::Region(_) => "influence_cd_m2",
    };
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "rank",
        "latitude_deg",
        "longitude_deg",
        "column",
        "row",
        "distance_m",
        "azimuth_deg",
        "radiance_nw_cm2_sr",
        "flux_dnb_w",
        influence,
        "share",
        "cumulative_share",
    ])?;
    for pixel in influential_pixels(map, map.total().influence, limit) {
        let InfluentialPixel {
            rank,
            latitude_deg,
            longitude_deg,
            column,
            row,
            distance_m,
            azimuth_deg,
            radiance_nw_cm2_sr,
            flux_dnb_w,
            influence,
            share,
            cumulative_share,
        } = pixel;
        let numbers = [
            latitude_deg,
            longitude_deg,
            f64::from(column),
            f64::from(row),
            distance_m,
            azimuth_deg,
            radiance_nw_cm2_sr,
            flux_dnb_w,
            influence,
            share,
            cumulative_share,
        ];
        writer.write_record(
            std::iter::once(rank.to_string()).chain(numbers.map(|number| number.to_string())),
        )?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()).into())
}

fn geotiff(
    assumptions: &Assumptions,
    map: &InfluenceMap,
    measure: &Measure,
) -> Result<Vec<u8>, InfluenceFileError> {
    let numbers: Vec<u32> = map.pixels().iter().map(|pixel| pixel.number).collect();
    let observer = &assumptions.observer;
    let mut description = format!(
        "influence of each lit pixel on the sky at {:.5}, {:.5}: {}",
        observer.latitude_deg,
        observer.longitude_deg,
        measure_name(measure)
    );
    if assumptions.scene.illustrative {
        description.push_str("; ");
        description.push_str(ILLUSTRATIVE);
    }
    let assumptions = serde_json::to_string(assumptions)?;
    let notes = [("TIFFTAG_SOFTWARE", "Skyglow"), ("ASSUMPTIONS", assumptions.as_str())];
    let words = RasterWords { description: &description, unit: measure.unit(), notes: &notes };
    Ok(map.open_scene().pixels_geotiff(&numbers, map.influence(), &words)?)
}
