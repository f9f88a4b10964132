//! Counters of the engine.

use crate::{plan::Pass, request::PassTime, request::WorkCount};
use serde::Serialize;
use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicBool, AtomicU64, Ordering},
};

/// Counters since the start.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EngineStats {
    /// Requests waiting now.
    pub queue_length: u64,
    /// Requests that may wait.
    pub queue_capacity: usize,
    /// Requests answered with a rendered panorama.
    pub rendered: u64,
    /// Requests answered without rendering, because there was no light.
    pub dark_requests: u64,
    /// Requests refused because the queue was full.
    pub refused: u64,
    /// Requests that a device fault failed.
    pub failed: u64,
    /// Submissions.
    pub batches: u64,
    /// Requests in the largest batch.
    pub largest_batch: u64,
    /// Times the device was lost and made anew.
    pub device_losses: u64,
    /// Nodes mixed, over all packs.
    pub mixed_nodes: u64,
    /// Lit cells processed, over all packs.
    pub lit_cells: u64,
    /// Lit columns processed, over all packs.
    pub lit_columns: u64,
    /// Total time of each pass.
    pub passes: Vec<PassTime>,
}

/// The counters as the threads share them.
#[derive(Debug, Default)]
pub(crate) struct StatsCell {
    pub(crate) ready: AtomicBool,
    pub(crate) queued: AtomicU64,
    pub(crate) refused: AtomicU64,
    pub(crate) dark_requests: AtomicU64,
    pub(crate) rendered: AtomicU64,
    pub(crate) failed: AtomicU64,
    pub(crate) batches: AtomicU64,
    pub(crate) largest_batch: AtomicU64,
    pub(crate) device_losses: AtomicU64,
    mixed_nodes: AtomicU64,
    lit_cells: AtomicU64,
    lit_columns: AtomicU64,
    pass_microseconds: Mutex<[f64; Pass::ALL.len()]>,
}

impl StatsCell {
    /// Counts a rendered request.
    pub(crate) fn count_work(&self, work: WorkCount) {
        let packs = work.packs as u64;
        self.mixed_nodes.fetch_add(packs * work.mixed_nodes as u64, Ordering::Relaxed);
        self.lit_cells.fetch_add(packs * work.lit_cells as u64, Ordering::Relaxed);
        self.lit_columns.fetch_add(packs * work.lit_columns as u64, Ordering::Relaxed);
        self.rendered.fetch_add(1, Ordering::Relaxed);
    }

    /// Counts a batch and its times.
    pub(crate) fn count_batch(&self, requests: usize, passes: &[PassTime]) {
        self.batches.fetch_add(1, Ordering::Relaxed);
        self.largest_batch.fetch_max(requests as u64, Ordering::Relaxed);
        let mut totals = self.pass_microseconds.lock().unwrap_or_else(PoisonError::into_inner);
        for pass in Pass::ALL {
            if let Some(time) = passes.iter().find(|time| time.name == pass.name()) {
                totals[pass.index()] += time.microseconds;
            }
        }
    }

    /// All counters, read one by one.
    pub(crate) fn snapshot(&self, queue_capacity: usize) -> EngineStats {
        let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let totals = *self.pass_microseconds.lock().unwrap_or_else(PoisonError::into_inner);
        EngineStats {
            queue_length: read(&self.queued),
            queue_capacity,
            rendered: read(&self.rendered),
            dark_requests: read(&self.dark_requests),
            refused: read(&self.refused),
            failed: read(&self.failed),
            batches: read(&self.batches),
            largest_batch: read(&self.largest_batch),
            device_losses: read(&self.device_losses),
            mixed_nodes: read(&self.mixed_nodes),
            lit_cells: read(&self.lit_cells),
            lit_columns: read(&self.lit_columns),
            passes: Pass::ALL
                .into_iter()
                .map(|pass| PassTime { name: pass.name(), microseconds: totals[pass.index()] })
                .collect(),
        }
    }
}
