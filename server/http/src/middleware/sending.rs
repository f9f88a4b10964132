//! What one client may have on its way to it: it keeps the memory of answers that it is slow to take.

use crate::{
    budget::{Full, Held},
    error::ApiError,
    party::Party,
    respond::Counted,
    state::AppState,
    trust::client_address,
};
use axum::{
    body::{Body, Bytes, HttpBody},
    extract::{Request, State},
    http::StatusCode,
    middleware::Next,
    response::{IntoResponse, Response},
};
use hyper::body::{Frame, SizeHint};
use skyglow_app::AppError;
use std::{
    pin::Pin,
    sync::Arc,
    task::{Context, Poll},
};

/// Shorter answers are not counted.
const SHORT_BYTES: u64 = 16 * 1024;

/// Counts answers in the client's share until they are sent, and answers 429 or 503 in their place where there is no room.
pub async fn limit_sending(State(state): State<AppState>, request: Request, next: Next) -> Response {
    let by_address = Party::of_address(client_address(&request, &state.config.trusted_proxies));
    let response = next.run(request).await;
    let length = response.body().size_hint().lower();
    // Who has something stored for them must hear of it.
    if length < SHORT_BYTES || response.status() == StatusCode::CREATED {
        return response;
    }
    let party = response.extensions().get::<Party>().copied().unwrap_or(by_address);
    let [counted, others] = &state.sending;
    let budget = if response.extensions().get::<Counted>().is_some() { counted } else { others };
    let refused = match budget.try_hold(party, usize::try_from(length).unwrap_or(usize::MAX)) {
        Ok(held) => return response.map(|body| Body::new(Sending { body, held: Arc::new(held) })),
        Err(Full::Share) => ApiError::TooManyRequests { retry_after_s: 5 },
        Err(Full::Whole) => ApiError::App(AppError::Busy { retry_after_s: 5 }),
    };
    state.metrics.count_refused("sending");
    refused.into_response()
}

/// A body that counts until it is sent or given up: whoever writes it out takes it whole, and keeps its bytes until then.
struct Sending {
    body: Body,
    held: Arc<Held>,
}

/// Bytes that count in a share.
struct Counting(Bytes, #[expect(dead_code, reason = "dropped with the bytes")] Arc<Held>);

impl AsRef<[u8]> for Counting {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

impl HttpBody for Sending {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        let held = Arc::clone(&self.held);
        let count = |bytes| Bytes::from_owner(Counting(bytes, held));
        Pin::new(&mut self.body).poll_frame(context).map_ok(|frame| frame.map_data(count))
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
