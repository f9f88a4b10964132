//! Who asks, known to whatever is done for a request; and whether somebody still waits for it.

use crate::{fair::Turn, party::Party};
use std::{
    future::Future,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU32, Ordering},
    },
};

tokio::task_local! {
    static ASKER: Arc<Asker>;
}

/// One request, from its beginning to its answer.
#[derive(Debug, Default)]
pub(crate) struct Asker {
    party: Party,
    work: Arc<Work>,
    /// Its place among the requests that are worked on, once it has one.
    place: Mutex<Option<Turn>>,
}

/// Work for a request, as those see it who do it and those who wait for it.
#[derive(Debug, Default)]
pub(crate) struct Work {
    is_gone: AtomicBool,
    /// Whether it goes on though nobody waits.
    goes_on: AtomicBool,
    has_begun: AtomicBool,
    /// Whether who waits for it has all the time: a job.
    is_job: bool,
    /// Millionths.
    done: AtomicU32,
}

impl Work {
    /// Of a job.
    pub(crate) fn of_job() -> Arc<Self> {
        Arc::new(Self { is_job: true, ..Self::default() })
    }

    pub(crate) fn is_job(&self) -> bool {
        self.is_job
    }

    /// Says how far it is; whether to go on.
    pub(crate) fn note(&self, done: f64) -> bool {
        self.has_begun.store(true, Ordering::Relaxed);
        self.done.store((done.clamp(0.0, 1.0) * 1e6) as u32, Ordering::Relaxed);
        !self.is_gone.load(Ordering::Relaxed) || self.goes_on.load(Ordering::Relaxed)
    }

    /// Has what has begun go on though nobody will wait: it is worth keeping.
    pub(crate) fn go_on(&self) {
        let has_begun = self.has_begun.load(Ordering::Relaxed);
        self.goes_on.store(has_begun, Ordering::Relaxed);
    }

    /// The part that is done, 0 to 1; None before it began.
    pub(crate) fn done(&self) -> Option<f64> {
        let has_begun = self.has_begun.load(Ordering::Relaxed);
        has_begun.then(|| f64::from(self.done.load(Ordering::Relaxed)) * 1e-6)
    }
}

impl Asker {
    pub(crate) fn new(party: Party, work: Arc<Work>) -> Arc<Self> {
        Arc::new(Self { party, work, place: Mutex::default() })
    }

    /// Whether the request has a place.
    pub(crate) fn has_place(&self) -> bool {
        self.place.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// Has a place for as long as the request takes.
    pub(crate) fn take_place(&self, place: Turn) {
        *self.place.lock().unwrap_or_else(PoisonError::into_inner) = Some(place);
    }

    /// Gives its place to others.
    pub(crate) fn leave_place(&self) {
        let place = self.place.lock().unwrap_or_else(PoisonError::into_inner).take();
        drop(place);
    }

    /// Work that is done for it.
    pub(crate) fn work(&self) -> Arc<Work> {
        Arc::clone(&self.work)
    }

    /// Does something for it; when that is given up, so is the work.
    pub(crate) async fn scope<T>(self: Arc<Self>, future: impl Future<Output = T>) -> T {
        ASKER.scope(self, future).await
    }
}

impl Drop for Asker {
    fn drop(&mut self) {
        self.work.is_gone.store(true, Ordering::Relaxed);
    }
}

/// The request that something is done for here.
pub(crate) fn current() -> Arc<Asker> {
    ASKER.try_with(Arc::clone).unwrap_or_default()
}

/// Who asks for what is done here.
pub(crate) fn party() -> Party {
    ASKER.try_with(|asker| asker.party).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Work goes on while its request is waited for, and not after.
    #[tokio::test]
    async fn work_ends_with_its_request() {
        let asker = Asker::new(Party::V4(1), Arc::default());
        let work = asker.work();
        assert_eq!(work.done(), None);
        let request = tokio::spawn(asker.scope(std::future::pending::<()>()));
        tokio::task::yield_now().await;
        assert!(work.note(0.25));
        assert_eq!(work.done(), Some(0.25));
        request.abort();
        assert!(request.await.is_err());
        assert!(!work.note(0.5));
        work.go_on();
        assert!(work.note(0.5));
    }
}
