//! The real program behind the interface.

use crate::{
    answers::{AtmosphereAnswer, PlanEntry, ScenarioEntry},
    kind_facts::KindFacts,
    parameters::{BASIS, SCATTERING, TURBIDITY},
    source::{
        BoxFuture, EyeHeight, InfluenceQuery, RenderContext, RenderedSky, SiteFacts, SkyQuery, SkySource,
        SourceError, SourceFacts,
    },
    stored::{stored_plans, stored_scenarios},
    upload_reader::{UploadOutcome, UploadReader, UploadTask},
};
use skyglow_observatory::{
    BrightnessMap, BrightnessRequest, InfluenceMap, InfluenceRequest, MAX_PLACES, Observatory,
    ObservatoryError, ObserverHeight, PlanOutcome, PlanRequest, SkyRequest,
};
use skyglow_physics::GeoPoint;
use skyglow_render::{EngineStats, PackKind, RenderError, ResidentKind};
use skyglow_scene::{
    ChangeId, ChangeStoreError, ChangeSummary, IngestOptions, NamedPlace, PatchStore, RasterTile, Scenario,
    Scene, SceneError, SceneId, SceneMetadata, StoredPlan, TileLayer, UploadFolder,
};
use skyglow_tables::{Clouds, Manifest};
use std::sync::Arc;

/// An observatory with what is fixed after the start.
#[derive(Debug)]
pub struct ObservatorySource {
    observatory: Arc<Observatory>,
    facts: SourceFacts,
    upload_reader: Option<UploadReader>,
}

impl ObservatorySource {
    /// Puts an observatory behind the interface.
    pub fn new(observatory: Arc<Observatory>) -> Self {
        let info = observatory.engine().info();
        let facts = SourceFacts {
            executor: info.executor.name().to_owned(),
            adapter: info.adapter.clone(),
            max_places: MAX_PLACES,
            kinds: info.kinds.iter().map(|kind| kind_facts(kind, observatory.atmospheres())).collect(),
            any_cloud_albedo: None,
            altitude_range_m: (info.altitude_range_m[0], info.altitude_range_m[1]),
            pack_checksums: observatory
                .engine()
                .tables()
                .iter()
                .map(|tables| tables.checksum.as_str())
                .collect::<Vec<_>>()
                .join(" "),
        };
        Self { observatory, facts, upload_reader: None }
    }

    /// The same with uploads read by a process of their own.
    #[must_use]
    pub fn with_upload_reader(mut self, reader: UploadReader) -> Self {
        self.upload_reader = Some(reader);
        self
    }

    /// The same with other limits of places in a map of the zenith's brightness.
    #[must_use]
    pub fn with_max_places(mut self, max_places: usize) -> Self {
        self.facts.max_places = max_places;
        self
    }
}

/// The first and the last of ascending values.
fn ends(values: &[f64]) -> (f64, f64) {
    (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(0.0))
}

fn kind_facts(resident: &ResidentKind, manifests: &[Manifest]) -> KindFacts {
    // Packs of one kind lie over one ground.
    let pack = manifests.iter().find(|manifest| PackKind::of_manifest(manifest) == resident.kind);
    KindFacts {
        clouds: pack.and_then(|pack| pack.clouds),
        scattering: resident.kind.scattering,
        turbidity_range: ends(&resident.turbidities),
        basis_count: resident.basis_count,
        ground_albedo: pack.and_then(|pack| pack.ground_albedo),
        why_open: (!resident.hides_lights).then_some(
            "the resident table packs know no skylines: make them again with `skyglow precompute`",
        ),
    }
}

impl From<RenderError> for SourceError {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Busy { .. } => SourceError::Busy,
            RenderError::Stopped | RenderError::Device(_) => SourceError::Down(error.to_string()),
            RenderError::AltitudeOutOfRange { altitude_m, minimum_m, maximum_m } => {
                SourceError::AltitudeOutOfRange { altitude_m, minimum_m, maximum_m }
            }
            RenderError::AboveClouds { altitude_m, base_m, maximum_m } => {
                SourceError::AboveClouds { altitude_m, base_m, maximum_m }
            }
            RenderError::TurbidityOutOfRange { turbidity, minimum, maximum } => SourceError::OutOfRange {
                parameter: TURBIDITY.name,
                value: turbidity.to_string(),
                allowed: format!("{minimum} to {maximum}"),
            },
            RenderError::BasisOutOfRange { basis, maximum } => SourceError::OutOfRange {
                parameter: BASIS.name,
                value: basis.to_string(),
                allowed: format!("a whole number from 1 to {maximum}"),
            },
            RenderError::KindNotResident { kind, resident } => SourceError::NotResident {
                parameter: SCATTERING.name,
                value: kind.to_string(),
                resident: resident.iter().map(PackKind::to_string).collect::<Vec<_>>().join(", "),
            },
            // The rest is about starting an engine, or a defect.
            other => SourceError::Broken(other.to_string()),
        }
    }
}

impl From<ObservatoryError> for SourceError {
    fn from(error: ObservatoryError) -> Self {
        match error {
            ObservatoryError::Render(error) => error.into(),
            ObservatoryError::OutsideScene { bounds, .. } => SourceError::OutsideScene { bounds },
            ObservatoryError::EmptyRegion => SourceError::EmptyRegion,
            ObservatoryError::Scene(error) => error.into(),
            ObservatoryError::Change(error) => SourceError::BadEdit(error),
            ObservatoryError::ChangeStore(error) => error.into(),
            ObservatoryError::BadPlan { reason } => SourceError::BadPlan(reason),
        }
    }
}

impl From<SceneError> for SourceError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::UnknownScene { id } | SceneError::InvalidId { id } => SourceError::UnknownScene(id),
            SceneError::InvalidTile { .. } => SourceError::UnknownTile(error.to_string()),
            other => SourceError::Broken(other.to_string()),
        }
    }
}

impl From<ChangeStoreError> for SourceError {
    fn from(error: ChangeStoreError) -> Self {
        match error {
            ChangeStoreError::Unknown { id } => SourceError::UnknownScenario(id.to_string()),
            ChangeStoreError::OtherScene { id, scene } => {
                SourceError::ScenarioOfOtherScene { id: id.to_string(), scene: scene.to_string() }
            }
            ChangeStoreError::Stale { id, .. } => SourceError::StalePlan(id.to_string()),
            ChangeStoreError::Draft { id } => SourceError::DraftPlan(id.to_string()),
            ChangeStoreError::TooDeep { id } => SourceError::ScenarioTooDeep(id.to_string()),
            ChangeStoreError::Io { .. } => SourceError::Storage(error.to_string()),
            ChangeStoreError::Damaged { .. } => SourceError::Broken(error.to_string()),
        }
    }
}

/// A sky as the engine is asked for it.
pub(crate) fn sky_request(query: &SkyQuery) -> SkyRequest {
    SkyRequest {
        scene: query.scene.clone(),
        scenario: query.scenario.clone(),
        place: query.place,
        observer_height: match query.eye_height {
            EyeHeight::AboveGround(height_m) => ObserverHeight::AboveGround(height_m),
            EyeHeight::AboveSea(altitude_m) => ObserverHeight::AboveSea(altitude_m),
        },
        turbidity: query.turbidity,
        scattering: query.scattering,
        cloud_base_m: query.cloud_base_m,
        lamp: query.lamp,
        emission: query.emission,
        basis: query.basis,
        tolerance: query.tolerance,
        terrain_hides: query.terrain_hides,
    }
}

/// The part of a range of altitudes that lies below a pack's clouds.
fn below_clouds_m(manifest: &Manifest, (lowest_m, highest_m): (f64, f64)) -> [f64; 2] {
    let ceiling_m = manifest.clouds.map_or(f64::INFINITY, Clouds::ceiling_m);
    [lowest_m, highest_m.min(ceiling_m)]
}

/// A pack as the interface describes it.
fn atmosphere(manifest: &Manifest) -> AtmosphereAnswer {
    AtmosphereAnswer {
        turbidity: manifest.turbidity,
        scattering: manifest.scattering.name().to_owned(),
        ground_albedo: manifest.ground_albedo,
        cloud_base_m: manifest.clouds.map(Clouds::base_m),
        cloud_albedo: manifest.clouds.map(Clouds::albedo),
        bands_nm: manifest.bands_nm.clone(),
        observer_altitude_m: below_clouds_m(manifest, ends(&manifest.axes.observer_altitude_m)),
        source_altitude_m: below_clouds_m(manifest, (0.0, skyglow_tables::axes::MAX_ALTITUDE_M)),
        distance_m: ends(&manifest.axes.distance_m).into(),
        basis_count: manifest.basis_count,
        checksum: manifest.checksum.clone(),
        measured_error: serde_json::to_value(&manifest.measured_error).ok(),
    }
}

impl SkySource for ObservatorySource {
    fn facts(&self) -> &SourceFacts {
        &self.facts
    }

    fn is_ready(&self) -> bool {
        self.observatory.engine().is_ready()
    }

    fn stats(&self) -> EngineStats {
        self.observatory.engine().stats()
    }

    fn open_scenes(&self) -> usize {
        self.observatory.open_scene_count()
    }

    fn atmospheres(&self) -> Vec<AtmosphereAnswer> {
        self.observatory.atmospheres().iter().map(atmosphere).collect()
    }

    fn scenes(&self) -> Result<Vec<SceneMetadata>, SourceError> {
        Ok(self.observatory.scenes()?)
    }

    fn upload_folder(&self) -> Result<UploadFolder, SourceError> {
        self.observatory.store().upload_folder().map_err(|error| SourceError::Storage(error.to_string()))
    }

    fn ingest(&self, options: &IngestOptions) -> Result<(SceneMetadata, bool), SourceError> {
        let scenes = self.observatory.store().scenes_dir();
        let data = scenes.parent().unwrap_or(scenes).to_owned();
        let task = UploadTask { data, options: options.clone() };
        let outcome =
            self.upload_reader.as_ref().map_or_else(|| Ok(task.run()), |reader| task.run_by(reader));
        match outcome? {
            UploadOutcome::Done { metadata, was_there } => Ok((*metadata, was_there)),
            UploadOutcome::Refused(reason) => Err(SourceError::BadUpload(reason)),
            UploadOutcome::Storage(reason) => Err(SourceError::Storage(reason)),
        }
    }

    fn remove_scene(&self, id: &SceneId) -> Result<(), SourceError> {
        self.observatory.store().remove(id).map_err(|error| match error {
            SceneError::Io { .. } => SourceError::Storage(error.to_string()),
            other => other.into(),
        })
    }

    fn scene(&self, id: &SceneId) -> Result<SceneMetadata, SourceError> {
        Ok(self.observatory.scene(id)?.metadata().clone())
    }

    fn places(&self, id: &SceneId) -> Result<Vec<NamedPlace>, SourceError> {
        Ok(self.observatory.scene(id)?.places().to_vec())
    }

    fn open_scene(&self, id: &SceneId, scenario: Option<&ChangeId>) -> Result<Arc<Scene>, SourceError> {
        Ok(self.observatory.changed_scene(id, scenario)?)
    }

    fn site(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
        place: GeoPoint,
    ) -> Result<SiteFacts, SourceError> {
        let site = self.observatory.site(id, scenario, place)?;
        Ok(SiteFacts { scene: site.scene, ground: site.ground, radiance_nw_cm2_sr: site.radiance_nw_cm2_sr })
    }

    fn tile(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
        layer: TileLayer,
        address: (u8, u32, u32),
        size_px: u32,
    ) -> Result<RasterTile, SourceError> {
        Ok(self.observatory.tile(id, scenario, layer, address, size_px)?)
    }

    fn influence(&self, query: &InfluenceQuery) -> Result<InfluenceMap, SourceError> {
        let request = InfluenceRequest { sky: sky_request(&query.sky), measure: query.measure.clone() };
        Ok(self.observatory.influence(&request)?)
    }

    fn brightness(
        &self,
        query: &BrightnessRequest,
        store: &dyn PatchStore,
    ) -> Result<BrightnessMap, SourceError> {
        Ok(self.observatory.brightness(query, store)?)
    }

    fn store_scenario(&self, scenario: &Scenario) -> Result<ChangeId, SourceError> {
        Ok(self.observatory.store_scenario(scenario)?.0)
    }

    fn scenario(&self, id: &ChangeId) -> Result<(Scenario, Arc<ChangeSummary>, u64), SourceError> {
        Ok(self.observatory.scenario(id)?)
    }

    fn plan(&self, request: &PlanRequest) -> Result<PlanOutcome, SourceError> {
        Ok(self.observatory.plan(request)?)
    }

    fn store_plan(&self, id: &ChangeId, plan: &StoredPlan) -> Result<(), SourceError> {
        Ok(self.observatory.changes().store_plan(id, plan)?)
    }

    fn hold_plan(&self, id: &ChangeId, plan: StoredPlan) {
        self.observatory.changes().hold_plan(id, plan);
    }

    fn check_base(&self, base: &ChangeId) -> Result<(), SourceError> {
        Ok(self.observatory.changes().check_base(Some(base))?)
    }

    fn is_stored(&self, id: &ChangeId) -> bool {
        self.observatory.changes().is_stored(id)
    }

    fn plan_by_id(&self, id: &ChangeId) -> Result<(StoredPlan, u64), SourceError> {
        if !id.is_plan() {
            return Err(SourceError::UnknownScenario(id.to_string()));
        }
        Ok(self.observatory.changes().plan(id)?)
    }

    fn list_scenarios(&self, scene: &SceneId) -> Result<Vec<ScenarioEntry>, SourceError> {
        self.scene(scene)?;
        Ok(stored_scenarios(self.observatory.changes(), scene)?)
    }

    fn list_plans(&self, scene: &SceneId) -> Result<Vec<PlanEntry>, SourceError> {
        self.scene(scene)?;
        Ok(stored_plans(self.observatory.changes(), scene)?)
    }

    fn sky(&self, query: Arc<SkyQuery>) -> BoxFuture<'_, Result<RenderedSky, SourceError>> {
        Box::pin(async move {
            let answer = self.observatory.sky(sky_request(&query)).await?;
            let horizon_time = answer.horizon_time.map(|time| ("horizon", 1e6 * time.as_secs_f64()));
            let passes = answer.rendered.passes.iter().map(|pass| (pass.name, pass.microseconds));
            Ok(RenderedSky {
                context: RenderContext {
                    altitude_m: answer.observer.altitude_m,
                    ground: answer.observer.ground,
                    coverage: answer.coverage,
                    calibration: answer.calibration,
                    local_optical_depth: answer.local_optical_depth,
                    flux_dnb_w: answer.flux_dnb_w,
                    basis_count: answer.rendered.basis_count,
                    basis_error_bound: answer.basis_error_bound,
                    lamps_not_met: answer.lamps_not_met,
                },
                quantities: answer.quantities,
                passes: horizon_time.into_iter().chain(passes).collect(),
                horizon: answer.horizon,
                panorama: answer.rendered.panorama,
            })
        })
    }
}
