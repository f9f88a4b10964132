//! OGC API – Processes: what is done by `influence` and `plans` under the names of the standard. Jobs are those of `Prefer:
//! respond-async`; they are not listed, for their ids are known to those who began them alone.

use super::{influence::post_influence_json, ogc::constant, plans::post_plan};
use crate::{
    error::ApiError,
    jobs::Standing,
    poster::Poster,
    problem::Problem,
    refusals::{BadParameters, BodyTooLong, OfSky},
    respond::{json_bytes, uncached},
    routes::frame::Answer,
    state::AppState,
    trust::PublicAddress,
};
use axum::{
    Extension,
    body::{Body, Bytes, to_bytes},
    extract::{Path, RawQuery, State},
    http::{HeaderMap, HeaderValue, Response, StatusCode, header},
};
use serde_json::{Value, json};
use skyglow_app::{
    answers::standards::{process_description, process_list, status_info},
    request::{Execution, ExecutionBody, Process, execution, no_parameters, process_limit},
    standard_parameters::{DocumentParameters, ProcessListParameters},
};

/// Longest output that is put into a document, bytes.
const MAX_OUTPUT_BYTES: usize = 64 << 20;

fn process_of(id: &str) -> Result<Process, ApiError> {
    Process::of_id(id).ok_or(ApiError::NoSuchProcess)
}

/// The processes.
#[utoipa::path(
    get,
    path = "/api/ogc/processes",
    tag = "standards",
    params(ProcessListParameters),
    responses((status = 200, description = "The processes", body = Object), BadParameters)
)]
pub async fn get_processes(
    Extension(address): Extension<PublicAddress>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Answer {
    let limit = process_limit(query.as_deref())?;
    constant(None, &headers, &process_list(&address.links(), limit))
}

/// A process with its inputs and its output.
#[utoipa::path(
    get,
    path = "/api/ogc/processes/{process}",
    tag = "standards",
    params(("process" = String, Path, description = "`influence` or `plan`"), DocumentParameters),
    responses(
        (status = 200, description = "The process", body = Object),
        BadParameters,
        (status = 404, description = "No such process", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_process(
    Extension(address): Extension<PublicAddress>,
    Path(process): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Answer {
    let description = process_description(&address.links(), process_of(&process)?);
    constant(query.as_deref(), &headers, &description)
}

/// Executes a process. `influence` answers what `POST influence.json` does. `plan` makes a plan that is held for some ten minutes
/// after it was last asked for, and kept by nobody: `POST plans` keeps one.
#[utoipa::path(
    post,
    path = "/api/ogc/processes/{process}/execution",
    tag = "standards",
    params(("process" = String, Path, description = "`influence` or `plan`")),
    request_body = ExecutionBody,
    responses(
        (status = 200, description = "The output, or with `response: document` an object that names it", body = Object),
        (status = 201, description = "With `Prefer: respond-async`: it is begun, and Location is the address of the job", body = Object),
        OfSky,
        BodyTooLong,
        (status = 404, description = "No such process or scene, or a place lies outside it", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn post_execution(
    State(state): State<AppState>,
    Path(process): Path<String>,
    RawQuery(query): RawQuery,
    poster: Poster,
    body: Bytes,
) -> Answer {
    no_parameters(query.as_deref())?;
    let process = process_of(&process)?;
    let Execution { scene, query, body, as_document } =
        state.blocking(move |_| Ok(execution(process, &body)?)).await?;
    let (scene, query) = (Path(scene), RawQuery(Some(query)));
    let made = match process {
        Process::Influence => {
            post_influence_json(State(state), scene, query, HeaderMap::new(), body.into()).await
        }
        Process::Plan => post_plan(State(state), scene, query, poster, body.into()).await,
    };
    let (mut parts, output) = made?.into_parts();
    parts.status = StatusCode::OK;
    parts.headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    for name in [header::ETAG, header::LOCATION] {
        parts.headers.remove(name);
    }
    if !as_document {
        return Ok(Response::from_parts(parts, output));
    }
    let bytes = to_bytes(output, MAX_OUTPUT_BYTES).await.map_err(ApiError::internal)?;
    let value: Value = serde_json::from_slice(&bytes).map_err(ApiError::internal)?;
    let document = json!({ process.output(): { "value": value, "mediaType": "application/json" } });
    Ok(Response::from_parts(parts, Body::from(json_bytes(&document)?)))
}

/// How a job stands, as the standard says it: the same job as that of `/api/v1/jobs`.
#[utoipa::path(
    get,
    path = "/api/ogc/jobs/{job}",
    tag = "standards",
    params(("job" = String, Path, description = "The job's id"), DocumentParameters),
    responses(
        (status = 200, description = "The job", body = Object),
        (status = 404, description = "No such job, or it was not kept so long", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_job_status(
    State(state): State<AppState>,
    Extension(address): Extension<PublicAddress>,
    Path(job): Path<String>,
    RawQuery(query): RawQuery,
) -> Answer {
    skyglow_app::request::document_format(query.as_deref())?;
    let (status, done) = match state.jobs.standing(&job).ok_or(ApiError::NoSuchJob)? {
        Standing::Queued => ("accepted", 0.0),
        Standing::Running(done) => ("running", done),
        Standing::Ended(outcome) if outcome.status.is_success() => ("successful", 1.0),
        Standing::Ended(_) => ("failed", 1.0),
    };
    uncached(&status_info(&address.links(), &job, status, done))
}

/// Dismisses a job: ends it and forgets it, with what came of it.
#[utoipa::path(
    delete,
    path = "/api/ogc/jobs/{job}",
    tag = "standards",
    params(("job" = String, Path, description = "The job's id")),
    responses(
        (status = 200, description = "It is gone", body = Object),
        (status = 404, description = "No such job, or it was not kept so long", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn dismiss_job(
    State(state): State<AppState>,
    Extension(address): Extension<PublicAddress>,
    Path(job): Path<String>,
    RawQuery(query): RawQuery,
) -> Answer {
    no_parameters(query.as_deref())?;
    if !state.jobs.cancel(&job) {
        return Err(ApiError::NoSuchJob);
    }
    uncached(&status_info(&address.links(), &job, "dismissed", 1.0))
}

/// What came of a job: the output, or why there is none.
#[utoipa::path(
    get,
    path = "/api/ogc/jobs/{job}/results",
    tag = "standards",
    params(("job" = String, Path, description = "The job's id"), DocumentParameters),
    responses(
        (status = 200, description = "The output, with the media type that it has", body = Object),
        (status = 404, description = "No such job, or it is not done", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_job_results(
    State(state): State<AppState>,
    Path(job): Path<String>,
    RawQuery(query): RawQuery,
) -> Answer {
    skyglow_app::request::document_format(query.as_deref())?;
    match state.jobs.standing(&job).ok_or(ApiError::NoSuchJob)? {
        Standing::Queued | Standing::Running(_) => Err(ApiError::ResultNotReady),
        Standing::Ended(outcome) => {
            let mut response = super::jobs::outcome_response(&outcome);
            // The same job may have been begun by another post, which made something.
            if outcome.status.is_success() {
                *response.status_mut() = StatusCode::OK;
            }
            Ok(response)
        }
    }
}
