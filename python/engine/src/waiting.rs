//! Work beside Python: other Python threads go on, and Ctrl-C ends it.

use pyo3::{PyResult, Python};
use std::{
    panic::resume_unwind,
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::{RecvTimeoutError, channel},
    },
    thread,
    time::Duration,
};

/// How long after Ctrl-C at most the work is told to end.
const PATIENCE: Duration = Duration::from_millis(50);

/// Does work on a thread of its own without holding Python's lock, and answers what it made, or what a signal handler raised meanwhile.
///
/// * `work`: given whether to go on; it ends soon when that turns false.
pub(crate) fn beside_python<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> PyResult<T> {
    let goes_on = AtomicBool::new(true);
    let goes_on = &goes_on;
    py.detach(move || {
        let (done, is_done) = channel::<()>();
        thread::scope(|scope| {
            let worker = scope.spawn(move || {
                // Dropped at the end, by a panic too.
                let _done = done;
                work(goes_on)
            });
            let mut raised = Ok(());
            while raised.is_ok() && is_done.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                raised = Python::attach(|py| py.check_signals());
            }
            if raised.is_err() {
                goes_on.store(false, Ordering::Relaxed);
            }
            let made = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
            raised.map(|()| made)
        })
    })
}
