//! The engine: the public interface of this crate.

use crate::{
    MAX_BATCH,
    config::EngineConfig,
    cpu::kept_shapes::MAX_KEPT_BYTES,
    error::RenderError,
    job::{Command, Job},
    pack_kind::ResidentKind,
    prepare::Prepared,
    request::{ExecutorKind, RenderRequest, Rendered},
    stats::{EngineStats, StatsCell},
    table_set::TableSet,
    truncation::BasisChooser,
    worker,
};
use serde::Serialize;
use skyglow_tables::resident::ResidentTables;
use std::{
    sync::{
        Arc,
        atomic::Ordering,
        mpsc::{SyncSender, TrySendError},
    },
    thread::JoinHandle,
};
use tokio::sync::oneshot;

/// What an engine runs on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EngineInfo {
    /// `gpu`, `lavapipe` or `cpu`.
    pub executor: ExecutorKind,
    /// Name of the adapter.
    pub adapter: String,
    /// Name and version of its driver.
    pub driver: String,
    /// Bytes of packs and workspace.
    pub resident_bytes: u64,
    /// The kinds of packs with their turbidities, the best last; never empty.
    pub kinds: Vec<ResidentKind>,
    /// Observer altitudes allowed, metres.
    pub altitude_range_m: [f64; 2],
}

/// Renders skies on its own thread. Dropping it ends the thread after the work in hand.
#[derive(Debug)]
pub struct Engine {
    set: Arc<TableSet>,
    basis: Arc<BasisChooser>,
    info: EngineInfo,
    stats: Arc<StatsCell>,
    queue: Option<SyncSender<Command>>,
    capacity: usize,
    thread: Option<JoinHandle<()>>,
}

impl Engine {
    /// Checks the packs, opens the device and puts the packs on it. Pipelines warm up behind the answer:
    /// see [`Self::is_ready`]; requests are accepted at once.
    ///
    /// # Errors
    /// No packs or packs that do not fit together, no such device, or too little memory for the packs.
    pub fn start(config: EngineConfig) -> Result<Self, RenderError> {
        let set = Arc::new(TableSet::new(config.tables.clone())?);
        let stats = Arc::new(StatsCell::default());
        let capacity = config.queue_capacity.max(1);
        let (queue, thread, opened) = worker::spawn(&config, capacity, Arc::clone(&set), Arc::clone(&stats))?;
        let info = EngineInfo {
            executor: opened.kind,
            adapter: opened.adapter,
            driver: opened.driver,
            resident_bytes: opened.resident_bytes,
            kinds: set.kinds().to_vec(),
            altitude_range_m: [0.0, set.highest_observer_m()],
        };
        let basis = Arc::new(BasisChooser::new(Arc::clone(&set)));
        Ok(Self { set, basis, info, stats, queue: Some(queue), capacity, thread: Some(thread) })
    }

    /// What it runs on.
    pub fn info(&self) -> &EngineInfo {
        &self.info
    }

    /// Bytes of main memory that packs take: as they are laid out, once more on a device that is none, and their bases as plain
    /// Rust has them, for rendering and for influences; where plain Rust renders, with what it keeps of them mixed.
    pub fn main_memory_bytes(&self) -> u64 {
        let sum = |bytes: fn(&ResidentTables) -> usize| -> u64 {
            self.tables().iter().map(|tables| bytes(tables) as u64).sum()
        };
        let (tables, bases) =
            (sum(ResidentTables::byte_count), sum(|tables| size_of_val(&tables.basis_spectrum[..])));
        tables
            + match self.info.executor {
                ExecutorKind::Cpu => 2 * bases + MAX_KEPT_BYTES as u64,
                ExecutorKind::Lavapipe => bases + self.info.resident_bytes,
                ExecutorKind::Gpu => bases,
            }
    }

    /// True once every pipeline has run, and until a device fails that cannot be made anew at once.
    pub fn is_ready(&self) -> bool {
        self.stats.ready.load(Ordering::Acquire)
    }

    /// Counters since the start.
    pub fn stats(&self) -> EngineStats {
        self.stats.snapshot(self.capacity)
    }

    /// What chooses the number of basis functions for a wanted accuracy.
    pub fn basis_chooser(&self) -> Arc<BasisChooser> {
        Arc::clone(&self.basis)
    }

    /// The resident packs.
    pub fn tables(&self) -> &[Arc<ResidentTables>] {
        self.set.tables()
    }

    /// The same, checked to fit together.
    pub fn table_set(&self) -> Arc<TableSet> {
        Arc::clone(&self.set)
    }

    /// Renders one sky. Never blocks the calling task.
    ///
    /// # Errors
    /// A value out of range, a full queue, a stopped engine, or a device that fails twice in a row.
    pub async fn render(&self, request: RenderRequest) -> Result<Rendered, RenderError> {
        self.submit(&request)?.await.unwrap_or(Err(RenderError::Stopped))
    }

    /// [`Self::render`] for threads outside an asynchronous runtime. Panics inside one.
    ///
    /// # Errors
    /// As [`Self::render`].
    pub fn render_blocking(&self, request: RenderRequest) -> Result<Rendered, RenderError> {
        self.submit(&request)?.blocking_recv().unwrap_or(Err(RenderError::Stopped))
    }

    /// Renders parts of one sky, in a batch if they fit.
    ///
    /// # Errors
    /// As [`Self::render`].
    pub async fn render_each(&self, parts: &[RenderRequest]) -> Result<Vec<Rendered>, RenderError> {
        let mut skies = Vec::with_capacity(parts.len());
        for batch in parts.chunks(MAX_BATCH) {
            let waiting: Vec<_> = batch.iter().map(|part| self.submit(part)).collect::<Result<_, _>>()?;
            for part in waiting {
                skies.push(part.await.unwrap_or(Err(RenderError::Stopped))?);
            }
        }
        Ok(skies)
    }

    /// [`Self::render_each`] for threads outside an asynchronous runtime. Panics inside one.
    ///
    /// # Errors
    /// As [`Self::render`].
    pub fn render_each_blocking(&self, parts: &[RenderRequest]) -> Result<Vec<Rendered>, RenderError> {
        pollster::block_on(self.render_each(parts))
    }

    /// Destroys the device under the engine, which must recover by itself: for tests of recovery.
    ///
    /// # Errors
    /// A full queue or a stopped engine.
    pub fn lose_device(&self) -> Result<(), RenderError> {
        self.send(Command::LoseDevice)
    }

    fn submit(
        &self,
        request: &RenderRequest,
    ) -> Result<oneshot::Receiver<Result<Rendered, RenderError>>, RenderError> {
        let prepared = Prepared::new(request, &self.set)?;
        let (answer, receiver) = oneshot::channel();
        if prepared.is_dark() {
            self.stats.dark_requests.fetch_add(1, Ordering::Relaxed);
            let _ = answer.send(Ok(Rendered::dark(self.info.executor)));
            return Ok(receiver);
        }
        self.stats.queued.fetch_add(1, Ordering::Relaxed);
        let sent = self.send(Command::Render(Box::new(Job { prepared, answer })));
        if sent.is_err() {
            self.stats.queued.fetch_sub(1, Ordering::Relaxed);
        }
        sent.map(|()| receiver)
    }

    fn send(&self, command: Command) -> Result<(), RenderError> {
        let queue = self.queue.as_ref().ok_or(RenderError::Stopped)?;
        queue.try_send(command).map_err(|refused| match refused {
            TrySendError::Full(_) => {
                self.stats.refused.fetch_add(1, Ordering::Relaxed);
                RenderError::Busy { capacity: self.capacity }
            }
            TrySendError::Disconnected(_) => RenderError::Stopped,
        })
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        self.queue = None;
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            tracing::error!("the render thread panicked");
        }
    }
}
