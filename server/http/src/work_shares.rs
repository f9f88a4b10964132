//! Time for long work (plans, influences, rasters of layers) that each client may take: a bucket of seconds that fills as time goes by.

use crate::party::{Party, Tier};
use std::{
    collections::HashMap,
    sync::{Mutex, PoisonError},
    time::Instant,
};

/// Buckets that are stored before full ones are thrown away.
const MAX_BUCKETS: usize = 10_000;

/// The buckets of all clients, and of the networks around them: twice and four times as large.
#[derive(Debug)]
pub(crate) struct WorkShares {
    /// Seconds of work a second.
    rate: f64,
    burst_s: f64,
    buckets: Mutex<HashMap<Tier, (f64, Instant)>>,
}

/// What is left of a client's share of something, for the `RateLimit` headers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Left {
    /// Its name.
    pub(crate) name: &'static str,
    /// What there is at most, and in how many seconds it fills.
    pub(crate) quota: f64,
    pub(crate) window_s: f64,
    /// What is left of it.
    pub(crate) left: f64,
}

impl WorkShares {
    /// So many seconds of work a minute on average, and so many at once; no limit for 0 a minute.
    pub(crate) fn new(per_minute_s: f64, burst_s: f64) -> Self {
        Self { rate: per_minute_s / 60.0, burst_s: burst_s.max(1.0), buckets: Mutex::default() }
    }

    fn is_limited(&self, party: Party) -> bool {
        self.rate > 0.0 && party != Party::Operator
    }

    /// What is left for a client and the networks around it, seconds, whichever is least; below 0 where they took more.
    fn tokens(&self, party: Party, now: Instant) -> f64 {
        let buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        let of_tier = |tier: Tier| {
            buckets.get(&tier).map_or(self.burst_of(tier), |&bucket| self.filled(tier, bucket, now))
        };
        party.tiers().map(of_tier).into_iter().fold(self.burst_s, f64::min)
    }

    fn burst_of(&self, tier: Tier) -> f64 {
        self.burst_s * f64::from(1 << tier.0)
    }

    fn filled(&self, tier: Tier, (tokens, since): (f64, Instant), now: Instant) -> f64 {
        let rate = self.rate * f64::from(1 << tier.0);
        (tokens + rate * now.saturating_duration_since(since).as_secs_f64()).min(self.burst_of(tier))
    }

    /// Whether a client may begin something.
    ///
    /// # Errors
    /// The seconds until it may.
    pub(crate) fn check(&self, party: Party, now: Instant) -> Result<(), f64> {
        let tokens = self.tokens(party, now);
        if self.is_limited(party) && tokens <= 0.0 { Err((1.0 - tokens) / self.rate) } else { Ok(()) }
    }

    /// Takes what something took.
    pub(crate) fn charge(&self, party: Party, seconds: f64, now: Instant) {
        if !self.is_limited(party) {
            return;
        }
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if buckets.len() >= MAX_BUCKETS {
            buckets.retain(|tier, bucket| self.filled(*tier, *bucket, now) < self.burst_of(*tier));
        }
        for tier in party.tiers() {
            let bucket = buckets.entry(tier).or_insert((self.burst_of(tier), now));
            *bucket = (self.filled(tier, *bucket, now) - seconds, now);
        }
    }

    /// What is left for a client; None where there is no limit.
    pub(crate) fn left(&self, party: Party, now: Instant) -> Option<Left> {
        self.is_limited(party).then(|| Left {
            name: "work-seconds",
            quota: self.burst_s,
            window_s: self.burst_s / self.rate,
            left: self.tokens(party, now),
        })
    }
}

/// The values of the headers `RateLimit-Policy` and `RateLimit` (draft-ietf-httpapi-ratelimit-headers).
pub(crate) fn header_values(shares: &[Left]) -> (String, String) {
    let policy = |share: &Left| {
        format!("\"{}\";q={:.0};w={:.0}", share.name, share.quota.floor(), share.window_s.ceil().max(1.0))
    };
    let left = |share: &Left| {
        let left = share.left.clamp(0.0, share.quota);
        let full_in_s = (1.0 - left / share.quota) * share.window_s;
        format!("\"{}\";r={:.0};t={:.0}", share.name, left.floor(), full_in_s.ceil())
    };
    let list = |text: &dyn Fn(&Left) -> String| shares.iter().map(text).collect::<Vec<_>>().join(", ");
    (list(&policy), list(&left))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// Who took more time than there was waits until it is earned, and others do not.
    #[test]
    fn time_that_was_taken_is_waited_for() {
        let shares = WorkShares::new(30.0, 100.0);
        let [a, b] = [1, 2].map(Party::V4);
        let start = Instant::now();
        shares.charge(a, 60.0, start);
        assert_eq!(shares.check(a, start), Ok(()));
        shares.charge(a, 60.0, start);
        assert_eq!(shares.check(a, start), Err(42.0));
        assert_eq!(shares.check(b, start), Ok(()));
        assert_eq!(shares.check(a, start + Duration::from_secs(43)), Ok(()));
        shares.charge(Party::Operator, 1e6, start);
        assert_eq!(shares.check(Party::Operator, start), Ok(()));
        let none = WorkShares::new(0.0, 1.0);
        none.charge(a, 1e6, start);
        assert_eq!((none.check(a, start), none.left(a, start)), (Ok(()), None));
    }

    /// Networks of a household together have twice what one has.
    #[test]
    fn households_share_time() {
        let shares = WorkShares::new(30.0, 100.0);
        let start = Instant::now();
        (0..20).for_each(|network| shares.charge(Party::V6(0x7700 + network), 15.0, start));
        assert!(shares.check(Party::V6(0x7742), start).is_err());
        assert_eq!(shares.check(Party::V6(0x7842), start), Ok(()), "a neighbour");
    }

    #[test]
    fn headers_say_what_is_left() {
        let shares = WorkShares::new(30.0, 100.0);
        let start = Instant::now();
        shares.charge(Party::V4(1), 25.5, start);
        let work = shares.left(Party::V4(1), start).unwrap();
        let requests = Left { name: "requests", quota: 1000.0, window_s: 10.0, left: -3.0 };
        let (policy, left) = header_values(&[requests, work]);
        assert_eq!(policy, "\"requests\";q=1000;w=10, \"work-seconds\";q=100;w=200");
        assert_eq!(left, "\"requests\";r=0;t=10, \"work-seconds\";r=74;t=51");
    }
}
