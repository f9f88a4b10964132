//! Shares of clients counted over several servers: each counts by itself, and ten times a second they add up in Valkey what was
//! taken (distributed rate limiting: Raghavan et al. 2007). No request waits for that. Who asks several servers at once may have
//! his burst of each for a tenth of a second; what was too much is owed.

use crate::{
    party::{Party, Tier},
    valkey::Valkey,
};
use redis::cmd;
use std::{
    sync::{Arc, Weak},
    time::{Duration, Instant},
};

/// How often servers add up what was taken.
const EVERY: Duration = Duration::from_millis(100);
/// Shares that are added up by one question.
const AT_ONCE: usize = 256;

/// For each name a rate, the most there is at once, and what was taken; the answers are what is left. With a rate of 0 what was
/// taken since the name is known, which is two days at most. Times are Valkey's own.
const SCRIPT: &str = r"
local time = redis.call('TIME')
local now = time[1] + time[2] / 1e6
local left = {}
for i, name in ipairs(KEYS) do
  local rate, most, taken = tonumber(ARGV[3 * i - 2]), tonumber(ARGV[3 * i - 1]), tonumber(ARGV[3 * i])
  if rate == 0 then
    left[i] = redis.call('INCRBYFLOAT', name, taken)
    redis.call('EXPIRE', name, 172800)
  else
    local known = redis.call('HMGET', name, 'tokens', 'seen')
    local tokens, seen = tonumber(known[1]) or most, tonumber(known[2]) or now
    tokens = math.min(most, math.min(most, tokens + math.max(0, now - seen) * rate) - taken)
    redis.call('HSET', name, 'tokens', string.format('%.9f', tokens), 'seen', string.format('%.6f', now))
    redis.call('PEXPIRE', name, math.ceil(1000 * (most - tokens) / rate) + 1000)
    left[i] = string.format('%.9f', tokens)
  end
end
return left
";

/// What was taken of a share since servers added up last.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Taken {
    /// Which, as [`Counted::adopt`] knows it.
    pub(crate) tier: Tier,
    /// What it is called: the same at all servers, and without an address.
    pub(crate) name: String,
    /// Tokens a second and at most; a rate of 0 where it only counts up.
    pub(crate) rate: f64,
    pub(crate) most: f64,
    pub(crate) taken: f64,
}

/// What has shares that several servers count.
pub(crate) trait Counted: Send + Sync {
    /// From now on notes what is taken.
    fn begin(&self);

    /// What was taken since this was asked last.
    ///
    /// * `name`: of a party, which says no address.
    fn drain(&self, name: &dyn Fn(Party) -> String) -> Vec<Taken>;

    /// What is left of a share, or was counted of it, at all servers together.
    fn adopt(&self, taken: &Taken, sum: f64, now: Instant);

    /// What only counts up could not be told: it is to be told the next time.
    fn put_back(&self, _taken: &Taken) {}
}

/// Adds up what servers counted until nobody counts here any more, on a thread of its own.
pub(crate) fn add_up(valkey: Arc<Valkey>, counted: Vec<Weak<dyn Counted>>) {
    for one in counted.iter().filter_map(Weak::upgrade) {
        one.begin();
    }
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(EVERY);
            let there: Vec<_> = counted.iter().filter_map(Weak::upgrade).collect();
            if there.is_empty() {
                return;
            }
            for one in there {
                add_up_once(&valkey, &*one);
            }
        }
    });
}

fn add_up_once(valkey: &Valkey, counted: &dyn Counted) {
    let name = |party: Party| {
        let hash = blake3::keyed_hash(valkey.key(), format!("{party:?}").as_bytes());
        hash.to_hex()[..24].to_owned()
    };
    for some in counted.drain(&name).chunks(AT_ONCE) {
        let mut eval = cmd("EVAL");
        eval.arg(SCRIPT).arg(some.len());
        for taken in some {
            eval.arg(format!("skyglow:share:{}", taken.name));
        }
        for taken in some {
            eval.arg(taken.rate).arg(taken.most).arg(taken.taken);
        }
        let now = Instant::now();
        match valkey.ask::<Vec<f64>>(&eval) {
            Some(sums) => some.iter().zip(sums).for_each(|(taken, sum)| counted.adopt(taken, sum, now)),
            // Buckets fill while it is away: what was taken long ago is not owed.
            None => some.iter().filter(|taken| taken.rate == 0.0).for_each(|taken| counted.put_back(taken)),
        }
    }
}
