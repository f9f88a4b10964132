//! What travels between the engine, the thread that owns the device and the pool behind it.

use crate::{
    error::RenderError,
    prepare::Prepared,
    request::{ExecutorKind, PassTime, Rendered},
};
use tokio::sync::oneshot;

/// A request and where its answer goes.
#[derive(Debug)]
pub(crate) struct Job {
    pub(crate) prepared: Prepared,
    pub(crate) answer: oneshot::Sender<Result<Rendered, RenderError>>,
}

/// What the thread is told.
#[derive(Debug)]
pub(crate) enum Command {
    Render(Box<Job>),
    LoseDevice,
}

/// A request that the device is done with.
pub(crate) struct RenderedJob {
    pub(crate) job: Job,
    pub(crate) radiance_w_m2_sr: Vec<f32>,
    pub(crate) passes: Vec<PassTime>,
    pub(crate) batch_size: usize,
    pub(crate) executor: ExecutorKind,
}
