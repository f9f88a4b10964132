//! Reduction plans: made, listed, handed out.

use super::{
    frame::{Answer, JsonRequest},
    influence::preferred_format,
    kept::{list, remove},
};
use crate::{
    asker::Work,
    error::ApiError,
    etag::ETag,
    middleware::StoredLength,
    poster::{Poster, hand_out},
    problem::Problem,
    refusals::{
        Accepted, BadParameters, BodyTooLong, Busy, NotAcceptable, NotOwner, OfScene, StorageRefused,
    },
    respond::{CachePolicy, Caching, created},
    state::{AppState, EncodedAnswer, influence_bytes},
    trust::PublicAddress,
    work_places::Lane,
};
use axum::{
    body::{Body, Bytes},
    extract::{Extension, Path, RawQuery, State},
    http::{HeaderMap, Response, StatusCode},
};
use skyglow_app::error::AppError;
use skyglow_app::{
    accept::InfluenceFormat,
    answers::{PlanAnswer, PlanEntry},
    negotiated_parameters::NegotiatedPlanParameters,
    parameters::{KeptListParameters, PlanPostParameters},
    plan_file::{encode_plan, plan_answer},
    planning::{find_plan, make_plan, prepare_plan},
    request::{PlanBody, change_id, plan, plan_limit, scene_id},
    source::SkySource,
};

/// Bytes that writing a plan takes, about.
const PLAN_FILE_BYTES: usize = 16 << 20;

/// Makes a reduction plan: what to dim, by how influential lights are on a site (`threshold`), or the least flux such that sites
/// meet limits (`target`). Values before and after come from the forward model. The plan is kept, unless `keep=off` only tries
/// it: then it counts towards no share of what is kept, and is forgotten after some minutes without a question about it. Its id is
/// taken by every query as `scenario`, and the same request for the same scene answers the same plan.
#[utoipa::path(
    post,
    path = "/api/v1/scenes/{scene}/plans",
    tag = "plans",
    params(("scene" = String, Path, description = "The scene's id"),
        ("Skyglow-Owner" = Option<String>, Header, description = "The secret of an owner, so that this is theirs too; without a key or a secret a new one is handed out"),
        PlanPostParameters,
    ),
    request_body = PlanBody,
    responses(
        (status = 201, description = "The plan; Location is its address", body = PlanAnswer, headers(
            ("skyglow-owner" = Option<String>, description = "The secret of whoever had this kept, who shows it to remove it or to list it: handed out once, where there was neither a key nor a secret"),
        )),
        StorageRefused,
        BodyTooLong,
        Accepted,
        (status = 400, description = "Bad parameters, or a body that cannot be meant", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such scene or scenario, or a site lies outside: then with the scene's bounds", body = Problem, content_type = "application/problem+json"),
        (status = 403, description = "What is pinned is for clients with a key", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The scenario is a plan for an earlier state of the scene, or, with `keep=on`, one that is not kept; or as much is pinned as may be", body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Altitude or turbidity out of range", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn post_plan(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    poster: Poster,
    body: Bytes,
) -> Result<Response<Body>, ApiError> {
    let scene = scene_id(&scene)?;
    let read = move |source: &dyn SkySource| {
        let request = plan(query.as_deref(), &body, scene, source.facts())?;
        // Places and altitudes are refused as those of any sky.
        let view = prepare_plan(source, &request)?;
        Ok((request, view))
    };
    let (request, view) = state.blocking(read).await?;
    let (posting, secret) = poster.posting(request.keeping)?;
    let is_private = !posting.listed;
    let bytes = influence_bytes(request.request.max_influences(&view));
    let bytes = bytes.saturating_add(request.request.programme_bytes(&view));
    let make = move |source: &dyn SkySource, work: &Work| {
        let (plan, is_new) = make_plan(source, &request, &view, &posting, &|done| work.note(done))?;
        let stored_bytes = if is_new { plan.stored_bytes() } else { 0 };
        Ok((plan_answer(&plan, request.limit), stored_bytes, is_new))
    };
    let ((answer, stored_bytes, is_new), _) = state.work.long(Lane::Plan, bytes, make).await?;
    let mut response = created(&format!("/api/v1/plans/{}", answer.id), &answer)?;
    response.extensions_mut().insert(StoredLength(stored_bytes));
    hand_out(&mut response, secret.filter(|_| is_new || is_private));
    Ok(response)
}

/// Lists the plans of a scene, the newest first: those that are listed, and those of who asks.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/plans",
    tag = "plans",
    params(
        ("scene" = String, Path, description = "The scene's id"),
        ("Skyglow-Owner" = Option<String>, Header, description = "The secret of an owner, who sees what is theirs and not listed too"),
        KeptListParameters,
    ),
    responses(
        (status = 200, description = "The plans", body = Vec<PlanEntry>, headers(
            ("link" = Option<String>, description = "The address of the next part of the list, `rel=\"next\"`, where there is more"),
        )),
        (status = 304, description = "The client has this answer already"),
        OfScene,
        Busy,
    )
)]
pub async fn list_plans(
    Extension(address): Extension<PublicAddress>,
    poster: Poster,
    request: JsonRequest,
) -> Answer {
    let read =
        |source: &dyn SkySource, scene: &_, viewer: &_, part: &_| source.list_plans(scene, viewer, part);
    list(request, &poster, &address, "plans", read).await
}

/// Removes a plan that is kept: for whoever had it kept, by the same key or the secret that was handed out then, and for the
/// operator. Others that were based on it cannot be had any more.
#[utoipa::path(
    delete,
    path = "/api/v1/plans/{plan}",
    tag = "plans",
    params(
        ("plan" = String, Path, description = "The plan's id"),
        ("Skyglow-Owner" = Option<String>, Header, description = "The secret that was handed out when it was kept; not for clients with a key"),
    ),
    responses(
        (status = 204, description = "It is gone"),
        NotOwner,
        (status = 404, description = "No such plan, or one that is not kept", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn delete_plan(
    State(state): State<AppState>,
    Path(plan): Path<String>,
    RawQuery(query): RawQuery,
    poster: Poster,
) -> Result<StatusCode, ApiError> {
    remove(&state, &poster, &plan, query.as_deref(), true).await
}

/// A plan, in the format that the Accept header prefers, or that its address ends in: `.json` what is said of it and the pixels
/// with the most effect, `.tif` the part of every pixel that goes as GeoTIFF on the scene's own grid, `.geojson` and `.csv` the
/// pixels with the most effect.
#[utoipa::path(
    get,
    path = "/api/v1/plans/{plan}",
    tag = "plans",
    params(
        ("plan" = String, Path, description = "The plan's id, with `.json`, `.tif`, `.geojson`, `.csv` or without"),
        NegotiatedPlanParameters,
    ),
    responses(
        (status = 200, description = "The plan", content(
            (PlanAnswer = "application/json"),
            (Vec<u8> = "image/tiff"),
            (Object = "application/geo+json"),
            (String = "text/csv"),
        )),
        (status = 304, description = "The client has this answer already"),
        BadParameters,
        NotAcceptable,
        Busy,
        (status = 404, description = "No such plan", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The plan is for an earlier state of the scene", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_plan(
    State(state): State<AppState>,
    Path(file): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let (id, format) = match file.split_once('.') {
        Some((id, end)) => {
            let format = InfluenceFormat::from_extension(end);
            (
                id,
                Some(format.ok_or_else(|| {
                    ApiError::App(AppError::UnknownScenario { id: skyglow_app::validation::echo(&file) })
                })?),
            )
        }
        None => (file.as_str(), None),
    };
    let id = change_id(id)?;
    let limit = plan_limit(query.as_deref())?;
    let vary = format.is_none().then_some("accept");
    let format = format.map_or_else(|| preferred_format(&headers), Ok)?;
    let record = state.blocking(move |source| Ok(find_plan(source, &id)?)).await?;
    let etag = ETag::of(&("plan", &record.id, record.created_unix_s, format.extension(), limit))?;
    let caching = Caching { etag, policy: CachePolicy::Revalidate, vary };
    if let Some(response) = caching.not_modified(&headers) {
        return Ok(response);
    }
    let encode = move |_: &dyn SkySource| encode_plan(&record, limit, format).map_err(ApiError::internal);
    let made = state
        .answer(&caching.etag, async {
            state.work.drawn(PLAN_FILE_BYTES, encode).await.map(EncodedAnswer::from)
        })
        .await?;
    Ok(made.response(&caching, format.media_type()))
}
