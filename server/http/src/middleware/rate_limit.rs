//! A rate of requests for each client address: the connection's own or, behind trusted proxies, the one that they name.

use crate::{
    access::Client,
    asker::Asker,
    error::ApiError,
    party::Party,
    state::AppState,
    token_buckets::{Left, TokenBuckets, header_values},
    trust::client_address,
};
use axum::{
    extract::{Request, State},
    http::HeaderValue,
    middleware::Next,
    response::{IntoResponse, Response},
};
use std::{sync::Arc, time::Instant};

/// The name of the key that a request came with, for the log.
#[derive(Clone, Debug)]
pub struct KnownClient(pub String);

/// Answers 429 to a client that sends too much, and 401 to one whose token or key nobody has. Known clients have rates of their
/// own, the operator none.
pub async fn limit_rate(
    State((state, limiter)): State<(AppState, Arc<TokenBuckets>)>,
    request: Request,
    next: Next,
) -> Response {
    let address = client_address(&request, &state.config.trusted_proxies);
    // Secrets are guessed at no higher rate than anything else is asked.
    let mut party = Party::of_address(address);
    let of_address = || {
        let taken = if address.is_some() { limiter.take(party, 1.0, Instant::now()) } else { Ok(()) };
        taken.map_err(|wait_s| ApiError::TooManyRequests { retry_after_s: wait_s.ceil() as u64 })
    };
    let mut known = None;
    let allowed = match state.access.client(request.headers()) {
        Ok(Client::Operator) => {
            party = Party::Operator;
            Ok(())
        }
        Ok(Client::Key(name)) => {
            known = Some(KnownClient(name.to_owned()));
            party = Party::of_key(name);
            state.access.count(name)
        }
        Ok(Client::Anyone) => of_address(),
        Err(error) => of_address().and(Err(error)),
    };
    let mut response = match allowed {
        Ok(()) => Asker::new(party, Arc::default()).scope(next.run(request)).await,
        Err(error) => {
            let reason = match error {
                ApiError::Unauthorized => "secret",
                ApiError::QuotaUsed { .. } => "quota",
                _ => "rate",
            };
            state.metrics.count_refused(reason);
            error.into_response()
        }
    };
    if let Some(known) = known {
        response.extensions_mut().insert(known);
    }
    response.extensions_mut().insert(party);
    let now = Instant::now();
    let is_by_address = matches!(party, Party::V4(_) | Party::V6(_));
    let requests = limiter.left(party, now).filter(|_| is_by_address);
    let shares: Vec<Left> = requests.into_iter().chain(state.work.shares.left(party, now)).collect();
    if !shares.is_empty() {
        let (policy, left) = header_values(&shares);
        for (name, value) in [("ratelimit-policy", policy), ("ratelimit", left)] {
            if let Ok(value) = HeaderValue::from_str(&value) {
                response.headers_mut().insert(name, value);
            }
        }
    }
    response
}
