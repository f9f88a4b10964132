//! Typed requests from query strings.

mod area;
mod brightness;
mod darker;
mod edr;
mod emission;
mod execution;
pub mod geojson;
mod horizon;
mod influence;
mod keeping;
mod night;
mod places;
mod plan;
mod plan_body;
mod points;
mod read_back;
#[cfg(test)]
mod read_back_tests;
mod reference;
mod scenario;
mod scenario_body;
mod shares;
mod skies;
mod sky;
mod spectra;
#[cfg(test)]
mod tests;
mod view;
mod wkt;

pub use area::{BoundedArea, other_format, without_byte_order_mark};
pub use brightness::brightness;
pub use darker::{DarkerQuestion, darker};
pub use edr::{
    AreaRequest, MapRequest, PositionRequest, TrajectoryRequest, area, document_format, map, position,
    process_limit, trajectory,
};
pub use emission::{EmissionBody, GarstangLawBody};
pub use execution::{Execution, ExecutionBody, Process, execution};
pub use horizon::{HorizonRequest, check_terrain, horizon, landscape};
pub use influence::{InfluenceBody, InfluenceListRequest, influence};
pub use keeping::{Keeping, ListRequest, list_request};
pub use night::{SceneNight, night, nights, scene_night};
pub use places::{FoundPlace, world_places};
pub use plan::{PlanStoreRequest, plan, plan_limit};
pub use plan_body::{PlanBody, SiteBody};
pub use scenario::scenario;
pub use scenario_body::{AreaBody, BrushBody, EditBody, FixtureBody, LampBody, ScenarioBody};
pub use shares::{AreaSharesRequest, NamedArea, SharesRequest, area_features, area_shares, shares};
pub use skies::{MAX_SKIES, SkiesBody, SkiesRequest, SkyOfMany, skies};
pub use view::PictureRequest;

use self::{
    sky::{read_light, read_place, read_scenario, read_sky},
    view::read_view,
};
use crate::{
    accept::Format,
    error::AppError,
    facts::SourceFacts,
    parameters::{self as p, ParameterSet},
    reader::Reader,
    validation::ValidationCode,
};
use skyglow_display::Sky;
use skyglow_observatory::SkyRequest;
use skyglow_physics::GeoPoint;
use skyglow_scene::{ChangeId, SceneId};

/// A scene's id from a path; a text that is none names no scene.
///
/// # Errors
/// [`AppError::UnknownScene`].
pub fn scene_id(text: &str) -> Result<SceneId, AppError> {
    SceneId::parse(text).map_err(|_| AppError::UnknownScene { id: crate::validation::echo(text) })
}

/// The id that a scene is to have.
///
/// # Errors
/// [`AppError::Parameters`] with what an id may be.
pub fn new_scene_id(text: &str) -> Result<SceneId, AppError> {
    SceneId::parse(text).map_err(|_| {
        let message = "is no scene id".to_owned();
        let allowed = "1 to 64 of the characters a-z, 0-9 and -, such as my-region".to_owned();
        AppError::parameter(
            "scene",
            crate::validation::echo(text),
            allowed,
            message,
            ValidationCode::NotAllowed,
        )
    })
}

/// Checks that there are no parameters.
///
/// # Errors
/// [`AppError::Parameters`] naming all that are there.
pub fn no_parameters(query: Option<&str>) -> Result<(), AppError> {
    Reader::new(query, p::NoParameters::ALL).finish()
}

/// Reads the parameters of a place, and whose lights are there.
///
/// # Errors
/// [`AppError::Parameters`].
pub fn place(query: Option<&str>) -> Result<(GeoPoint, Option<ChangeId>), AppError> {
    let mut reader = Reader::new(query, p::PlaceParameters::ALL);
    let (place, scenario) = (read_place(&mut reader), read_scenario(&mut reader));
    reader.finish()?;
    let place = place.ok_or_else(|| AppError::internal("a place was neither read nor refused"))?;
    Ok((place, scenario))
}

/// Reads the scenario, where there may be nothing else.
///
/// # Errors
/// [`AppError::Parameters`].
pub fn scenario_alone(query: Option<&str>) -> Result<Option<ChangeId>, AppError> {
    let mut reader = Reader::new(query, p::ScenarioParameters::ALL);
    let scenario = read_scenario(&mut reader);
    reader.finish()?;
    Ok(scenario)
}

/// The id of a scenario or plan from a path; a text that is none names none.
///
/// # Errors
/// [`AppError::UnknownScenario`].
pub fn change_id(text: &str) -> Result<ChangeId, AppError> {
    ChangeId::parse(text).map_err(|_| AppError::UnknownScenario { id: crate::validation::echo(text) })
}

/// Reads the parameters of a sky.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn sky(query: Option<&str>, scene: SceneId, facts: &SourceFacts) -> Result<SkyRequest, AppError> {
    let mut reader = Reader::new(query, p::SkyParameters::ALL);
    let sky = read_sky(&mut reader, scene, facts);
    reader.finish()?;
    sky.ok_or_else(|| AppError::internal("a sky was neither read nor refused"))
}

/// Reads the parameters of a sky that is summed over every light, and which light is shown.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn reference(
    query: Option<&str>,
    scene: SceneId,
    facts: &SourceFacts,
) -> Result<(SkyRequest, Sky), AppError> {
    let mut reader = Reader::new(query, p::ReferenceParameters::ALL);
    let sky = read_sky(&mut reader, scene, facts);
    let light = read_light(&mut reader);
    reader.finish()?;
    let sky = sky.ok_or_else(|| AppError::internal("a sky was neither read nor refused"))?;
    Ok((sky, light))
}

/// Reads the parameters of a panorama in a format.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake; what means nothing for the format is as good as unknown.
pub fn panorama(
    query: Option<&str>,
    scene: SceneId,
    facts: &SourceFacts,
    format: Format,
) -> Result<(SkyRequest, PictureRequest), AppError> {
    let mut reader = Reader::new(query, p::PanoramaParameters::ALL);
    only_what_means_something(&mut reader, format);
    let sky = read_sky(&mut reader, scene, facts);
    let response = sky.as_ref().map(|sky| sky.response.clone()).unwrap_or_default();
    let view = read_view(&mut reader, &response);
    reader.finish()?;
    let sky = sky.ok_or_else(|| AppError::internal("a sky was neither read nor refused"))?;
    Ok((sky, view))
}

fn only_what_means_something(reader: &mut Reader, format: Format) {
    let known = format.parameters();
    let names: Vec<&str> = known.iter().map(|parameter| parameter.name).collect();
    for parameter in p::PanoramaParameters::ALL.iter().filter(|parameter| !names.contains(&parameter.name)) {
        if reader.text(parameter).is_some() {
            let message = Some(format!("means nothing for {}", format.media_type()));
            reader.fail(parameter, ValidationCode::UnknownParameter, message, Some(names.join(", ")));
        }
    }
}
