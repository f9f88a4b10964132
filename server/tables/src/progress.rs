//! Progress of the work on a pack.

/// Receives the progress of a precompute.
pub trait Progress: Sync {
    /// A stage begins, with this many steps.
    fn begin(&self, stage: &str, steps: u64);
    /// Some steps are done.
    fn advance(&self, steps: u64);
}

/// Ignores it.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProgress;

impl Progress for NoProgress {
    fn begin(&self, _stage: &str, _steps: u64) {}
    fn advance(&self, _steps: u64) {}
}
