//! Scenarios and plans: stored and looked at.

use crate::observatory::Observatory;
use crate::{cache_sizes::CacheSizes, error::ObservatoryError, scene_cache::SceneCache};
use skyglow_scene::{
    ChangeId, ChangeLimits, ChangeStep, ChangeStore, ChangeStoreError, ChangeSummary, MAX_CHANGE_DEPTH,
    Posting, Scenario, SceneMetadata, SceneStore,
};
use std::{path::Path, sync::Arc};

/// A scenario that is stored.
#[derive(Clone, Debug)]
pub struct ScenarioRecord {
    /// The scenario.
    pub scenario: Scenario,
    /// What it does to its scene.
    pub summary: Arc<ChangeSummary>,
    /// The scene without its changes.
    pub scene: SceneMetadata,
    /// When it was stored, seconds since 1970.
    pub created_unix_s: u64,
}

/// Stores a scenario in a data folder if it can be painted over its scene, and says what it does; needs no engine. Takes up to
/// seconds.
///
/// # Errors
/// [`ObservatoryError::Scene`], [`ObservatoryError::ChangeStore`], [`ObservatoryError::Change`].
pub fn store_scenario(
    data_dir: &Path,
    scenario: &Scenario,
) -> Result<(ChangeId, Arc<ChangeSummary>, SceneMetadata), ObservatoryError> {
    let changes = ChangeStore::new(data_dir, ChangeLimits::none());
    let scenes = SceneCache::new(SceneStore::new(data_dir), changes, 1, &CacheSizes::of_machine());
    let (id, summary, _) = store_in(&scenes, scenario, &Posting::default())?;
    Ok((id, summary, scenes.scene(&scenario.scene)?.metadata().clone()))
}

fn store_in(
    scenes: &SceneCache,
    scenario: &Scenario,
    posting: &Posting,
) -> Result<(ChangeId, Arc<ChangeSummary>, bool), ObservatoryError> {
    let (scene, changes) = (scenes.scene(&scenario.scene)?, scenes.changes());
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
    // Painted before it is stored, and there for the first query.
    let (_, summary) = scenes.apply(&scene, &changes.scenario_id(scenario, posting)?, &steps)?;
    let (id, is_new) = changes.store_scenario_as(scenario, posting)?;
    Ok((id, summary, is_new))
}

impl Observatory {
    /// Where scenarios and plans are stored.
    pub fn changes(&self) -> &ChangeStore {
        self.scenes.changes()
    }

    /// Stores a scenario if it can be painted, and says what it does. Reads and writes files; takes up to seconds.
    ///
    /// # Errors
    /// [`ObservatoryError::Scene`], [`ObservatoryError::ChangeStore`], [`ObservatoryError::Change`].
    pub fn store_scenario(
        &self,
        scenario: &Scenario,
    ) -> Result<(ChangeId, Arc<ChangeSummary>), ObservatoryError> {
        store_in(&self.scenes, scenario, &Posting::default()).map(|(id, summary, _)| (id, summary))
    }

    /// Stores a scenario of somebody, and says whether it is new.
    ///
    /// # Errors
    /// As [`Self::store_scenario`].
    pub fn store_scenario_as(
        &self,
        scenario: &Scenario,
        posting: &Posting,
    ) -> Result<(ChangeId, bool), ObservatoryError> {
        store_in(&self.scenes, scenario, posting).map(|(id, _, is_new)| (id, is_new))
    }

    /// A scenario that is stored, with what it does to its scene.
    ///
    /// # Errors
    /// As [`Self::store_scenario`].
    pub fn scenario(&self, id: &ChangeId) -> Result<ScenarioRecord, ObservatoryError> {
        let (scenario, created_unix_s) = self.changes().scenario(id)?;
        let scene = self.scenes.scene(&scenario.scene)?;
        let (_, summary) = self.scenes.changed(&scene, id)?;
        Ok(ScenarioRecord { scenario, summary, scene: scene.metadata().clone(), created_unix_s })
    }
}
