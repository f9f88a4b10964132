//! Bodies of requests: none where none is read, and else within a budget of bytes, before anything is done for them.

use crate::{
    asker,
    budget::{Budget, Full, Held},
    error::ApiError,
    state::AppState,
};
use axum::{
    body::{Body, Bytes, HttpBody},
    extract::{Request, State},
    http::{HeaderMap, HeaderValue, Method, StatusCode, header},
    middleware::Next,
    response::{IntoResponse, Response},
};
use http_body_util::{BodyExt, LengthLimitError};
use std::{sync::Arc, time::Duration};
use tokio::time::Instant;

/// What a body is given before anything of it has come, at most, bytes.
const FIRST_BYTES: usize = 16 * 1024;
/// How long a body may come at any rate.
const GRACE: Duration = Duration::from_secs(10);
/// The least rate after that, on average, bytes a second.
const MIN_RATE_BYTES_PER_S: f64 = 1024.0;
/// Longest wait for the next piece.
const MAX_PAUSE: Duration = Duration::from_secs(10);

/// Length of a request's body, bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyLength(pub(super) usize);

/// Refuses bodies where nobody reads one, without reading them: the connection ends with the answer.
pub async fn refuse_stray_bodies(State(state): State<AppState>, request: Request, next: Next) -> Response {
    let takes_none =
        matches!(*request.method(), Method::GET | Method::HEAD | Method::DELETE | Method::OPTIONS);
    if !takes_none || request.body().is_end_stream() {
        return next.run(request).await;
    }
    state.metrics.count_refused("body");
    let limit_bytes = state.config.body_limit_bytes;
    let is_long = length_said(request.headers()).is_some_and(|length| length > limit_bytes);
    let error = match is_long {
        true => ApiError::BodyTooLong { limit_bytes },
        false => ApiError::Unreadable(StatusCode::BAD_REQUEST.as_u16()),
    };
    let mut response = error.into_response();
    response.headers_mut().insert(header::CONNECTION, HeaderValue::from_static("close"));
    response
}

/// Reads the body, within the time for an answer and the budget of bytes.
pub async fn read_body(State(state): State<AppState>, request: Request, next: Next) -> Response {
    let (mut parts, body) = request.into_parts();
    if body.is_end_stream() {
        return next.run(Request::from_parts(parts, body)).await;
    }
    let limits = Limits { bytes: state.config.body_limit_bytes, time: state.config.request_timeout() };
    match read(&state.bodies, body, length_said(&parts.headers), limits).await {
        Ok(bytes) => {
            parts.extensions.insert(BodyLength(bytes.len()));
            next.run(Request::from_parts(parts, Body::from(bytes))).await
        }
        Err(error) => {
            if !matches!(error, ApiError::BodyTooLong { .. }) {
                state.metrics.count_refused("body");
            }
            error.into_response()
        }
    }
}

fn length_said(headers: &HeaderMap) -> Option<usize> {
    headers.get(header::CONTENT_LENGTH)?.to_str().ok()?.parse().ok()
}

/// What a body may take.
#[derive(Clone, Copy, Debug)]
struct Limits {
    bytes: usize,
    time: Duration,
}

/// * `length`: what the client says of it.
async fn read(
    budget: &Arc<Budget>,
    mut body: Body,
    length: Option<usize>,
    limits: Limits,
) -> Result<Bytes, ApiError> {
    let mut read = Growing::new(budget, length.unwrap_or(FIRST_BYTES)).map_err(refusal)?;
    let start = Instant::now();
    loop {
        let at_rate = Duration::from_secs_f64(read.bytes.len() as f64 / MIN_RATE_BYTES_PER_S);
        let until = (start + limits.time.min(GRACE + at_rate)).min(Instant::now() + MAX_PAUSE);
        let Ok(frame) = tokio::time::timeout_at(until, body.frame()).await else {
            return Err(ApiError::Unreadable(StatusCode::REQUEST_TIMEOUT.as_u16()));
        };
        let Some(frame) = frame else { return Ok(read.finish()) };
        let too_long = ApiError::BodyTooLong { limit_bytes: limits.bytes };
        let frame = frame.map_err(|error| {
            let is_long = std::iter::successors(std::error::Error::source(&error), |error| error.source())
                .any(|error| error.is::<LengthLimitError>());
            match is_long {
                true => too_long.clone(),
                false => ApiError::Unreadable(StatusCode::BAD_REQUEST.as_u16()),
            }
        })?;
        let Ok(piece) = frame.into_data() else { continue };
        if read.bytes.len() + piece.len() > limits.bytes {
            return Err(too_long);
        }
        read.push(&piece, length.unwrap_or(limits.bytes)).map_err(refusal)?;
    }
}

fn refusal(full: Full) -> ApiError {
    match full {
        Full::Share => ApiError::TooManyRequests { retry_after_s: 1 },
        Full::Whole => ApiError::App(skyglow_app::AppError::Busy { retry_after_s: 2 }),
    }
}

/// A body that grows within a budget: its own bytes alone, none of the connection's buffers.
struct Growing {
    bytes: Vec<u8>,
    held: Held,
}

impl Growing {
    fn new(budget: &Arc<Budget>, expected: usize) -> Result<Self, Full> {
        let first = expected.min(FIRST_BYTES);
        let held = budget.try_hold(asker::party(), first)?;
        Ok(Self { bytes: Vec::with_capacity(first), held })
    }

    /// * `most`: bytes that it can come to be.
    fn push(&mut self, piece: &[u8], most: usize) -> Result<(), Full> {
        let needed = self.bytes.len() + piece.len();
        if needed > self.bytes.capacity() {
            let capacity = needed.max((2 * self.bytes.capacity()).min(most));
            self.held.try_grow(capacity - self.bytes.capacity())?;
            self.bytes.reserve_exact(capacity - self.bytes.len());
        }
        self.bytes.extend_from_slice(piece);
        Ok(())
    }

    /// What came; it counts until whoever reads it is done.
    fn finish(self) -> Bytes {
        self.held.keep(self.bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::body::HttpBody;
    use hyper::body::Frame;
    use prometheus_client::metrics::gauge::Gauge;
    use std::{
        convert::Infallible,
        pin::Pin,
        task::{Context, Poll},
    };
    use tokio::sync::mpsc::{Receiver, channel};

    const LIMITS: Limits = Limits { bytes: 100_000, time: Duration::from_secs(3600) };

    /// A body whose pieces come when they are sent.
    struct Sent(Receiver<Bytes>);

    impl HttpBody for Sent {
        type Data = Bytes;
        type Error = Infallible;
        fn poll_frame(
            mut self: Pin<&mut Self>,
            context: &mut Context<'_>,
        ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
            self.0.poll_recv(context).map(|piece| piece.map(|piece| Ok(Frame::data(piece))))
        }
    }

    fn budget(bytes: u64) -> (Arc<Budget>, Gauge) {
        let gauge = Gauge::default();
        (Budget::new(bytes, bytes, gauge.clone()), gauge)
    }

    /// Sends pieces with pauses before them, and reads them.
    async fn sent(
        budget: &Arc<Budget>,
        pieces: usize,
        length: usize,
        pause_s: u64,
    ) -> Result<Bytes, ApiError> {
        let (sender, receiver) = channel(1);
        tokio::spawn(async move {
            for _ in 0..pieces {
                tokio::time::sleep(Duration::from_secs(pause_s)).await;
                let _gone = sender.send(vec![7; length].into()).await;
            }
        });
        read(budget, Body::new(Sent(receiver)), None, LIMITS).await
    }

    /// A slow body is read, one that stands still or trickles is cut, and what it held is given back.
    #[tokio::test(start_paused = true)]
    async fn bodies_that_stand_still_are_cut() {
        let (budget, gauge) = budget(1 << 20);
        let slow = sent(&budget, 60, 1500, 1).await.unwrap();
        assert_eq!((slow.len(), gauge.get() >= 90_000), (90_000, true));
        drop(slow);
        let cut = ApiError::Unreadable(408);
        assert_eq!(sent(&budget, 2, 50_000, 11).await, Err(cut.clone()), "it stands still");
        assert_eq!(sent(&budget, 60, 500, 1).await, Err(cut), "it trickles");
        assert_eq!(gauge.get(), 0);
    }

    /// Bodies take of the budget what came of them, and are refused where there is no more.
    #[tokio::test(start_paused = true)]
    async fn bodies_take_of_the_budget_what_came() {
        let (budget, gauge) = budget(64 * 1024);
        let first = sent(&budget, 3, 10_000, 0).await.unwrap();
        assert!((30_000..=40_000).contains(&gauge.get()), "{}", gauge.get());
        assert_eq!(sent(&budget, 4, 10_000, 0).await, Err(ApiError::TooManyRequests { retry_after_s: 1 }));
        drop(first);
        assert!(sent(&budget, 4, 10_000, 0).await.is_ok());
        let roomy = self::budget(1 << 20);
        let long = sent(&roomy.0, 11, 10_000, 0).await;
        assert_eq!(long, Err(ApiError::BodyTooLong { limit_bytes: LIMITS.bytes }));
    }
}
