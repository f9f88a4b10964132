//! Making and finding plans, for the HTTP interface and the command line alike.

use crate::{
    answers::plan_facts,
    conversion::check_altitude,
    error::AppError,
    fingerprint::{canonical_bytes, program},
    request::PlanStoreRequest,
    source::SkySource,
};
use skyglow_observatory::{InfluenceRequest, SceneView, Watch};
use skyglow_scene::{ChangeId, Posting, Scene, StoredPlan};
use std::sync::Arc;

/// A plan that is stored or held.
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
fn plan_id(
    source: &dyn SkySource,
    request: &PlanStoreRequest,
    scene_version: &str,
    posting: &Posting,
) -> Result<ChangeId, AppError> {
    let facts = source.facts();
    let device = (program(), &facts.pack_checksums, &facts.executor, &facts.adapter);
    let decides = canonical_bytes(&(&request.scenario, &request.request, scene_version, device))?;
    source.plan_id(decides, posting)
}

/// The scene of a plan, all of whose sites are in it and below the tables' end.
///
/// # Errors
/// As [`SkySource::view`] and [`SkySource::site`], and an altitude out of range.
pub fn prepare_plan(source: &dyn SkySource, request: &PlanStoreRequest) -> Result<SceneView, AppError> {
    let view = source.view(&request.scene, request.scenario.as_ref())?;
    for InfluenceRequest { sky, .. } in request.request.sites() {
        let site = source.site(&view, sky.place)?;
        check_altitude(sky, site.ground, source.facts().altitude_range_m)?;
    }
    Ok(view)
}

/// Makes a plan and stores it, or holds it for some minutes, as asked, unless that is so already; whether something new was
/// stored. Takes seconds.
///
/// * `view`: of the scene that is dimmed, changes of its scenario included.
/// * `posting`: how it is stored, and whose it then is.
/// * `watch`: as in [`SkySource::plan`].
///
/// # Errors
/// As [`SkySource::plan`] and [`SkySource::store_plan`].
pub fn make_plan(
    source: &dyn SkySource,
    request: &PlanStoreRequest,
    view: &SceneView,
    posting: &Posting,
    watch: &Watch<'_>,
) -> Result<(PlanRecord, bool), AppError> {
    if request.store
        && let Some(base) = &request.scenario
    {
        source.check_base(base)?;
    }
    let id = plan_id(source, request, &view.base().metadata().version, posting)?;
    let is_new = match source.plan_by_id(&id) {
        Ok(_) if !request.store || source.is_kept(&id)? && !posting.pinned => false,
        known => {
            let plan = known.map_or_else(|_| new_plan(source, request, view, watch), |(held, _)| Ok(held))?;
            if request.store {
                source.store_plan(&id, &plan, posting)?
            } else {
                source.hold_plan(&id, plan, &posting.account);
                false
            }
        }
    };
    let (plan, created_unix_s) = source.plan_by_id(&id)?;
    Ok((PlanRecord { id, plan, created_unix_s, scene: Arc::clone(view.scene()) }, is_new))
}

fn new_plan(
    source: &dyn SkySource,
    request: &PlanStoreRequest,
    view: &SceneView,
    watch: &Watch<'_>,
) -> Result<StoredPlan, AppError> {
    let outcome = source.plan(&request.request, view, watch)?;
    let facts = plan_facts(&request.request, &outcome, source.facts());
    Ok(StoredPlan {
        scene: request.scene.clone(),
        scene_version: view.base().metadata().version.clone(),
        base: request.scenario.clone(),
        answer: serde_json::to_value(facts).map_err(AppError::internal)?,
        factors: outcome.factors(),
        effects: outcome.pixels.iter().map(|pixel| pixel.effect as f32).collect(),
    })
}

/// A plan that is stored or held, with its scene.
///
/// # Errors
/// [`AppError::UnknownScenario`], [`AppError::StalePlan`], and whatever is wrong with the scene.
pub fn find_plan(source: &dyn SkySource, id: &ChangeId) -> Result<PlanRecord, AppError> {
    let (plan, created_unix_s) = source.plan_by_id(id)?;
    let view = source.view(&plan.scene, plan.base.as_ref())?;
    if view.base().metadata().version != plan.scene_version {
        return Err(AppError::StalePlan { id: id.to_string() });
    }
    Ok(PlanRecord { id: id.clone(), plan, created_unix_s, scene: Arc::clone(view.scene()) })
}
