//! The post-process pool: the near-field correction of rendered skies, on the pool of threads, so that the device goes on.
//!
//! It takes as many requests at once as a batch has, or as there are threads: a thread of the pool that waits for a part of one begins
//! another, and each holds a sky in memory. A faster render thread waits.

use crate::{
    error::{DeviceFault, RenderError},
    job::{Job, RenderedJob},
    request::{PassTime, Rendered},
    stats::StatsCell,
    table_set::TableSet,
};
use skyglow_physics::Panorama;
use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, atomic::Ordering},
    time::Instant,
};

/// The name of the correction's time among those of passes: it is spent on the processor, whatever renders.
const NEAR_LIGHTS: &str = "near_lights";

impl RenderedJob {
    /// Corrects the near field and answers; false where that failed.
    fn answer(self, set: &TableSet) -> bool {
        let Self { job: Job { prepared, answer }, radiance_w_m2_sr, passes, batch_size, executor } = self;
        // Nobody waits for an answer whose receiver is gone.
        if answer.is_closed() {
            return true;
        }
        let finish = || -> Result<Rendered, RenderError> {
            let (mut sky, mut passes) = (radiance_w_m2_sr, passes);
            if let Some(near) = &prepared.near {
                let start = Instant::now();
                near.apply(set, &mut sky);
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
            .unwrap_or_else(|_| Err(DeviceFault::Other("the near-field correction panicked".into()).into()));
        let is_whole = finished.is_ok();
        let _ = answer.send(finished);
        is_whole
    }
}

/// Where requests are finished.
pub(crate) struct PostProcessPool {
    permits: Arc<Permits>,
    limit: usize,
    set: Arc<TableSet>,
    stats: Arc<StatsCell>,
}

impl PostProcessPool {
    /// For requests of a set of packs.
    pub(crate) fn new(set: &Arc<TableSet>, stats: &Arc<StatsCell>) -> Self {
        let limit = rayon::current_num_threads().max(crate::MAX_BATCH);
        Self { permits: Arc::default(), limit, set: Arc::clone(set), stats: Arc::clone(stats) }
    }

    /// Answers a request: at once where nothing is left to do, else from the pool; waits while too many are being finished.
    pub(crate) fn finish(&self, rendered: RenderedJob) {
        let (set, stats) = (Arc::clone(&self.set), Arc::clone(&self.stats));
        let needs_work = rendered.job.prepared.near.is_some();
        let answer = move || {
            if !rendered.answer(&set) {
                stats.failed.fetch_add(1, Ordering::Relaxed);
            }
        };
        if needs_work {
            let permit = Permits::take(&self.permits, self.limit);
            rayon::spawn(move || {
                // The permit last: an engine that ends waits for it, and is then the last to hold its packs.
                answer();
                drop(permit);
            });
        } else {
            answer();
        }
    }
}

impl Drop for PostProcessPool {
    /// Whoever waits for an answer gets it first.
    fn drop(&mut self) {
        drop(self.permits.wait_for_fewer_than(1));
    }
}

/// How many requests are being finished: a counting semaphore.
#[derive(Default)]
struct Permits {
    count: Mutex<usize>,
    fewer: Condvar,
}

impl Permits {
    /// A permit for one more, once there are fewer than `limit`.
    fn take(permits: &Arc<Self>, limit: usize) -> Permit {
        *permits.wait_for_fewer_than(limit) += 1;
        Permit(Arc::clone(permits))
    }

    fn wait_for_fewer_than(&self, limit: usize) -> MutexGuard<'_, usize> {
        let count = self.count.lock().unwrap_or_else(PoisonError::into_inner);
        self.fewer.wait_while(count, |count| *count >= limit).unwrap_or_else(PoisonError::into_inner)
    }
}

/// Lets one request be finished, and another once dropped.
struct Permit(Arc<Permits>);

impl Drop for Permit {
    fn drop(&mut self) {
        *self.0.count.lock().unwrap_or_else(PoisonError::into_inner) -= 1;
        self.0.fewer.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{thread, time::Duration};

    /// No more requests are finished at once than may be, and each gives its permit back.
    #[test]
    fn permits_are_limited_and_come_back() {
        let permits = Arc::new(Permits::default());
        let first = Permits::take(&permits, 2);
        let second = Permits::take(&permits, 2);
        let third = thread::spawn({
            let permits = Arc::clone(&permits);
            move || drop(Permits::take(&permits, 2))
        });
        thread::sleep(Duration::from_millis(20));
        assert!(!third.is_finished());
        drop(first);
        third.join().unwrap();
        drop(second);
        assert_eq!(*permits.wait_for_fewer_than(1), 0);
    }
}
