//! Painted scenarios: stored, listed, looked at.

use super::{
    frame::{Answer, JsonRequest},
    kept::{list, remove},
};
use crate::{
    error::ApiError,
    middleware::StoredLength,
    poster::{Poster, hand_out},
    problem::Problem,
    refusals::{BadParameters, BodyTooLong, Busy, NotOwner, OfScene, StorageRefused},
    respond::{CachePolicy, created, json_by_content},
    state::AppState,
    trust::PublicAddress,
};
use axum::{
    body::{Body, Bytes},
    extract::{Extension, Path, RawQuery, State},
    http::{HeaderMap, Response, StatusCode},
};
use skyglow_app::error::AppError;
use skyglow_app::{
    answers::{ScenarioAnswer, ScenarioEntry},
    parameters::{KeptListParameters, ScenarioPostParameters},
    request::{ScenarioBody, change_id, no_parameters, scenario, scene_id},
    source::SkySource,
};

/// Paints over a scene: dims, brightens or adds lights, replaces lamps, changes where they shine. The id that is answered is
/// taken by every query as `scenario`; the same body answers the same id, which is then whose it was. A scenario as it was answered may
/// be posted again, whole or its edits.
#[utoipa::path(
    post,
    path = "/api/v1/scenes/{scene}/scenarios",
    tag = "plans",
    params(("scene" = String, Path, description = "The scene's id"),
        ("Skyglow-Owner" = Option<String>, Header, description = "The secret of an owner, so that this is theirs too; without a key or a secret a new one is handed out"),
        ScenarioPostParameters,
    ),
    request_body = ScenarioBody,
    responses(
        (status = 201, description = "The scenario; Location is its address", body = ScenarioAnswer, headers(
            ("skyglow-owner" = Option<String>, description = "The secret of whoever had this kept, who shows it to remove it or to list it: handed out once, where there was neither a key nor a secret"),
        )),
        StorageRefused,
        BodyTooLong,
        (status = 400, description = "A body that cannot be meant, or an area outside the scene", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such scene, or no such scenario or plan to go on from", body = Problem, content_type = "application/problem+json"),
        (status = 403, description = "What is pinned is for clients with a key", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "It goes on from a plan for an earlier state of the scene, or one that is not kept; or as much is pinned as may be", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn post_scenario(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    poster: Poster,
    body: Bytes,
) -> Result<Response<Body>, ApiError> {
    let scene = scene_id(&scene)?;
    let store = move |source: &dyn SkySource| {
        let (scenario, keeping) = scenario(query.as_deref(), &body, scene)?;
        let (posting, secret) = poster.posting(keeping)?;
        let (id, is_new) = source.store_scenario(&scenario, &posting)?;
        let secret = secret.filter(|_| is_new || !posting.listed);
        Ok((ScenarioAnswer::new(&id, &source.scenario(&id)?), is_new, secret))
    };
    let (answer, is_new, secret) = state.heavy(store).await?;
    let mut response = created(&format!("/api/v1/scenarios/{}", answer.entry.id), &answer)?;
    if !is_new {
        response.extensions_mut().insert(StoredLength(0));
    }
    hand_out(&mut response, secret);
    Ok(response)
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

/// Removes a scenario: for whoever had it kept, by the same key or the secret that was handed out then, and for the operator.
/// Others that were based on it cannot be had any more.
#[utoipa::path(
    delete,
    path = "/api/v1/scenarios/{scenario}",
    tag = "plans",
    params(
        ("scenario" = String, Path, description = "The scenario's id"),
        ("Skyglow-Owner" = Option<String>, Header, description = "The secret that was handed out when it was kept; not for clients with a key"),
    ),
    responses(
        (status = 204, description = "It is gone"),
        NotOwner,
        (status = 404, description = "No such scenario", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn delete_scenario(
    State(state): State<AppState>,
    Path(scenario): Path<String>,
    RawQuery(query): RawQuery,
    poster: Poster,
) -> Result<StatusCode, ApiError> {
    remove(&state, &poster, &scenario, query.as_deref(), false).await
}

/// Lists the scenarios of a scene, the newest first: those that are listed, and those of who asks.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/scenarios",
    tag = "plans",
    params(
        ("scene" = String, Path, description = "The scene's id"),
        ("Skyglow-Owner" = Option<String>, Header, description = "The secret of an owner, who sees what is theirs and not listed too"),
        KeptListParameters,
    ),
    responses(
        (status = 200, description = "The scenarios", body = Vec<ScenarioEntry>, headers(
            ("link" = Option<String>, description = "The address of the next part of the list, `rel=\"next\"`, where there is more"),
        )),
        (status = 304, description = "The client has this answer already"),
        OfScene,
        Busy,
    )
)]
pub async fn list_scenarios(
    Extension(address): Extension<PublicAddress>,
    poster: Poster,
    request: JsonRequest,
) -> Answer {
    let read =
        |source: &dyn SkySource, scene: &_, viewer: &_, part: &_| source.list_scenarios(scene, viewer, part);
    list(request, &poster, &address, "scenarios", read).await
}
