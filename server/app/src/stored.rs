//! Lists of the scenarios and plans that are stored of a scene.

use crate::answers::{PlanEntry, ScenarioEntry};
use crate::request::ListRequest;
use skyglow_scene::{ChangeKind, ChangeStore, ChangeStoreError, Listed, Page, SceneId, Viewer};

/// Part of the list of its scenarios, the newest first, as somebody sees it. One that cannot be read is left out, and logged.
///
/// # Errors
/// [`ChangeStoreError::Io`] where the folder cannot be read; [`ChangeStoreError::Reading`] soon after the start.
pub fn stored_scenarios(
    changes: &ChangeStore,
    scene: &SceneId,
    viewer: &Viewer,
    part: &ListRequest,
) -> Result<Page<ScenarioEntry>, ChangeStoreError> {
    page(changes, ChangeKind::Scenario, scene, viewer, part, ScenarioEntry::of_listed)
}

/// The same of its plans.
///
/// # Errors
/// As [`stored_scenarios`].
pub fn stored_plans(
    changes: &ChangeStore,
    scene: &SceneId,
    viewer: &Viewer,
    part: &ListRequest,
) -> Result<Page<PlanEntry>, ChangeStoreError> {
    page(changes, ChangeKind::Plan, scene, viewer, part, PlanEntry::of_listed)
}

fn page<T>(
    changes: &ChangeStore,
    kind: ChangeKind,
    scene: &SceneId,
    viewer: &Viewer,
    part: &ListRequest,
    entry: impl Fn(Listed) -> Option<T>,
) -> Result<Page<T>, ChangeStoreError> {
    let page = changes.page(kind, scene, viewer, part.after.as_ref(), part.limit)?;
    log_damaged(changes);
    Ok(Page { entries: page.entries.into_iter().filter_map(entry).collect(), next: page.next })
}

/// Looks through what is stored at the start, so that the first list need not wait for it; says in the log what is there.
pub fn read_index(changes: &ChangeStore) {
    let began = std::time::Instant::now();
    match changes.read_index() {
        Ok(count) => tracing::info!("{count} scenarios and plans are kept, found in {:.1?}", began.elapsed()),
        Err(error) => tracing::error!(%error, "what is kept cannot be looked through"),
    }
    log_damaged(changes);
}

fn log_damaged(changes: &ChangeStore) {
    for error in changes.take_damaged() {
        tracing::error!(%error, "a scenario or plan is left out of the lists");
    }
}
