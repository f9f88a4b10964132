//! Cross-origin requests (the Fetch standard's CORS protocol): pages of any site may read; those that the operator names may
//! have things kept.

use crate::{config::HttpConfig, state::AppState};
use axum::{
    body::Body,
    extract::{Request, State},
    http::{HeaderMap, HeaderName, HeaderValue, Method, header},
    middleware::Next,
    response::Response,
};

/// Headers that a page may send.
const REQUEST_HEADERS: &str = "accept, authorization, content-type, if-none-match, if-range, prefer, range, skyglow-owner, \
     traceparent, x-api-key, x-request-id";
/// Headers of answers that a page may see.
const EXPOSED_HEADERS: &str = "accept-ranges, content-bbox, content-range, etag, link, location, preference-applied, ratelimit, ratelimit-policy, \
     retry-after, server-timing, skyglow-owner, skyglow-warnings, x-request-id";
/// How long a browser need not ask again, seconds.
const MAX_AGE_S: &str = "86400";
/// What decides a preflight's answer.
const PREFLIGHT_VARY: &str = "origin, access-control-request-method, access-control-request-headers";

/// Says to browsers which pages may ask what below `/api/`.
pub async fn share_across_origins(State(state): State<AppState>, request: Request, next: Next) -> Response {
    if !request.uri().path().starts_with("/api/") {
        return next.run(request).await;
    }
    let headers = request.headers();
    if request.method() == Method::OPTIONS && headers.contains_key(header::ACCESS_CONTROL_REQUEST_METHOD) {
        let may_store = is_listed(headers.get(header::ORIGIN), &state.config);
        return preflight(request.uri().path(), may_store);
    }
    let mut response = next.run(request).await;
    // It says so to everyone: an answer in a cache serves all.
    let headers = response.headers_mut();
    put(headers, header::ACCESS_CONTROL_ALLOW_ORIGIN, "*");
    put(headers, header::ACCESS_CONTROL_EXPOSE_HEADERS, EXPOSED_HEADERS);
    response
}

/// Whether the operator lets pages of this origin have things kept.
pub(super) fn is_listed(origin: Option<&HeaderValue>, config: &HttpConfig) -> bool {
    let Some(origin) = origin.and_then(|origin| origin.to_str().ok()) else { return false };
    config.cors_origins.iter().any(|listed| listed == "*" || listed.eq_ignore_ascii_case(origin))
}

fn preflight(path: &str, may_store: bool) -> Response {
    let methods = match may_store {
        true => "GET, HEAD, POST, PUT, DELETE",
        false if stores(path) => "GET, HEAD",
        false => "GET, HEAD, POST",
    };
    let mut response = Response::new(Body::empty());
    let headers = response.headers_mut();
    put(headers, header::ACCESS_CONTROL_ALLOW_ORIGIN, "*");
    put(headers, header::ACCESS_CONTROL_ALLOW_METHODS, methods);
    put(headers, header::ACCESS_CONTROL_ALLOW_HEADERS, REQUEST_HEADERS);
    put(headers, header::ACCESS_CONTROL_MAX_AGE, MAX_AGE_S);
    put(headers, header::VARY, PREFLIGHT_VARY);
    response
}

/// Whether what is posted to a path is kept.
fn stores(path: &str) -> bool {
    path.ends_with("/scenarios") || path.ends_with("/plans") || path.ends_with("/processes/plan/execution")
}

fn put(headers: &mut HeaderMap, name: HeaderName, value: &'static str) {
    headers.insert(name, HeaderValue::from_static(value));
}
