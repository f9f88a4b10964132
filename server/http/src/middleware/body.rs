//! Bodies of requests, read before anything is done for them: a client that sends its own byte by byte holds nobody else's place.

use crate::{error::ApiError, state::AppState};
use axum::{
    body::{Body, to_bytes},
    extract::{Request, State},
    http::StatusCode,
    middleware::Next,
    response::{IntoResponse, Response},
};
use http_body_util::LengthLimitError;

/// Length of a request's body, bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyLength(pub(super) usize);

/// Reads the body, within the time for an answer.
pub async fn read_body(State(state): State<AppState>, request: Request, next: Next) -> Response {
    let (mut parts, body) = request.into_parts();
    let limit_bytes = state.config.body_limit_bytes;
    let read = tokio::time::timeout(state.config.request_timeout(), to_bytes(body, limit_bytes)).await;
    let bytes = match read {
        Ok(Ok(bytes)) => bytes,
        Ok(Err(error)) => {
            let is_long = std::iter::successors(std::error::Error::source(&error), |error| error.source())
                .any(|error| error.is::<LengthLimitError>());
            return match is_long {
                true => ApiError::BodyTooLong { limit_bytes },
                false => ApiError::Unreadable(StatusCode::BAD_REQUEST.as_u16()),
            }
            .into_response();
        }
        Err(_) => {
            state.metrics.count_refused("body");
            return ApiError::Unreadable(StatusCode::REQUEST_TIMEOUT.as_u16()).into_response();
        }
    };
    parts.extensions.insert(BodyLength(bytes.len()));
    next.run(Request::from_parts(parts, Body::from(bytes))).await
}
