//! Painted scenarios: stored, listed, looked at.

use super::frame::{Answer, JsonRequest};
use crate::{
    error::ApiError,
    problem::Problem,
    refusals::{BadParameters, BodyTooLong, Busy, OfScene, StorageRefused},
    respond::{CachePolicy, created, json_by_content},
    state::AppState,
};
use axum::{
    body::{Body, Bytes},
    extract::{Path, RawQuery, State},
    http::{HeaderMap, Response},
};
use skyglow_app::error::AppError;
use skyglow_app::{
    answers::{ScenarioAnswer, ScenarioEntry},
    parameters::NoParameters,
    request::{ScenarioBody, change_id, no_parameters, scenario, scene_id},
    source::SkySource,
};

/// Paints over a scene: dims, brightens or adds lights, replaces lamps, changes where they shine. The id that is answered is
/// taken by every query as `scenario`; the same body answers the same id.
#[utoipa::path(
    post,
    path = "/api/v1/scenes/{scene}/scenarios",
    tag = "plans",
    params(("scene" = String, Path, description = "The scene's id"), NoParameters),
    request_body = ScenarioBody,
    responses(
        (status = 201, description = "The scenario; Location is its address", body = ScenarioAnswer),
        StorageRefused,
        BodyTooLong,
        (status = 400, description = "A body that cannot be meant, or an area outside the scene", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such scene, or no such scenario or plan to go on from", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "It goes on from a plan for an earlier state of the scene, or one that is not kept", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn post_scenario(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    body: Bytes,
) -> Result<Response<Body>, ApiError> {
    let scene = scene_id(&scene)?;
    let store = move |source: &dyn SkySource| {
        let scenario = scenario(query.as_deref(), &body, scene)?;
        let id = source.store_scenario(&scenario)?;
        Ok(ScenarioAnswer::new(&id, &source.scenario(&id)?))
    };
    let answer = state.heavy(store).await?;
    created(&format!("/api/v1/scenarios/{}", answer.entry.id), &answer)
}

/// A scenario, and what it does to its scene.
#[utoipa::path(
    get,
    path = "/api/v1/scenarios/{scenario}",
    tag = "plans",
    params(("scenario" = String, Path, description = "The scenario's id")),
    responses(
        (status = 200, description = "The scenario", body = ScenarioAnswer),
        (status = 304, description = "The client has this answer already"),
        BadParameters,
        Busy,
        (status = 404, description = "No such scenario", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "It goes on from a plan for an earlier state of the scene", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_scenario(
    State(state): State<AppState>,
    Path(scenario): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    no_parameters(query.as_deref())?;
    let id = change_id(&scenario)?;
    if id.is_plan() {
        return Err(ApiError::App(AppError::UnknownScenario { id: id.to_string() }));
    }
    let answer = state.heavy(move |source| Ok(ScenarioAnswer::new(&id, &source.scenario(&id)?))).await?;
    json_by_content(&headers, CachePolicy::Revalidate, &answer)
}

/// Lists the scenarios of a scene, the newest first.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/scenarios",
    tag = "plans",
    params(("scene" = String, Path, description = "The scene's id")),
    responses(
        (status = 200, description = "The scenarios", body = Vec<ScenarioEntry>),
        (status = 304, description = "The client has this answer already"),
        OfScene,
        Busy,
    )
)]
pub async fn list_scenarios(request: JsonRequest) -> Answer {
    let scene = request.scene()?;
    request.without_parameters()?;
    request.heavy(CachePolicy::Revalidate, move |source| Ok(source.list_scenarios(&scene)?)).await
}
