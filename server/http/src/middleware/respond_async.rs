//! `Prefer: respond-async` (RFC 7240): long work is answered 202 at once, with the address of a job.

use crate::{
    asker::{self, Asker, Work},
    error::ApiError,
    jobs::{Jobs, Outcome, TooMany},
    state::AppState,
    trust::PublicAddress,
};
use axum::{
    Json,
    body::to_bytes,
    extract::{Request, State},
    http::{HeaderMap, HeaderValue, Method, StatusCode, header},
    middleware::Next,
    response::{IntoResponse, Response},
};
use skyglow_app::{
    AppError,
    answers::standards::{Base, status_info},
};
use std::sync::Arc;

/// Longest answer that is kept for a job, bytes.
const MAX_OUTCOME_BYTES: usize = 256 << 20;

/// Where processes are, which are answered 201 and have jobs of their own as their standard says.
const PROCESSES: &str = "/api/ogc/processes/";

/// Marks a request that nobody waits for on a connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unhurried;

/// Ends a job that no answer came of.
struct Ending {
    jobs: Arc<Jobs>,
    id: String,
    is_answered: bool,
}

impl Ending {
    fn answered(mut self, outcome: Outcome) {
        self.jobs.end(&self.id, outcome);
        self.is_answered = true;
    }
}

impl Drop for Ending {
    fn drop(&mut self) {
        if self.is_answered {
            return;
        }
        let (parts, _) = ApiError::internal("a job ended without an answer").into_response().into_parts();
        self.jobs
            .end(&self.id, Outcome { status: parts.status, headers: parts.headers, ..Outcome::default() });
    }
}

/// Makes jobs of posts of plans, influences and shares whose clients prefer that.
pub async fn respond_async(State(state): State<AppState>, mut request: Request, next: Next) -> Response {
    let path = request.uri().path();
    let is_process = path.starts_with(PROCESSES) && path.ends_with("/execution");
    let is_long =
        is_process || path.ends_with("/plans") || path.contains("/influence") || path.contains("/shares");
    if *request.method() != Method::POST || !is_long || !prefers_async(request.headers()) {
        return next.run(request).await;
    }
    let address = request.extensions().get::<PublicAddress>();
    let links = Base::new(address.map(PublicAddress::base).unwrap_or_default());
    let (party, work) = (asker::party(), Work::of_job());
    let id = match state.jobs.begin(party, Arc::clone(&work)) {
        Ok(id) => id,
        Err(TooMany) => {
            state.metrics.count_refused("jobs");
            return ApiError::App(AppError::Busy { retry_after_s: 30 }).into_response();
        }
    };
    request.extensions_mut().insert(Unhurried);
    let ending = Ending { jobs: Arc::clone(&state.jobs), id: id.clone(), is_answered: false };
    let job = async move {
        let (parts, body) = next.run(request).await.into_parts();
        if let Ok(body) = to_bytes(body, MAX_OUTCOME_BYTES).await {
            ending.answered(Outcome { status: parts.status, headers: parts.headers, body });
        }
    };
    let task = tokio::spawn(Asker::new(party, work).scope(job));
    state.jobs.set_task(&id, task.abort_handle());
    match is_process {
        true => accepted(&id, StatusCode::CREATED, &status_info(&links, &id, "accepted", 0.0), "ogc"),
        false => {
            let job = serde_json::json!({ "id": id, "state": "queued", "progress": 0.0 });
            accepted(&id, StatusCode::ACCEPTED, &job, "v1")
        }
    }
}

/// * `api`: the part of the interface that the job's address is in.
fn accepted(id: &str, status: StatusCode, job: &serde_json::Value, api: &str) -> Response {
    let mut response = (status, Json(job)).into_response();
    let headers = response.headers_mut();
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert("preference-applied", HeaderValue::from_static("respond-async"));
    if let Ok(location) = HeaderValue::from_str(&format!("/api/{api}/jobs/{id}")) {
        headers.insert(header::LOCATION, location);
    }
    response
}

fn prefers_async(headers: &HeaderMap) -> bool {
    let values = headers.get_all("prefer").iter().filter_map(|value| value.to_str().ok());
    let preferences = values.flat_map(|value| value.split(','));
    preferences
        .map(|text| text.split(';').next().unwrap_or_default().trim())
        .any(|name| name.eq_ignore_ascii_case("respond-async"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn preferences_are_a_list_in_any_case() {
        let prefers = |value: &'static str| {
            prefers_async(&HeaderMap::from_iter([(
                "prefer".parse().unwrap(),
                HeaderValue::from_static(value),
            )]))
        };
        assert!(prefers("respond-async") && prefers("wait=10, Respond-Async; x=1"));
        assert!(
            !prefers("return=minimal") && !prefers("respond-async-not") && !prefers_async(&HeaderMap::new())
        );
    }
}
