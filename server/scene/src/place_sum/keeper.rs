//! What becomes of sums while they are found.

/// Is told of every stretch of ground that is done, and may know some from before. Called from any thread.
pub trait SumKeeper: Sync {
    /// The sums of a stretch, by its number, if they are known: so many.
    fn kept(&self, stretch: u64, count: usize) -> Option<Vec<f32>>;

    /// A stretch is done, and this share of all places with it; false ends the work.
    fn keep(&self, stretch: u64, sums: &[f32], share: f64) -> bool;
}

/// Told the share alone.
impl<F: Fn(f64) -> bool + Sync> SumKeeper for F {
    fn kept(&self, _: u64, _: usize) -> Option<Vec<f32>> {
        None
    }

    fn keep(&self, _: u64, _: &[f32], share: f64) -> bool {
        self(share)
    }
}
