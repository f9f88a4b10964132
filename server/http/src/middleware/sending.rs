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
    middleware::Next,
    response::{IntoResponse, Response},
};
use hyper::body::{Frame, SizeHint};
use skyglow_app::AppError;
use std::{
    pin::Pin,
    task::{Context, Poll},
};

/// Shorter answers are not counted.
const SHORT_BYTES: u64 = 16 * 1024;

/// Counts answers in the client's share until they are sent, and answers 429 or 503 in their place where there is no room.
pub async fn limit_sending(State(state): State<AppState>, request: Request, next: Next) -> Response {
    let by_address = Party::of_address(client_address(&request, &state.config.trusted_proxies));
    let response = next.run(request).await;
    let length = response.body().size_hint().lower();
    if length < SHORT_BYTES {
        return response;
    }
    let party = response.extensions().get::<Party>().copied().unwrap_or(by_address);
    let [counted, others] = &state.sending;
    let budget = if response.extensions().get::<Counted>().is_some() { counted } else { others };
    let refused = match budget.try_hold(party, usize::try_from(length).unwrap_or(usize::MAX)) {
        Ok(held) => return response.map(|body| Body::new(Sending { body, _held: held })),
        Err(Full::Share) => ApiError::TooManyRequests { retry_after_s: 5 },
        Err(Full::Whole) => ApiError::App(AppError::Busy { retry_after_s: 5 }),
    };
    state.metrics.count_refused("sending");
    refused.into_response()
}

/// A body that counts until it is sent or given up.
struct Sending {
    body: Body,
    _held: Held,
}

impl HttpBody for Sending {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    /// Never before it is asked: whoever sends the last bytes keeps this until then.
    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
