//! Scenarios and plans: kept, listed, and looked at.

use crate::observatory::Observatory;
use crate::{error::ObservatoryError, scene_cache::SceneCache};
use skyglow_scene::{
    ChangeId, ChangeLimits, ChangeStep, ChangeStore, ChangeStoreError, ChangeSummary, MAX_CHANGE_DEPTH,
    Scenario, SceneMetadata, SceneStore,
};
use std::{path::Path, sync::Arc};

/// Keeps a scenario in a data folder if it can be painted over its scene, and says what it does; needs no engine. Takes up to
/// seconds.
///
/// # Errors
/// [`ObservatoryError::Scene`], [`ObservatoryError::ChangeStore`], [`ObservatoryError::Change`].
pub fn store_scenario(
    data_dir: &Path,
    scenario: &Scenario,
) -> Result<(ChangeId, Arc<ChangeSummary>, SceneMetadata), ObservatoryError> {
    let changes = ChangeStore::new(data_dir, ChangeLimits::none());
    let shelf = SceneCache::new(SceneStore::new(data_dir), changes, 1);
    let (id, summary) = keep_on(&shelf, scenario)?;
    Ok((id, summary, shelf.scene(&scenario.scene)?.metadata().clone()))
}

fn keep_on(
    shelf: &SceneCache,
    scenario: &Scenario,
) -> Result<(ChangeId, Arc<ChangeSummary>), ObservatoryError> {
    let (scene, changes) = (shelf.scene(&scenario.scene)?, shelf.changes());
    changes.check_base(scenario.base.as_ref())?;
    let mut steps = match &scenario.base {
        Some(base) => changes.steps(base, &scenario.scene, &scene.metadata().version)?,
        None => Vec::new(),
    };
    steps.push(ChangeStep::Painted(scenario.edits.clone()));
    if let Some(base) = &scenario.base
        && steps.len() > MAX_CHANGE_DEPTH
    {
        return Err(ChangeStoreError::TooDeep { id: base.clone() }.into());
    }
    // Painted before it is kept, and there for the first query.
    let (_, summary) = shelf.made(&scene, &changes.scenario_id(scenario)?, &steps)?;
    Ok((changes.store_scenario(scenario)?, summary))
}

impl Observatory {
    /// Where scenarios and plans are stored.
    pub fn changes(&self) -> &ChangeStore {
        self.shelf.changes()
    }

    /// Keeps a scenario if it can be painted, and says what it does. Reads and writes files; takes up to seconds.
    ///
    /// # Errors
    /// [`ObservatoryError::Scene`], [`ObservatoryError::ChangeStore`], [`ObservatoryError::Change`].
    pub fn store_scenario(
        &self,
        scenario: &Scenario,
    ) -> Result<(ChangeId, Arc<ChangeSummary>), ObservatoryError> {
        keep_on(&self.shelf, scenario)
    }

    /// A scenario that is kept, what it does to its scene, and when it was kept, seconds since 1970.
    ///
    /// # Errors
    /// As [`Self::store_scenario`].
    pub fn scenario(&self, id: &ChangeId) -> Result<(Scenario, Arc<ChangeSummary>, u64), ObservatoryError> {
        let (scenario, created_unix_s) = self.changes().scenario(id)?;
        let (_, summary) = self.shelf.changed(&self.shelf.scene(&scenario.scene)?, id)?;
        Ok((scenario, summary, created_unix_s))
    }
}
