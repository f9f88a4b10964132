//! The render thread, which alone speaks to the device: it collects queued jobs into batches.

use crate::{
    config::EngineConfig,
    device::{self, Opened},
    error::{DeviceFault, RenderError},
    executor::{BatchOutput, Executor},
    job::{Command, Job, RenderedJob},
    plan::Pass,
    post_process::PostProcessPool,
    prepare::Prepared,
    request::ExecutorKind,
    stats::StatsCell,
    table_set::TableSet,
};
use std::{
    collections::VecDeque,
    sync::{
        Arc,
        atomic::Ordering,
        mpsc::{Receiver, RecvTimeoutError, SyncSender, TryRecvError, sync_channel},
    },
    thread::JoinHandle,
    time::Duration,
};

type Spawned = (SyncSender<Command>, JoinHandle<()>, Opened);

/// Starts the thread and waits until its device is open.
pub(crate) fn spawn(
    config: &EngineConfig,
    capacity: usize,
    set: Arc<TableSet>,
    stats: Arc<StatsCell>,
) -> Result<Spawned, RenderError> {
    let (queue, commands) = sync_channel(capacity);
    let (opened_sender, opened) = sync_channel(1);
    let config = config.clone();
    let thread = std::thread::Builder::new()
        .name("skyglow-render".into())
        .spawn(move || match device::open(config.device, config.budget_bytes, &set) {
            Ok((executor, opened)) => {
                // A device that is lost comes back as what it was: answers name their executor, and its kind is part
                // of their ETags.
                let config = EngineConfig { device: opened.kind.choice(), ..config };
                let _ = opened_sender.send(Ok(opened));
                Worker::new(config, set, stats, executor, commands).run();
            }
            Err(error) => {
                let _ = opened_sender.send(Err(error));
            }
        })
        .map_err(|error| RenderError::Thread { reason: error.to_string() })?;
    let opened = opened.recv().map_err(|_| RenderError::Stopped)??;
    Ok((queue, thread, opened))
}

/// True where a batch can take the job too.
fn fits(batch: &[Job], job: &Job) -> bool {
    let with = |count: fn(&Prepared) -> usize| -> usize {
        batch.iter().chain([job]).map(|one| count(&one.prepared)).sum()
    };
    with(|prepared| prepared.nodes.len()) <= crate::MAX_BATCH_NODES
        && with(|prepared| prepared.cells.len()) <= crate::MAX_BATCH_CELLS
        && job.prepared.is_compatible(&batch[0].prepared)
}

/// Time between tries to open a lost device again.
const REPAIR_INTERVAL: Duration = Duration::from_secs(5);

struct Worker {
    config: EngineConfig,
    set: Arc<TableSet>,
    stats: Arc<StatsCell>,
    /// None after a loss that could not be repaired yet.
    executor: Option<Box<dyn Executor>>,
    commands: Receiver<Command>,
    /// Requests taken from the queue that did not fit the batch in hand.
    waiting: VecDeque<Job>,
    post_process: PostProcessPool,
}

impl Worker {
    fn new(
        config: EngineConfig,
        set: Arc<TableSet>,
        stats: Arc<StatsCell>,
        executor: Box<dyn Executor>,
        commands: Receiver<Command>,
    ) -> Self {
        let waiting = VecDeque::new();
        let post_process = PostProcessPool::new(&set, &stats);
        Self { config, set, stats, executor: Some(executor), commands, waiting, post_process }
    }

    fn run(mut self) {
        self.warm_up();
        while let Some(batch) = self.next_batch() {
            self.answer(batch);
        }
    }

    /// Runs every pipeline once, so that no caller waits for a compiler, and the engine is ready if all of them ran.
    fn warm_up(&mut self) {
        let requests = device::warm_up_requests(&self.set);
        for request in &requests {
            match self.render(&[request]) {
                Ok(output) => debug_assert!(output.passes.len() <= Pass::ALL.len()),
                Err(fault) => {
                    tracing::error!(%fault, "the device failed while it warmed up");
                    return;
                }
            }
        }
        self.stats.ready.store(true, Ordering::Release);
    }

    /// The next command. While the device is down it is opened again at intervals, for nobody sends work to a server that is not ready.
    fn next_command(&mut self) -> Option<Command> {
        loop {
            if self.stats.ready.load(Ordering::Acquire) {
                return self.commands.recv().ok();
            }
            match self.commands.recv_timeout(REPAIR_INTERVAL) {
                Ok(command) => return Some(command),
                Err(RecvTimeoutError::Timeout) => self.warm_up(),
                Err(RecvTimeoutError::Disconnected) => return None,
            }
        }
    }

    /// The next requests to render together; None when the engine is dropped and nothing waits.
    fn next_batch(&mut self) -> Option<Vec<Job>> {
        let first = loop {
            if let Some(job) = self.waiting.pop_front() {
                break job;
            }
            match self.next_command()? {
                Command::Render(job) => break *job,
                Command::LoseDevice => self.lose(),
            }
        };
        let mut batch = vec![first];
        let limit = self.config.batch_limit.clamp(1, crate::MAX_BATCH);
        let mut held = VecDeque::new();
        while let Some(job) = self.waiting.pop_front() {
            if batch.len() < limit && fits(&batch, &job) {
                batch.push(job);
            } else {
                held.push_back(job);
            }
        }
        self.waiting = held;
        self.collect(&mut batch, limit);
        Some(batch)
    }

    /// Adds compatible requests that are in the queue. It does not wait for more: an idle device would render fewer
    /// panoramas, and whoever comes meanwhile is in the next batch.
    fn collect(&mut self, batch: &mut Vec<Job>, limit: usize) {
        while batch.len() < limit && self.waiting.len() < limit {
            match self.commands.try_recv() {
                Ok(Command::Render(job)) if fits(batch, &job) => batch.push(*job),
                Ok(Command::Render(job)) => self.waiting.push_back(*job),
                Ok(Command::LoseDevice) => self.lose(),
                Err(TryRecvError::Empty | TryRecvError::Disconnected) => return,
            }
        }
    }

    fn lose(&mut self) {
        if let Some(executor) = &mut self.executor {
            executor.lose();
        }
    }

    fn answer(&mut self, mut batch: Vec<Job>) {
        self.stats.queued.fetch_sub(batch.len() as u64, Ordering::Relaxed);
        // Nobody waits for an answer whose receiver is gone.
        batch.retain(|job| !job.answer.is_closed());
        if batch.is_empty() {
            return;
        }
        let requests: Vec<&Prepared> = batch.iter().map(|job| &job.prepared).collect();
        match self.render(&requests) {
            Ok(output) => {
                self.stats.ready.store(true, Ordering::Release);
                self.answer_rendered(batch, output);
            }
            Err(fault) => {
                self.stats.ready.store(false, Ordering::Release);
                self.stats.failed.fetch_add(batch.len() as u64, Ordering::Relaxed);
                for job in batch {
                    let _ = job.answer.send(Err(RenderError::Device(fault.clone())));
                }
            }
        }
    }

    fn answer_rendered(&self, batch: Vec<Job>, output: BatchOutput) {
        let batch_size = batch.len();
        let executor = self.executor.as_ref().map_or(ExecutorKind::Cpu, |executor| executor.kind());
        self.stats.count_batch(batch_size, &output.passes);
        for (job, radiance_w_m2_sr) in batch.into_iter().zip(output.radiance_w_m2_sr) {
            let rendered =
                RenderedJob { job, radiance_w_m2_sr, passes: output.passes.clone(), batch_size, executor };
            self.stats.count_work(rendered.job.prepared.work());
            self.post_process.finish(rendered);
        }
    }

    /// Renders; a device that fails is made anew and asked once more.
    fn render(&mut self, requests: &[&Prepared]) -> Result<BatchOutput, DeviceFault> {
        let mut fault = DeviceFault::Lost("it could not be made anew".into());
        for attempt in 0..2 {
            if self.executor.is_none() {
                self.reopen();
            }
            let Some(executor) = &mut self.executor else { return Err(fault) };
            match executor.render(requests) {
                Ok(output) => return Ok(output),
                Err(error) => {
                    tracing::warn!(%error, attempt, "the device failed; it is made anew");
                    self.stats.device_losses.fetch_add(1, Ordering::Relaxed);
                    self.executor = None;
                    fault = error;
                }
            }
        }
        Err(fault)
    }

    fn reopen(&mut self) {
        match device::open(self.config.device, self.config.budget_bytes, &self.set) {
            Ok((executor, _)) => self.executor = Some(executor),
            Err(error) => tracing::error!(%error, "no device could be opened"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{request::DeviceChoice, synthetic};
    use skyglow_physics::Panorama;
    use std::sync::atomic::AtomicBool;
    use tokio::sync::oneshot;

    /// A device that fails while its flag is down.
    struct Flaky(Arc<AtomicBool>);

    impl Executor for Flaky {
        fn kind(&self) -> ExecutorKind {
            ExecutorKind::Gpu
        }

        fn resident_bytes(&self) -> u64 {
            0
        }

        fn render(&mut self, batch: &[&Prepared]) -> Result<BatchOutput, DeviceFault> {
            if !self.0.load(Ordering::SeqCst) {
                return Err(DeviceFault::Lost("in a drill".into()));
            }
            let dark = Panorama::dark().samples().to_vec();
            Ok(BatchOutput { radiance_w_m2_sr: vec![dark; batch.len()], passes: Vec::new() })
        }

        fn lose(&mut self) {}
    }

    /// An engine is not ready while its device cannot be made anew.
    #[test]
    fn a_lost_device_is_not_ready() {
        let set = Arc::new(TableSet::new(vec![Arc::new(synthetic::tables(2.0, 4))]).unwrap());
        let stats = Arc::new(StatsCell::default());
        let works = Arc::new(AtomicBool::new(true));
        // No device fits into no memory, so that what is lost stays lost.
        let config = EngineConfig { device: DeviceChoice::Gpu, budget_bytes: 0, ..EngineConfig::default() };
        let (_queue, commands) = sync_channel(1);
        let device = Box::new(Flaky(Arc::clone(&works)));
        let mut worker = Worker::new(config, Arc::clone(&set), Arc::clone(&stats), device, commands);
        let ready = || stats.ready.load(Ordering::Acquire);
        assert!(!ready());
        worker.warm_up();
        assert!(ready());
        works.store(false, Ordering::SeqCst);
        let (answer, mut receiver) = oneshot::channel();
        let prepared = device::warm_up_requests(&set).remove(0);
        worker.answer(vec![Job { prepared, answer }]);
        assert!(matches!(receiver.try_recv(), Ok(Err(RenderError::Device(_)))));
        assert!(!ready());
        // Once a device is there again, the next try finds it.
        works.store(true, Ordering::SeqCst);
        worker.executor = Some(Box::new(Flaky(works)));
        worker.warm_up();
        assert!(ready());
    }
}
