//! How far work is that goes on behind answers.

use std::{
    collections::HashMap,
    sync::{Arc, Mutex, PoisonError},
    time::Instant,
};

/// Longest time until it is worth asking again, seconds.
const MAX_RETRY_S: f64 = 30.0;

/// How far each piece of work is, by what decides it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Progress(Arc<Mutex<HashMap<String, Step>>>);

#[derive(Clone, Copy, Debug)]
struct Step {
    began: Instant,
    done: f64,
}

/// A piece of work until this is dropped.
#[derive(Debug)]
pub(crate) struct Work {
    all: Progress,
    key: String,
}

impl Progress {
    /// Begins a piece of work.
    pub(crate) fn begin(&self, key: &str) -> Work {
        let step = Step { began: Instant::now(), done: 0.0 };
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(key.to_owned(), step);
        Work { all: self.clone(), key: key.to_owned() }
    }

    /// The part that is done, 0 to 1, and the seconds until it is worth asking again; None where nobody is at it, which waits
    /// for other work.
    pub(crate) fn of(&self, key: &str) -> Option<(f64, u64)> {
        let step = *self.0.lock().unwrap_or_else(PoisonError::into_inner).get(key)?;
        let elapsed_s = step.began.elapsed().as_secs_f64();
        let left_s = elapsed_s * (1.0 - step.done) / step.done.max(1e-3);
        Some((step.done, left_s.clamp(1.0, MAX_RETRY_S).ceil() as u64))
    }
}

impl Work {
    /// Notes how far it is.
    pub(crate) fn set(&self, done: f64) {
        let mut steps = self.all.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(step) = steps.get_mut(&self.key) {
            step.done = done.clamp(0.0, 1.0);
        }
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        self.all.0.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.key);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_known_while_it_goes_on() {
        let all = Progress::default();
        assert_eq!(all.of("a"), None);
        let work = all.begin("a");
        assert_eq!(all.of("a"), Some((0.0, 1)));
        work.set(0.25);
        assert_eq!((all.of("a").unwrap().0, all.of("b")), (0.25, None));
        drop(work);
        assert_eq!(all.of("a"), None);
    }
}
