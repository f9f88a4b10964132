//! The resident table packs.

use crate::{
    answers::AtmosphereAnswer,
    error::ApiError,
    problem::Problem,
    request::no_parameters,
    respond::{Keep, json_by_content},
    state::AppState,
};
use axum::{
    body::Body,
    extract::{RawQuery, State},
    http::{HeaderMap, Response},
};

/// Lists the resident table packs, ascending in turbidity.
#[utoipa::path(
    get,
    path = "/api/v1/atmospheres",
    tag = "atmospheres",
    responses(
        (status = 200, description = "The packs", body = Vec<AtmosphereAnswer>),
        (status = 304, description = "The client has this answer already"),
        (status = 400, description = "Bad parameters", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn list_atmospheres(
    State(state): State<AppState>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    no_parameters(query.as_deref())?;
    json_by_content(&headers, Keep::Revalidate, &state.source.atmospheres())
}
