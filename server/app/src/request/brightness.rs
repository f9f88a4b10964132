//! Requests for the brightness of all places.

use super::sky::read_conditions;
use crate::{
    error::AppError,
    facts::SourceFacts,
    parameters::{self as p, BrightnessParameters, ParameterSet},
    reader::Reader,
};
use skyglow_observatory::{BrightnessRequest, MapMeasure};
use skyglow_scene::SceneId;

/// Reads the parameters of the sky's brightness at every place.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn brightness(
    query: Option<&str>,
    scene: SceneId,
    facts: &SourceFacts,
) -> Result<BrightnessRequest, AppError> {
    let mut reader = Reader::new(query, BrightnessParameters::ALL);
    let conditions = read_conditions(&mut reader, facts);
    let measure = read_map_measure(&mut reader);
    reader.finish()?;
    let conditions = conditions.ok_or_else(|| AppError::internal("a map was neither read nor refused"))?;
    Ok(conditions.over_all(scene, measure, facts.max_places))
}

/// What of the sky a map shows.
pub(super) fn read_map_measure(reader: &mut Reader) -> MapMeasure {
    match reader.choice(&p::MAP_MEASURE) {
        Some("mean") => MapMeasure::Mean,
        Some("horizontal") => MapMeasure::Horizontal,
        _ => MapMeasure::Zenith,
    }
}
