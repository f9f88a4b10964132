//! What the interface asks of the program behind it. [`ObservatorySource`](crate::ObservatorySource) is the real one; tests
//! put slow, busy and counting ones in its place.

mod error;

use crate::{
    answers::{AtmosphereAnswer, PlanEntry, ScenarioEntry},
    kind_facts::KindFacts,
};

pub use error::SourceError;
use skyglow_observatory::{
    BrightnessMap, BrightnessRequest, InfluenceMap, Measure, PlanOutcome, PlanRequest,
};
use skyglow_physics::{EmissionMix, GeoPoint, Horizon, Lamp, LampPreset, Panorama, SkyQuantities, Turbidity};
use skyglow_render::EngineStats;
use skyglow_scene::{
    ChangeId, ChangeSummary, Ground, IngestOptions, NamedPlace, PatchStore, RasterTile, Scenario, Scene,
    SceneId, SceneMetadata, StoredPlan, TileLayer, UploadFolder,
};
use skyglow_tables::Scattering;
use std::{future::Future, pin::Pin, sync::Arc};

/// What is fixed after the start.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceFacts {
    /// `gpu`, `lavapipe` or `cpu`.
    pub executor: String,
    /// Name of the device.
    pub adapter: String,
    /// Places of a map of the zenith's brightness at most.
    pub max_places: usize,
    /// The packs resident, those of a clear sky first, under each sky by scattering, the best last; one at least.
    pub kinds: Vec<KindFacts>,
    /// Albedo of the base of clouds at whatever altitude, where no packs are needed; None where packs decide.
    pub any_cloud_albedo: Option<f64>,
    /// Lowest and highest observer altitude resident, metres.
    pub altitude_range_m: (f64, f64),
    /// Checksums of all resident packs, one after another; part of every ETag.
    pub pack_checksums: String,
}

/// Where the observer's eye is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EyeHeight {
    /// Metres above the ground.
    AboveGround(f64),
    /// Metres above sea level.
    AboveSea(f64),
}

impl EyeHeight {
    /// Metres above sea level over a ground.
    pub fn altitude_m(self, ground: Ground) -> f64 {
        match self {
            EyeHeight::AboveGround(height_m) => ground.altitude_m() + height_m,
            EyeHeight::AboveSea(altitude_m) => altitude_m,
        }
    }
}

/// One sky asked for. Its `Debug` form is its identity in ETags and the cache.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyQuery {
    /// The scene.
    pub scene: SceneId,
    /// The scenario or plan that changes its lights.
    pub scenario: Option<ChangeId>,
    /// The place, in the scene.
    pub place: GeoPoint,
    /// Where the eye is.
    pub eye_height: EyeHeight,
    /// Turbidity, in the resident range.
    pub turbidity: Turbidity,
    /// Orders of scattering, of which packs are resident.
    pub scattering: Scattering,
    /// Base of the layer of cloud above sea level, metres, of which packs are resident; None under a clear sky.
    pub cloud_base_m: Option<u32>,
    /// The lamp.
    pub lamp: Lamp,
    /// Where lamps send their light.
    pub emission: EmissionMix,
    /// Basis functions; None for all, or for as many as the tolerance needs.
    pub basis: Option<usize>,
    /// Relative difference that fewer functions may make; None where all are wanted, or a number of them is.
    pub tolerance: Option<f64>,
    /// Whether terrain hides the sky.
    pub terrain_hides: bool,
}

/// What the numbers of an answer depend on that nobody asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderContext {
    /// Observer's altitude, metres above sea level.
    pub altitude_m: f64,
    /// The ground there.
    pub ground: Ground,
    /// Covered share of the 300 km disc, 0..=1.
    pub coverage: f64,
    /// The scene's calibration factor.
    pub calibration: f64,
    /// Vertical optical depth above the observer in R, G, B.
    pub local_optical_depth: [f64; 3],
    /// Upward flux within 300 km, DNB watts.
    pub flux_dnb_w: f64,
    /// Basis functions used.
    pub basis_count: usize,
    /// Where a tolerance was given: bound of the relative difference to the sky of all functions.
    pub basis_error_bound: Option<f64>,
    /// Lamps that changes replace around here where there are none of them by then.
    pub lamps_not_met: Vec<LampPreset>,
}

impl RenderContext {
    /// Those of a map of influences.
    pub fn of_influences(map: &InfluenceMap) -> Self {
        Self {
            altitude_m: map.observer.altitude_m,
            ground: map.observer.ground,
            coverage: map.coverage,
            calibration: map.scene().calibration,
            local_optical_depth: map.local_optical_depth,
            flux_dnb_w: map.flux_dnb_w,
            basis_count: map.basis_count,
            basis_error_bound: map.basis_error_bound,
            lamps_not_met: map.lamps_not_met.clone(),
        }
    }
}

/// A rendered sky.
#[derive(Clone, Debug)]
pub struct RenderedSky {
    /// Radiance of artificial light, 0 below the horizon.
    pub panorama: Panorama,
    /// Below it terrain hides the sky; flat where nothing does.
    pub horizon: Horizon,
    /// The reported quantities.
    pub quantities: SkyQuantities,
    /// What its numbers depend on.
    pub context: RenderContext,
    /// Name and time [µs] of each pass, for the batch it was in; before them `horizon`, where one was computed.
    pub passes: Vec<(&'static str, f64)>,
}

/// A map of influences asked for. Its `Debug` form is its identity in ETags and the cache.
#[derive(Clone, Debug, PartialEq)]
pub struct InfluenceQuery {
    /// The sky that lights are to have their part in.
    pub sky: SkyQuery,
    /// What of it.
    pub measure: Measure,
}

/// What is at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct SiteFacts {
    /// The scene that the place is in.
    pub scene: SceneMetadata,
    /// The ground there.
    pub ground: Ground,
    /// Radiance of the pixel there, nW cm⁻² sr⁻¹; None without data.
    pub radiance_nw_cm2_sr: Option<f64>,
}

/// Degrees without the last digits of the way through radians.
pub fn rounded(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

/// A future that a trait object returns.
pub type BoxFuture<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;

/// The program behind the interface. Methods that are not async may read files: never on an async thread.
pub trait SkySource: Send + Sync + 'static {
    /// What is fixed after the start. Cheap.
    fn facts(&self) -> &SourceFacts;
    /// Whether tables are resident and the device answers. Cheap.
    fn is_ready(&self) -> bool;
    /// Counters of the engine. Cheap.
    fn stats(&self) -> EngineStats;
    /// Number of scenes open. Cheap.
    fn open_scenes(&self) -> usize;
    /// The resident packs. Cheap.
    fn atmospheres(&self) -> Vec<AtmosphereAnswer>;
    /// All scenes.
    ///
    /// # Errors
    /// [`SourceError::Broken`].
    fn scenes(&self) -> Result<Vec<SceneMetadata>, SourceError>;
    /// A new folder for files that come in, on the same disk as the scenes; gone when it is dropped.
    ///
    /// # Errors
    /// [`SourceError::Storage`].
    fn upload_folder(&self) -> Result<UploadFolder, SourceError>;
    /// Checks files and makes a scene of them, in place of the one of that id if there is one, which stays where they are refused;
    /// and whether there was one. Takes seconds to minutes.
    ///
    /// # Errors
    /// [`SourceError::BadUpload`], [`SourceError::Storage`].
    fn ingest(&self, options: &IngestOptions) -> Result<(SceneMetadata, bool), SourceError>;
    /// Removes a scene; requests under way keep it.
    ///
    /// # Errors
    /// [`SourceError::UnknownScene`], [`SourceError::Storage`].
    fn remove_scene(&self, id: &SceneId) -> Result<(), SourceError>;
    /// One scene.
    ///
    /// # Errors
    /// [`SourceError::UnknownScene`], [`SourceError::Broken`].
    fn scene(&self, id: &SceneId) -> Result<SceneMetadata, SourceError>;
    /// Its named places, the most populous first.
    ///
    /// # Errors
    /// As [`Self::scene`].
    fn places(&self, id: &SceneId) -> Result<Vec<NamedPlace>, SourceError>;
    /// A scene, open, with the changes of a scenario or plan.
    ///
    /// # Errors
    /// As [`Self::scene`], and what is wrong with the scenario.
    fn open_scene(&self, id: &SceneId, scenario: Option<&ChangeId>) -> Result<Arc<Scene>, SourceError>;
    /// What is at a place.
    ///
    /// # Errors
    /// As [`Self::open_scene`], and [`SourceError::OutsideScene`].
    fn site(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
        place: GeoPoint,
    ) -> Result<SiteFacts, SourceError>;
    /// Numbers of a map tile.
    ///
    /// # Errors
    /// As [`Self::open_scene`], and [`SourceError::UnknownTile`].
    fn tile(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
        layer: TileLayer,
        address: (u8, u32, u32),
        size_px: u32,
    ) -> Result<RasterTile, SourceError>;
    /// Finds what each light does to a sky; takes up to a second of all cores.
    ///
    /// # Errors
    /// As [`Self::site`], an altitude out of range, and [`SourceError::EmptyRegion`].
    fn influence(&self, query: &InfluenceQuery) -> Result<InfluenceMap, SourceError>;
    /// Finds the zenith's brightness at every place of a scene; takes seconds to a minute of all cores. `store` is given every
    /// patch that is done, and may cancel the computation.
    ///
    /// # Errors
    /// As [`Self::open_scene`], and a turbidity out of range; [`SourceError::Down`] where it was ended.
    fn brightness(
        &self,
        query: &BrightnessRequest,
        store: &dyn PatchStore,
    ) -> Result<BrightnessMap, SourceError>;
    /// Keeps a scenario if it can be painted.
    ///
    /// # Errors
    /// As [`Self::open_scene`], [`SourceError::BadEdit`], [`SourceError::Storage`].
    fn store_scenario(&self, scenario: &Scenario) -> Result<ChangeId, SourceError>;
    /// A scenario, what it does to its scene, and when it was kept, seconds since 1970.
    ///
    /// # Errors
    /// As [`Self::store_scenario`].
    fn scenario(&self, id: &ChangeId) -> Result<(Scenario, Arc<ChangeSummary>, u64), SourceError>;
    /// Makes a plan; takes seconds of all cores.
    ///
    /// # Errors
    /// As [`Self::influence`] of any site, and [`SourceError::BadPlan`].
    fn plan(&self, request: &PlanRequest) -> Result<PlanOutcome, SourceError>;
    /// Keeps a plan.
    ///
    /// # Errors
    /// [`SourceError::Storage`].
    fn store_plan(&self, id: &ChangeId, plan: &StoredPlan) -> Result<(), SourceError>;
    /// Holds a plan for some minutes, and keeps nothing.
    fn hold_plan(&self, id: &ChangeId, plan: StoredPlan);
    /// Whether what is kept may go on from this.
    ///
    /// # Errors
    /// [`SourceError::DraftPlan`].
    fn check_base(&self, base: &ChangeId) -> Result<(), SourceError>;
    /// Whether a plan is kept, and not just held.
    fn is_stored(&self, id: &ChangeId) -> bool;
    /// A plan, kept or held, and since when, seconds since 1970.
    ///
    /// # Errors
    /// [`SourceError::UnknownScenario`], [`SourceError::Broken`].
    fn plan_by_id(&self, id: &ChangeId) -> Result<(StoredPlan, u64), SourceError>;
    /// The scenarios of a scene, the newest first.
    ///
    /// # Errors
    /// As [`Self::scene`].
    fn list_scenarios(&self, scene: &SceneId) -> Result<Vec<ScenarioEntry>, SourceError>;
    /// The plans of a scene, the newest first.
    ///
    /// # Errors
    /// As [`Self::scene`].
    fn list_plans(&self, scene: &SceneId) -> Result<Vec<PlanEntry>, SourceError>;
    /// Renders a sky.
    fn sky(&self, query: Arc<SkyQuery>) -> BoxFuture<'_, Result<RenderedSky, SourceError>>;
}
