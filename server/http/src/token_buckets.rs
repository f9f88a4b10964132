//! Token buckets (Turner 1986) for shares of anything by time: one for each client, and larger ones for the networks around it.

use crate::{
    party::{Party, Tier},
    shared_counts::{Counted, Taken},
};
use std::{
    collections::HashMap,
    sync::{Mutex, MutexGuard, PoisonError},
    time::Instant,
};

/// Buckets that are remembered before full ones are forgotten.
const MAX_BUCKETS: usize = 30_000;

/// The buckets of all clients. A /56 has twice, and a /48 four times what one client has.
#[derive(Debug)]
pub struct TokenBuckets {
    name: &'static str,
    tokens_per_second: f64,
    burst: f64,
    buckets: Mutex<HashMap<Tier, Bucket>>,
    /// What was taken since other servers were told, where there are some.
    untold: Mutex<Option<HashMap<Tier, f64>>>,
}

/// Tokens, below 0 where more was taken than there was, as of when.
#[derive(Clone, Copy, Debug)]
struct Bucket {
    tokens: f64,
    seen: Instant,
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

impl TokenBuckets {
    /// `tokens_per_second` on average and `burst` at once, 1 or more; no limit for a rate of 0.
    ///
    /// * `name`: of what is shared, as headers have it.
    pub(crate) fn new(name: &'static str, tokens_per_second: f64, burst: f64) -> Self {
        Self {
            name,
            tokens_per_second,
            burst: burst.max(1.0),
            buckets: Mutex::default(),
            untold: Mutex::default(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<Tier, Bucket>> {
        self.buckets.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_limited(&self, party: Party) -> bool {
        self.tokens_per_second > 0.0 && party != Party::Operator
    }

    /// What a tier has for each token of one client.
    fn factor(tier: Tier) -> f64 {
        f64::from(1 << tier.0)
    }

    fn filled(&self, tier: Tier, bucket: Option<&Bucket>, now: Instant) -> f64 {
        let most = self.burst * Self::factor(tier);
        bucket.map_or(most, |bucket| {
            let elapsed_s = now.saturating_duration_since(bucket.seen).as_secs_f64();
            (bucket.tokens + elapsed_s * self.tokens_per_second * Self::factor(tier)).min(most)
        })
    }

    /// Seconds until a client and the networks around it have so many tokens.
    fn wait_s(&self, buckets: &HashMap<Tier, Bucket>, party: Party, count: f64, now: Instant) -> f64 {
        let of_tier = |tier: Tier| {
            let missing = count - self.filled(tier, buckets.get(&tier), now);
            missing / (self.tokens_per_second * Self::factor(tier))
        };
        party.tiers().map(of_tier).into_iter().fold(0.0, f64::max)
    }

    fn subtract(&self, buckets: &mut HashMap<Tier, Bucket>, party: Party, count: f64, now: Instant) {
        self.make_room(buckets, now);
        for tier in party.tiers() {
            let tokens = self.filled(tier, buckets.get(&tier), now) - count;
            buckets.insert(tier, Bucket { tokens: tokens.min(self.burst * Self::factor(tier)), seen: now });
        }
        self.note(party, count);
    }

    /// Notes for other servers what was taken; where it was nothing, how much is left is asked all the same.
    fn note(&self, party: Party, count: f64) {
        if let Some(untold) = self.untold().as_mut() {
            for tier in party.tiers() {
                *untold.entry(tier).or_default() += count;
            }
        }
    }

    fn untold(&self) -> MutexGuard<'_, Option<HashMap<Tier, f64>>> {
        self.untold.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes tokens, all that a client ever has at most.
    ///
    /// # Errors
    /// Seconds until there are so many.
    pub(crate) fn take(&self, party: Party, count: f64, now: Instant) -> Result<(), f64> {
        if !self.is_limited(party) {
            return Ok(());
        }
        let mut buckets = self.lock();
        let count = count.min(self.burst);
        let wait_s = self.wait_s(&buckets, party, count, now);
        if wait_s > 0.0 {
            self.note(party, 0.0);
            return Err(wait_s);
        }
        self.subtract(&mut buckets, party, count, now);
        Ok(())
    }

    /// Whether anything is left, so that what is charged afterwards may begin.
    ///
    /// # Errors
    /// Seconds until there is a token.
    pub(crate) fn check(&self, party: Party, now: Instant) -> Result<(), f64> {
        let buckets = self.lock();
        let is_empty = |tier: Tier| self.filled(tier, buckets.get(&tier), now) <= 0.0;
        if self.is_limited(party) && party.tiers().into_iter().any(is_empty) {
            self.note(party, 0.0);
            return Err(self.wait_s(&buckets, party, 1.0, now));
        }
        Ok(())
    }

    /// Takes tokens that may not be there any more, for which the client then waits the longer; gives back where negative.
    pub(crate) fn charge(&self, party: Party, count: f64, now: Instant) {
        if self.is_limited(party) {
            self.subtract(&mut self.lock(), party, count, now);
        }
    }

    /// What is left for a client; None where there is no limit.
    pub(crate) fn left(&self, party: Party, now: Instant) -> Option<Left> {
        let buckets = self.is_limited(party).then(|| self.lock())?;
        let of_tier = |tier: Tier| self.filled(tier, buckets.get(&tier), now);
        let left = party.tiers().map(of_tier).into_iter().fold(self.burst, f64::min);
        Some(Left { name: self.name, quota: self.burst, window_s: self.burst / self.tokens_per_second, left })
    }

    /// Where there are too many clients to remember, forgets whose buckets are full, and then the half that has taken least.
    fn make_room(&self, buckets: &mut HashMap<Tier, Bucket>, now: Instant) {
        if buckets.len() < MAX_BUCKETS {
            return;
        }
        let level = |tier: Tier, bucket: &Bucket| self.filled(tier, Some(bucket), now) / Self::factor(tier);
        buckets.retain(|tier, bucket| level(*tier, bucket) < self.burst);
        if buckets.len() >= MAX_BUCKETS {
            let mut levels: Vec<f64> = buckets.iter().map(|(tier, bucket)| level(*tier, bucket)).collect();
            let middle = levels.len() / 2;
            let (_, median, _) = levels.select_nth_unstable_by(middle, f64::total_cmp);
            buckets.retain(|tier, bucket| level(*tier, bucket) < *median);
        }
    }
}

impl Counted for TokenBuckets {
    fn begin(&self) {
        self.untold().get_or_insert_default();
    }

    fn drain(&self, name: &dyn Fn(Party) -> String) -> Vec<Taken> {
        let untold = self.untold().as_mut().map(std::mem::take).unwrap_or_default();
        let taken = |(tier, taken): (Tier, f64)| {
            let (rate, most) = (self.tokens_per_second * Self::factor(tier), self.burst * Self::factor(tier));
            Taken { tier, name: format!("{}:{}:{}", self.name, tier.0, name(tier.1)), rate, most, taken }
        };
        untold.into_iter().map(taken).collect()
    }

    fn adopt(&self, taken: &Taken, sum: f64, now: Instant) {
        let mut buckets = self.lock();
        let since = self.untold().as_ref().and_then(|untold| untold.get(&taken.tier).copied());
        let tokens = (sum - since.unwrap_or_default()).min(taken.most);
        buckets.insert(taken.tier, Bucket { tokens, seen: now });
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

    fn buckets(tokens_per_second: f64, burst: f64) -> TokenBuckets {
        TokenBuckets::new("tokens", tokens_per_second, burst)
    }

    /// A burst is free, then the rate holds, for each client alone.
    #[test]
    fn the_rate_holds_after_a_burst_by_client() {
        let buckets = buckets(2.0, 3.0);
        let start = Instant::now();
        let [a, b] = [1, 2].map(Party::V4);
        let take = |party, after_ms| buckets.take(party, 1.0, start + Duration::from_millis(after_ms));
        assert!((0..3).all(|_| take(a, 0).is_ok()));
        assert!((take(a, 0).unwrap_err() - 0.5).abs() < 1e-9);
        assert!(take(b, 0).is_ok());
        assert!(take(a, 600).is_ok());
        assert!(take(a, 700).is_err());
    }

    /// A rate of 0 is no limit, and the operator has none.
    #[test]
    fn a_rate_of_0_is_no_limit() {
        let (none, now) = (buckets(0.0, 1.0), Instant::now());
        assert!((0..100).all(|_| none.take(Party::V4(1), 1.0, now).is_ok()));
        none.charge(Party::V4(1), 1e6, now);
        assert_eq!((none.check(Party::V4(1), now), none.left(Party::V4(1), now)), (Ok(()), None));
        let some = buckets(1.0, 1.0);
        some.charge(Party::Operator, 1e6, now);
        assert_eq!(some.check(Party::Operator, now), Ok(()));
    }

    /// Who took more than there was waits until it is earned, others do not, and what is given back fills no more than the bucket.
    #[test]
    fn what_was_taken_is_waited_for() {
        let buckets = buckets(0.5, 100.0);
        let [a, b] = [1, 2].map(Party::V4);
        let start = Instant::now();
        buckets.charge(a, 60.0, start);
        assert_eq!(buckets.check(a, start), Ok(()));
        buckets.charge(a, 60.0, start);
        assert_eq!(buckets.check(a, start), Err(42.0));
        assert_eq!(buckets.check(b, start), Ok(()));
        assert_eq!(buckets.check(a, start + Duration::from_secs(43)), Ok(()));
        buckets.charge(a, -500.0, start);
        assert_eq!(buckets.left(a, start).map(|left| left.left), Some(100.0));
    }

    /// The networks of a household have twice what one has, and its site four times; a neighbour has its own.
    #[test]
    fn households_share() {
        let buckets = buckets(0.5, 100.0);
        let start = Instant::now();
        (0..20).for_each(|network| buckets.charge(Party::V6(0x7700 + network), 15.0, start));
        assert!(buckets.check(Party::V6(0x7742), start).is_err());
        assert_eq!(buckets.check(Party::V6(0x7842), start), Ok(()));
        let taken = (0..1_000).filter(|of| buckets.take(Party::V6(0x9_0000 + of * 7), 1.0, start).is_ok());
        assert_eq!(taken.count(), 400);
    }

    /// More clients than are remembered do not give back what one of them took.
    #[test]
    fn who_took_much_is_not_forgotten() {
        let buckets = buckets(1e-6, 10.0);
        let start = Instant::now();
        assert!(buckets.take(Party::V4(1), 10.0, start).is_ok());
        for number in 0..MAX_BUCKETS as u64 {
            assert!(buckets.take(Party::V6(number << 16), 1.0, start).is_ok());
        }
        assert!(buckets.take(Party::V4(1), 1.0, start).is_err());
        assert!(buckets.lock().len() <= MAX_BUCKETS + 3);
    }

    /// What others took is gone here too, and what is taken while they are told is not given back.
    #[test]
    fn what_others_took_is_gone_here_too() {
        let (buckets, start) = (buckets(1.0, 10.0), Instant::now());
        let name = |party: Party| format!("{party:?}");
        buckets.charge(Party::V4(1), 1.0, start);
        assert_eq!(buckets.drain(&name), [], "nobody is to be told");
        buckets.begin();
        buckets.charge(Party::V4(1), 3.0, start);
        let told = buckets.drain(&name);
        assert_eq!(
            told.iter().map(|taken| (taken.taken, taken.rate, taken.most)).fold(
                0.0,
                |sum, (taken, rate, most)| {
                    assert_eq!(most, 10.0 * rate);
                    sum + taken
                }
            ),
            9.0
        );
        assert!(told.iter().any(|taken| taken.name == "tokens:2:V4(1)"));
        buckets.charge(Party::V4(1), 1.0, start);
        told.iter().for_each(|taken| buckets.adopt(taken, 2.0, start));
        assert_eq!(buckets.left(Party::V4(1), start).map(|left| left.left), Some(1.0));
        buckets.drain(&name);
        assert!(buckets.take(Party::V4(1), 5.0, start).is_err());
        assert!(buckets.drain(&name).iter().all(|taken| taken.taken == 0.0), "who is refused asks anew");
    }

    #[test]
    fn headers_say_what_is_left() {
        let shares = TokenBuckets::new("work-seconds", 0.5, 100.0);
        let start = Instant::now();
        shares.charge(Party::V4(1), 25.5, start);
        let work = shares.left(Party::V4(1), start).unwrap();
        let requests = Left { name: "requests", quota: 1000.0, window_s: 10.0, left: -3.0 };
        let (policy, left) = header_values(&[requests, work]);
        assert_eq!(policy, "\"requests\";q=1000;w=10, \"work-seconds\";q=100;w=200");
        assert_eq!(left, "\"requests\";r=0;t=10, \"work-seconds\";r=74;t=51");
    }
}
