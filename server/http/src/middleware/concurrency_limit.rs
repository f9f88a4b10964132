//! ConcurrencyLimit for so many requests at a time, and a limit on how long each takes.

use crate::{error::ApiError, state::AppState};
use axum::{
    extract::{Request, State},
    middleware::Next,
    response::{IntoResponse, Response},
};
use skyglow_app::error::AppError;
use std::sync::Arc;
use tokio::sync::Semaphore;

/// The state with its limit for requests.
#[derive(Clone)]
pub struct ConcurrencyLimit {
    state: AppState,
    permits: Arc<Semaphore>,
}

impl ConcurrencyLimit {
    /// ConcurrencyLimit as configured.
    pub fn new(state: AppState) -> Self {
        let permits = state.config.concurrent_requests.clamp(1, Semaphore::MAX_PERMITS);
        Self { state, permits: Arc::new(Semaphore::new(permits)) }
    }
}

/// Answers 503 at once when there is no limit, and after the longest time allowed.
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
