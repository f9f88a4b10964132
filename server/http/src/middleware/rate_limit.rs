//! A token bucket for each client address: the connection's own or, behind trusted proxies, the one that they name.

use crate::{
    access::Client,
    asker::Asker,
    error::ApiError,
    party::Party,
    state::AppState,
    trust::client_address,
    work_shares::{Left, header_values},
};
use axum::{
    extract::{Request, State},
    http::HeaderValue,
    middleware::Next,
    response::{IntoResponse, Response},
};
use std::{
    collections::HashMap,
    net::{IpAddr, Ipv6Addr},
    sync::{Arc, Mutex, PoisonError},
    time::Instant,
};

/// Buckets that are stored before full ones are thrown away.
const MAX_BUCKETS: usize = 10_000;

#[derive(Clone, Copy, Debug)]
struct Bucket {
    tokens: f64,
    seen: Instant,
}

/// The buckets of all clients.
#[derive(Debug)]
pub struct RateLimiter {
    tokens_per_second: f64,
    burst: f64,
    buckets: Mutex<HashMap<IpAddr, Bucket>>,
}

impl RateLimiter {
    /// `tokens_per_second` on average and `burst` at once; no limit for a rate of 0.
    pub fn new(tokens_per_second: f64, burst: u32) -> Self {
        Self { tokens_per_second, burst: f64::from(burst.max(1)), buckets: Mutex::default() }
    }

    /// Takes a token; the seconds to wait where there is none.
    ///
    /// # Errors
    /// Seconds until there is one.
    pub fn take(&self, client: IpAddr, now: Instant) -> Result<(), f64> {
        self.take_some(client, 1.0, now)
    }

    /// What is left for a client; None where there is no limit.
    fn left(&self, client: IpAddr, now: Instant) -> Option<Left> {
        if self.tokens_per_second.is_nan() || self.tokens_per_second <= 0.0 {
            return None;
        }
        let buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        let left = buckets.get(&group(client)).map_or(self.burst, |bucket| {
            bucket.tokens + now.saturating_duration_since(bucket.seen).as_secs_f64() * self.tokens_per_second
        });
        let window_s = self.burst / self.tokens_per_second;
        Some(Left { name: "requests", quota: self.burst, window_s, left })
    }

    /// Gives tokens back that were taken.
    pub(super) fn give_back(&self, client: IpAddr, count: f64) {
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(bucket) = buckets.get_mut(&group(client)) {
            bucket.tokens = (bucket.tokens + count.min(self.burst)).min(self.burst);
        }
    }

    /// Takes tokens that may not be there any more: the client then waits the longer for the next.
    pub(super) fn charge(&self, client: IpAddr, count: f64) {
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(bucket) = buckets.get_mut(&group(client)) {
            bucket.tokens -= count;
        }
    }

    /// Forgets the half that has taken least: too many clients to remember, and who took much is remembered.
    fn forget_the_fullest(&self, buckets: &mut HashMap<IpAddr, Bucket>, now: Instant) {
        let level = |bucket: &Bucket| {
            bucket.tokens + now.saturating_duration_since(bucket.seen).as_secs_f64() * self.tokens_per_second
        };
        let mut levels: Vec<f64> = buckets.values().map(level).collect();
        let middle = levels.len() / 2;
        let (_, median, _) = levels.select_nth_unstable_by(middle, f64::total_cmp);
        buckets.retain(|_, bucket| level(bucket) < *median);
    }

    /// Takes several tokens at once, all there ever are at most.
    ///
    /// # Errors
    /// Seconds until there are so many.
    pub(super) fn take_some(&self, client: IpAddr, count: f64, now: Instant) -> Result<(), f64> {
        if self.tokens_per_second.is_nan() || self.tokens_per_second <= 0.0 {
            return Ok(());
        }
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if buckets.len() >= MAX_BUCKETS {
            let refilled_s = self.burst / self.tokens_per_second;
            buckets.retain(|_, bucket| (now - bucket.seen).as_secs_f64() < refilled_s);
            if buckets.len() >= MAX_BUCKETS {
                self.forget_the_fullest(&mut buckets, now);
            }
        }
        let bucket = buckets.entry(group(client)).or_insert(Bucket { tokens: self.burst, seen: now });
        let elapsed_s = now.saturating_duration_since(bucket.seen).as_secs_f64();
        bucket.tokens = (bucket.tokens + elapsed_s * self.tokens_per_second).min(self.burst);
        bucket.seen = now;
        let count = count.min(self.burst);
        if bucket.tokens >= count {
            bucket.tokens -= count;
            Ok(())
        } else {
            Err((count - bucket.tokens) / self.tokens_per_second)
        }
    }
}

/// One client holds a whole /64 of IPv6.
fn group(client: IpAddr) -> IpAddr {
    match client.to_canonical() {
        IpAddr::V6(address) => IpAddr::V6(Ipv6Addr::from(u128::from(address) >> 64 << 64)),
        v4 => v4,
    }
}

/// The name of the key that a request came with, for the log.
#[derive(Clone, Debug)]
pub struct KnownClient(pub String);

/// Answers 429 to a client that sends too much, and 401 to one whose token or key nobody has. Known clients have rates of their
/// own, the operator none.
pub async fn limit_rate(
    State((state, limiter)): State<(AppState, Arc<RateLimiter>)>,
    request: Request,
    next: Next,
) -> Response {
    let address = client_address(&request, &state.config.trusted_proxies);
    // Secrets are guessed at no higher rate than anything else is asked.
    let of_address =
        |address: Option<IpAddr>| match address.map(|address| limiter.take(address, Instant::now())) {
            Some(Err(wait_s)) => Err(ApiError::TooManyRequests { retry_after_s: wait_s.ceil() as u64 }),
            _ => Ok(()),
        };
    let mut known = None;
    let mut party = Party::of_address(address);
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
        Ok(Client::Anyone) => of_address(address),
        Err(error) => of_address(address).and(Err(error)),
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
    let requests = address.filter(|_| matches!(party, Party::V4(_) | Party::V6(_)));
    let requests = requests.and_then(|address| limiter.left(address, now));
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// A burst is free then the rate holds for each client alone.
    #[test]
    fn the_rate_holds_after_a_burst_by_client() {
        let limiter = RateLimiter::new(2.0, 3);
        let start = Instant::now();
        let (a, b): (IpAddr, IpAddr) = ("10.0.0.1".parse().unwrap(), "10.0.0.2".parse().unwrap());
        for _ in 0..3 {
            assert!(limiter.take(a, start).is_ok());
        }
        let wait_s = limiter.take(a, start).unwrap_err();
        assert!((wait_s - 0.5).abs() < 1e-9);
        assert!(limiter.take(b, start).is_ok());
        assert!(limiter.take(a, start + Duration::from_millis(600)).is_ok());
        assert!(limiter.take(a, start + Duration::from_millis(700)).is_err());
    }

    /// More clients than are remembered do not give back what one of them took.
    #[test]
    fn who_took_much_is_not_forgotten() {
        let limiter = RateLimiter::new(1e-6, 10);
        let start = Instant::now();
        let heavy: IpAddr = "192.0.2.1".parse().unwrap();
        assert!(limiter.take_some(heavy, 10.0, start).is_ok());
        for number in 0..3 * MAX_BUCKETS as u32 {
            let other = IpAddr::from(Ipv6Addr::from(u128::from(number) << 64));
            assert!(limiter.take(other, start).is_ok());
        }
        assert!(limiter.take(heavy, start).is_err());
    }

    /// A rate of 0 is no limit and addresses of one network are one client.
    #[test]
    fn rate_0_is_no_limit_and_a_network_one_client() {
        let none = RateLimiter::new(0.0, 1);
        let client: IpAddr = "2001:db8::1".parse().unwrap();
        assert!((0..100).all(|_| none.take(client, Instant::now()).is_ok()));
        let one = RateLimiter::new(0.1, 1);
        let now = Instant::now();
        assert!(one.take(client, now).is_ok());
        assert!(one.take("2001:db8::2".parse().unwrap(), now).is_err());
    }
}
