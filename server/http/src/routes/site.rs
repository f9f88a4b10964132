//! What is at a place: the cheap call that a click makes first.

use super::frame::{Answer, JsonRequest};
use crate::{problem::Problem, respond::CachePolicy};
use skyglow_app::{answers::SiteAnswer, parameters::PlaceParameters, request::place, source::SkySource};

/// Says what is at a place.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/site",
    tag = "sky",
    params(("scene" = String, Path, description = "The scene's id"), PlaceParameters),
    responses(
        (status = 200, description = "Terrain and radiance there", body = SiteAnswer),
        (status = 304, description = "The client has this answer already"),
        (status = 400, description = "Bad parameters", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such scene or scenario, or the place lies outside it: then with its bounds", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The scenario is a plan for an earlier state of the scene", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_site(asked: JsonRequest) -> Answer {
    let id = asked.scene()?;
    let (place, scenario) = place(asked.query.as_deref())?;
    let read = move |source: &dyn SkySource| {
        let site = source.site(&id, scenario.as_ref(), place).map_err(|error| error.at(place))?;
        Ok(SiteAnswer::new(place, &site))
    };
    asked.answer(CachePolicy::Minutes, read).await
}
