//! A storage quota for each client address and the networks around it: what one client stores pushes out what others stored.

use super::{body::BodyLength, cors::is_listed};
use crate::{
    access::Client,
    error::{ApiError, TookTooLong},
    party::Party,
    state::AppState,
    token_buckets::TokenBuckets,
    trust::{PublicAddress, client_address},
};
use axum::{
    extract::{Request, State},
    http::{HeaderMap, HeaderValue, Method, StatusCode, header},
    middleware::Next,
    response::{IntoResponse, Response},
};
use moka::sync::Cache;
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// Bytes that count as one scenario.
const SCENARIO_BYTES: f64 = 16_384.0;
/// What a plan is charged before it is known: who goes away before the answer has had it stored all the same.
const PLAN_DEPOSIT: f64 = 8.0;
/// Plans that are made here are held alone.
const PLAN_EXECUTION: &str = "/api/ogc/processes/plan/execution";
const DAY: Duration = Duration::from_secs(86_400);
/// Scenarios and plans of a day that are remembered as counted.
const MAX_COUNTED: u64 = 100_000;

/// What an answer says of the bytes that it had stored, where these are not those of the request's body; 0 where nothing new was.
#[derive(Clone, Copy, Debug)]
pub struct StoredLength(pub usize);

/// The shares of all clients, and what was counted today.
pub struct StorageQuota {
    shares: Arc<TokenBuckets>,
    counted: Cache<HeaderValue, ()>,
}

impl StorageQuota {
    /// Shares of so many scenarios a day; 0 for no limit.
    pub fn new(per_day: u32) -> Self {
        // Half of it at once, and half over the day, is all of it in any day.
        let half = f64::from(per_day.div_ceil(2));
        let counted = Cache::builder().max_capacity(MAX_COUNTED).time_to_live(DAY).build();
        let shares = TokenBuckets::new("stored", half / DAY.as_secs_f64(), half);
        Self { shares: Arc::new(shares), counted }
    }

    /// The shares, for who adds them up with those of other servers.
    pub(crate) fn shares(&self) -> &Arc<TokenBuckets> {
        &self.shares
    }

    /// What an answer counts: nothing where it is a refusal or what it names was counted today, else its length; `deposit` where
    /// nobody knows what became of it.
    fn count(&self, response: &Response, of_body: f64, deposit: f64) -> f64 {
        let length = response.extensions().get::<StoredLength>().map(|length| length.0);
        if response.extensions().get::<TookTooLong>().is_some() {
            return deposit;
        }
        if response.status() != StatusCode::CREATED || length == Some(0) {
            return 0.0;
        }
        if let Some(location) = response.headers().get(header::LOCATION) {
            if self.counted.contains_key(location) {
                return 0.0;
            }
            self.counted.insert(location.clone(), ());
        }
        length.map_or(of_body, |bytes| of_body.max((bytes as f64 / SCENARIO_BYTES).ceil()))
    }
}

/// Answers 429 to an address that had more scenarios and plans stored than its share of a day: storage is not without end. What is
/// refused, or was stored before, does not count. Known clients have their quotas. Pages of other sites store nothing but where
/// the operator names them: a visitor's share is not theirs to spend.
pub async fn limit_storage(
    State((state, quota)): State<(AppState, Arc<StorageQuota>)>,
    request: Request,
    next: Next,
) -> Response {
    let path = request.uri().path();
    let least = match *request.method() {
        Method::POST if path.ends_with("/scenarios") => 1.0,
        Method::POST if path.ends_with("/plans") || path == PLAN_EXECUTION => PLAN_DEPOSIT,
        _ => return next.run(request).await,
    };
    let is_listed = is_listed(request.headers().get(header::ORIGIN), &state.config);
    let address = request.extensions().get::<PublicAddress>();
    if !is_listed && is_of_another_site(request.headers(), address) {
        return ApiError::ForeignOrigin.into_response();
    }
    if path == PLAN_EXECUTION || is_draft(request.uri().query()) {
        return next.run(request).await;
    }
    let is_anyone = matches!(state.access.client(request.headers()), Ok(Client::Anyone));
    let address = client_address(&request, &state.config.trusted_proxies).filter(|_| is_anyone);
    let Some(party) = address.map(|address| Party::of_address(Some(address))) else {
        return next.run(request).await;
    };
    let length = request.extensions().get::<BodyLength>().map_or(0, |length| length.0);
    let of_body = (length as f64 / SCENARIO_BYTES).ceil().max(1.0);
    let deposit = of_body.max(least);
    if let Err(wait_s) = quota.shares.take(party, deposit, Instant::now()) {
        state.metrics.count_refused("keeping");
        return ApiError::StorageQuotaUsed { retry_after_s: wait_s.ceil() as u64 }.into_response();
    }
    let response = next.run(request).await;
    let count = quota.count(&response, of_body, deposit);
    // What turned out to be more or less than was taken.
    quota.shares.charge(party, count - deposit, Instant::now());
    response
}

/// Whether a plan is only to be held. Whoever says so in another way is charged a deposit and given it back.
fn is_draft(query: Option<&str>) -> bool {
    query.is_some_and(|query| query.split('&').any(|pair| pair == "keep=off"))
}

/// Whether a browser sends this for a page of another site.
fn is_of_another_site(headers: &HeaderMap, address: Option<&PublicAddress>) -> bool {
    let Some(origin) = headers.get(header::ORIGIN) else { return false };
    let Ok(origin) = origin.to_str() else { return true };
    if address.is_some_and(|address| address.is_origin(origin)) {
        return false;
    }
    // A proxy that tells nothing hides the scheme.
    let Some((_, authority)) = origin.split_once("://") else { return true };
    let host = headers.get(header::HOST).and_then(|host| host.to_str().ok());
    !host.is_some_and(|host| host.eq_ignore_ascii_case(authority.trim_end_matches('/')))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::HttpConfig;
    use axum::{body::Body, http::Extensions};

    fn created(location: &str, length: Option<usize>) -> Response {
        let mut response = Response::new(Body::empty());
        *response.status_mut() = StatusCode::CREATED;
        response.headers_mut().insert(header::LOCATION, location.parse().unwrap());
        if let Some(length) = length {
            response.extensions_mut().insert(StoredLength(length));
        }
        response
    }

    #[test]
    fn what_is_kept_counts_once_and_by_its_length() {
        let quota = StorageQuota::new(100);
        assert_eq!(quota.count(&created("/a", None), 3.0, 3.0), 3.0);
        assert_eq!(quota.count(&created("/a", None), 3.0, 3.0), 0.0, "stored before");
        assert_eq!(quota.count(&created("/b", Some(1)), 1.0, 8.0), 1.0);
        assert_eq!(quota.count(&created("/c", Some(40_000)), 1.0, 8.0), 3.0);
        assert_eq!(quota.count(&created("/d", Some(0)), 1.0, 8.0), 0.0, "nothing new was stored");
        assert_eq!(quota.count(&Response::new(Body::empty()), 1.0, 8.0), 0.0, "nothing was stored");
        let mut late = Response::new(Body::empty());
        late.extensions_mut().insert(TookTooLong);
        assert_eq!(quota.count(&late, 1.0, 8.0), 8.0, "it may be stored yet");
    }

    #[test]
    fn what_was_kept_beyond_the_share_is_waited_for() {
        let quota = StorageQuota::new(20);
        let client = Party::V4(1);
        let now = Instant::now();
        quota.shares.take(client, 1.0, now).unwrap();
        quota.shares.charge(client, 12.0, now);
        let wait_s = quota.shares.take(client, 1.0, now).unwrap_err();
        assert!((wait_s - 4.0 * 8640.0).abs() < 1.0, "{wait_s}");
        assert!(quota.shares.take(client, 1.0, now + Duration::from_secs(5 * 8640)).is_ok());
    }

    /// Twenty /64 of one household have twice one's share together, and its /48 four times; others have theirs.
    #[test]
    fn a_household_has_no_more_by_more_networks() {
        let quota = StorageQuota::new(20);
        let now = Instant::now();
        let had = |address: &dyn Fn(u32) -> String| {
            let party = |number| Party::of_address(Some(address(number).parse().unwrap()));
            (0..400).filter(|number| quota.shares.take(party(*number), 1.0, now).is_ok()).count()
        };
        assert_eq!(had(&|number| format!("2001:db8:7:ff{:02x}::1", 0x40 + number % 20)), 20);
        assert_eq!(
            had(&|number| format!("2001:db8:7:{:02x}00::1", number % 100)),
            20,
            "40 of the /48 in all"
        );
        assert_eq!(had(&|_| "2001:db8:8::1".to_owned()), 10);
        assert_eq!(had(&|_| "192.0.2.1".to_owned()), 10);
    }

    #[test]
    fn a_page_of_another_site_is_known_by_its_origin() {
        let headers = |origin: Option<&str>, host: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::HOST, host.parse().unwrap());
            if let Some(origin) = origin {
                headers.insert(header::ORIGIN, origin.parse().unwrap());
            }
            headers
        };
        let of_another = |origin, public: Option<&str>| {
            let headers = headers(origin, "127.0.0.1:8080");
            let config = HttpConfig { public_url: public.map(str::to_owned), ..HttpConfig::default() };
            let address = PublicAddress::of(&headers, &Extensions::new(), &config);
            is_of_another_site(&headers, Some(&address))
        };
        assert!(!of_another(None, None));
        assert!(!of_another(Some("http://127.0.0.1:8080"), None));
        assert!(of_another(Some("http://127.0.0.1:9090"), None) && of_another(Some("null"), None));
        let public = Some("https://sky.example.org/skyglow/");
        assert!(!of_another(Some("https://sky.example.org"), public));
        assert!(of_another(Some("https://sky.example.org.evil.net"), public));
    }
}
