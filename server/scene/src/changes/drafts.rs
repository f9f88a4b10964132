//! Plans that somebody tries one after the other, such as with a slider: held in memory for some minutes, never on disk.

use super::change_id::ChangeId;
use super::store::StoredPlan;
use moka::sync::Cache;
use std::sync::Arc;
use std::time::Duration;

/// How long a draft is held after it was last asked for.
const IDLE: Duration = Duration::from_secs(600);
/// Bytes that all of them take together at most, about.
const MOST_BYTES: u64 = 128 << 20;
/// About what a draft takes besides its pixels: what is said of it.
const ANSWER_BYTES: usize = 16_384;

/// A draft, and since when it is held, seconds since 1970.
pub(super) type Held = Arc<(StoredPlan, u64)>;

/// The drafts.
#[derive(Clone, Debug)]
pub(super) struct Drafts(Cache<ChangeId, Held>);

impl Default for Drafts {
    fn default() -> Self {
        let bytes = |_: &ChangeId, held: &Held| u32::try_from(bytes_of(&held.0)).unwrap_or(u32::MAX);
        Self(Cache::builder().weigher(bytes).max_capacity(MOST_BYTES).time_to_idle(IDLE).build())
    }
}

fn bytes_of(plan: &StoredPlan) -> usize {
    let of_pixel = size_of_val(&plan.factors.codes[..]) + size_of_val(&plan.factors.factors[..]);
    ANSWER_BYTES + of_pixel + size_of_val(&plan.effects[..])
}

impl Drafts {
    pub(super) fn hold(&self, id: &ChangeId, plan: StoredPlan, now_unix_s: u64) {
        self.0.insert(id.clone(), Arc::new((plan, now_unix_s)));
    }

    pub(super) fn get(&self, id: &ChangeId) -> Option<Held> {
        self.0.get(id)
    }
}
