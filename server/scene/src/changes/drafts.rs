//! Draft plans, such as those tried with a slider: held in memory for some minutes (LRU), never on disk.

use super::change_id::ChangeId;
use super::stored::StoredPlan;
use moka::policy::EvictionPolicy;
use moka::sync::Cache;
use std::sync::Arc;
use std::time::Duration;

/// How long a draft is held after its last use.
const IDLE: Duration = Duration::from_secs(600);
/// Bytes that all of them take together at most, about.
const MAX_BYTES: u64 = 128 << 20;
/// About what a draft takes in addition to its pixels and its answer.
const OVERHEAD_BYTES: usize = 4096;
/// About how much larger JSON is in memory than as text.
const JSON_MEMORY_FACTOR: usize = 4;

/// A draft, and since when it is held, seconds since 1970.
pub(super) type Held = Arc<(StoredPlan, u64)>;

/// The drafts.
#[derive(Clone, Debug)]
pub(super) struct Drafts(Cache<ChangeId, Held>);

impl Default for Drafts {
    fn default() -> Self {
        let bytes = |_: &ChangeId, held: &Held| u32::try_from(bytes_of(&held.0)).unwrap_or(u32::MAX);
        // The newest is the one requested next, however often others were.
        let cache = Cache::builder().weigher(bytes).max_capacity(MAX_BYTES).time_to_idle(IDLE);
        Self(cache.eviction_policy(EvictionPolicy::lru()).build())
    }
}

fn bytes_of(plan: &StoredPlan) -> usize {
    let of_pixel = size_of_val(&plan.factors.codes[..]) + size_of_val(&plan.factors.factors[..]);
    let of_answer = JSON_MEMORY_FACTOR * plan.answer.to_string().len();
    OVERHEAD_BYTES + of_answer + of_pixel + size_of_val(&plan.effects[..])
}

impl Drafts {
    pub(super) fn hold(&self, id: &ChangeId, plan: StoredPlan, now_unix_s: u64) {
        self.0.insert(id.clone(), Arc::new((plan, now_unix_s)));
    }

    pub(super) fn get(&self, id: &ChangeId) -> Option<Held> {
        self.0.get(id)
    }
}
