//! What is at a place: the cheap call that a click makes first.

use super::frame::{Answer, JsonRequest};
use crate::{refusals::OfPlace, respond::CachePolicy};
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
        OfPlace,
    )
)]
pub async fn get_site(request: JsonRequest) -> Answer {
    let id = request.scene()?;
    let (place, scenario) = place(request.query.as_deref())?;
    let read = move |source: &dyn SkySource| {
        let view = source.view(&id, scenario.as_ref())?;
        Ok(SiteAnswer::new(place, view.metadata(), source.site(&view, place)?))
    };
    request.answer(CachePolicy::Minutes, read).await
}
