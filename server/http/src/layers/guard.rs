//! Room for so many requests at a time, and a limit on how long each takes.

use crate::{error::ApiError, state::AppState};
use axum::{
    extract::{Request, State},
    middleware::Next,
    response::{IntoResponse, Response},
};
use skyglow_app::error::AppError;
use std::sync::Arc;
use tokio::sync::Semaphore;

/// The state with its room for requests.
#[derive(Clone)]
pub struct Room {
    state: AppState,
    places: Arc<Semaphore>,
}

impl Room {
    /// Room as configured.
    pub fn new(state: AppState) -> Self {
        let places = state.config.concurrent_requests.clamp(1, Semaphore::MAX_PERMITS);
        Self { state, places: Arc::new(Semaphore::new(places)) }
    }
}

/// Answers 503 at once when there is no room, and after the longest time allowed.
pub async fn guard(State(room): State<Room>, request: Request, next: Next) -> Response {
    let metrics = &room.state.metrics;
    let Ok(_place) = room.places.try_acquire() else {
        metrics.count_refused("busy");
        return ApiError::App(AppError::Busy { retry_after_s: 1 }).into_response();
    };
    match tokio::time::timeout(room.state.config.request_timeout(), next.run(request)).await {
        Ok(response) => response,
        Err(_) => {
            metrics.count_refused("timeout");
            ApiError::Timeout { limit_s: room.state.config.request_timeout_s }.into_response()
        }
    }
}
