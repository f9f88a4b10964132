//! Who may do more than read: the operator by a token, known clients by keys with a rate and a daily quota of their own.
//!
//! Secrets are kept as BLAKE3 hashes, and compared as such: the time that takes says nothing about them.

use crate::{
    error::ApiError,
    party::Party,
    shared_counts::{Counted, Taken},
};
use axum::http::{HeaderMap, header};
use serde::{Deserialize, Serialize};
use std::{
    sync::{Mutex, PoisonError},
    time::{Instant, SystemTime, UNIX_EPOCH},
};

/// A client that is known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ApiKey {
    /// Its name in the log.
    pub name: String,
    /// BLAKE3 hash of its key, hexadecimal.
    pub blake3: String,
    /// Requests a second on average.
    pub requests_per_second: f64,
    /// Requests at once.
    pub request_burst: u32,
    /// Requests a day (UTC); None for no limit.
    pub requests_per_day: Option<u64>,
}

/// Why keys cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AccessError {
    /// Not a hash.
    #[error("key \"{name}\": blake3 must be 64 hexadecimal digits")]
    BadHash {
        /// Whose.
        name: String,
    },
    /// A name or key twice, or no name.
    #[error("key \"{name}\": {reason}")]
    BadKey {
        /// Whose.
        name: String,
        /// What is wrong.
        reason: &'static str,
    },
    /// Short enough to be guessed.
    #[error("the operator's token must be {MIN_TOKEN_LENGTH} characters or longer, without spaces")]
    WeakToken,
}

/// BLAKE3 hash of a key, hexadecimal.
pub fn hash_of(key: &str) -> String {
    blake3::hash(key.as_bytes()).to_hex().to_string()
}

/// A token shorter than this could be guessed.
pub const MIN_TOKEN_LENGTH: usize = 20;
/// Longest name of a key.
const MAX_NAME_BYTES: usize = 64;

/// A key with what is left of its rate and quota.
#[derive(Debug)]
struct KnownKey {
    key: ApiKey,
    hash: blake3::Hash,
    state: Mutex<KeyState>,
}

#[derive(Clone, Copy, Debug)]
struct KeyState {
    tokens: f64,
    seen: Instant,
    day: u64,
    requests_today: u64,
    /// What other servers were not told: of the rate, and of the day's quota.
    untold: u64,
    untold_today: u64,
}

/// The operator and the known clients.
#[derive(Debug, Default)]
pub struct Access {
    operator: Option<blake3::Hash>,
    keys: Vec<KnownKey>,
}

/// Who asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Client<'a> {
    /// Somebody.
    Anyone,
    /// The operator.
    Operator,
    /// A known client, by its name.
    Key(&'a str),
}

impl Access {
    /// * `token`: the operator's; None where nobody may upload.
    ///
    /// # Errors
    /// [`AccessError`].
    pub fn new(token: Option<&str>, keys: Vec<ApiKey>) -> Result<Self, AccessError> {
        let is_weak = |token: &str| token.len() < MIN_TOKEN_LENGTH || token.contains(char::is_whitespace);
        if token.is_some_and(is_weak) {
            return Err(AccessError::WeakToken);
        }
        let mut known: Vec<KnownKey> = Vec::new();
        for key in keys {
            let refuse = |reason| AccessError::BadKey { name: key.name.clone(), reason };
            let hash = blake3::Hash::from_hex(&key.blake3)
                .map_err(|_| AccessError::BadHash { name: key.name.clone() })?;
            if key.name.is_empty() || key.name.len() > MAX_NAME_BYTES || key.name.contains(char::is_control) {
                return Err(refuse("a name has 1 to 64 characters"));
            }
            if !(key.requests_per_second > 0.0 && key.requests_per_second.is_finite())
                || key.request_burst == 0
            {
                return Err(refuse("its rate and burst must be above 0"));
            }
            if known.iter().any(|other| other.key.name == key.name || other.hash == hash) {
                return Err(refuse("its name or its hash is there twice"));
            }
            let state = KeyState {
                tokens: f64::from(key.request_burst),
                seen: Instant::now(),
                day: 0,
                requests_today: 0,
                untold: 0,
                untold_today: 0,
            };
            known.push(KnownKey { key, hash, state: Mutex::new(state) });
        }
        Ok(Self { operator: token.map(|token| blake3::hash(token.as_bytes())), keys: known })
    }

    /// Whether there is an operator at all.
    pub fn has_operator(&self) -> bool {
        self.operator.is_some()
    }

    /// Who a request is from: by `Authorization: Bearer`, or `X-Api-Key`.
    ///
    /// # Errors
    /// [`ApiError::Unauthorized`] for a token or key that nobody has.
    pub fn client(&self, headers: &HeaderMap) -> Result<Client<'_>, ApiError> {
        let Some(secret) = secret_of(headers)? else { return Ok(Client::Anyone) };
        let hash = blake3::hash(secret.as_bytes());
        // All are looked at, whichever is the one.
        let operator = self.operator.is_some_and(|operator| operator == hash);
        let key =
            self.keys.iter().fold(None, |found, known| if known.hash == hash { Some(known) } else { found });
        match (operator, key) {
            (true, _) => Ok(Client::Operator),
            (false, Some(known)) => Ok(Client::Key(&known.key.name)),
            (false, None) => Err(ApiError::Unauthorized),
        }
    }

    /// Counts a request of a known client.
    ///
    /// # Errors
    /// [`ApiError::TooManyRequests`] or [`ApiError::QuotaUsed`].
    pub fn count(&self, name: &str) -> Result<(), ApiError> {
        let now_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
        self.count_at(name, Instant::now(), now_s)
    }

    fn count_at(&self, name: &str, now: Instant, now_s: u64) -> Result<(), ApiError> {
        let Some(known) = self.keys.iter().find(|known| known.key.name == name) else { return Ok(()) };
        let key = &known.key;
        let mut state = known.state.lock().unwrap_or_else(PoisonError::into_inner);
        let elapsed_s = now.saturating_duration_since(state.seen).as_secs_f64();
        state.tokens = (state.tokens + elapsed_s * key.requests_per_second).min(f64::from(key.request_burst));
        state.seen = now;
        let (day, second) = (now_s / 86_400, now_s % 86_400);
        // A clock that was set back does not give the quota anew.
        if day > state.day {
            (state.day, state.requests_today, state.untold_today) = (day, 0, 0);
        }
        if key.requests_per_day.is_some_and(|most| state.requests_today >= most) {
            return Err(ApiError::QuotaUsed { retry_after_s: 86_400 - second });
        }
        if state.tokens < 1.0 {
            let wait_s = (1.0 - state.tokens) / key.requests_per_second;
            return Err(ApiError::TooManyRequests { retry_after_s: wait_s.ceil() as u64 });
        }
        state.tokens -= 1.0;
        state.requests_today += 1;
        state.untold += 1;
        state.untold_today += 1;
        Ok(())
    }
}

/// The day in the name of its count.
fn day_of(name: &str) -> Option<u64> {
    name.split(':').nth(1)?.parse().ok()
}

impl Counted for Access {
    fn begin(&self) {}

    fn drain(&self, name: &dyn Fn(Party) -> String) -> Vec<Taken> {
        let mut all = Vec::new();
        for known in &self.keys {
            let party = Party::of_key(&known.key.name);
            let mut state = known.state.lock().unwrap_or_else(PoisonError::into_inner);
            if state.untold == 0 && state.untold_today == 0 {
                continue;
            }
            let (rate, most) = (known.key.requests_per_second, f64::from(known.key.request_burst));
            for (name, rate, most, taken) in [
                (format!("key::{}", name(party)), rate, most, state.untold),
                (format!("day:{}:{}", state.day, name(party)), 0.0, 0.0, state.untold_today),
            ] {
                all.push(Taken { tier: (0, party), name, rate, most, taken: taken as f64 });
            }
            (state.untold, state.untold_today) = (0, 0);
        }
        all
    }

    fn adopt(&self, taken: &Taken, sum: f64, now: Instant) {
        let Some(known) = self.keys.iter().find(|known| Party::of_key(&known.key.name) == taken.tier.1)
        else {
            return;
        };
        let mut state = known.state.lock().unwrap_or_else(PoisonError::into_inner);
        if taken.rate > 0.0 {
            (state.tokens, state.seen) = (sum - state.untold as f64, now);
        } else if day_of(&taken.name) == Some(state.day) {
            state.requests_today = sum as u64 + state.untold_today;
        }
    }

    fn put_back(&self, taken: &Taken) {
        let of_key = |known: &&KnownKey| Party::of_key(&known.key.name) == taken.tier.1;
        if let Some(known) = self.keys.iter().find(of_key) {
            let mut state = known.state.lock().unwrap_or_else(PoisonError::into_inner);
            if day_of(&taken.name) == Some(state.day) {
                state.untold_today += taken.taken as u64;
            }
        }
    }
}

/// The token or key that a request carries.
fn secret_of(headers: &HeaderMap) -> Result<Option<&str>, ApiError> {
    let bearer = |value: &'_ str| value.get(..7).is_some_and(|scheme| scheme.eq_ignore_ascii_case("bearer "));
    // Other schemes are between the client and a proxy.
    if let Some(value) = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok())
        && bearer(value)
    {
        return Ok(value.get(7..).map(str::trim));
    }
    match headers.get("x-api-key") {
        Some(value) => value.to_str().map(Some).map_err(|_| ApiError::Unauthorized),
        None => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;
    use std::time::Duration;

    const TOKEN: &str = "a-token-of-some-length-1234";

    fn key(name: &str, secret: &str) -> ApiKey {
        ApiKey {
            name: name.to_owned(),
            blake3: hash_of(secret),
            requests_per_second: 2.0,
            request_burst: 3,
            requests_per_day: Some(5),
        }
    }

    fn with(name: &'static str, value: &str) -> HeaderMap {
        HeaderMap::from_iter([(name.parse().unwrap(), HeaderValue::from_str(value).unwrap())])
    }

    /// The operator and known clients are told from anyone and wrong secrets refused.
    #[test]
    fn clients_are_told_apart_by_their_secrets() {
        let token = TOKEN;
        let access = Access::new(Some(token), vec![key("city", "k1"), key("park", "k2")]).unwrap();
        assert_eq!(access.client(&HeaderMap::new()), Ok(Client::Anyone));
        assert_eq!(access.client(&with("authorization", &format!("Bearer {token}"))), Ok(Client::Operator));
        assert_eq!(access.client(&with("authorization", "bearer k2")), Ok(Client::Key("park")));
        assert_eq!(access.client(&with("x-api-key", "k1")), Ok(Client::Key("city")));
        for (name, value) in [("authorization", "Bearer k3"), ("authorization", "Bearer "), ("x-api-key", "")]
        {
            assert_eq!(access.client(&with(name, value)), Err(ApiError::Unauthorized), "{name} {value}");
        }
        // What is between a client and a proxy is nobody's business here.
        assert_eq!(access.client(&with("authorization", "Basic azE=")), Ok(Client::Anyone));
        // Without a token in force no text is the operator's.
        assert_eq!(
            Access::default().client(&with("authorization", &format!("Bearer {token}"))),
            Err(ApiError::Unauthorized)
        );
    }

    /// Keys have a rate and a quota of a day that a clock set back does not renew.
    #[test]
    fn keys_have_a_rate_and_a_daily_quota() {
        let access = Access::new(None, vec![key("city", "k1"), key("park", "k2")]).unwrap();
        let (start, noon_s) = (Instant::now(), 20_000 * 86_400 + 43_200);
        for _ in 0..3 {
            assert_eq!(access.count_at("city", start, noon_s), Ok(()));
        }
        assert_eq!(
            access.count_at("city", start, noon_s),
            Err(ApiError::TooManyRequests { retry_after_s: 1 })
        );
        assert_eq!(access.count_at("park", start, noon_s), Ok(()));
        let later = start + Duration::from_secs(60);
        assert_eq!(access.count_at("city", later, noon_s + 60), Ok(()));
        assert_eq!(access.count_at("city", later, noon_s + 60), Ok(()));
        let used = Err(ApiError::QuotaUsed { retry_after_s: 43_140 });
        assert_eq!(access.count_at("city", later, noon_s + 60), used);
        assert!(access.count_at("city", later, noon_s - 86_400).is_err());
        assert_eq!(access.count_at("city", later, noon_s + 86_400), Ok(()));
    }

    /// Keys and tokens that cannot be meant are refused by name.
    #[test]
    fn wrong_keys_and_tokens_are_refused_by_name() {
        let refused =
            |key: ApiKey| Access::new(None, vec![self::key("city", "k1"), key]).unwrap_err().to_string();
        assert!(refused(ApiKey { blake3: "12".into(), ..key("park", "k2") }).contains("park"));
        assert!(refused(key("city", "k2")).contains("twice"));
        assert!(refused(key("park", "k1")).contains("twice"));
        assert!(refused(key("", "k2")).contains("1 to 64"));
        assert!(refused(ApiKey { requests_per_second: f64::NAN, ..key("park", "k2") }).contains("above 0"));
        for weak in ["short", "with a space in the middle"] {
            assert_eq!(Access::new(Some(weak), Vec::new()).unwrap_err(), AccessError::WeakToken);
        }
    }
}
