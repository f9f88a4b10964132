//! Where work is done for requests: places, cores, memory, and queues before what takes long. Answers that are there already need
//! none of it.

use crate::{
    asker::{self, Work},
    budget::{Budget, Held},
    config::HttpConfig,
    error::ApiError,
    fair::{Crowded, FairQueue},
    metrics::Metrics,
    token_buckets::TokenBuckets,
};
use axum::body::Bytes;
use skyglow_app::{error::AppError, source::SkySource};
use std::{sync::Arc, time::Instant};
use tokio::sync::Semaphore;
use tracing::Instrument;

/// Part of the requests at a time that are worked on; the others wait for their turn.
const PART_WORKED_ON: usize = 4;
/// Part of all memory that answers in the cache may take.
pub(crate) const PART_FOR_CACHED_ANSWERS: u64 = 4;
/// Pictures that take more memory than this do not share that of others.
const LARGE_BYTES: usize = 32 << 20;
/// What a document takes that is made of what is kept, about.
const DOCUMENT_BYTES: usize = 4 << 20;
/// Maps of influences, plans and rasters that are found at a time; the others wait.
const AT_ONCE: usize = 2;
/// Scenes with changes that are resolved at a time.
const PAINTINGS: usize = 4;
/// Part of all places that may wait for one of those.
const PART_THAT_WAITS: usize = 4;
/// Maps of the zenith's brightness that wait for the one that is found.
const WAITING_MAPS: usize = 3;

/// What takes long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lane {
    /// Influences: up to a second each.
    Influence,
    /// Plans, and rasters of whole layers: seconds each.
    Plan,
    /// Maps of the zenith's brightness: up to a minute of all cores each.
    Map,
}

/// Memory for work of one kind, which waits for none of another; what takes more than all of it is done alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Room {
    Small,
    Large,
    Plans,
    Influences,
    /// For answers that are made, as long as anybody has them.
    Answers,
}

/// Eighths of all memory, by kind.
const EIGHTHS: [u64; 5] = [2, 2, 1, 1, 2];

/// The places for work.
pub(crate) struct WorkPlaces {
    source: Arc<dyn SkySource>,
    metrics: Arc<Metrics>,
    places: Arc<FairQueue>,
    memory: [Arc<Budget>; 5],
    /// Bytes that there are for all work.
    most_bytes: u64,
    cores: Arc<Semaphore>,
    large: Arc<FairQueue>,
    influences: Arc<FairQueue>,
    plans: Arc<FairQueue>,
    maps: Arc<FairQueue>,
    paintings: Arc<FairQueue>,
    /// Time for long work by client.
    pub(crate) shares: Arc<TokenBuckets>,
}

impl WorkPlaces {
    pub(crate) fn new(source: Arc<dyn SkySource>, metrics: Arc<Metrics>, config: &HttpConfig) -> Self {
        let memory = EIGHTHS.map(|eighths| {
            let bytes = config.memory_budget() / 8 * eighths;
            Budget::new(bytes, bytes, metrics.work_bytes.clone())
        });
        let cores = std::thread::available_parallelism().map_or(2, |cores| cores.get());
        let shares =
            Arc::new(TokenBuckets::new("work-seconds", config.work_per_minute_s / 60.0, config.work_burst_s));
        let waiting = (config.concurrent_requests / PART_THAT_WAITS).max(1);
        let queue = |places, waiting| FairQueue::new(places, waiting, Arc::clone(&shares));
        let worked_on = (config.concurrent_requests / PART_WORKED_ON).max(1);
        // Short work counts in nobody's time for long work.
        let unlimited = Arc::new(TokenBuckets::new("work", 0.0, 0.0));
        Self {
            source,
            metrics,
            places: FairQueue::new(worked_on, config.concurrent_requests - worked_on, Arc::clone(&unlimited)),
            large: FairQueue::new(cores.max(AT_ONCE), waiting, unlimited),
            memory,
            most_bytes: config.memory_budget(),
            cores: Arc::new(Semaphore::new(2 * cores)),
            influences: queue(AT_ONCE, waiting),
            plans: queue(AT_ONCE, waiting),
            maps: queue(1, WAITING_MAPS),
            paintings: queue(PAINTINGS, config.concurrent_requests),
            shares,
        }
    }

    /// A place for the request that this is done for, in its turn, unless it has one.
    ///
    /// # Errors
    /// [`AppError::Busy`] where too many wait.
    pub(crate) async fn place(&self) -> Result<(), AppError> {
        let asker = asker::current();
        if !asker.has_place() {
            let waiting =
                self.places.turn(asker::party()).instrument(tracing::info_span!("wait for a place"));
            asker.take_place(waiting.await.map_err(|_: Crowded| self.busy(1))?);
        }
        Ok(())
    }

    fn busy(&self, retry_after_s: u64) -> AppError {
        self.metrics.count_refused("busy");
        AppError::Busy { retry_after_s }
    }

    /// Memory for work, in the order of asking.
    async fn memory(&self, room: Room, bytes: usize) -> Result<Held, ApiError> {
        let held =
            self.memory[room as usize].hold(bytes).instrument(tracing::info_span!("wait for memory")).await;
        held.ok_or_else(|| ApiError::internal("the budget of memory is closed"))
    }

    /// Runs something that may read files or compute for long, off the async threads.
    ///
    /// # Errors
    /// Its own, and [`AppError::Internal`] where it panics.
    pub(crate) async fn blocking<T: Send + 'static>(
        &self,
        work: impl FnOnce(&dyn SkySource) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let source = self.source.clone();
        let span = tracing::info_span!("work");
        match tokio::task::spawn_blocking(move || span.in_scope(|| work(source.as_ref()))).await {
            Ok(result) => result,
            Err(error) => Err(ApiError::internal(format!("a worker failed: {error}"))),
        }
    }

    /// Resolves a scene; one with changes may have to be painted, few at a time.
    ///
    /// # Errors
    /// As [`Self::blocking`], and [`AppError::Busy`].
    pub(crate) async fn resolve<T: Send + 'static>(
        &self,
        is_changed: bool,
        work: impl FnOnce(&dyn SkySource) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        if !is_changed {
            return self.blocking(work).await;
        }
        let turn = self.paintings.turn(asker::party()).await.map_err(|_: Crowded| self.busy(1))?;
        self.blocking(move |source| {
            let resolved = work(source);
            drop(turn);
            resolved
        })
        .await
    }

    /// The same for work that takes a core and so many bytes for a while: the request has a place, and waits for both.
    async fn with_core<T: Send + 'static>(
        &self,
        bytes: usize,
        work: impl FnOnce(&dyn SkySource) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<(T, Held), ApiError> {
        // What is large waits for memory: the place is for others meanwhile.
        let (room, turn) = if bytes > LARGE_BYTES {
            asker::current().leave_place();
            let waiting =
                self.large.turn(asker::party()).instrument(tracing::info_span!("wait for its turn"));
            (Room::Large, Some(waiting.await.map_err(|_: Crowded| self.busy(5))?))
        } else {
            self.place().await?;
            (Room::Small, None)
        };
        let held = self.memory(room, bytes).await?;
        let waiting = self.cores.clone().acquire_owned().instrument(tracing::info_span!("wait for a core"));
        let core = waiting.await.map_err(ApiError::internal)?;
        self.blocking(move |source| {
            let result = work(source);
            drop((core, turn));
            result.map(|made| (made, held))
        })
        .await
    }

    /// Makes a document.
    ///
    /// # Errors
    /// As [`Self::blocking`], and [`AppError::Busy`].
    pub(crate) async fn heavy<T: Send + 'static>(
        &self,
        work: impl FnOnce(&dyn SkySource) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        self.with_core(DOCUMENT_BYTES, work).await.map(|(made, _)| made)
    }

    /// Makes a file within so many bytes of memory, of which it keeps its own for as long as somebody has it.
    ///
    /// # Errors
    /// As [`Self::heavy`].
    pub(crate) async fn drawn(
        &self,
        bytes: usize,
        work: impl FnOnce(&dyn SkySource) -> Result<Vec<u8>, ApiError> + Send + 'static,
    ) -> Result<Bytes, ApiError> {
        self.with_core(bytes, work).await.map(|(made, held)| self.keep(made, held))
    }

    /// A file that keeps memory for as long as somebody has it: that for answers, or where this is full what it was made in.
    pub(crate) fn keep(&self, made: Vec<u8>, held: Held) -> Bytes {
        let of_answers = self.memory[Room::Answers as usize].try_hold_any(made.len());
        of_answers.unwrap_or(held).keep(made)
    }

    /// Runs what takes long, within so many bytes of memory, in its turn; it is given up when nobody waits for it any more.
    ///
    /// # Errors
    /// As [`Self::blocking`], [`AppError::SceneTooLarge`] for more than there is for all, [`AppError::Busy`] where too many wait, and [`ApiError::TooManyRequests`] for a client that had more
    /// than its time.
    pub(crate) async fn long<T: Send + 'static>(
        &self,
        lane: Lane,
        bytes: usize,
        work: impl FnOnce(&dyn SkySource, &Work) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<(T, Held), ApiError> {
        if bytes as u64 > self.most_bytes {
            let [needed, most] = [bytes as u64, self.most_bytes].map(|bytes| bytes.div_ceil(1 << 20));
            let reason = format!(
                "this takes about {needed} MiB for the pixels of its scene, and {most} MiB are there for all requests \
                 (memory_budget_bytes)"
            );
            return Err(AppError::SceneTooLarge { reason }.into());
        }
        let party = asker::party();
        self.shares.check(party, Instant::now()).map_err(|wait_s| {
            self.metrics.count_refused("work");
            ApiError::TooManyRequests { retry_after_s: wait_s.ceil() as u64 }
        })?;
        let (queue, room, retry_after_s) = match lane {
            Lane::Influence => (&self.influences, Room::Influences, 2),
            Lane::Plan => (&self.plans, Room::Plans, 10),
            Lane::Map => (&self.maps, Room::Plans, 20),
        };
        let waiting = queue.turn(party).instrument(tracing::info_span!("wait for its turn"));
        let turn = waiting.await.map_err(|_: Crowded| self.busy(retry_after_s))?;
        let held = self.memory(room, bytes).await?;
        let progress = asker::current().work();
        self.blocking(move |source| {
            // Whoever waited may have gone in the meantime.
            let made =
                if progress.note(0.0) { work(source, &progress) } else { Err(AppError::EngineDown.into()) };
            drop(turn);
            made.map(|made| (made, held))
        })
        .await
    }
}
