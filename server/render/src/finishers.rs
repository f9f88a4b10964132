//! What is left to do when the device is done: near lights, in the pool of threads, so that the device goes on.
//!
//! As many requests at once as a batch has or threads there are: a thread of the pool that waits for a part of one begins another,
//! and each holds a sky. A render thread that is faster waits.

use crate::{
    error::{DeviceFault, RenderError},
    request::{ExecutorKind, PassTime, Rendered},
    stats::StatsCell,
    table_set::TableSet,
    worker::Ticket,
};
use skyglow_physics::Panorama;
use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, atomic::Ordering},
    time::Instant,
};

/// What the time of near lights is called among those of passes: it is spent on the processor, whatever renders.
const NEAR_LIGHTS: &str = "near_lights";

/// A request that the device is done with.
pub(crate) struct RenderedTicket {
    pub(crate) ticket: Ticket,
    pub(crate) radiance_w_m2_sr: Vec<f32>,
    pub(crate) passes: Vec<PassTime>,
    pub(crate) batch_size: usize,
    pub(crate) executor: ExecutorKind,
}

impl RenderedTicket {
    /// Puts near lights right and answers; false where that failed.
    fn answer(self, set: &TableSet) -> bool {
        let Self { ticket: Ticket { prepared, answer }, radiance_w_m2_sr, passes, batch_size, executor } =
            self;
        // Nobody waits for an answer whose receiver is gone.
        if answer.is_closed() {
            return true;
        }
        let finish = || -> Result<Rendered, RenderError> {
            let (mut sky, mut passes) = (radiance_w_m2_sr, passes);
            if let Some(near) = &prepared.near {
                let start = Instant::now();
                near.add_to(set, &mut sky);
                let microseconds = start.elapsed().as_secs_f64() * 1e6;
                passes.push(PassTime { name: NEAR_LIGHTS, microseconds });
            }
            let (work, basis_count) = (prepared.work(), prepared.basis_count);
            let panorama = Panorama::from_samples(sky)
                .ok_or_else(|| DeviceFault::Other("a panorama of the wrong size came back".into()))?;
            Ok(Rendered { panorama, passes, batch_size, executor, work, basis_count })
        };
        // A panic fails this one request, where it would end the process.
        let finished = catch_unwind(AssertUnwindSafe(finish))
            .unwrap_or_else(|_| Err(DeviceFault::Other("near lights panicked".into()).into()));
        let is_whole = finished.is_ok();
        let _ = answer.send(finished);
        is_whole
    }
}

/// Requests that are being finished.
pub(crate) struct Finishers {
    in_hand: Arc<InHand>,
    most: usize,
    set: Arc<TableSet>,
    stats: Arc<StatsCell>,
}

impl Finishers {
    /// For requests of a set of packs.
    pub(crate) fn new(set: &Arc<TableSet>, stats: &Arc<StatsCell>) -> Self {
        let most = rayon::current_num_threads().max(crate::MAX_BATCH);
        Self { in_hand: Arc::default(), most, set: Arc::clone(set), stats: Arc::clone(stats) }
    }

    /// Has a request answered, at once where nothing is left to do; waits while too many are being finished.
    pub(crate) fn finish(&self, rendered: RenderedTicket) {
        let (set, stats) = (Arc::clone(&self.set), Arc::clone(&self.stats));
        let needs_work = rendered.ticket.prepared.near.is_some();
        let answer = move || {
            if !rendered.answer(&set) {
                stats.failed.fetch_add(1, Ordering::Relaxed);
            }
        };
        if needs_work {
            let place = InHand::take(&self.in_hand, self.most);
            rayon::spawn(move || {
                // The place last: an engine that ends waits for it, and is then the last to hold its packs.
                answer();
                drop(place);
            });
        } else {
            answer();
        }
    }
}

impl Drop for Finishers {
    /// Whoever waits for an answer gets it first.
    fn drop(&mut self) {
        drop(self.in_hand.wait_for_fewer_than(1));
    }
}

/// How many requests are in hand.
#[derive(Default)]
struct InHand {
    count: Mutex<usize>,
    fewer: Condvar,
}

impl InHand {
    /// A place for one more, once there are fewer than `most`.
    fn take(in_hand: &Arc<Self>, most: usize) -> Place {
        *in_hand.wait_for_fewer_than(most) += 1;
        Place(Arc::clone(in_hand))
    }

    fn wait_for_fewer_than(&self, most: usize) -> MutexGuard<'_, usize> {
        let count = self.count.lock().unwrap_or_else(PoisonError::into_inner);
        self.fewer.wait_while(count, |count| *count >= most).unwrap_or_else(PoisonError::into_inner)
    }
}

/// A request's place among those in hand.
struct Place(Arc<InHand>);

impl Drop for Place {
    fn drop(&mut self) {
        *self.0.count.lock().unwrap_or_else(PoisonError::into_inner) -= 1;
        self.0.fewer.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{thread, time::Duration};

    #[test]
    fn no_more_are_in_hand_than_there_may_be_and_each_gives_its_place_back() {
        let in_hand = Arc::new(InHand::default());
        let first = InHand::take(&in_hand, 2);
        let second = InHand::take(&in_hand, 2);
        let third = thread::spawn({
            let in_hand = Arc::clone(&in_hand);
            move || drop(InHand::take(&in_hand, 2))
        });
        thread::sleep(Duration::from_millis(20));
        assert!(!third.is_finished());
        drop(first);
        third.join().unwrap();
        drop(second);
        assert_eq!(*in_hand.wait_for_fewer_than(1), 0);
    }
}
