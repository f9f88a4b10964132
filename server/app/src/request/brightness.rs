//! Requests for the brightness of all places.

use super::sky::{Conditions, read_conditions, read_light, read_time};
use crate::{
    error::AppError,
    facts::SourceFacts,
    parameters::{self as p, BrightnessParameters, ParameterSet},
    reader::Reader,
    validation::ValidationCode,
};
use skyglow_display::Sky;
use skyglow_observatory::{BrightnessRequest, MapLight, MapMeasure};
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
    let sky = read_light(&mut reader);
    let turbidity = conditions.as_ref().map(|conditions| conditions.turbidity());
    let time = read_time(&mut reader, &p::TIME, facts, turbidity);
    if sky == Sky::Total && conditions.as_ref().is_some_and(Conditions::is_overcast) {
        let message = Some("means nothing under `clouds`: maps under them show artificial light".to_owned());
        let asking = if reader.text(&p::SKY).is_some() { &p::SKY } else { &p::TIME };
        reader.fail(
            asking,
            ValidationCode::Conflict,
            message,
            Some("artificial light, without a time".to_owned()),
        );
    }
    reader.finish()?;
    let (Some(conditions), Some(time)) = (conditions, time) else {
        return Err(AppError::internal("a map was neither read nor refused"));
    };
    let light = if sky == Sky::Total { MapLight::Total(time) } else { MapLight::Artificial };
    Ok(BrightnessRequest { light, ..conditions.over_all(scene, measure, facts.max_places) })
}

/// What of the sky a map shows.
pub(super) fn read_map_measure(reader: &mut Reader) -> MapMeasure {
    reader.choice(&p::MAP_MEASURE).and_then(MapMeasure::named).unwrap_or(MapMeasure::Zenith)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Kind;

    /// Every measure of a map can be asked for, by the name that it has.
    #[test]
    fn all_measures_can_be_asked_for() {
        let Kind::Choice(names) = p::MAP_MEASURE.kind else { panic!("a measure is chosen") };
        assert_eq!(names, MapMeasure::ALL.map(MapMeasure::name));
    }
}
