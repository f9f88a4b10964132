//! Jobs, as they go from the engine to the render thread and on to the post-process pool.

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

/// A command to the render thread.
#[derive(Debug)]
pub(crate) enum Command {
    Render(Box<Job>),
    LoseDevice,
}

/// A job whose passes have run.
pub(crate) struct RenderedJob {
    pub(crate) job: Job,
    pub(crate) radiance_w_m2_sr: Vec<f32>,
    pub(crate) passes: Vec<PassTime>,
    pub(crate) batch_size: usize,
    pub(crate) executor: ExecutorKind,
}
