//! What is stored, in memory: by id, by scene for lists, by age and by whom it counts for. The files are the truth; this is made
//! of them.

use super::change_id::{ChangeId, ChangeKind};
use super::listing::{Cursor, Listed, Outline, Outlined, Page, Viewer};
use super::posting::{NETWORK_TIERS, Networks, Posted};
use super::shares::{Aged, Share};
use super::stored::ChangeLimits;
use crate::scene_id::SceneId;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeSet, HashMap};

/// Part of the limits that what is pinned may take.
const PINNED_PART: f64 = 0.5;

/// A document.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Entry {
    pub(super) id: ChangeId,
    pub(super) base: Option<ChangeId>,
    /// None where the document is damaged: it takes room, and is in no list.
    pub(super) listed: Option<(SceneId, Outline)>,
    pub(super) posted: Posted,
    pub(super) created_unix_ns: u64,
    pub(super) modified_unix_ns: u64,
    /// Of the document alone.
    pub(super) document_bytes: u64,
    /// With its pixels.
    pub(super) bytes: u64,
}

impl Entry {
    /// What an [`Outlined`] document says of itself goes into the entry.
    pub(super) fn outlined(mut self, Outlined { scene, base, outline }: Outlined) -> Self {
        (self.base, self.listed) = (base, Some((scene, outline)));
        self
    }

    fn age(&self) -> Aged {
        (self.modified_unix_ns, self.id.clone())
    }

    /// Whom it counts for. What programs beside a server or earlier versions stored counts for itself alone.
    fn networks(&self) -> Networks {
        match self.posted.networks == Networks::default() {
            true => [self.id.number(); NETWORK_TIERS.len()],
            false => self.posted.networks,
        }
    }

    fn place(&self) -> Cursor {
        Cursor { created_unix_ns: self.created_unix_ns, id: self.id.clone() }
    }
}

/// How many documents there are, and how many bytes they take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Total {
    count: usize,
    bytes: u64,
}

/// What is known of the documents of one kind.
#[derive(Debug, Default)]
struct OfKind {
    total: Total,
    pinned: Total,
    by_age: BTreeSet<Aged>,
    shares: Share,
    by_scene: HashMap<SceneId, BTreeSet<Cursor>>,
}

/// The index.
#[derive(Debug)]
pub(super) struct Index {
    limits: ChangeLimits,
    entries: HashMap<ChangeId, Entry>,
    kinds: [OfKind; 2],
    /// How many are based on each.
    bases: HashMap<ChangeId, usize>,
}

impl Index {
    pub(super) fn new(limits: ChangeLimits) -> Self {
        Self { limits, entries: HashMap::new(), kinds: Default::default(), bases: HashMap::new() }
    }

    pub(super) fn get(&self, id: &ChangeId) -> Option<&Entry> {
        self.entries.get(id)
    }

    pub(super) fn ids(&self, kind: ChangeKind) -> impl Iterator<Item = &ChangeId> {
        self.entries.keys().filter(move |id| id.kind() == kind)
    }

    pub(super) fn entries(&self, kind: ChangeKind) -> impl Iterator<Item = &Entry> {
        self.entries.values().filter(move |entry| entry.id.kind() == kind)
    }

    /// What a document weighs: no less than an average one where the store is full.
    fn weight(&self, bytes: u64) -> f64 {
        1.0 + bytes as f64 * self.limits.count as f64 / (self.limits.bytes.max(1) as f64)
    }

    /// Adds a document, or takes it as it is now.
    pub(super) fn put(&mut self, entry: Entry) {
        self.take(&entry.id);
        let weight = self.weight(entry.bytes);
        let of_kind = &mut self.kinds[entry.id.kind() as usize];
        of_kind.total.count += 1;
        of_kind.total.bytes += entry.bytes;
        if entry.posted.pinned {
            of_kind.pinned.count += 1;
            of_kind.pinned.bytes += entry.bytes;
        } else {
            of_kind.by_age.insert(entry.age());
        }
        of_kind.shares.weigh(&entry.networks(), weight);
        if let Some((scene, _)) = &entry.listed {
            of_kind.by_scene.entry(scene.clone()).or_default().insert(entry.place());
        }
        let (id, base) = (entry.id.clone(), entry.base.clone());
        self.entries.insert(id.clone(), entry);
        self.offer(&id);
        if let Some(base) = base {
            self.withdraw(&base);
            *self.bases.entry(base).or_default() += 1;
        }
    }

    /// Removes a document.
    pub(super) fn take(&mut self, id: &ChangeId) -> Option<Entry> {
        self.withdraw(id);
        let entry = self.entries.remove(id)?;
        let weight = self.weight(entry.bytes);
        let of_kind = &mut self.kinds[entry.id.kind() as usize];
        of_kind.total.count -= 1;
        of_kind.total.bytes -= entry.bytes;
        if entry.posted.pinned {
            of_kind.pinned.count -= 1;
            of_kind.pinned.bytes -= entry.bytes;
        }
        of_kind.by_age.remove(&entry.age());
        of_kind.shares.weigh(&entry.networks(), -weight);
        if let Some((scene, _)) = &entry.listed
            && let Some(list) = of_kind.by_scene.get_mut(scene)
        {
            list.remove(&entry.place());
        }
        if let Some(base) = &entry.base
            && let Some(count) = self.bases.get_mut(base)
        {
            *count -= 1;
            if *count == 0 {
                self.bases.remove(base);
                self.offer(base);
            }
        }
        Some(entry)
    }

    /// Notes that a document is as young as this.
    pub(super) fn renew(&mut self, id: &ChangeId, modified_unix_ns: u64) {
        if let Some(entry) = self.entries.get(id) {
            self.put(Entry { modified_unix_ns, ..entry.clone() });
        }
    }

    /// Has a document go when it is its turn: none that is pinned, or that others are based on.
    pub(super) fn offer(&mut self, id: &ChangeId) {
        let Some(entry) = self.entries.get(id) else { return };
        if !entry.posted.pinned && !self.bases.contains_key(id) {
            self.kinds[id.kind() as usize].shares.offer(&entry.networks(), entry.age());
        }
    }

    /// Has a document stay however much is stored.
    pub(super) fn withdraw(&mut self, id: &ChangeId) {
        let Some(entry) = self.entries.get(id) else { return };
        self.kinds[id.kind() as usize].shares.withdraw(&entry.networks(), &entry.age());
    }

    /// Whether there is room for what is pinned.
    pub(super) fn may_pin(&self, kind: ChangeKind, bytes: u64) -> bool {
        let Total { count, bytes: pinned_bytes } = self.kinds[kind as usize].pinned;
        (count + 1) as f64 <= PINNED_PART * self.limits.count as f64
            && (pinned_bytes + bytes) as f64 <= PINNED_PART * self.limits.bytes as f64
    }

    /// What must go beside the newest: what is past its age and what is too much, the oldest of the heaviest networks first.
    pub(super) fn next_to_go(&self, newest: &ChangeId, now_unix_s: u64) -> Option<ChangeId> {
        let of_kind = &self.kinds[newest.kind() as usize];
        // What others are based on goes after them: of those only what is pinned gets older than its base.
        let past_age = of_kind.by_age.iter().take_while(|(ns, _)| self.is_past_age(*ns, now_unix_s));
        if let Some((_, id)) = { past_age }.find(|(_, id)| id != newest && !self.is_base(id)) {
            return Some(id.clone());
        }
        let newest_bytes = self.entries.get(newest).map_or(0, |entry| entry.bytes);
        let Total { count, bytes } = of_kind.total;
        let is_too_much = count > self.limits.count || bytes - newest_bytes > self.limits.bytes;
        of_kind.shares.next_to_go().filter(|_| is_too_much).cloned()
    }

    fn is_past_age(&self, modified_unix_ns: u64, now_unix_s: u64) -> bool {
        now_unix_s.saturating_sub(modified_unix_ns / 1_000_000_000) > self.limits.age.as_secs()
    }

    /// A part of a scene's list, or of all scenes', as somebody sees it.
    pub(super) fn page(
        &self,
        kind: ChangeKind,
        scene: &SceneId,
        viewer: &Viewer,
        after: Option<&Cursor>,
        limit: usize,
        now_unix_s: u64,
    ) -> Page<Listed> {
        let Some(list) = self.kinds[kind as usize].by_scene.get(scene) else {
            return Page { entries: Vec::new(), next: None };
        };
        let places = match after {
            Some(after) => list.range(..after),
            None => list.range(..),
        };
        let is_seen = |entry: &&Entry| {
            let is_own = match viewer {
                Viewer::Operator => true,
                Viewer::Owner(owner) => entry.posted.is_of(Some(owner)),
                Viewer::Anyone => false,
            };
            (is_own || !entry.posted.unlisted) && self.is_there(entry, now_unix_s)
        };
        let mut seen = places.rev().filter_map(|place| self.entries.get(&place.id)).filter(is_seen);
        let entries: Vec<&Entry> = seen.by_ref().take(limit).collect();
        let next = seen.next().and(entries.last()).map(|entry| entry.place());
        Page { entries: entries.into_iter().filter_map(as_listed).collect(), next }
    }

    /// All ids of a kind with the time of their storage, the newest first.
    pub(super) fn list(&self, kind: ChangeKind, now_unix_s: u64) -> Vec<(ChangeId, u64)> {
        let there = self.entries(kind).filter(|entry| self.is_there(entry, now_unix_s));
        let mut places: Vec<Cursor> = there.map(Entry::place).collect();
        places.sort_unstable_by(|a, b| b.cmp(a));
        places.into_iter().map(|place| (place.id, place.created_unix_ns / 1_000_000_000)).collect()
    }

    /// Whether something stored is based on it.
    pub(super) fn is_base(&self, id: &ChangeId) -> bool {
        self.bases.contains_key(id)
    }

    fn is_there(&self, entry: &Entry, now_unix_s: u64) -> bool {
        entry.posted.pinned
            || self.is_base(&entry.id)
            || !self.is_past_age(entry.modified_unix_ns, now_unix_s)
    }
}

fn as_listed(entry: &Entry) -> Option<Listed> {
    let (_, outline) = entry.listed.as_ref()?;
    Some(Listed {
        id: entry.id.clone(),
        base: entry.base.clone(),
        created_unix_s: entry.created_unix_ns / 1_000_000_000,
        outline: outline.clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::posting::{Account, Posting};
    use super::*;
    use std::time::Duration;

    fn entry(number: u64, address: &str) -> Entry {
        let account = Account::Address(address.parse().unwrap());
        let id = ChangeId::of_scenario(&number.to_le_bytes());
        let posted = Posted::new(&Posting { account, ..Posting::default() }, &[7; 32], 0);
        let outline = Outline::Scenario { title: None, edit_count: 1 };
        let listed = Some((SceneId::parse("here").unwrap(), outline));
        let (created_unix_ns, modified_unix_ns, document_bytes, bytes) = (number, number, 900, 900);
        let base = None;
        Entry { id, base, listed, posted, created_unix_ns, modified_unix_ns, document_bytes, bytes }
    }

    /// Five thousand small scenarios of one household, twenty /64 of a /59, into a store that a thousand others have filled.
    #[test]
    fn five_thousand_of_one_evict_their_own() {
        let mut index = Index::new(ChangeLimits::default());
        let others: Vec<Entry> = (0..4_900)
            .map(|number| entry(number, &format!("2001:db8:{:x}::1", 1 + number % 1_000)))
            .collect();
        others.iter().for_each(|entry| index.put(entry.clone()));
        for number in 0..5_000 {
            let new = entry(10_000 + number, &format!("2001:db8:fff:fe{:02x}::1", 0x40 + number % 20));
            let id = new.id.clone();
            index.put(new);
            index.withdraw(&id);
            while let Some(gone) = index.next_to_go(&id, 1) {
                index.take(&gone);
            }
            index.offer(&id);
        }
        let left = others.iter().filter(|entry| index.get(&entry.id).is_some()).count();
        assert_eq!((left, index.entries.len()), (4_900, 5_000));
    }

    /// What a pinned document is based on stays with it, however old, and goes when it goes.
    #[test]
    fn bases_stay_with_what_is_pinned() {
        let mut index = Index::new(ChangeLimits { age: Duration::from_secs(10), ..ChangeLimits::default() });
        let base = entry(1, "192.0.2.1");
        let mut pinned = Entry { base: Some(base.id.clone()), ..entry(2, "192.0.2.2") };
        pinned.posted.pinned = true;
        let newest = entry(100_000_000_000, "192.0.2.3");
        [&base, &pinned, &newest].into_iter().for_each(|entry| index.put(entry.clone()));
        assert_eq!(index.next_to_go(&newest.id, 100), None);
        index.take(&pinned.id);
        assert_eq!(index.next_to_go(&newest.id, 100), Some(base.id));
    }

    /// Documents of nobody known are not one heavy client.
    #[test]
    fn documents_of_nobody_count_for_themselves() {
        let mut index = Index::new(ChangeLimits { count: 100, ..ChangeLimits::default() });
        let of_nobody = |number| Entry { posted: Posted::default(), ..entry(number, "192.0.2.1") };
        (0..90).for_each(|number| index.put(of_nobody(number)));
        (100..111).for_each(|number| index.put(entry(number, "192.0.2.1")));
        let newest = entry(111, "192.0.2.9");
        index.put(newest.clone());
        assert_eq!(index.next_to_go(&newest.id, 1), Some(entry(100, "192.0.2.1").id));
    }

    /// Who has pixels of many megabytes loses them before those who have little.
    #[test]
    fn bytes_weigh_as_much_as_counts() {
        let limits = ChangeLimits { count: 1_000, bytes: 1_000_000, ..ChangeLimits::default() };
        let mut index = Index::new(limits);
        (0..50).for_each(|number| index.put(entry(number, "192.0.2.1")));
        let large = Entry { bytes: 400_000, ..entry(60, "192.0.2.2") };
        let (large_id, newest) = (large.id.clone(), Entry { bytes: 700_000, ..entry(61, "192.0.2.3") });
        index.put(large);
        index.put(newest.clone());
        assert_eq!(index.next_to_go(&newest.id, 1), None, "the newest is not counted");
        let last = Entry { bytes: 700_000, ..entry(62, "192.0.2.2") };
        index.put(last.clone());
        index.withdraw(&last.id);
        assert_eq!(index.next_to_go(&last.id, 1), Some(large_id));
    }
}
