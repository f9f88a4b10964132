//! The real program behind the interface.

use crate::{
    answers::{AtmosphereAnswer, PlanEntry, ScenarioEntry},
    error::AppError,
    facts::{KindFacts, LeftOut, SourceFacts},
    request::ListRequest,
    source::{BoxFuture, SkySource},
    stored::{stored_plans, stored_scenarios},
    upload_reader::{UploadOutcome, UploadReader, UploadTask},
};
use skyglow_observatory::{
    BrightnessMap, BrightnessRequest, DarkerPlaces, DarkerRequest, InfluenceMap, InfluenceRequest,
    MAX_PLACES, Observatory, ObservatoryError, PlanOutcome, PlanRequest, PreparedBrightness, RenderedSky,
    ScenarioRecord, SceneView, SkyAtTime, SkyRequest, SkyTime, Watch,
};
use skyglow_render::{EngineStats, LeftOutPack, PackKind, ResidentKind, celestial::CelestialTables};
use skyglow_scene::{
    Account, ChangeId, ChangeStoreError, IngestOptions, Owner, Page, PatchStore, PlaceWindow, Posting,
    Scenario, SceneError, SceneId, SceneMetadata, StoredPlan, UploadFolder, Viewer, available_bytes,
};
use skyglow_tables::{Clouds, Manifest};
use std::sync::Arc;

/// An observatory with what is fixed after the start.
#[derive(Debug)]
pub struct ObservatorySource {
    observatory: Arc<Observatory>,
    facts: SourceFacts,
    left_out_packs: Vec<String>,
    upload_reader: Option<UploadReader>,
}

impl ObservatorySource {
    /// Puts an observatory behind the interface.
    pub fn new(observatory: Arc<Observatory>) -> Self {
        let info = observatory.engine().info();
        let celestial = observatory.celestial_tables();
        let facts = SourceFacts {
            executor: info.executor.name().to_owned(),
            adapter: info.adapter.clone(),
            max_places: MAX_PLACES,
            kinds: info.kinds.iter().map(|kind| kind_facts(kind, observatory.atmospheres())).collect(),
            any_cloud_albedo: None,
            altitude_range_m: (info.altitude_range_m[0], info.altitude_range_m[1]),
            celestial_turbidity_range: celestial.map(CelestialTables::turbidity_range),
            celestial_highest_m: celestial.map(|tables| tables.altitude_range_m().1),
            pack_checksums: observatory
                .engine()
                .tables()
                .iter()
                .map(|tables| tables.checksum.clone())
                .chain(celestial.map(CelestialTables::checksums))
                .collect::<Vec<_>>()
                .join(" "),
        };
        Self { observatory, facts, left_out_packs: Vec::new(), upload_reader: None }
    }

    /// The same where packs were left out: what they alone could serve is refused.
    ///
    /// * `celestial`: the name of a celestial table for which all of them are.
    #[must_use]
    pub fn without_packs(mut self, left_out: &[LeftOutPack], celestial: Option<String>) -> Self {
        let kinds = &self.observatory.engine().info().kinds;
        for (facts, kind) in self.facts.kinds.iter_mut().zip(kinds) {
            facts.unserved = LeftOutPack::unserved(kind, left_out);
        }
        self.left_out_packs = left_out.iter().map(|pack| pack.name.clone()).chain(celestial).collect();
        self
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
        unserved: Vec::new(),
        basis_count: resident.basis_count,
        ground_albedo: pack.and_then(|pack| pack.ground_albedo),
        why_open: (!resident.hides_lights).then_some(match resident.kind.cloud_base_m {
            None => "the resident table packs know no skylines: make them again with `skyglow precompute`",
            Some(_) => "under clouds table packs know no skylines",
        }),
        checksums: manifests
            .iter()
            .filter(|manifest| PackKind::of_manifest(manifest) == resident.kind)
            .map(|manifest| manifest.checksum.as_str())
            .collect::<Vec<_>>()
            .join(" "),
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

    fn left_out(&self) -> LeftOut {
        let (damaged, others) = self.observatory.damaged_scenes();
        LeftOut {
            packs: self.left_out_packs.clone(),
            no_scene_left: others == 0 && !damaged.is_empty(),
            scenes: damaged.iter().map(SceneId::to_string).collect(),
        }
    }

    fn check_scenes(&self) -> Result<(), AppError> {
        Ok(self.observatory.check_scenes()?)
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

    fn scenes(&self) -> Result<Vec<SceneMetadata>, AppError> {
        Ok(self.observatory.scenes()?)
    }

    fn stored_unix_s(&self, id: &SceneId) -> Option<u64> {
        self.observatory.store().stored_unix_s(id)
    }

    fn upload_folder(&self) -> Result<UploadFolder, AppError> {
        let folder = self.observatory.store().upload_folder();
        folder.map_err(|error| AppError::Storage { reason: error.to_string() })
    }

    fn ingest(
        &self,
        folder: &UploadFolder,
        options: &IngestOptions,
    ) -> Result<(SceneMetadata, bool), AppError> {
        let task = UploadTask {
            folder: folder.path().to_owned(),
            data: folder.made(),
            memory_bytes: available_bytes().map_or(u64::MAX, |bytes| bytes / 4 * 3),
            options: IngestOptions {
                max_scene_bytes: Some(self.observatory.max_scene_bytes()),
                ..options.clone()
            },
        };
        let outcome =
            self.upload_reader.as_ref().map_or_else(|| Ok(task.run()), |reader| task.run_by(reader));
        match outcome? {
            UploadOutcome::Done { id } => {
                let adopted = self.observatory.adopt_scene(folder, &id);
                adopted.map_err(|error| match error {
                    SceneError::StoreAway { reason } => AppError::StoreAway { reason },
                    other => AppError::Storage { reason: other.to_string() },
                })
            }
            UploadOutcome::Refused(reason) => Err(AppError::BadUpload { reason }),
            UploadOutcome::Storage(reason) => Err(AppError::Storage { reason }),
        }
    }

    fn remove_scene(&self, id: &SceneId) -> Result<(), AppError> {
        self.observatory.remove_scene(id).map_err(|error| match error {
            SceneError::Io { .. } => AppError::Storage { reason: error.to_string() },
            other => ObservatoryError::from(other).into(),
        })
    }

    fn view(&self, id: &SceneId, scenario: Option<&ChangeId>) -> Result<SceneView, AppError> {
        self.observatory.view(id, scenario).map_err(AppError::in_scenario)
    }

    fn influence(
        &self,
        request: &InfluenceRequest,
        view: &SceneView,
        watch: &Watch<'_>,
    ) -> Result<InfluenceMap, AppError> {
        let map = self.observatory.influence_in(view, request, watch);
        map.map_err(|error| AppError::of_sky(error, &request.sky))
    }

    fn brightness(
        &self,
        request: &BrightnessRequest,
        view: &SceneView,
        store: &dyn PatchStore,
    ) -> Result<BrightnessMap, AppError> {
        if request.terrain_hides {
            let limit_bytes = self.observatory.max_scene_bytes() / 2;
            view.scene().check_skylines_of_all(limit_bytes).map_err(ObservatoryError::from)?;
        }
        Ok(self.observatory.brightness_in(view, request, store)?)
    }

    fn prepare_brightness(
        &self,
        request: &BrightnessRequest,
        view: &SceneView,
    ) -> Result<PreparedBrightness, AppError> {
        Ok(self.observatory.prepare_brightness(view, request)?)
    }

    fn brightness_part(
        &self,
        prepared: &PreparedBrightness,
        window: Option<&PlaceWindow>,
        store: &dyn PatchStore,
    ) -> Result<BrightnessMap, AppError> {
        let lattice = prepared.lattice();
        let is_within = |window: &PlaceWindow| window.pieces(lattice).iter().all(|it| it.is_within(lattice));
        if !window.is_none_or(is_within) {
            return Err(AppError::internal("a window beyond its map"));
        }
        Ok(prepared.find(&self.observatory, window, store)?)
    }

    fn darker(
        &self,
        request: &DarkerRequest,
        view: &SceneView,
        watch: &Watch<'_>,
    ) -> Result<DarkerPlaces, AppError> {
        let found = self.observatory.darker_in(view, request, watch);
        found.map_err(|error| AppError::at(error, request.place))
    }

    fn store_scenario(&self, scenario: &Scenario, posting: &Posting) -> Result<(ChangeId, bool), AppError> {
        self.observatory.store_scenario_as(scenario, posting).map_err(AppError::of_painting)
    }

    fn scenario(&self, id: &ChangeId) -> Result<ScenarioRecord, AppError> {
        Ok(self.observatory.scenario(id)?)
    }

    fn plan(
        &self,
        request: &PlanRequest,
        view: &SceneView,
        watch: &Watch<'_>,
    ) -> Result<PlanOutcome, AppError> {
        self.observatory.plan_in(view, request, watch).map_err(|error| match request.sites().as_slice() {
            [site] => AppError::of_sky(error, &site.sky),
            _ => error.into(),
        })
    }

    fn plan_id(&self, content: Vec<u8>, posting: &Posting) -> Result<ChangeId, AppError> {
        Ok(self.observatory.changes().plan_id_as(content, posting).map_err(ObservatoryError::from)?)
    }

    fn store_plan(&self, id: &ChangeId, plan: &StoredPlan, posting: &Posting) -> Result<bool, AppError> {
        Ok(self.observatory.changes().store_plan_as(id, plan, posting).map_err(ObservatoryError::from)?)
    }

    fn remove_change(&self, id: &ChangeId, owner: Option<&Owner>) -> Result<(), AppError> {
        Ok(self.observatory.changes().remove(id, owner).map_err(ObservatoryError::from)?)
    }

    fn hold_plan(&self, id: &ChangeId, plan: StoredPlan, account: &Account) {
        self.observatory.changes().hold_plan(id, plan, account);
    }

    fn check_base(&self, base: &ChangeId) -> Result<(), AppError> {
        Ok(self.observatory.changes().check_base(Some(base)).map_err(ObservatoryError::from)?)
    }

    fn is_kept(&self, id: &ChangeId) -> Result<bool, AppError> {
        Ok(self.observatory.changes().is_kept(id).map_err(ObservatoryError::from)?)
    }

    fn refresh_kept(&self) -> Result<(), AppError> {
        Ok(self.observatory.changes().refresh().map_err(ObservatoryError::from)?)
    }

    fn refresh_scenes(&self) -> Result<(), AppError> {
        Ok(self.observatory.refresh_scenes().map_err(ObservatoryError::from)?)
    }

    fn plan_by_id(&self, id: &ChangeId) -> Result<(StoredPlan, u64), AppError> {
        let plan = match id.is_plan() {
            true => self.observatory.changes().plan(id),
            false => Err(ChangeStoreError::Unknown { id: id.clone() }),
        };
        Ok(plan.map_err(ObservatoryError::from)?)
    }

    fn list_scenarios(
        &self,
        scene: &SceneId,
        viewer: &Viewer,
        part: &ListRequest,
    ) -> Result<Page<ScenarioEntry>, AppError> {
        self.view(scene, None)?;
        let list = stored_scenarios(self.observatory.changes(), scene, viewer, part);
        Ok(list.map_err(ObservatoryError::from)?)
    }

    fn list_plans(
        &self,
        scene: &SceneId,
        viewer: &Viewer,
        part: &ListRequest,
    ) -> Result<Page<PlanEntry>, AppError> {
        self.view(scene, None)?;
        Ok(stored_plans(self.observatory.changes(), scene, viewer, part).map_err(ObservatoryError::from)?)
    }

    fn sky_at_times(
        &self,
        request: &SkyRequest,
        sky: &RenderedSky,
        times: &[SkyTime],
    ) -> Result<Vec<SkyAtTime>, AppError> {
        Ok(self.observatory.sky_at_times(request, sky, times)?)
    }

    fn sky(&self, request: Arc<SkyRequest>, view: SceneView) -> BoxFuture<'_, Result<RenderedSky, AppError>> {
        Box::pin(async move {
            let sky = self.observatory.sky(view, Arc::clone(&request)).await;
            sky.map_err(|error| AppError::of_sky(error, &request))
        })
    }
}
