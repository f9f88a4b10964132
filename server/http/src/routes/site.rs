//! What is at a place: the cheap call that a click makes first.

use crate::{
    answers::SiteAnswer,
    error::ApiError,
    parameters::PlaceParameters,
    problem::Problem,
    request::{place, scene_id},
    respond::{Keep, json_by_content},
    state::AppState,
};
use axum::{
    body::Body,
    extract::{Path, RawQuery, State},
    http::{HeaderMap, Response},
};

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
        (status = 404, description = "No such scene, or the place lies outside it: then with its bounds", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_site(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let id = scene_id(&scene)?;
    let place = place(query.as_deref())?;
    let site = state.blocking(move |source| source.site(&id, place).map_err(|e| e.at(place))).await?;
    json_by_content(&headers, Keep::Minutes, &SiteAnswer::new(place, &site))
}
