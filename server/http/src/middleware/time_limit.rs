//! How long each request may take.

use super::respond_async::Unhurried;
use crate::{asker, error::ApiError, state::AppState};
use axum::{
    extract::{Request, State},
    http::Method,
    middleware::Next,
    response::{IntoResponse, Response},
};

/// Answers 503 after the longest time allowed. A plan that has begun then is made all the same, and kept for who asks again.
pub async fn limit_time(State(state): State<AppState>, request: Request, next: Next) -> Response {
    if request.extensions().get::<Unhurried>().is_some() {
        return next.run(request).await;
    }
    let is_kept = *request.method() == Method::POST && request.uri().path().ends_with("/plans");
    let work = asker::current().work();
    match tokio::time::timeout(state.config.request_timeout(), next.run(request)).await {
        Ok(response) => response,
        Err(_) => {
            if is_kept {
                work.go_on();
            }
            state.metrics.count_refused("timeout");
            ApiError::Timeout { limit_s: state.config.request_timeout_s }.into_response()
        }
    }
}
