//! Scenarios and plans: kept, listed, and looked at.

use super::Observatory;
use crate::error::EngineError;
use skyglow_scene::{ChangeId, ChangeKind, ChangeStep, ChangeStore, ChangeSummary, Scenario, Scene};

/// Keeps a scenario if it can be painted over a scene as it was ingested, and says what it does. Reads and writes files; takes
/// up to seconds for many new lights among mountains.
///
/// # Errors
/// [`EngineError::ChangeStore`], [`EngineError::Change`].
pub fn keep_scenario(
    store: &ChangeStore,
    scene: &Scene,
    scenario: &Scenario,
) -> Result<(ChangeId, ChangeSummary), EngineError> {
    let summary = try_scenario(store, scene, scenario)?;
    Ok((store.keep_scenario(scenario)?, summary))
}

/// What a scenario does to its scene.
fn try_scenario(
    store: &ChangeStore,
    scene: &Scene,
    scenario: &Scenario,
) -> Result<ChangeSummary, EngineError> {
    let mut steps = match &scenario.base {
        Some(base) => store.steps(base, &scenario.scene, &scene.metadata().version)?,
        None => Vec::new(),
    };
    steps.push(ChangeStep::Painted(scenario.edits.clone()));
    Ok(scene.changed(&steps, "try")?.1)
}

impl Observatory {
    /// Where scenarios and plans are stored.
    pub fn changes(&self) -> &ChangeStore {
        self.shelf.changes()
    }

    /// [`keep_scenario`] for the scene that it names.
    ///
    /// # Errors
    /// [`EngineError::Scene`], [`EngineError::ChangeStore`], [`EngineError::Change`].
    pub fn keep_scenario(&self, scenario: &Scenario) -> Result<(ChangeId, ChangeSummary), EngineError> {
        keep_scenario(self.changes(), self.shelf.scene(&scenario.scene)?.as_ref(), scenario)
    }

    /// What a scenario does to its scene.
    ///
    /// # Errors
    /// As [`Self::keep_scenario`].
    pub fn try_scenario(&self, scenario: &Scenario) -> Result<ChangeSummary, EngineError> {
        try_scenario(self.changes(), self.shelf.scene(&scenario.scene)?.as_ref(), scenario)
    }

    /// Ids with the time they were kept, seconds since 1970, the newest first.
    ///
    /// # Errors
    /// [`EngineError::ChangeStore`].
    pub fn list_changes(&self, kind: ChangeKind) -> Result<Vec<(ChangeId, u64)>, EngineError> {
        Ok(self.changes().list(kind)?)
    }
}
