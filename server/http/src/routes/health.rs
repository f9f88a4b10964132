//! Whether the server lives and is ready, and its counters.

use crate::{
    error::ApiError, problem::Problem, refusals::BadParameters, respond::json_bytes, state::AppState,
};
use axum::{
    body::Body,
    extract::{RawQuery, State},
    http::{HeaderValue, Response, header},
};
use skyglow_app::error::AppError;
use skyglow_app::{answers::HealthAnswer, request::no_parameters};

/// A body that nobody keeps.
fn fresh(media_type: &'static str, body: Vec<u8>) -> Response<Body> {
    let mut response = Response::new(Body::from(body));
    response.headers_mut().insert(header::CONTENT_TYPE, HeaderValue::from_static(media_type));
    response.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    response
}

/// Answers while the server lives.
#[utoipa::path(
    get,
    path = "/healthz",
    tag = "operation",
    responses(
        (status = 200, description = "The server lives", body = HealthAnswer),
        BadParameters,
    )
)]
pub async fn get_health(RawQuery(query): RawQuery) -> Result<Response<Body>, ApiError> {
    no_parameters(query.as_deref())?;
    let answer = HealthAnswer {
        status: "ok".to_owned(),
        executor: None,
        packs_left_out: Vec::new(),
        scenes_left_out: Vec::new(),
    };
    Ok(fresh("application/json", json_bytes(&answer)?))
}

/// Answers 200 once tables are resident and the device answers, unless every scene is damaged. Names what is left out because it
/// is damaged.
#[utoipa::path(
    get,
    path = "/readyz",
    tag = "operation",
    responses(
        (status = 200, description = "The server is ready", body = HealthAnswer),
        BadParameters,
        (status = 503, description = "Tables or device are not ready, or every scene is damaged", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_readiness(
    State(state): State<AppState>,
    RawQuery(query): RawQuery,
) -> Result<Response<Body>, ApiError> {
    no_parameters(query.as_deref())?;
    if !state.source.is_ready() {
        return Err(ApiError::App(AppError::EngineDown));
    }
    let left_out = state.source.left_out();
    if left_out.no_scene_left {
        return Err(ApiError::App(AppError::DamagedScene { id: left_out.scenes.join("\", \"") }));
    }
    let answer = HealthAnswer {
        status: "ok".to_owned(),
        executor: Some(state.source.facts().executor.clone()),
        packs_left_out: left_out.packs,
        scenes_left_out: left_out.scenes,
    };
    Ok(fresh("application/json", json_bytes(&answer)?))
}

/// Counters for Prometheus, in the OpenMetrics text format.
#[utoipa::path(
    get,
    path = "/metrics",
    tag = "operation",
    responses(
        (status = 200, description = "The counters", body = String, content_type = "application/openmetrics-text"),
        BadParameters,
    )
)]
pub async fn get_metrics(
    State(state): State<AppState>,
    RawQuery(query): RawQuery,
) -> Result<Response<Body>, ApiError> {
    no_parameters(query.as_deref())?;
    let text = state.metrics.text().map_err(ApiError::internal)?;
    Ok(fresh("application/openmetrics-text; version=1.0.0; charset=utf-8", text.into_bytes()))
}
