//! Lists of the scenarios and plans that are stored of a scene.

use crate::answers::{PlanEntry, ScenarioEntry, plan_entry};
use skyglow_scene::{ChangeId, ChangeKind, ChangeStore, ChangeStoreError, SceneId};

/// Its scenarios, the newest first. One that cannot be read is left out, and logged.
///
/// # Errors
/// [`ChangeStoreError::Io`] where the folder cannot be read.
pub fn stored_scenarios(
    changes: &ChangeStore,
    scene: &SceneId,
) -> Result<Vec<ScenarioEntry>, ChangeStoreError> {
    let read = |(id, _): (ChangeId, u64)| match changes.scenario(&id) {
        Ok((scenario, created_unix_s)) => {
            (scenario.scene == *scene).then(|| ScenarioEntry::new(&id, &scenario, created_unix_s))
        }
        Err(error) => {
            tracing::error!(%error, "a scenario is left out of the list");
            None
        }
    };
    Ok(changes.list(ChangeKind::Scenario)?.into_iter().filter_map(read).collect())
}

/// Its plans, the newest first. One that cannot be read is left out, and logged.
///
/// # Errors
/// [`ChangeStoreError::Io`] where the folder cannot be read.
pub fn stored_plans(changes: &ChangeStore, scene: &SceneId) -> Result<Vec<PlanEntry>, ChangeStoreError> {
    let read = |(id, _): (ChangeId, u64)| match changes.plan_answer(&id) {
        Ok((of, facts, created_unix_s)) => (of == *scene).then(|| plan_entry(&id, &facts, created_unix_s)),
        Err(error) => {
            tracing::error!(%error, "a plan is left out of the list");
            None
        }
    };
    Ok(changes.list(ChangeKind::Plan)?.into_iter().filter_map(read).collect())
}
