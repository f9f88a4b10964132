//! Whatever else refuses a request says so as a problem document too.

use crate::{error::ApiError, etag::ETag, problem::PROBLEM_JSON, state::AppState};
use axum::{
    extract::{Request, State},
    http::{HeaderValue, Method, StatusCode, header},
    middleware::Next,
    response::{IntoResponse, Response},
};
use std::{future::Future, panic::AssertUnwindSafe};

/// Turns the plain-text refusals of the framework into problem documents; keeps their Allow header.
pub async fn problems_only(State(state): State<AppState>, request: Request, next: Next) -> Response {
    // Nothing else is put than a scene.
    let limit_bytes = match *request.method() {
        Method::PUT => state.config.upload_limit_bytes,
        _ => state.config.body_limit_bytes,
    };
    let response = next.run(request).await;
    let status = response.status();
    if !status.is_client_error() && !status.is_server_error() {
        return response;
    }
    let is_problem = response
        .headers()
        .get(header::CONTENT_TYPE)
        .is_some_and(|media_type| media_type.as_bytes() == PROBLEM_JSON.as_bytes());
    if is_problem {
        return response;
    }
    let error = match status {
        StatusCode::NOT_FOUND => ApiError::NotFound,
        StatusCode::METHOD_NOT_ALLOWED => ApiError::MethodNotAllowed,
        StatusCode::PAYLOAD_TOO_LARGE => ApiError::BodyTooLong { limit_bytes },
        other if other.is_client_error() => ApiError::Unreadable(other.as_u16()),
        other => ApiError::internal(format!("status {other} without a problem document")),
    };
    let allow = response.headers().get(header::ALLOW).cloned();
    let mut problem = error.into_response();
    if let Some(allow) = allow {
        problem.headers_mut().insert(header::ALLOW, allow);
    }
    problem
}

/// Answers a panic with an internal error that tells nothing; the log has the rest.
pub async fn catch_panic(State(state): State<AppState>, request: Request, next: Next) -> Response {
    // The state that a panic could leave half-changed is counters and caches, which stay usable.
    match CatchUnwind(AssertUnwindSafe(Box::pin(next.run(request)))).await {
        Ok(response) => response,
        Err(reason) => {
            state.metrics.count_panic();
            ApiError::internal(format!("panic: {reason}")).into_response()
        }
    }
}

/// A future whose panics are values.
struct CatchUnwind<F>(AssertUnwindSafe<std::pin::Pin<Box<F>>>);

impl<F: Future> Future for CatchUnwind<F> {
    type Output = Result<F::Output, String>;

    fn poll(
        mut self: std::pin::Pin<&mut Self>,
        context: &mut std::task::Context<'_>,
    ) -> std::task::Poll<Self::Output> {
        let inner = &mut self.0.0;
        match std::panic::catch_unwind(AssertUnwindSafe(|| inner.as_mut().poll(context))) {
            Ok(poll) => poll.map(Ok),
            Err(payload) => {
                let text = payload
                    .downcast_ref::<&str>()
                    .map(|text| (*text).to_owned())
                    .or_else(|| payload.downcast_ref::<String>().cloned())
                    .unwrap_or_else(|| "no message".to_owned());
                std::task::Poll::Ready(Err(text))
            }
        }
    }
}

/// Gives each encoding of an answer a strong tag of its own.
pub async fn tag_encodings(request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    let headers = response.headers();
    let encoding = headers.get(header::CONTENT_ENCODING).and_then(|value| value.to_str().ok());
    let tag = headers.get(header::ETAG).and_then(|value| value.to_str().ok());
    if let (Some(encoding), Some(tag)) = (encoding, tag)
        && let Some(tag) = ETag::with_encoding(tag, encoding)
        && let Ok(tag) = HeaderValue::from_str(&tag)
    {
        response.headers_mut().insert(header::ETAG, tag);
    }
    response
}
