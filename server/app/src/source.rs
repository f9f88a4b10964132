//! What the interface asks of the program behind it. [`ObservatorySource`](crate::ObservatorySource) is the real one; tests
//! put slow, busy and counting ones in its place.

use crate::{
    answers::{AtmosphereAnswer, PlanEntry, ScenarioEntry},
    error::AppError,
    facts::{LeftOut, SourceFacts},
    request::ListRequest,
};
use skyglow_observatory::{
    BrightnessMap, BrightnessRequest, DarkerPlaces, DarkerRequest, InfluenceMap, InfluenceRequest,
    ObservatoryError, PlanOutcome, PlanRequest, PreparedBrightness, RenderedSky, ScenarioRecord, SceneView,
    Site, SkyAtTime, SkyRequest, SkyTime, Watch,
};
use skyglow_physics::GeoPoint;
use skyglow_render::EngineStats;
use skyglow_scene::{
    Account, ChangeId, IngestOptions, NamedPlace, Owner, Page, PatchStore, PlaceWindow, Posting, RasterTile,
    Scenario, SceneId, SceneMetadata, StoredPlan, TileLayer, UploadFolder, Viewer,
};
use std::{future::Future, pin::Pin, sync::Arc};

/// A future that a trait object returns.
pub type BoxFuture<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;

/// The program behind the interface. Methods that are not async may read files: never on an async thread.
pub trait SkySource: Send + Sync + 'static {
    /// What is fixed after the start. Cheap.
    fn facts(&self) -> &SourceFacts;
    /// Whether tables are resident and the device answers. Cheap.
    fn is_ready(&self) -> bool;
    /// What is left out because it is damaged. Cheap.
    fn left_out(&self) -> LeftOut {
        LeftOut::default()
    }
    /// Reads every scene through that was not yet, to find those that are damaged. Takes as long as the disk does.
    ///
    /// # Errors
    /// [`AppError::Internal`].
    fn check_scenes(&self) -> Result<(), AppError> {
        Ok(())
    }
    /// The sky of a request at several times, of which `sky` is the artificial part. Takes some milliseconds a time.
    ///
    /// # Errors
    /// [`AppError::Internal`] without celestial tables, which requests are refused for.
    fn sky_at_times(
        &self,
        _request: &SkyRequest,
        _sky: &RenderedSky,
        _times: &[SkyTime],
    ) -> Result<Vec<SkyAtTime>, AppError> {
        Err(ObservatoryError::NoCelestialTables.into())
    }
    /// Counters of the engine. Cheap.
    fn stats(&self) -> EngineStats;
    /// Number of scenes open. Cheap.
    fn open_scenes(&self) -> usize;
    /// The resident packs. Cheap.
    fn atmospheres(&self) -> Vec<AtmosphereAnswer>;
    /// All scenes.
    ///
    /// # Errors
    /// [`AppError::Internal`].
    fn scenes(&self) -> Result<Vec<SceneMetadata>, AppError>;
    /// When a scene was stored, seconds since 1970; None where nobody knows.
    fn stored_unix_s(&self, _id: &SceneId) -> Option<u64> {
        None
    }
    /// A new folder for files that come in, on the same disk as the scenes; gone when it is dropped.
    ///
    /// # Errors
    /// [`AppError::Storage`].
    fn upload_folder(&self) -> Result<UploadFolder, AppError>;
    /// Checks files and makes a scene of them, in place of the one of that id if there is one, which stays where they are refused;
    /// and whether there was one. Takes seconds to minutes.
    ///
    /// * `folder`: where the files lie.
    ///
    /// # Errors
    /// [`AppError::BadUpload`], [`AppError::Storage`].
    fn ingest(
        &self,
        folder: &UploadFolder,
        options: &IngestOptions,
    ) -> Result<(SceneMetadata, bool), AppError>;
    /// Removes a scene; requests under way keep it.
    ///
    /// # Errors
    /// [`AppError::UnknownScene`], [`AppError::Storage`].
    fn remove_scene(&self, id: &SceneId) -> Result<(), AppError>;
    /// A scene as it is now, with the changes of a scenario or plan: resolved once for a request, and passed down.
    ///
    /// # Errors
    /// [`AppError::UnknownScene`], [`AppError::UnknownScenario`], and what else is wrong with the scenario.
    fn view(&self, id: &SceneId, scenario: Option<&ChangeId>) -> Result<SceneView, AppError>;
    /// Its named places, the most populous first.
    fn places(&self, view: &SceneView) -> Vec<NamedPlace> {
        view.scene().places().to_vec()
    }
    /// What is at a place.
    ///
    /// # Errors
    /// [`AppError::OutsideScene`].
    fn site(&self, view: &SceneView, place: GeoPoint) -> Result<Site, AppError> {
        view.site(place).map_err(|error| AppError::at(error, place))
    }
    /// Numbers of a map tile.
    ///
    /// # Errors
    /// [`AppError::UnknownTile`].
    fn tile(
        &self,
        view: &SceneView,
        layer: TileLayer,
        (z, x, y): (u8, u32, u32),
        size_px: u32,
    ) -> Result<RasterTile, AppError> {
        Ok(view.scene().tile(layer, z, x, y, size_px).map_err(ObservatoryError::from)?)
    }
    /// Finds what each light does to a sky; takes up to a second of all cores. `watch` is told how far it is, and may end it.
    ///
    /// # Errors
    /// As [`Self::site`], an altitude out of range, and a region without a visible direction; [`AppError::EngineDown`] where it
    /// was ended.
    fn influence(
        &self,
        request: &InfluenceRequest,
        view: &SceneView,
        watch: &Watch<'_>,
    ) -> Result<InfluenceMap, AppError>;
    /// Finds the zenith's brightness at every place of a scene; takes seconds to a minute of all cores. `store` is given every
    /// patch that is done, and may cancel the computation.
    ///
    /// # Errors
    /// A turbidity out of range; [`AppError::EngineDown`] where it was ended.
    fn brightness(
        &self,
        request: &BrightnessRequest,
        view: &SceneView,
        store: &dyn PatchStore,
    ) -> Result<BrightnessMap, AppError>;
    /// What all parts of such a map have in common; takes seconds of all cores.
    ///
    /// # Errors
    /// A turbidity out of range.
    fn prepare_brightness(
        &self,
        _request: &BrightnessRequest,
        _view: &SceneView,
    ) -> Result<PreparedBrightness, AppError> {
        Err(AppError::internal("this program finds no parts of maps"))
    }
    /// A part of a map, with the numbers of the whole map there, bit for bit.
    ///
    /// * `window`: None for all places.
    /// * `store`: as in [`Self::brightness`].
    ///
    /// # Errors
    /// [`AppError::EngineDown`] where the store cancelled it; [`AppError::Internal`] for a window beyond the map.
    fn brightness_part(
        &self,
        _prepared: &PreparedBrightness,
        _window: Option<&PlaceWindow>,
        _store: &dyn PatchStore,
    ) -> Result<BrightnessMap, AppError> {
        Err(AppError::internal("this program finds no parts of maps"))
    }
    /// Finds darker places near a place; takes tenths of a second of all cores. `watch` as in [`Self::influence`].
    ///
    /// # Errors
    /// As [`Self::site`] and [`Self::brightness`].
    fn darker(
        &self,
        request: &DarkerRequest,
        view: &SceneView,
        watch: &Watch<'_>,
    ) -> Result<DarkerPlaces, AppError>;
    /// Stores a scenario if it can be painted, and whether it is new.
    ///
    /// # Errors
    /// As [`Self::view`], edits that cannot be made, [`AppError::Storage`], [`AppError::PinsFull`].
    fn store_scenario(&self, scenario: &Scenario, posting: &Posting) -> Result<(ChangeId, bool), AppError>;
    /// A scenario with what it does to its scene.
    ///
    /// # Errors
    /// As [`Self::store_scenario`].
    fn scenario(&self, id: &ChangeId) -> Result<ScenarioRecord, AppError>;
    /// Makes a plan; takes seconds of all cores. `watch` as in [`Self::influence`].
    ///
    /// # Errors
    /// As [`Self::influence`] of any site, and a plan that cannot be made.
    fn plan(
        &self,
        request: &PlanRequest,
        view: &SceneView,
        watch: &Watch<'_>,
    ) -> Result<PlanOutcome, AppError>;
    /// The id of a plan with this content, which must include all of its inputs.
    ///
    /// # Errors
    /// [`AppError::Storage`].
    fn plan_id(&self, content: Vec<u8>, posting: &Posting) -> Result<ChangeId, AppError>;
    /// Stores a plan, and whether it is new.
    ///
    /// # Errors
    /// [`AppError::Storage`], [`AppError::PinsFull`].
    fn store_plan(&self, id: &ChangeId, plan: &StoredPlan, posting: &Posting) -> Result<bool, AppError>;
    /// Holds a plan for some minutes, and stores nothing.
    ///
    /// * `account`: whom it counts for.
    fn hold_plan(&self, id: &ChangeId, plan: StoredPlan, account: &Account);
    /// Whether what is stored may go on from this.
    ///
    /// # Errors
    /// [`AppError::DraftPlan`].
    fn check_base(&self, base: &ChangeId) -> Result<(), AppError>;
    /// Whether a plan is stored, and not just held.
    ///
    /// # Errors
    /// [`AppError::StoreAway`].
    fn is_kept(&self, id: &ChangeId) -> Result<bool, AppError>;
    /// Looks for what other servers over the same store kept or removed.
    ///
    /// # Errors
    /// [`AppError::StoreAway`], [`AppError::Busy`] soon after the start.
    fn refresh_kept(&self) -> Result<(), AppError> {
        Ok(())
    }
    /// Copies the scenes that other servers over the same store have, and removes those that are there no more.
    ///
    /// # Errors
    /// [`AppError::StoreAway`].
    fn refresh_scenes(&self) -> Result<(), AppError> {
        Ok(())
    }
    /// A plan, stored or held, and since when, seconds since 1970.
    ///
    /// # Errors
    /// [`AppError::UnknownScenario`], [`AppError::Internal`].
    fn plan_by_id(&self, id: &ChangeId) -> Result<(StoredPlan, u64), AppError>;
    /// Removes a scenario or plan that is stored: for its owner, or where None for the operator.
    ///
    /// # Errors
    /// [`AppError::UnknownScenario`], [`AppError::NotOwner`], [`AppError::Storage`].
    fn remove_change(&self, id: &ChangeId, owner: Option<&Owner>) -> Result<(), AppError>;
    /// Part of the list of a scene's scenarios as somebody sees it, the newest first. Cheap.
    ///
    /// # Errors
    /// As [`Self::view`]; [`AppError::Busy`] soon after the start.
    fn list_scenarios(
        &self,
        scene: &SceneId,
        viewer: &Viewer,
        part: &ListRequest,
    ) -> Result<Page<ScenarioEntry>, AppError>;
    /// The same of its plans.
    ///
    /// # Errors
    /// As [`Self::list_scenarios`].
    fn list_plans(
        &self,
        scene: &SceneId,
        viewer: &Viewer,
        part: &ListRequest,
    ) -> Result<Page<PlanEntry>, AppError>;
    /// Renders a sky.
    fn sky(&self, request: Arc<SkyRequest>, view: SceneView) -> BoxFuture<'_, Result<RenderedSky, AppError>>;
}
