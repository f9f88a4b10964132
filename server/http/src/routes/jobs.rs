//! Jobs: work that was answered 202, and what came of it.

use crate::{
    error::ApiError,
    jobs::{Outcome, Standing},
    problem::Problem,
    respond::{Counted, uncached},
    state::AppState,
    trust::PublicAddress,
};
use axum::{
    Extension,
    body::Body,
    extract::{Path, RawQuery, State},
    http::{HeaderValue, Response, StatusCode, header},
};
use serde::Serialize;
use skyglow_app::request::no_parameters;
use utoipa::ToSchema;

/// How a job stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum JobState {
    /// It waits for its turn.
    Queued,
    /// It is worked on.
    Running,
    /// Its result can be had.
    Done,
    /// Its result says why not.
    Failed,
}

/// A job.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct JobAnswer {
    /// Its id.
    pub id: String,
    /// How it stands.
    pub state: JobState,
    /// The part that is done, 0 to 1.
    pub progress: f64,
    /// Where its result is: the plan that was made, or the answer itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub result: Option<String>,
    /// The status that the answer has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub status: Option<u16>,
}

impl JobAnswer {
    fn new(id: &str, standing: &Standing, address: &PublicAddress) -> Self {
        let (state, progress, outcome) = match standing {
            Standing::Queued => (JobState::Queued, 0.0, None),
            Standing::Running(done) => (JobState::Running, *done, None),
            Standing::Ended(outcome) if outcome.status.is_success() => (JobState::Done, 1.0, Some(outcome)),
            Standing::Ended(outcome) => (JobState::Failed, 1.0, Some(outcome)),
        };
        let made = |outcome: &Outcome| {
            let location = outcome.headers.get(header::LOCATION).and_then(|value| value.to_str().ok());
            address.path(location.unwrap_or(&format!("/api/v1/jobs/{id}/result")))
        };
        Self {
            id: id.to_owned(),
            state,
            progress,
            result: outcome.map(|outcome| made(outcome)),
            status: outcome.map(|outcome| outcome.status.as_u16()),
        }
    }
}

/// How a job stands: the work that a post with `Prefer: respond-async` began. Jobs are known for ten minutes after their end, for one where the result is longer than a megabyte.
#[utoipa::path(
    get,
    path = "/api/v1/jobs/{job}",
    tag = "plans",
    params(("job" = String, Path, description = "The job's id")),
    responses(
        (status = 200, description = "The job", body = JobAnswer),
        (status = 404, description = "No such job, or it was not kept so long", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_job(
    State(state): State<AppState>,
    Extension(address): Extension<PublicAddress>,
    Path(job): Path<String>,
    RawQuery(query): RawQuery,
) -> Result<Response<Body>, ApiError> {
    no_parameters(query.as_deref())?;
    let standing = state.jobs.standing(&job).ok_or(ApiError::NotFound)?;
    let mut response = uncached(&JobAnswer::new(&job, &standing, &address))?;
    if !matches!(standing, Standing::Ended(_)) {
        response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from_static("1"));
    }
    Ok(response)
}

/// What came of a job: the answer that the post would have had, problems included.
#[utoipa::path(
    get,
    path = "/api/v1/jobs/{job}/result",
    tag = "plans",
    params(("job" = String, Path, description = "The job's id")),
    responses(
        (status = 200, description = "The answer, with the media type that it has", body = Object),
        (status = 201, description = "The answer to what made a plan", body = Object),
        (status = 404, description = "No such job, or it was not kept so long", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "It is not done; Retry-After says when to try again", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_job_result(
    State(state): State<AppState>,
    Path(job): Path<String>,
    RawQuery(query): RawQuery,
) -> Result<Response<Body>, ApiError> {
    no_parameters(query.as_deref())?;
    match state.jobs.standing(&job).ok_or(ApiError::NotFound)? {
        Standing::Queued => Err(ApiError::BeingMade { progress: 0.0, retry_after_s: 1 }),
        Standing::Running(progress) => Err(ApiError::BeingMade { progress, retry_after_s: 1 }),
        Standing::Ended(outcome) => Ok(outcome_response(&outcome)),
    }
}

/// The answer that came of a job.
pub(super) fn outcome_response(outcome: &Outcome) -> Response<Body> {
    let mut response = Response::new(Body::from(outcome.body.clone()));
    *response.status_mut() = outcome.status;
    *response.headers_mut() = outcome.headers.clone();
    response.extensions_mut().insert(Counted);
    response
}

/// Ends a job and forgets it, with what came of it; a plan that is made stays.
#[utoipa::path(
    delete,
    path = "/api/v1/jobs/{job}",
    tag = "plans",
    params(("job" = String, Path, description = "The job's id")),
    responses(
        (status = 204, description = "It is gone"),
        (status = 404, description = "No such job, or it was not kept so long", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn delete_job(
    State(state): State<AppState>,
    Path(job): Path<String>,
    RawQuery(query): RawQuery,
) -> Result<StatusCode, ApiError> {
    no_parameters(query.as_deref())?;
    if state.jobs.cancel(&job) { Ok(StatusCode::NO_CONTENT) } else { Err(ApiError::NotFound) }
}
