//! Scenes and their named places.

use crate::{
    answers::{PlaceAnswer, SceneAnswer},
    error::ApiError,
    etag::ETag,
    problem::Problem,
    request::{no_parameters, scene_id},
    respond::{Caching, Keep, json_by_content},
    state::AppState,
};
use axum::{
    body::Body,
    extract::{Path, RawQuery, State},
    http::{HeaderMap, Response},
};

/// Lists the scenes.
#[utoipa::path(
    get,
    path = "/api/v1/scenes",
    tag = "scenes",
    responses(
        (status = 200, description = "All scenes, by id", body = Vec<SceneAnswer>),
        (status = 304, description = "The client has this answer already"),
        (status = 400, description = "Bad parameters", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn list_scenes(
    State(state): State<AppState>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    no_parameters(query.as_deref())?;
    let scenes = state.blocking(|source| Ok(source.scenes()?)).await?;
    let answer: Vec<SceneAnswer> = scenes.into_iter().map(SceneAnswer::from).collect();
    json_by_content(&headers, Keep::Revalidate, &answer)
}

/// Describes a scene.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}",
    tag = "scenes",
    params(("scene" = String, Path, description = "The scene's id")),
    responses(
        (status = 200, description = "The scene", body = SceneAnswer),
        (status = 304, description = "The client has this answer already"),
        (status = 400, description = "Bad parameters", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such scene", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_scene(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let id = scene_id(&scene)?;
    no_parameters(query.as_deref())?;
    let scene = state.blocking(move |source| Ok(source.scene(&id)?)).await?;
    json_by_content(&headers, Keep::Revalidate, &SceneAnswer::from(scene))
}

/// Lists the named places of a scene, the most populous first.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/places",
    tag = "scenes",
    params(("scene" = String, Path, description = "The scene's id")),
    responses(
        (status = 200, description = "The places", body = Vec<PlaceAnswer>),
        (status = 304, description = "The client has this answer already"),
        (status = 400, description = "Bad parameters", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such scene", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn list_places(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let id = scene_id(&scene)?;
    no_parameters(query.as_deref())?;
    let wanted = id.clone();
    let scene = state.blocking(move |source| Ok(source.scene(&wanted)?)).await?;
    let etag = ETag::of(&["places", &scene.version]);
    let caching = Caching { etag, keep: Keep::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&headers) {
        return Ok(response);
    }
    let places = state.blocking(move |source| Ok(source.places(&id)?)).await?;
    let answer: Vec<PlaceAnswer> = places.into_iter().map(PlaceAnswer::from).collect();
    caching.json(&answer)
}
