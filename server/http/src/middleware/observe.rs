//! Request ids, counts and the log line of each request.

use super::KnownClient;
use crate::{state::AppState, trust::client_address};
use axum::{
    extract::{MatchedPath, Request, State},
    http::{HeaderMap, HeaderName, HeaderValue},
    middleware::Next,
    response::Response,
};
use opentelemetry::{
    Context,
    propagation::{Extractor, TextMapPropagator},
    trace::Status,
};
use opentelemetry_sdk::propagation::TraceContextPropagator;
use std::{
    sync::atomic::{AtomicU64, Ordering},
    time::{Instant, SystemTime, UNIX_EPOCH},
};
use tracing::{Instrument, Span};
use tracing_opentelemetry::OpenTelemetrySpanExt;

const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");
const MAX_ID_BYTES: usize = 64;
const METHODS: [&str; 7] = ["GET", "HEAD", "POST", "PUT", "DELETE", "OPTIONS", "PATCH"];
/// JsonRequest every few seconds by whoever watches the server: nobody wants to see that traced.
const UNTRACED: [&str; 3] = ["/healthz", "/readyz", "/metrics"];

/// Gives each request an id (the client's own where it is short and plain), counts it, logs it, and opens the span that what is
/// logged and traced on its way belongs to; that one continues the trace of the client (W3C Trace Context) where there is one.
pub async fn observe(State(state): State<AppState>, request: Request, next: Next) -> Response {
    let start = Instant::now();
    let _under_way = state.metrics.under_way();
    let method = request.method().as_str().to_owned();
    // A closed list: names that clients make up would be counted for ever.
    let method = if METHODS.contains(&method.as_str()) { method } else { "OTHER".to_owned() };
    let route = request
        .extensions()
        .get::<MatchedPath>()
        .map_or_else(|| "other".to_owned(), |path| path.as_str().to_owned());
    let id = request_id(&request);
    let address = client_address(&request, &state.config.trusted_proxies);
    let address = address.and_then(|address| state.config.log_client_address.of(address));
    let span = match UNTRACED.contains(&route.as_str()) {
        true => Span::none(),
        false => {
            tracing::info_span!("request", otel.name = format!("{method} {route}"), otel.kind = "server", id)
        }
    };
    // Fails where nobody traces, and then there is nothing to continue.
    let _not_traced = span.set_parent(parent(request.headers()));
    let mut response = next.run(request).instrument(span.clone()).await;
    let status = response.status().as_u16();
    span.set_attribute("http.request.method", method.clone());
    span.set_attribute("http.route", route.clone());
    span.set_attribute("http.response.status_code", i64::from(status));
    if status >= 500 {
        span.set_status(Status::error(""));
    }
    drop(span);
    let duration = start.elapsed();
    state.metrics.count(&method, &route, status, duration);
    let client = response.extensions().get::<KnownClient>().map(|known| known.0.as_str());
    tracing::info!(%method, %route, status, ms = duration.as_secs_f64() * 1e3, id, client, address, "request");
    if let Ok(value) = HeaderValue::from_str(&id) {
        response.headers_mut().insert(REQUEST_ID, value);
    }
    response
}

/// The client's span.
fn parent(headers: &HeaderMap) -> Context {
    struct Headers<'a>(&'a HeaderMap);
    impl Extractor for Headers<'_> {
        fn get(&self, key: &str) -> Option<&str> {
            self.0.get(key)?.to_str().ok()
        }
        fn keys(&self) -> Vec<&str> {
            self.0.keys().map(HeaderName::as_str).collect()
        }
    }
    TraceContextPropagator::new().extract(&Headers(headers))
}

fn request_id(request: &Request) -> String {
    let plain = |text: &&str| {
        !text.is_empty()
            && text.len() <= MAX_ID_BYTES
            && text.bytes().all(|b| b.is_ascii_alphanumeric() || b"-_.".contains(&b))
    };
    let given = request.headers().get(REQUEST_ID).and_then(|value| value.to_str().ok()).filter(plain);
    given.map_or_else(new_id, str::to_owned)
}

/// Time of the process's start and a count: unique enough to find a line in a log.
fn new_id() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    static START: std::sync::LazyLock<u64> = std::sync::LazyLock::new(|| {
        SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_millis() as u64)
    });
    format!("{:x}-{:x}", *START, COUNT.fetch_add(1, Ordering::Relaxed))
}
