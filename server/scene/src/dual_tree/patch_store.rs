//! What becomes of the sums of patches while they are computed: progress, checkpoints, cancellation.

/// Is given the sums of every patch that is done, and may know some from an earlier run. Called from any thread.
pub trait PatchStore: Sync {
    /// The sums of a patch by its number, `count` of them, if they are stored.
    fn load(&self, patch: u64, count: usize) -> Option<Vec<f32>>;

    /// Takes the sums of a patch that is done, and with it this fraction of all places; false cancels the computation.
    fn store(&self, patch: u64, sums: &[f32], progress: f64) -> bool;
}

/// Given the progress alone; nothing is stored.
impl<F: Fn(f64) -> bool + Sync> PatchStore for F {
    fn load(&self, _: u64, _: usize) -> Option<Vec<f32>> {
        None
    }

    fn store(&self, _: u64, _: &[f32], progress: f64) -> bool {
        self(progress)
    }
}
