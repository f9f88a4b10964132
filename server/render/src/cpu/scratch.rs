//! A pool of buffers that requests reuse: fresh ones of a megabyte come from the kernel page by page, which takes longer than
//! filling them.

use super::layout::{CellWeights, ColumnBlock, FrequencySums, GroupSpectra, MixedNode, NodeScales};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What the passes of one pack write, in the order in which they do.
#[derive(Default)]
pub struct Scratch {
    /// The scales of the mixed nodes.
    pub scales: Vec<NodeScales>,
    /// The mixed nodes.
    pub mixed: Vec<MixedNode>,
    /// The weights of the cells between nodes.
    pub weights: Vec<CellWeights>,
    /// Coefficients of the lit columns.
    pub columns: Vec<ColumnBlock>,
    /// Spectra of the coefficients along azimuth.
    pub spectra: Vec<GroupSpectra>,
    /// Sums over the basis by frequency.
    pub sums: Vec<FrequencySums>,
}

/// Buffers that are not in use. They hold what was left in them: whoever takes one writes before reading.
#[derive(Default)]
pub struct ScratchPool {
    idle: Mutex<Vec<Scratch>>,
    panoramas: Mutex<Vec<Vec<f32>>>,
}

/// Panoramas in the pool at most: those of a batch of requests between four packs each.
const MAX_POOLED_PANORAMAS: usize = 3 * crate::MAX_BATCH;

impl ScratchPool {
    /// Buffers, those used last first: they may still be in the cache.
    pub fn take(&self) -> Scratch {
        lock(&self.idle).pop().unwrap_or_default()
    }

    /// Takes buffers back. There are never more than were in use at once.
    pub fn keep(&self, scratch: Scratch) {
        lock(&self.idle).push(scratch);
    }

    /// A buffer for a panorama, of whatever length and content.
    pub fn take_panorama(&self) -> Vec<f32> {
        lock(&self.panoramas).pop().unwrap_or_default()
    }

    /// Takes a panorama back that no answer went out with.
    pub fn keep_panorama(&self, panorama: Vec<f32>) {
        let mut panoramas = lock(&self.panoramas);
        if panoramas.len() < MAX_POOLED_PANORAMAS {
            panoramas.push(panorama);
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
