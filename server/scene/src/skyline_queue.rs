//! Tiles of skylines that places wait for, made one after another by a thread of their own while those who asked are told to come again.
//! Places have their turns: who asks about one does not wait for all tiles of another.

use std::collections::{BTreeSet, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Lights a second before any were made: a tenth of a millisecond each.
const FIRST_LIGHTS_PER_S: f64 = 10_000.0;
/// Places beyond these come in when they ask again.
const MOST_PLACES: usize = 64;
/// Weight of what was measured before, when the next tile is done.
const MEMORY: f64 = 0.8;

/// Tiles to be made, in their order.
#[derive(Debug, Default)]
pub(crate) struct SkylineQueue(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    /// By the place that asked for them first.
    waiting: VecDeque<VecDeque<usize>>,
    /// The same, and the one that is being made.
    known: BTreeSet<usize>,
    /// Whether a thread is at it.
    is_worked: bool,
    /// None before any was made.
    lights_per_s: Option<f64>,
    /// A tile could not be stored, so nothing is gained by waiting.
    is_given_up: bool,
}

impl SkylineQueue {
    fn lock(&self) -> MutexGuard<'_, State> {
        // The lists are valid whatever a panicking holder was doing.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds the tiles of a place that are not in it yet, and says whether the caller is to begin to work on it.
    pub(crate) fn add(&self, tiles: impl IntoIterator<Item = usize>) -> bool {
        let mut state = self.lock();
        if state.waiting.len() < MOST_PLACES {
            let new: VecDeque<usize> = tiles.into_iter().filter(|tile| state.known.insert(*tile)).collect();
            if !new.is_empty() {
                state.waiting.push_back(new);
            }
        }
        !std::mem::replace(&mut state.is_worked, true)
    }

    /// Whether a tile is in it, or being made.
    pub(crate) fn has(&self, tile: usize) -> bool {
        self.lock().known.contains(&tile)
    }

    /// The next tile; None where there is none, and who asked is done.
    pub(crate) fn next(&self) -> Option<usize> {
        let mut state = self.lock();
        let mut place = state.waiting.pop_front();
        let next = place.as_mut().and_then(VecDeque::pop_front);
        state.waiting.extend(place.filter(|place| !place.is_empty()));
        state.is_worked = next.is_some();
        next
    }

    /// A tile of so many lights is made and stored after so many seconds.
    pub(crate) fn done(&self, tile: usize, lights: usize, seconds: f64) {
        let mut state = self.lock();
        state.known.remove(&tile);
        if lights > 0 && seconds > 0.0 {
            let rate = lights as f64 / seconds;
            let mixed = |before: f64| before.powf(MEMORY) * rate.powf(1.0 - MEMORY);
            state.lights_per_s = Some(state.lights_per_s.map_or(rate, mixed));
        }
    }

    /// A tile cannot be stored: nobody waits for tiles from now on.
    pub(crate) fn give_up(&self) {
        *self.lock() = State { is_given_up: true, ..State::default() };
    }

    pub(crate) fn is_given_up(&self) -> bool {
        self.lock().is_given_up
    }

    pub(crate) fn lights_per_s(&self) -> f64 {
        self.lock().lights_per_s.unwrap_or(FIRST_LIGHTS_PER_S)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_is_made_once_for_all_who_wait() {
        let queue = SkylineQueue::default();
        assert!(queue.add([3, 1]) && !queue.add([1, 2, 3]));
        assert_eq!(queue.next(), Some(3));
        assert!(queue.has(3) && queue.has(2) && !queue.has(5));
        // It is being made.
        assert!(!queue.add([3]));
        queue.done(3, 500, 0.1);
        assert!((queue.lights_per_s() / 5_000.0 - 1.0).abs() < 1e-9);
        // The second place has its turn.
        assert!(!queue.add([5, 6]));
        assert_eq!([(); 5].map(|()| queue.next()), [Some(2), Some(1), Some(5), Some(6), None]);
        // Who adds the next begins.
        assert!(queue.add([3]));
        queue.give_up();
        assert!(queue.is_given_up() && queue.next().is_none());
    }
}
