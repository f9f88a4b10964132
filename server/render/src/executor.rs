//! The interface of a device to the render thread.

use crate::{error::DeviceFault, plan::Pass, prepare::Prepared, request::ExecutorKind, request::PassTime};
use std::time::Instant;

/// A batch's result.
pub(crate) struct BatchOutput {
    /// One panorama a request, `[band][row][column]`, W m⁻² sr⁻¹.
    pub(crate) radiance_w_m2_sr: Vec<Vec<f32>>,
    /// Times of the passes for the whole batch.
    pub(crate) passes: Vec<PassTime>,
}

/// Renders batches of compatible requests with light, at most [`crate::MAX_BATCH`] at once.
pub(crate) trait Executor {
    /// What it is.
    fn kind(&self) -> ExecutorKind;
    /// Bytes of tables and workspace.
    fn resident_bytes(&self) -> u64;
    /// Renders a batch.
    fn render(&mut self, batch: &[&Prepared]) -> Result<BatchOutput, DeviceFault>;
    /// Destroys the device, for tests of recovery.
    fn lose(&mut self);
}

/// Sums up time by pass.
#[derive(Default)]
pub(crate) struct PassClock {
    microseconds: [Option<f64>; Pass::ALL.len()],
}

impl PassClock {
    /// Runs and times `work`.
    pub(crate) fn time<T>(&mut self, pass: Pass, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.add(pass, start.elapsed().as_secs_f64() * 1e6);
        result
    }

    /// Adds time measured elsewhere.
    pub(crate) fn add(&mut self, pass: Pass, microseconds: f64) {
        *self.microseconds[pass.index()].get_or_insert(0.0) += microseconds;
    }

    /// Adds the times of work that ran beside this.
    pub(crate) fn merge(&mut self, other: &Self) {
        for (pass, microseconds) in Pass::ALL.into_iter().zip(other.microseconds) {
            microseconds.into_iter().for_each(|microseconds| self.add(pass, microseconds));
        }
    }

    /// Makes the sum of all times `microseconds`, each its share of it, where it is more: for passes that ran side by
    /// side.
    pub(crate) fn scale_to(&mut self, microseconds: f64) {
        let sum: f64 = self.microseconds.iter().flatten().sum();
        let factor = (microseconds / sum).min(1.0);
        self.microseconds.iter_mut().flatten().for_each(|time| *time *= factor);
    }

    /// The passes that ran, in order.
    pub(crate) fn into_passes(self) -> Vec<PassTime> {
        Pass::ALL
            .into_iter()
            .filter_map(|pass| {
                let microseconds = self.microseconds[pass.index()]?;
                Some(PassTime { name: pass.name(), microseconds })
            })
            .collect()
    }
}
