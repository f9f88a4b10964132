//! Plans that somebody tries one after the other, such as with a slider: held in memory for some minutes, never on disk.

use super::change_id::ChangeId;
use super::stored::StoredPlan;
use moka::policy::EvictionPolicy;
use moka::sync::Cache;
use std::sync::Arc;
use std::time::Duration;

/// How long a draft is held after it was last asked for.
const IDLE: Duration = Duration::from_secs(600);
/// Bytes that all of them take together at most, about.
const MAX_BYTES: u64 = 128 << 20;
/// About what a draft takes besides its pixels and what is said of it.
const BYTES_AT_LEAST: usize = 4096;
/// About how much longer JSON is in memory than as text.
const JSON_TIMES: usize = 4;

/// A draft, and since when it is held, seconds since 1970.
pub(super) type Held = Arc<(StoredPlan, u64)>;

/// The drafts.
#[derive(Clone, Debug)]
pub(super) struct Drafts(Cache<ChangeId, Held>);

impl Default for Drafts {
    fn default() -> Self {
        let bytes = |_: &ChangeId, held: &Held| u32::try_from(bytes_of(&held.0)).unwrap_or(u32::MAX);
        // The newest is the one that is asked for next, however often others were.
        let cache = Cache::builder().weigher(bytes).max_capacity(MAX_BYTES).time_to_idle(IDLE);
        Self(cache.eviction_policy(EvictionPolicy::lru()).build())
    }
}

fn bytes_of(plan: &StoredPlan) -> usize {
    let of_pixel = size_of_val(&plan.factors.codes[..]) + size_of_val(&plan.factors.factors[..]);
    let of_answer = JSON_TIMES * plan.answer.to_string().len();
    BYTES_AT_LEAST + of_answer + of_pixel + size_of_val(&plan.effects[..])
}

impl Drafts {
    pub(super) fn hold(&self, id: &ChangeId, plan: StoredPlan, now_unix_s: u64) {
        self.0.insert(id.clone(), Arc::new((plan, now_unix_s)));
    }

    pub(super) fn get(&self, id: &ChangeId) -> Option<Held> {
        self.0.get(id)
    }
}
