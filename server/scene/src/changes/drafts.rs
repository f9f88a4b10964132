//! Draft plans, such as those tried with a slider: held in memory for some minutes, never on disk. Where they are too much, the one
//! that was used least lately goes first, of the heaviest networks as with what is stored (see [`Share`]).

use super::change_id::ChangeId;
use super::posting::{Account, NETWORK_TIERS, Networks};
use super::shares::{Aged, Share};
use super::stored::StoredPlan;
use std::collections::{BTreeSet, HashMap};
use std::fmt::Debug;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Bytes by ids for some minutes after their last use, such as Valkey has. What cannot be put there or had is done without.
pub trait DraftShelf: Debug + Send + Sync {
    /// Puts a draft there.
    fn put(&self, id: &str, bytes: &[u8]);

    /// A draft that is there.
    fn get(&self, id: &str) -> Option<Vec<u8>>;
}

/// How long a draft is held after its last use.
const IDLE: Duration = Duration::from_secs(600);
/// About what a draft takes in addition to its pixels and its answer: no draft weighs less.
const OVERHEAD_BYTES: usize = 4096;
/// About how much larger JSON is in memory than as text.
const JSON_MEMORY_FACTOR: usize = 4;
/// A draft, and since when it is held, seconds since 1970.
pub(super) type Held = Arc<(StoredPlan, u64)>;

/// The drafts.
#[derive(Clone, Debug)]
pub(super) struct Drafts {
    /// Times are counted from here.
    start: Instant,
    table: Arc<Mutex<Table>>,
}

#[derive(Debug)]
struct Draft {
    held: Held,
    bytes: usize,
    networks: Networks,
    used_ns: u64,
}

#[derive(Debug, Default)]
struct Table {
    most_bytes: u64,
    bytes: u64,
    drafts: HashMap<ChangeId, Draft>,
    by_use: BTreeSet<Aged>,
    shares: Share,
}

fn bytes_of(plan: &StoredPlan) -> usize {
    let of_pixel = size_of_val(&plan.factors.codes[..]) + size_of_val(&plan.factors.factors[..]);
    let of_answer = JSON_MEMORY_FACTOR * plan.answer.to_string().len();
    OVERHEAD_BYTES + of_answer + of_pixel + size_of_val(&plan.effects[..])
}

impl Drafts {
    /// Drafts of so many bytes together, about, the newest excepted.
    pub(super) fn new(most_bytes: u64) -> Self {
        let table = Table { most_bytes, ..Table::default() };
        Self { start: Instant::now(), table: Arc::new(Mutex::new(table)) }
    }

    /// Whom a draft counts for.
    pub(super) fn networks(id: &ChangeId, account: &Account, key: &[u8; 32]) -> Networks {
        match account {
            // As what is stored for nobody, each counts for itself.
            Account::Nobody => [id.number(); NETWORK_TIERS.len()],
            somebody => somebody.networks(key),
        }
    }

    pub(super) fn hold(&self, id: &ChangeId, plan: StoredPlan, networks: Networks, now_unix_s: u64) {
        let (bytes, held) = (bytes_of(&plan), Arc::new((plan, now_unix_s)));
        let (mut table, now_ns) = self.table();
        table.put(id, Draft { held, bytes, networks, used_ns: now_ns });
        table.make_room(networks, (now_ns, id.clone()));
    }

    pub(super) fn get(&self, id: &ChangeId) -> Option<Held> {
        let (mut table, now_ns) = self.table();
        let draft = table.take(id)?;
        let held = Arc::clone(&draft.held);
        table.put(id, Draft { used_ns: now_ns, ..draft });
        Some(held)
    }

    /// The drafts that are not past their time, and the time, nanoseconds.
    fn table(&self) -> (MutexGuard<'_, Table>, u64) {
        let now_ns = u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX);
        let mut table = self.table.lock().unwrap_or_else(PoisonError::into_inner);
        table.expire(now_ns);
        (table, now_ns)
    }
}

impl Table {
    fn expire(&mut self, now_ns: u64) {
        while let Some((used_ns, id)) = self.by_use.first().cloned()
            && u128::from(now_ns.saturating_sub(used_ns)) > IDLE.as_nanos()
        {
            self.take(&id);
        }
    }

    fn put(&mut self, id: &ChangeId, draft: Draft) {
        self.take(id);
        let age = (draft.used_ns, id.clone());
        self.bytes += draft.bytes as u64;
        self.shares.weigh(&draft.networks, weight(draft.bytes));
        self.shares.offer(&draft.networks, age.clone());
        self.by_use.insert(age);
        self.drafts.insert(id.clone(), draft);
    }

    /// Lets go of drafts that are too much, but not of the newest, which is the one that is asked for next.
    fn make_room(&mut self, networks: Networks, newest: Aged) {
        self.shares.withdraw(&networks, &newest);
        while self.bytes > self.most_bytes
            && let Some(gone) = self.shares.next_to_go().cloned()
        {
            self.take(&gone);
        }
        self.shares.offer(&networks, newest);
    }

    fn take(&mut self, id: &ChangeId) -> Option<Draft> {
        let draft = self.drafts.remove(id)?;
        let age = (draft.used_ns, id.clone());
        self.by_use.remove(&age);
        self.shares.withdraw(&draft.networks, &age);
        self.shares.weigh(&draft.networks, -weight(draft.bytes));
        self.bytes -= draft.bytes as u64;
        Some(draft)
    }
}

fn weight(bytes: usize) -> f64 {
    bytes as f64 / OVERHEAD_BYTES as f64
}

#[cfg(test)]
mod tests {
    use super::super::edits::PixelFactors;
    use super::*;
    use crate::scene_id::SceneId;

    fn plan() -> StoredPlan {
        StoredPlan {
            scene: SceneId::parse("here").unwrap(),
            scene_version: "v1".to_owned(),
            base: None,
            answer: serde_json::json!({}),
            factors: PixelFactors::default(),
            effects: Vec::new(),
        }
    }

    fn id(number: u32) -> ChangeId {
        ChangeId::of_plan(&number.to_le_bytes())
    }

    fn hold(drafts: &Drafts, number: u32, account: &Account) {
        drafts.hold(&id(number), plan(), Drafts::networks(&id(number), account, &[0; 32]), 1);
    }

    fn address(text: &str) -> Account {
        Account::Address(text.parse().unwrap())
    }

    /// Many drafts of one household, from many of its networks, push out its own and nobody else's; the newest stays.
    #[test]
    fn many_drafts_push_out_their_own() {
        let drafts = Drafts::new(20 * bytes_of(&plan()) as u64);
        for number in 0..8 {
            hold(&drafts, number, &address(&format!("192.0.2.{number}")));
        }
        for number in 100..200 {
            hold(&drafts, number, &address(&format!("2001:db8:1:ff{:02x}::1", number % 20)));
            assert!(drafts.get(&id(number)).is_some(), "{number}");
        }
        assert!((0..8).all(|number| drafts.get(&id(number)).is_some()));
        assert_eq!((100..200).filter(|number| drafts.get(&id(*number)).is_some()).count(), 12);
        let table = drafts.table().0;
        assert!(table.bytes <= table.most_bytes && table.by_use.len() == 20);
    }

    /// A draft is held while it is used, and goes some minutes after.
    #[test]
    fn drafts_go_when_nobody_uses_them() {
        let drafts = Drafts::new(u64::MAX);
        (1..3).for_each(|number| hold(&drafts, number, &Account::Nobody));
        let mut table = drafts.table().0;
        let idle_ns = IDLE.as_nanos() as u64;
        let used = table.take(&id(2)).unwrap();
        table.put(&id(2), Draft { used_ns: idle_ns / 2, ..used });
        table.expire(idle_ns + idle_ns / 4);
        assert!(!table.drafts.contains_key(&id(1)) && table.drafts.contains_key(&id(2)));
        table.expire(2 * idle_ns);
        assert_eq!((table.bytes, table.drafts.len(), table.by_use.len()), (0, 0, 0));
    }

    /// One draft that is larger than all that there is room for is held by itself.
    #[test]
    fn the_newest_is_held_however_large() {
        let drafts = Drafts::new(1);
        for number in 0..3 {
            hold(&drafts, number, &Account::Nobody);
            assert!(drafts.get(&id(number)).is_some());
        }
        assert!(drafts.get(&id(0)).is_none());
    }
}
