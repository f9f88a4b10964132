//! What becomes of the sums of patches while they are computed: progress, checkpoints, cancellation.

use super::place_window::PlaceWindow;

/// Is given the sums of every patch that is done, and may know some from an earlier run. Called from any thread.
pub trait PatchStore: Sync {
    /// The sums of a patch by its number, `count` of them, if they are stored.
    fn load(&self, patch: u64, count: usize) -> Option<Vec<f32>>;

    /// Takes the sums of a patch that is done, and with it this fraction of all places; false cancels the computation.
    fn store(&self, patch: u64, sums: &[f32], progress: f64) -> bool;

    /// Whether any of these places is wanted; the sums of others need not be found, and are NaN.
    fn wants(&self, _: &PlaceWindow) -> bool {
        true
    }
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

/// One of several computations whose patches one store is given.
pub(crate) struct Stage<'a> {
    pub(crate) store: &'a dyn PatchStore,
    /// Added to the numbers of its patches, which are below it.
    pub(crate) first_number: u64,
    /// Progress where it begins and where it ends.
    pub(crate) progress: [f64; 2],
}

impl PatchStore for Stage<'_> {
    fn load(&self, patch: u64, count: usize) -> Option<Vec<f32>> {
        self.store.load(self.first_number + patch, count)
    }

    fn store(&self, patch: u64, sums: &[f32], progress: f64) -> bool {
        let [begin, end] = self.progress;
        self.store.store(self.first_number + patch, sums, begin + progress * (end - begin))
    }

    fn wants(&self, places: &PlaceWindow) -> bool {
        self.store.wants(places)
    }
}
