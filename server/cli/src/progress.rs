//! Progress bars with the time left, on standard error. Where that is no terminal, one log line a stage.

use indicatif::{ProgressBar, ProgressStyle};
use skyglow_scene::{IngestProgress, IngestStage};
use std::{
    io::IsTerminal,
    sync::{Mutex, MutexGuard, PoisonError},
};

/// A bar that is replaced at every stage of a work.
#[derive(Debug)]
pub(crate) struct Stages {
    bar: Mutex<ProgressBar>,
    visible: bool,
}

impl Stages {
    /// No stage yet.
    pub(crate) fn new() -> Self {
        Self { bar: Mutex::new(ProgressBar::hidden()), visible: std::io::stderr().is_terminal() }
    }

    fn bar(&self) -> MutexGuard<'_, ProgressBar> {
        self.bar.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A stage begins, with this many steps.
    pub(crate) fn begin(&self, stage: &str, steps: u64) {
        let mut bar = self.bar();
        bar.finish();
        if !self.visible {
            tracing::info!(steps, "{stage}");
            return;
        }
        let style = ProgressStyle::with_template(
            "{prefix:>22} [{bar:30}] {percent:>3} %  {elapsed} gone, {eta} left",
        );
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> ");
        *bar = ProgressBar::new(steps).with_style(style).with_prefix(stage.to_owned());
    }

    /// More steps of the stage are done.
    pub(crate) fn advance(&self, steps: u64) {
        self.bar().inc(steps);
    }

    /// This many steps of the stage are done.
    pub(crate) fn set(&self, done: u64) {
        self.bar().set_position(done);
    }
}

impl Drop for Stages {
    fn drop(&mut self) {
        self.bar().finish();
    }
}

impl skyglow_tables::Progress for Stages {
    fn begin(&self, stage: &str, steps: u64) {
        self.begin(stage, steps);
    }

    fn advance(&self, steps: u64) {
        self.advance(steps);
    }
}

/// What an ingest reports its progress to.
pub(crate) fn of_ingest(stages: &Stages) -> impl FnMut(IngestProgress) + '_ {
    let mut current = None;
    move |progress| {
        if current != Some(progress.stage) {
            current = Some(progress.stage);
            stages.begin(stage_name(progress.stage), progress.total);
        }
        stages.set(progress.done);
    }
}

fn stage_name(stage: IngestStage) -> &'static str {
    match stage {
        IngestStage::Generate => "making the demo",
        IngestStage::Radiance => "reading radiance",
        IngestStage::Terrain => "reading terrain",
        IngestStage::Altitude => "finding altitudes",
        IngestStage::Skyline => "finding what hides lights",
        IngestStage::Store => "storing the scene",
    }
}
