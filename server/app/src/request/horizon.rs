//! Requests for horizons and for landscapes that have one.

use super::sky::{read_conditions, read_eye_height, read_place};
use crate::{
    error::AppError,
    facts::SourceFacts,
    horizon_file::HorizonFormat,
    parameters::{self as p, ParameterSet},
    reader::Reader,
    validation::ValidationCode,
};
use skyglow_observatory::{ObserverHeight, SkyRequest};
use skyglow_physics::GeoPoint;
use skyglow_scene::{SceneId, SceneMetadata};

/// A request for the horizon of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HorizonRequest {
    /// The place.
    pub place: GeoPoint,
    /// Where the eye is.
    pub observer_height: ObserverHeight,
    /// Whose file.
    pub format: HorizonFormat,
}

/// Reads the parameters of a horizon.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn horizon(query: Option<&str>, facts: &SourceFacts) -> Result<HorizonRequest, AppError> {
    let mut reader = Reader::new(query, p::HorizonParameters::ALL);
    let place = read_place(&mut reader);
    let observer_height = read_eye_height(&mut reader, facts);
    let format = match reader.choice(&p::HORIZON_FORMAT) {
        Some("nina") => HorizonFormat::Nina,
        _ => HorizonFormat::Stellarium,
    };
    reader.finish()?;
    let place = place.ok_or_else(|| AppError::internal("a place was neither read nor refused"))?;
    Ok(HorizonRequest { place, observer_height, format })
}

/// Reads the parameters of a landscape.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn landscape(query: Option<&str>, scene: SceneId, facts: &SourceFacts) -> Result<SkyRequest, AppError> {
    let mut reader = Reader::new(query, p::LandscapeParameters::ALL);
    let place = read_place(&mut reader);
    let observer_height = read_eye_height(&mut reader, facts);
    let conditions = read_conditions(&mut reader, facts);
    reader.finish()?;
    let read = place.zip(conditions);
    let (place, conditions) = read.ok_or_else(|| AppError::internal("a sky was neither read nor refused"))?;
    Ok(conditions.over(scene, place, observer_height))
}

/// Refuses a scene that knows no horizons: a flat one would look like an answer.
///
/// # Errors
/// [`AppError::Parameters`].
pub fn check_terrain(scene: &SceneMetadata) -> Result<(), AppError> {
    if scene.terrain {
        return Ok(());
    }
    Err(AppError::parameter(
        "scene",
        scene.id.to_string(),
        "a scene with terrain; `skyglow ingest --terrain` makes one".to_owned(),
        "has no terrain, and so no horizons".to_owned(),
        ValidationCode::NotAllowed,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::tests::facts;

    #[test]
    fn horizons_are_read_with_their_format() {
        let ask = |query: &str| horizon(Some(query), &facts());
        assert_eq!(ask("lat=46&lon=8").unwrap().format, HorizonFormat::Stellarium);
        let nina = ask("lat=46&lon=8&format=nina&height=10").unwrap();
        assert_eq!(
            (nina.format, nina.observer_height),
            (HorizonFormat::Nina, ObserverHeight::AboveGround(10.0))
        );
        assert!(ask("lat=46&lon=8&format=voyager").is_err() && ask("lat=46").is_err());
        let scene = SceneId::parse("demo").unwrap();
        let sky = landscape(Some("lat=46&lon=8&altitude=900&turbidity=3"), scene, &facts()).unwrap();
        assert_eq!((sky.observer_height, sky.turbidity.value()), (ObserverHeight::AboveSea(900.0), 3.0));
    }
}
