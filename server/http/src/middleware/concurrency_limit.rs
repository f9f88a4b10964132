//! A limit on the requests that are worked on at a time and on how long each takes.

use crate::{error::ApiError, state::AppState};
use axum::{
    extract::{Request, State},
    middleware::Next,
    response::{IntoResponse, Response},
};
use skyglow_app::error::AppError;
use std::sync::Arc;
use tokio::sync::Semaphore;

/// The permits for requests, with the state.
#[derive(Clone)]
pub struct ConcurrencyLimit {
    state: AppState,
    permits: Arc<Semaphore>,
}

impl ConcurrencyLimit {
    /// The limit as configured.
    pub fn new(state: AppState) -> Self {
        let permits = state.config.concurrent_requests.clamp(1, Semaphore::MAX_PERMITS);
        Self { state, permits: Arc::new(Semaphore::new(permits)) }
    }
}

/// Answers 503 at once when no permit is free, and after the longest time allowed.
pub async fn limit_concurrency(
    State(limit): State<ConcurrencyLimit>,
    request: Request,
    next: Next,
) -> Response {
    let metrics = &limit.state.metrics;
    let Ok(_permit) = limit.permits.try_acquire() else {
        metrics.count_refused("busy");
        return ApiError::App(AppError::Busy { retry_after_s: 1 }).into_response();
    };
    match tokio::time::timeout(limit.state.config.request_timeout(), next.run(request)).await {
        Ok(response) => response,
        Err(_) => {
            metrics.count_refused("timeout");
            ApiError::Timeout { limit_s: limit.state.config.request_timeout_s }.into_response()
        }
    }
}
