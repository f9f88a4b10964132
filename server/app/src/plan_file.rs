//! Plans as the bytes of a file: what the HTTP interface answers and the command line writes.

use crate::{
    accept::InfluenceFormat,
    answers::{DimmedPixelAnswer, PlanAnswer, dimmed_pixels},
    format::rfc3339,
    influence_file::{InfluenceFileError, csv_table, feature_collection},
    planning::PlanRecord,
};
use skyglow_display::notes;
use skyglow_scene::RasterMetadata;

/// Encodes a plan; takes milliseconds to a second.
///
/// * `limit`: pixels listed; a raster has all.
///
/// # Errors
/// [`InfluenceFileError`], only by a defect.
pub fn encode_plan(
    record: &PlanRecord,
    limit: usize,
    format: InfluenceFormat,
) -> Result<Vec<u8>, InfluenceFileError> {
    let pixels = || dimmed_pixels(&record.plan, &record.scene, limit);
    match format {
        InfluenceFormat::Json => Ok(serde_json::to_vec(&plan_answer(record, limit))?),
        InfluenceFormat::GeoJson => {
            let place = |pixel: &DimmedPixelAnswer| [pixel.longitude_deg, pixel.latitude_deg];
            let mut collection = feature_collection(pixels(), place)?;
            collection.insert("plan".to_owned(), record.id.as_str().into());
            collection.insert("created".to_owned(), rfc3339(record.created_unix_s).into());
            collection.insert("facts".to_owned(), record.plan.answer.clone());
            Ok(serde_json::to_vec(&collection)?)
        }
        InfluenceFormat::Csv => csv_table(pixels()),
        InfluenceFormat::Tiff => geotiff(record),
    }
}

/// A plan as JSON answers it.
pub fn plan_answer(record: &PlanRecord, limit: usize) -> PlanAnswer {
    PlanAnswer {
        id: record.id.to_string(),
        created: rfc3339(record.created_unix_s),
        facts: record.plan.answer.clone(),
        pixels: dimmed_pixels(&record.plan, &record.scene, limit),
    }
}

/// γ of every pixel that is dimmed.
fn geotiff(record: &PlanRecord) -> Result<Vec<u8>, InfluenceFileError> {
    let factors = &record.plan.factors;
    let pixels = factors.codes.iter().zip(&factors.factors).map(|(code, factor)| (*code, 1.0 - factor));
    let pixels: Vec<(u64, f32)> = pixels.collect();
    let shows = format!("part of each pixel's light that plan {} takes away", record.id);
    let description = notes::description(shows, record.scene.metadata().illustrative);
    let facts = serde_json::to_string(&record.plan.answer)?;
    let notes = [("TIFFTAG_SOFTWARE", "Skyglow"), ("PLAN", facts.as_str())];
    let words = RasterMetadata { description: &description, unit: "1", notes: &notes };
    Ok(record.scene.codes_geotiff(&pixels, &words)?)
}
