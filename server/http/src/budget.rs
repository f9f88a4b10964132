//! Budgets of bytes: what is in memory for all clients together, and for each.

use crate::party::{Party, Tier};
use axum::body::Bytes;
use prometheus_client::metrics::gauge::Gauge;
use std::{
    collections::HashMap,
    sync::{Arc, Mutex, PoisonError},
};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// The unit that is counted in, bytes.
const UNIT_BYTES: usize = 1024;

/// Bytes that may be held at a time.
#[derive(Debug)]
pub(crate) struct Budget {
    units: u32,
    free: Arc<Semaphore>,
    /// What one party may hold; the networks around it twice and four times that, but no more than half of all.
    share_units: u32,
    held_by: Mutex<HashMap<Tier, u32>>,
    /// Bytes held, for all to see.
    gauge: Gauge,
}

/// Why bytes cannot be held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Full {
    /// The party holds its share.
    Share,
    /// All of the budget is held.
    Whole,
}

/// Bytes that are held until this is dropped.
#[derive(Debug)]
pub(crate) struct Held {
    budget: Arc<Budget>,
    /// Whose share they count in; None where they count in none.
    party: Option<Party>,
    permit: OwnedSemaphorePermit,
}

fn units(bytes: usize) -> u32 {
    u32::try_from(bytes.div_ceil(UNIT_BYTES)).unwrap_or(u32::MAX)
}

impl Budget {
    /// A budget of so many bytes, of which a party may hold a share.
    pub(crate) fn new(bytes: u64, share_bytes: u64, gauge: Gauge) -> Arc<Self> {
        let units = |bytes: u64| units(usize::try_from(bytes).unwrap_or(usize::MAX)).max(1);
        Arc::new(Self {
            units: units(bytes),
            free: Arc::new(Semaphore::new(units(bytes) as usize)),
            share_units: units(share_bytes),
            held_by: Mutex::default(),
            gauge,
        })
    }

    /// Holds bytes of a party's share, where both it and the whole have room; what is larger than either counts as all of it.
    pub(crate) fn try_hold(self: &Arc<Self>, party: Party, bytes: usize) -> Result<Held, Full> {
        let wanted = units(bytes).min(self.share_units).min(self.units);
        self.charge(party, wanted)?;
        let Ok(permit) = self.free.clone().try_acquire_many_owned(wanted) else {
            self.discharge(party, wanted);
            return Err(Full::Whole);
        };
        Ok(self.held(Some(party), permit))
    }

    /// Holds bytes of nobody's share once there is room, in the order of asking; what is larger than the whole counts as all of it.
    pub(crate) async fn hold(self: &Arc<Self>, bytes: usize) -> Option<Held> {
        let permit = self.free.clone().acquire_many_owned(units(bytes).min(self.units)).await.ok()?;
        Some(self.held(None, permit))
    }

    /// Holds bytes of nobody's share, where there is room.
    pub(crate) fn try_hold_any(self: &Arc<Self>, bytes: usize) -> Option<Held> {
        let permit = self.free.clone().try_acquire_many_owned(units(bytes)).ok()?;
        Some(self.held(None, permit))
    }

    fn held(self: &Arc<Self>, party: Option<Party>, permit: OwnedSemaphorePermit) -> Held {
        self.gauge.inc_by((permit.num_permits() * UNIT_BYTES) as i64);
        Held { budget: Arc::clone(self), party, permit }
    }

    /// Counts units in the share of a party and those of the networks around it.
    fn charge(&self, party: Party, wanted: u32) -> Result<(), Full> {
        if party == Party::Operator {
            return Ok(());
        }
        let mut held_by = self.held_by.lock().unwrap_or_else(PoisonError::into_inner);
        let tiers = party.tiers();
        let has_room = |tier: &Tier| {
            let share = u64::from(self.share_units);
            let most = (share << tier.0).min(share.max(u64::from(self.units / 2)));
            u64::from(held_by.get(tier).copied().unwrap_or(0)) + u64::from(wanted) <= most
        };
        if !tiers.iter().all(has_room) {
            return Err(Full::Share);
        }
        tiers.into_iter().for_each(|tier| *held_by.entry(tier).or_default() += wanted);
        Ok(())
    }

    fn discharge(&self, party: Party, count: u32) {
        if party == Party::Operator || count == 0 {
            return;
        }
        let mut held_by = self.held_by.lock().unwrap_or_else(PoisonError::into_inner);
        for tier in party.tiers() {
            if let Some(held) = held_by.get_mut(&tier) {
                *held = held.saturating_sub(count);
                if *held == 0 {
                    held_by.remove(&tier);
                }
            }
        }
    }
}

impl Held {
    /// Holds more, of the same share.
    pub(crate) fn try_grow(&mut self, bytes: usize) -> Result<(), Full> {
        let more = match self.party {
            Some(party) => self.budget.try_hold(party, bytes)?,
            None => {
                let permit = self.budget.free.clone().try_acquire_many_owned(units(bytes));
                self.budget.held(None, permit.map_err(|_| Full::Whole)?)
            }
        };
        self.merge(more);
        Ok(())
    }

    /// Takes over what another holds.
    fn merge(&mut self, mut other: Held) {
        if let Some(permit) = other.permit.split(other.permit.num_permits()) {
            // The other has none left to give back; its share goes over too.
            other.party = None;
            self.permit.merge(permit);
        }
    }

    /// Gives back what is held beyond so many bytes.
    pub(crate) fn shrink_to(&mut self, bytes: usize) {
        let surplus = self.permit.num_permits().saturating_sub(units(bytes) as usize);
        if let Some(permit) = self.permit.split(surplus) {
            drop(Held { budget: Arc::clone(&self.budget), party: self.party, permit });
        }
    }

    /// Bytes that hold their place for as long as anybody has them.
    pub(crate) fn keep(mut self, mut bytes: Vec<u8>) -> Bytes {
        struct Kept(Vec<u8>, #[expect(dead_code, reason = "dropped with the bytes")] Held);
        impl AsRef<[u8]> for Kept {
            fn as_ref(&self) -> &[u8] {
                &self.0
            }
        }
        bytes.shrink_to_fit();
        self.shrink_to(bytes.capacity());
        Bytes::from_owner(Kept(bytes, self))
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        let count = self.permit.num_permits();
        self.budget.gauge.dec_by((count * UNIT_BYTES) as i64);
        if let Some(party) = self.party {
            self.budget.discharge(party, u32::try_from(count).unwrap_or(u32::MAX));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIB: usize = 1024;

    fn budget(kib: u64, share_kib: u64) -> (Arc<Budget>, Gauge) {
        let gauge = Gauge::default();
        (Budget::new(kib * 1024, share_kib * 1024, gauge.clone()), gauge)
    }

    /// A party holds its share and no more, and others what is left of the whole.
    #[test]
    fn shares_and_the_whole_end() {
        let (all, gauge) = budget(10, 4);
        let [a, b, c] = [1, 2, 3].map(Party::V4);
        let mut of_a = all.try_hold(a, KIB).unwrap();
        of_a.try_grow(3 * KIB).unwrap();
        assert_eq!(of_a.try_grow(1), Err(Full::Share));
        let of_b = all.try_hold(b, 4 * KIB).unwrap();
        assert_eq!(all.try_hold(c, 3 * KIB).unwrap_err(), Full::Whole);
        assert_eq!(gauge.get(), 8 * 1024);
        drop(of_b);
        let of_c = all.try_hold(c, 3 * KIB).unwrap();
        of_a.shrink_to(KIB);
        assert_eq!(gauge.get(), 4 * 1024);
        of_a.try_grow(3 * KIB).unwrap();
        drop((of_a, of_c));
        assert_eq!((gauge.get(), all.free.available_permits()), (0, 10));
        assert!(all.held_by.lock().unwrap().is_empty());
    }

    /// A household of many /64 holds twice a share, and a site four times that of one.
    #[test]
    fn networks_have_shares_too() {
        let (all, _) = budget(1000, 4);
        let count = |parties: Vec<Party>| {
            let held: Vec<Held> =
                parties.into_iter().filter_map(|party| all.try_hold(party, 4 * KIB).ok()).collect();
            held.len()
        };
        assert_eq!(count((0..20).map(Party::V6).collect()), 2);
        assert_eq!(count((0..20).map(|household| Party::V6(household << 8)).collect()), 4);
        assert_eq!(count((0..20).map(|site| Party::V6(site << 16)).collect()), 20);
        assert_eq!(count(vec![Party::Operator; 20]), 20);
    }

    /// Bytes hold their place until the last copy of them is gone.
    #[tokio::test]
    async fn bytes_hold_their_place_until_they_go() {
        let (all, gauge) = budget(10, 10);
        let held = all.hold(1000 * KIB).await.unwrap();
        assert_eq!(gauge.get(), 10 * 1024, "what is larger is all of it");
        let bytes = held.keep(vec![7; 2 * KIB]);
        let part = bytes.slice(5..9);
        assert_eq!(gauge.get(), 2 * 1024);
        drop(bytes);
        assert_eq!((gauge.get(), &part[..]), (2 * 1024, &[7; 4][..]));
        drop(part);
        assert_eq!(gauge.get(), 0);
    }
}
