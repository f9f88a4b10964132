//! Making and finding plans, for the HTTP interface and the command line alike.

use crate::{
    answers::plan_facts,
    program::program,
    request::PlanStoreRequest,
    source::{SkySource, SourceError},
};
use skyglow_scene::{ChangeId, ChangeStore, Scene, StoredPlan};
use std::sync::Arc;

/// A plan that is kept or held.
#[derive(Clone, Debug)]
pub struct PlanRecord {
    /// Its id.
    pub id: ChangeId,
    /// The plan.
    pub plan: StoredPlan,
    /// When it was made, seconds since 1970.
    pub created_unix_s: u64,
    /// The scene as it is before the plan.
    pub scene: Arc<Scene>,
}

/// About what a dimmed pixel takes on disk: the difference of its code, its factor and its effect.
const PIXEL_BYTES: usize = 10;

impl PlanRecord {
    /// About what it takes on disk, bytes.
    pub fn stored_bytes(&self) -> usize {
        self.plan.factors.codes.len() * PIXEL_BYTES
    }
}

/// The id of a plan: the same request for the same scene with the same tables and the same build of the program has the same.
///
/// * `scene_version`: of the scene itself.
pub fn plan_id(source: &dyn SkySource, ask: &PlanStoreRequest, scene_version: &str) -> ChangeId {
    let facts = source.facts();
    let decides = [
        &format!("{:?} {:?}", ask.scenario, ask.request),
        scene_version,
        program(),
        &facts.pack_checksums,
        &facts.executor,
        &facts.adapter,
    ];
    ChangeStore::plan_id(decides.join("\n").as_bytes())
}

/// Makes a plan and keeps it, or holds it for some minutes, as asked, unless that is so already; answers its id and whether
/// something new was kept. Takes seconds.
///
/// # Errors
/// As [`SkySource::plan`] and [`SkySource::store_plan`].
pub fn make_plan(source: &dyn SkySource, ask: &PlanStoreRequest) -> Result<(ChangeId, bool), SourceError> {
    let scene_version = source.scene(&ask.scene)?.version;
    if ask.keep
        && let Some(base) = &ask.scenario
    {
        source.check_base(base)?;
    }
    let id = plan_id(source, ask, &scene_version);
    let plan = match source.plan_by_id(&id) {
        Ok(_) if !ask.keep || source.is_stored(&id) => return Ok((id, false)),
        Ok((held, _)) => held,
        Err(_) => new_plan(source, ask, scene_version)?,
    };
    if ask.keep {
        source.store_plan(&id, &plan)?;
    } else {
        source.hold_plan(&id, plan);
    }
    Ok((id, ask.keep))
}

fn new_plan(
    source: &dyn SkySource,
    ask: &PlanStoreRequest,
    scene_version: String,
) -> Result<StoredPlan, SourceError> {
    let outcome = source.plan(&ask.request)?;
    if source.scene(&ask.scene)?.version != scene_version {
        // Ingested again meanwhile: its pixels may be others.
        return Err(SourceError::Busy);
    }
    let facts = plan_facts(ask, &outcome, source.facts());
    let answer = serde_json::to_value(facts).map_err(|error| SourceError::Broken(error.to_string()))?;
    Ok(StoredPlan {
        scene: ask.scene.clone(),
        scene_version,
        base: ask.scenario.clone(),
        answer,
        factors: outcome.factors(),
        effects: outcome.pixels.iter().map(|pixel| pixel.effect as f32).collect(),
    })
}

/// A plan that is kept or held, with its scene.
///
/// # Errors
/// [`SourceError::UnknownScenario`], [`SourceError::StalePlan`], and whatever is wrong with the scene.
pub fn find_plan(source: &dyn SkySource, id: &ChangeId) -> Result<PlanRecord, SourceError> {
    let (plan, created_unix_s) = source.plan_by_id(id)?;
    if source.scene(&plan.scene)?.version != plan.scene_version {
        return Err(SourceError::StalePlan(id.to_string()));
    }
    let scene = source.open_scene(&plan.scene, plan.base.as_ref())?;
    Ok(PlanRecord { id: id.clone(), plan, created_unix_s, scene })
}
