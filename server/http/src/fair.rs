//! A queue before long work that is fair by time: whoever had least of it lately is next, so that nobody waits for all that another
//! has asked for.

use crate::{
    party::{Party, Tier},
    token_buckets::TokenBuckets,
};
use std::{
    cmp::Ordering,
    collections::HashMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Instant,
};
use tokio::sync::oneshot::{Sender, channel};

/// Time after which half of what a party had counts, seconds.
const HALF_LIFE_S: f64 = 60.0;

/// Places for work, and who waits for one.
#[derive(Debug)]
pub(crate) struct FairQueue {
    places: usize,
    most_waiting: usize,
    shares: Arc<TokenBuckets>,
    inner: Mutex<Inner>,
}

#[derive(Debug, Default)]
struct Inner {
    count: u64,
    waiting: Vec<Waiting>,
    running: Vec<(u64, Party, Instant)>,
    /// Seconds that parties, and networks around them, had, as of when.
    had: HashMap<(u8, Party), (f64, Instant)>,
}

#[derive(Debug)]
struct Waiting {
    number: u64,
    party: Party,
    sender: Sender<Turn>,
}

/// A place, until this is dropped.
#[derive(Debug)]
pub(crate) struct Turn {
    queue: Arc<FairQueue>,
    number: u64,
}

/// No room to wait: others wait for less.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crowded;

/// Leaves the queue when nobody waits any more.
struct Place<'a> {
    queue: &'a FairQueue,
    number: u64,
}

impl Drop for Place<'_> {
    fn drop(&mut self) {
        self.queue.lock().waiting.retain(|waiting| waiting.number != self.number);
    }
}

impl FairQueue {
    /// So many places, and so many who may wait for one.
    pub(crate) fn new(places: usize, most_waiting: usize, shares: Arc<TokenBuckets>) -> Arc<Self> {
        Arc::new(Self { places, most_waiting, shares, inner: Mutex::default() })
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a place.
    ///
    /// # Errors
    /// [`Crowded`] where too many wait: for the last of whoever has most waiting there.
    pub(crate) async fn turn(self: &Arc<Self>, party: Party) -> Result<Turn, Crowded> {
        let (sender, receiver) = channel();
        let number = {
            let mut inner = self.lock();
            let is_full = inner.running.len() >= self.places || !inner.waiting.is_empty();
            if is_full && inner.waiting.len() >= self.most_waiting {
                inner.make_room(party)?;
            }
            inner.count += 1;
            let number = inner.count;
            inner.waiting.push(Waiting { number, party, sender });
            number
        };
        let _place = Place { queue: self, number };
        self.hand_out();
        receiver.await.map_err(|_| Crowded)
    }

    /// Gives free places to those whose turn it is.
    fn hand_out(self: &Arc<Self>) {
        loop {
            let now = Instant::now();
            let mut inner = self.lock();
            let Some(next) = inner.next(self.places, now) else { return };
            let Waiting { number, party, sender } = inner.waiting.remove(next);
            inner.running.push((number, party, now));
            drop(inner);
            // Who is gone meanwhile gives it back at once.
            let _gone = sender.send(Turn { queue: Arc::clone(self), number });
        }
    }
}

impl Inner {
    /// Sends the last away of whoever has most waiting, networks first, if that is not the one who comes.
    fn make_room(&mut self, party: Party) -> Result<(), Crowded> {
        let count = |tier: Tier| {
            let of_tier = |waiting: &&Waiting| waiting.party.tiers()[usize::from(tier.0)] == tier;
            self.waiting.iter().filter(of_tier).count()
        };
        let counts = |of: Party| {
            let [own, household, site] = of.tiers().map(count);
            (site, household, own)
        };
        let most = (0..self.waiting.len()).max_by_key(|&at| (counts(self.waiting[at].party), at));
        let has_more = |other: Party| {
            // Of the widest network that they do not share.
            let apart = other.tiers().into_iter().zip(party.tiers()).rev().find(|(a, b)| a != b);
            apart.is_some_and(|(other, own)| count(other) > count(own) + 1)
        };
        let most = most.filter(|&at| has_more(self.waiting[at].party)).ok_or(Crowded)?;
        self.waiting.remove(most);
        Ok(())
    }

    /// Whose turn it is: no party has all places where there are several.
    fn next(&self, places: usize, now: Instant) -> Option<usize> {
        if self.running.len() >= places {
            return None;
        }
        let most = (places - 1).max(1);
        let may = |party: Party| {
            let [_, household, _] = party.tiers();
            let running = self.running.iter().filter(|(_, other, _)| other.tiers()[1] == household);
            party == Party::Operator || running.count() < most
        };
        (0..self.waiting.len())
            .filter(|&at| may(self.waiting[at].party))
            .min_by(|&a, &b| self.compare(&self.waiting[a], &self.waiting[b], now))
    }

    /// Networks first, then those inside, then who came first.
    fn compare(&self, a: &Waiting, b: &Waiting, now: Instant) -> Ordering {
        let loads = |party: Party| party.tiers().map(|tier| self.load_s(tier, now));
        let (of_a, of_b) = (loads(a.party), loads(b.party));
        let by_load = of_a.iter().zip(&of_b).rev().map(|(a, b)| a.total_cmp(b));
        by_load.fold(Ordering::Equal, Ordering::then).then(a.number.cmp(&b.number))
    }

    /// Seconds that a tier had lately, those of what runs included.
    fn load_s(&self, tier: (u8, Party), now: Instant) -> f64 {
        let had = self.had.get(&tier).map_or(0.0, |&had| faded(had, now));
        let of_tier = self.running.iter().filter(|(_, party, _)| party.tiers()[usize::from(tier.0)] == tier);
        had + of_tier.map(|(_, _, began)| 1.0 + (now - *began).as_secs_f64()).sum::<f64>()
    }
}

fn faded((seconds, since): (f64, Instant), now: Instant) -> f64 {
    seconds * (-now.saturating_duration_since(since).as_secs_f64() / HALF_LIFE_S).exp2()
}

impl Drop for Turn {
    fn drop(&mut self) {
        let now = Instant::now();
        let mut inner = self.queue.lock();
        if let Some(at) = inner.running.iter().position(|(number, ..)| *number == self.number) {
            let (_, party, began) = inner.running.swap_remove(at);
            let took_s = (now - began).as_secs_f64();
            for tier in party.tiers() {
                let had = inner.had.entry(tier).or_insert((0.0, now));
                *had = (faded(*had, now) + took_s, now);
            }
            inner.had.retain(|_, had| faded(*had, now) > 1e-3);
            self.queue.shares.charge(party, took_s, now);
        }
        drop(inner);
        self.queue.hand_out();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn queue(places: usize, most_waiting: usize) -> Arc<FairQueue> {
        FairQueue::new(places, most_waiting, Arc::new(TokenBuckets::new("work", 0.0, 0.0)))
    }

    /// Many networks of one household, each with one waiting, leave room for somebody else.
    #[tokio::test]
    async fn a_household_that_fills_the_queue_makes_room() {
        let queue = queue(1, 8);
        let first = queue.turn(Party::V4(1)).await.unwrap();
        let turns = Arc::default();
        let household: Vec<_> = (0..8).map(|of| wait(&queue, Party::V6(0x7700 + of), &turns)).collect();
        tokio::task::yield_now().await;
        assert_eq!(queue.turn(Party::V6(0x7709)).await.err(), Some(Crowded), "one of them");
        let other = wait(&queue, Party::V4(2), &turns);
        tokio::task::yield_now().await;
        drop(first);
        assert!(other.await.unwrap());
        let mut waited = 0;
        for network in household {
            waited += usize::from(network.await.unwrap());
        }
        assert_eq!(waited, 7);
    }

    /// Has somebody wait, and says whose turn came when.
    fn wait(
        queue: &Arc<FairQueue>,
        party: Party,
        turns: &Arc<Mutex<Vec<Party>>>,
    ) -> tokio::task::JoinHandle<bool> {
        let (queue, turns) = (Arc::clone(queue), Arc::clone(turns));
        tokio::spawn(async move {
            let Ok(turn) = queue.turn(party).await else { return false };
            turns.lock().unwrap().push(party);
            tokio::time::sleep(Duration::from_millis(5)).await;
            drop(turn);
            true
        })
    }

    /// Who asks once is served before the many that another asked for earlier.
    #[tokio::test]
    async fn one_who_asks_once_is_next() {
        let queue = queue(1, 100);
        let turns = Arc::default();
        let [many, one] = [1, 2].map(Party::V4);
        let first = queue.turn(many).await.unwrap();
        let mut all: Vec<_> = (0..20).map(|_| wait(&queue, many, &turns)).collect();
        tokio::task::yield_now().await;
        all.push(wait(&queue, one, &turns));
        tokio::time::sleep(Duration::from_millis(20)).await;
        drop(first);
        for waiting in all {
            assert!(waiting.await.unwrap());
        }
        let turns = turns.lock().unwrap();
        assert_eq!((turns.len(), turns[0]), (21, one));
    }

    /// A household of many networks is one among others.
    #[tokio::test]
    async fn a_household_of_networks_is_one() {
        let queue = queue(1, 100);
        let turns = Arc::default();
        let first = queue.turn(Party::V6(0)).await.unwrap();
        let mut all: Vec<_> = (1..20).map(|network| wait(&queue, Party::V6(network), &turns)).collect();
        tokio::task::yield_now().await;
        let other = Party::V6(5 << 16);
        all.push(wait(&queue, other, &turns));
        tokio::time::sleep(Duration::from_millis(20)).await;
        drop(first);
        for waiting in all {
            waiting.await.unwrap();
        }
        assert_eq!(turns.lock().unwrap()[0], other);
    }

    /// One party leaves a place to others, and the one who has most waiting is sent away first.
    #[tokio::test]
    async fn a_party_leaves_places_to_others() {
        let queue = queue(2, 3);
        let turns = Arc::default();
        let [many, one] = [1, 2].map(Party::V4);
        let first = queue.turn(many).await.unwrap();
        let waiting: Vec<_> = (0..3).map(|_| wait(&queue, many, &turns)).collect();
        tokio::task::yield_now().await;
        assert_eq!(queue.turn(many).await.unwrap_err(), Crowded);
        // There is no room to wait, but for one who has nothing waiting.
        let other = queue.turn(one).await.unwrap();
        drop((first, other));
        let mut count = 0;
        for waiting in waiting {
            count += usize::from(waiting.await.unwrap());
        }
        assert_eq!(count, 2, "the last was sent away");
    }

    /// Who stops waiting has no turn, and takes none from others.
    #[tokio::test]
    async fn who_is_gone_has_no_turn() {
        let queue = queue(1, 10);
        let first = queue.turn(Party::V4(1)).await.unwrap();
        let turns = Arc::default();
        let gone = wait(&queue, Party::V4(2), &turns);
        let last = wait(&queue, Party::V4(3), &turns);
        tokio::task::yield_now().await;
        gone.abort();
        drop(first);
        assert!(last.await.unwrap());
        assert_eq!(*turns.lock().unwrap(), [Party::V4(3)]);
        assert!(queue.lock().waiting.is_empty() && queue.lock().running.is_empty());
    }
}
