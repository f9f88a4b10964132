//! What the interface asks of the program behind it. [`ObservatorySource`](crate::ObservatorySource) is the real one; tests
//! put slow, busy and counting ones in its place.

use crate::{
    answers::{AtmosphereAnswer, PlanEntry, ScenarioEntry},
    error::ApiError,
    kind_facts::KindFacts,
    parameters::{ALTITUDE, CLOUDS, HEIGHT, REGION, SCENARIO},
    problem::{FieldError, Mistake},
};
use skyglow_engine::{BrightnessMap, EngineStats, InfluenceMap, Measure, PlanOutcome, PlanRequest};
use skyglow_physics::{EmissionMix, GeoPoint, Horizon, Lamp, Panorama, SkyQuantities, Turbidity};
use skyglow_scene::{
    ChangeError, ChangeId, ChangeSummary, Ground, IngestOptions, Place, RasterTile, Scenario, Scene, SceneId,
    SceneMetadata, StoredPlan, SumKeeper, TileLayer, UploadFolder,
};
use skyglow_tables::Scattering;
use std::{future::Future, pin::Pin, sync::Arc};
use thiserror::Error;

/// What is fixed after the start.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceFacts {
    /// `gpu`, `lavapipe` or `cpu`.
    pub executor: String,
    /// Name of the device.
    pub adapter: String,
    /// Places of a map of the zenith's brightness at most.
    pub most_places: usize,
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
pub struct Circumstances {
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
}

impl Circumstances {
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
    pub circumstances: Circumstances,
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

/// The zenith's brightness at every place of a scene. Its `Debug` form is its identity in ETags and the cache.
#[derive(Clone, Debug, PartialEq)]
pub struct BrightnessQuery {
    /// The scene.
    pub scene: SceneId,
    /// The scenario or plan that changes its lights.
    pub scenario: Option<ChangeId>,
    /// Turbidity, in the resident range.
    pub turbidity: Turbidity,
    /// Orders of scattering, resident.
    pub scattering: Scattering,
    /// The lamp.
    pub lamp: Lamp,
    /// Where lamps send their light.
    pub emission: EmissionMix,
    /// Whether terrain hides low light.
    pub terrain_hides: bool,
    /// Places at most; beyond, pixels share one by blocks.
    pub most_places: usize,
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

/// Why the program behind does not answer.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SourceError {
    /// No scene of that id.
    #[error("there is no scene \"{0}\"")]
    UnknownScene(String),
    /// The place lies outside.
    #[error("the place lies outside the scene")]
    OutsideScene {
        /// West, south, east, north of the scene, degrees.
        bounds: [f64; 4],
    },
    /// Observer too high.
    #[error("altitude is {altitude_m} m; allowed is {minimum_m} to {maximum_m} m")]
    AltitudeOutOfRange {
        /// Altitude asked for, metres.
        altitude_m: f64,
        /// Lowest resident, metres.
        minimum_m: f64,
        /// Highest resident, metres.
        maximum_m: f64,
    },
    /// Observer at the clouds or above them.
    #[error("altitude is {altitude_m} m; the clouds are at {base_m} m, and allowed is up to {maximum_m} m")]
    AboveClouds {
        /// Altitude asked for, metres.
        altitude_m: f64,
        /// Base of the clouds, metres.
        base_m: u32,
        /// Highest allowed, metres.
        maximum_m: f64,
    },
    /// Another number that the resident tables do not reach.
    #[error("{parameter} is {value}; allowed is {allowed}")]
    OutOfRange {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value asked for.
        value: String,
        /// What is resident.
        allowed: String,
    },
    /// A value for which no tables are resident at all.
    #[error("{parameter} is {value}; resident is {resident}")]
    NotResident {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value asked for.
        value: String,
        /// What is resident.
        resident: String,
    },
    /// A curve on the sky without a visible direction in it.
    #[error("the curve holds no visible direction of the sky")]
    EmptyRegion,
    /// No scenario or plan of that id.
    #[error("there is no scenario or plan \"{0}\"")]
    UnknownScenario(String),
    /// It belongs to another scene.
    #[error("\"{id}\" belongs to scene \"{scene}\"")]
    ScenarioOfOtherScene {
        /// The id.
        id: String,
        /// Its scene.
        scene: String,
    },
    /// A plan for pixels of a raster that was replaced.
    #[error("plan \"{0}\" is for an earlier state of its scene")]
    StalePlan(String),
    /// Too many scenarios and plans one upon the other.
    #[error("\"{0}\" stands on too many others")]
    ScenarioTooDeep(String),
    /// Edits that cannot be made.
    #[error(transparent)]
    BadEdit(#[from] ChangeError),
    /// A plan that cannot be meant.
    #[error("{0}")]
    BadPlan(String),
    /// What was uploaded cannot be meant.
    #[error("{0}")]
    BadUpload(String),
    /// Nothing can be kept.
    #[error("{0}")]
    Storage(String),
    /// No such tile.
    #[error("{0}")]
    UnknownTile(String),
    /// The queue is full.
    #[error("the queue is full")]
    Busy,
    /// No engine, or its device failed twice.
    #[error("the engine is down: {0}")]
    Down(String),
    /// A defect or a broken installation.
    #[error("{0}")]
    Broken(String),
}

impl SourceError {
    /// The answer to the client that asked for a sky: an altitude out of range is the fault of the parameter
    /// that made it.
    pub fn of_sky(self, query: &SkyQuery) -> ApiError {
        match self {
            SourceError::AltitudeOutOfRange { altitude_m, minimum_m, maximum_m } => {
                too_high(query.eye_height, altitude_m, (minimum_m, maximum_m))
            }
            other => other.at(query.place),
        }
    }

    /// The answer to the client that asked about a place.
    pub fn at(self, place: GeoPoint) -> ApiError {
        match self {
            SourceError::OutsideScene { bounds } => ApiError::OutsideScene {
                latitude_deg: rounded(place.latitude_deg()),
                longitude_deg: rounded(place.longitude_deg()),
                bounds,
            },
            // The scene was ingested again since the scenario was painted.
            SourceError::BadEdit(error) => ApiError::Parameters(vec![FieldError {
                parameter: SCENARIO.name.to_owned(),
                value: None,
                allowed: "a scenario that can be painted over the scene as it is now".to_owned(),
                message: error.to_string(),
                code: Mistake::NotAllowed,
            }]),
            other => other.into(),
        }
    }

    /// The answer to the client that painted: what its scenario goes on from is named in the body.
    pub fn of_painting(self) -> ApiError {
        let (id, message) = match self {
            SourceError::ScenarioOfOtherScene { id, scene } => {
                (id, format!("it belongs to scene \"{scene}\""))
            }
            SourceError::ScenarioTooDeep(id) => {
                (id, "it stands on too many others, one upon the other".to_owned())
            }
            other => return other.into(),
        };
        let allowed = "a scenario or plan of this scene that stands on few others".to_owned();
        ApiError::parameter("base", id, allowed, message, Mistake::NotAllowed)
    }
}

/// Refuses the height or the altitude that puts an eye above the tables.
fn too_high(eye_height: EyeHeight, altitude_m: f64, (minimum_m, maximum_m): (f64, f64)) -> ApiError {
    let (name, value_m, allowed) = match eye_height {
        EyeHeight::AboveSea(altitude_m) => {
            (ALTITUDE.name, altitude_m, format!("{minimum_m} to {maximum_m} m above sea level"))
        }
        EyeHeight::AboveGround(height_m) => {
            let ground_m = altitude_m - height_m;
            let room_m = maximum_m - ground_m;
            let allowed = if room_m >= 0.0 {
                format!("0 to {room_m:.0} m above this ground, which lies at {ground_m:.0} m")
            } else {
                format!("none above this ground: it lies at {ground_m:.0} m, the tables end at {maximum_m} m")
            };
            (HEIGHT.name, height_m, allowed)
        }
    };
    ApiError::parameter(
        name,
        value_m.to_string(),
        allowed,
        Mistake::OutOfRange.words().to_owned(),
        Mistake::OutOfRange,
    )
}

/// Refuses clouds that an eye is in or above.
fn above_clouds(altitude_m: f64, base_m: u32, maximum_m: f64) -> ApiError {
    let room_m = f64::from(base_m) - maximum_m;
    ApiError::parameter(
        CLOUDS.name,
        base_m.to_string(),
        format!("none, or a base {room_m:.0} m or more above the observer, who is at {altitude_m:.0} m"),
        "the observer would be in the clouds or above them".to_owned(),
        Mistake::OutOfRange,
    )
}

/// Refuses an edit that only the scene shows to be wrong.
fn bad_edit(error: &ChangeError) -> ApiError {
    let (parameter, allowed) = match error {
        ChangeError::Area { number, .. } => {
            (format!("edits[{}]", number - 1), "an area with closed rings, or a stroke of places")
        }
        ChangeError::Outside { number } => (format!("edits[{}]", number - 1), "an area in the scene"),
        ChangeError::TooBright { number } => (format!("edits[{}]", number - 1), "light that lamps can give"),
        ChangeError::TooManyFixtures { number } => {
            (format!("edits[{}]", number - 1), "fewer kinds of lamps and emissions")
        }
        ChangeError::TooMuch { number } => (format!("edits[{}]", number - 1), "smaller areas, or fewer"),
        ChangeError::TooManyNewLights { .. } => ("edits".to_owned(), "fewer new lights"),
    };
    let (message, allowed) = (error.to_string(), allowed.to_owned());
    let code = Mistake::NotAllowed;
    ApiError::Parameters(vec![FieldError { parameter, value: None, allowed, message, code }])
}

/// Degrees without the last digits of the way through radians.
pub(crate) fn rounded(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

impl From<SourceError> for ApiError {
    fn from(error: SourceError) -> Self {
        match error {
            SourceError::UnknownScene(id) => ApiError::UnknownScene { id: crate::problem::echo(&id) },
            SourceError::OutsideScene { .. } => ApiError::internal("a place was checked without a place"),
            SourceError::AltitudeOutOfRange { altitude_m, minimum_m, maximum_m } => {
                too_high(EyeHeight::AboveSea(altitude_m), altitude_m, (minimum_m, maximum_m))
            }
            SourceError::AboveClouds { altitude_m, base_m, maximum_m } => {
                above_clouds(altitude_m, base_m, maximum_m)
            }
            SourceError::OutOfRange { parameter, value, allowed } => ApiError::parameter(
                parameter,
                value,
                allowed,
                Mistake::OutOfRange.words().to_owned(),
                Mistake::OutOfRange,
            ),
            SourceError::NotResident { parameter, value, resident } => ApiError::parameter(
                parameter,
                value,
                resident,
                Mistake::NotResident.words().to_owned(),
                Mistake::NotResident,
            ),
            SourceError::EmptyRegion => ApiError::parameter(
                REGION.name,
                "the curve".to_owned(),
                "a curve around some of the visible sky; directions are 1.4 degrees apart".to_owned(),
                "it holds no visible direction of the sky".to_owned(),
                Mistake::NotAllowed,
            ),
            SourceError::UnknownScenario(id) => ApiError::UnknownScenario { id: crate::problem::echo(&id) },
            SourceError::ScenarioOfOtherScene { id, scene } => ApiError::parameter(
                SCENARIO.name,
                id,
                "one of this scene".to_owned(),
                format!("it belongs to scene \"{scene}\""),
                Mistake::NotAllowed,
            ),
            SourceError::StalePlan(id) => ApiError::StalePlan { id },
            SourceError::ScenarioTooDeep(id) => ApiError::parameter(
                SCENARIO.name,
                id,
                "one that stands on fewer others".to_owned(),
                "it stands on too many others, one upon the other".to_owned(),
                Mistake::NotAllowed,
            ),
            SourceError::BadEdit(error) => bad_edit(&error),
            SourceError::BadPlan(reason) => ApiError::Parameters(vec![FieldError {
                parameter: "body".to_owned(),
                value: None,
                allowed: "a plan that can be made".to_owned(),
                message: reason,
                code: Mistake::NotAllowed,
            }]),
            SourceError::BadUpload(reason) => ApiError::BadUpload { reason },
            SourceError::Storage(reason) => ApiError::Storage { reason },
            SourceError::UnknownTile(reason) => ApiError::UnknownTile { reason },
            SourceError::Busy => ApiError::Busy { retry_after_s: 1 },
            SourceError::Down(reason) => {
                tracing::error!(%reason, "engine down");
                ApiError::EngineDown
            }
            SourceError::Broken(reason) => ApiError::Internal { reason },
        }
    }
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
    fn places(&self, id: &SceneId) -> Result<Vec<Place>, SourceError>;
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
    /// Finds the zenith's brightness at every place of a scene; takes seconds to a minute of all cores. `keeper` is told
    /// of every part that is done, and may end the work.
    ///
    /// # Errors
    /// As [`Self::open_scene`], and a turbidity out of range; [`SourceError::Down`] where it was ended.
    fn brightness(
        &self,
        query: &BrightnessQuery,
        keeper: &dyn SumKeeper,
    ) -> Result<BrightnessMap, SourceError>;
    /// Keeps a scenario if it can be painted.
    ///
    /// # Errors
    /// As [`Self::open_scene`], [`SourceError::BadEdit`], [`SourceError::Storage`].
    fn keep_scenario(&self, scenario: &Scenario) -> Result<ChangeId, SourceError>;
    /// A scenario, what it does to its scene, and when it was kept, seconds since 1970.
    ///
    /// # Errors
    /// As [`Self::keep_scenario`].
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
    fn keep_plan(&self, id: &ChangeId, plan: &StoredPlan) -> Result<(), SourceError>;
    /// A plan, and when it was kept, seconds since 1970.
    ///
    /// # Errors
    /// [`SourceError::UnknownScenario`], [`SourceError::Broken`].
    fn kept_plan(&self, id: &ChangeId) -> Result<(StoredPlan, u64), SourceError>;
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
