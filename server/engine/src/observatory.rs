//! From a place in a scene to its sky: the layer that the command line and the HTTP interface share.

mod brightness;
mod change;
mod influence;
mod influence_summary;
mod plan;
mod view;

pub use brightness::{BrightnessMap, BrightnessRequest, EYE_HEIGHT_M, MOST_PLACES};
pub use change::store_scenario;
pub use influence::{InfluenceMap, InfluenceRequest, Measure};
pub use influence_summary::{Part, RING_EDGES_M, SECTOR_COUNT};
pub use plan::{
    DimmedPixel, Level, Limit, PlanMethod, PlanOutcome, PlanRequest, SiteOutcome, SitePlan, SkyState,
    TargetSite,
};

use self::{influence::InfluenceDesk, view::View};
use crate::{
    engine::Engine, error::EngineError, packs::PackKind, request::Rendered, scene_shelf::SceneShelf,
};
use skyglow_physics::{
    BAND_COUNT, EmissionMix, GeoPoint, Horizon, Lamp, LampPreset, SkyQuantities, Turbidity,
};
use skyglow_scene::{
    ChangeId, ChangeLimits, ChangeStore, Ground, RasterTile, Scene, SceneId, SceneMetadata, SceneStore,
    TileLayer,
};
use skyglow_tables::{Manifest, Scattering};
use std::{path::Path, sync::Arc, time::Duration};

/// Scenes that an observatory keeps open unless told otherwise.
pub const OPEN_SCENE_COUNT: usize = 8;

/// An engine, the scenes it may be asked about, and what is known of its packs.
#[derive(Debug)]
pub struct Observatory {
    engine: Engine,
    shelf: Arc<SceneShelf>,
    manifests: Vec<Manifest>,
    influences: InfluenceDesk,
}

/// Where the observer's eye is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObserverHeight {
    /// Metres above the ground, as [`Ground`] has it: above sea level where there is no terrain within 5 km.
    AboveGround(f64),
    /// Metres above sea level.
    AboveSea(f64),
}

/// One sky asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyRequest {
    /// The scene.
    pub scene: SceneId,
    /// The scenario or plan that changes its lights; None for the scene as it is.
    pub scenario: Option<ChangeId>,
    /// The place, in the scene.
    pub place: GeoPoint,
    /// Where the eye is.
    pub observer_height: ObserverHeight,
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
    /// Relative difference that fewer functions may make where `basis` names no number; None for all functions.
    pub tolerance: Option<f64>,
    /// Whether the scene's terrain hides the sky below the observer's horizon.
    pub terrain_hides: bool,
}

impl SkyRequest {
    /// The kind of packs that it is rendered from.
    fn kind(&self) -> PackKind {
        PackKind { cloud_base_m: self.cloud_base_m, scattering: self.scattering }
    }
}

/// Where an answer was observed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer {
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
    /// Altitude used, metres above sea level, at least 0.
    pub altitude_m: f64,
    /// The ground there.
    pub ground: Ground,
}

/// What is at a place.
#[derive(Clone, Debug)]
pub struct SiteAnswer {
    /// The scene.
    pub scene: SceneMetadata,
    /// The ground there.
    pub ground: Ground,
    /// Radiance of the pixel there, nW cm⁻² sr⁻¹, without the calibration; None without data.
    pub radiance_nw_cm2_sr: Option<f64>,
}

/// A sky with everything that its numbers depend on.
#[derive(Clone, Debug)]
pub struct SkyAnswer {
    /// The scene as it was.
    pub scene: SceneMetadata,
    /// Where.
    pub observer: Observer,
    /// The panorama, dark below the horizon, and how it was made.
    pub rendered: Rendered,
    /// The observer's horizon; flat where terrain does not hide or the scene has none.
    pub horizon: Horizon,
    /// How long the horizon took; None where none was computed.
    pub horizon_time: Option<Duration>,
    /// Where a tolerance was given, the bound of the difference to the sky of all functions
    /// ([`BasisWithin::error_bound`](crate::BasisWithin::error_bound)).
    pub basis_error_bound: Option<f64>,
    /// Lamps that changes replace around here where there are none of them by then.
    pub lamps_not_met: Vec<LampPreset>,
    /// The reported quantities, of the sky above the horizon.
    pub quantities: SkyQuantities,
    /// Covered share of the 300 km disc, 0..=1.
    pub coverage: f64,
    /// The scene's calibration factor.
    pub calibration: f64,
    /// Vertical optical depth above the observer in R, G, B.
    pub local_optical_depth: [f64; BAND_COUNT],
    /// Upward flux within 300 km, DNB watts, calibration included.
    pub flux_dnb_w: f64,
    /// Turbidity used.
    pub turbidity: Turbidity,
    /// Orders of scattering used.
    pub scattering: Scattering,
    /// Lamp used.
    pub lamp: Lamp,
    /// Emission used.
    pub emission: EmissionMix,
}

impl Observatory {
    /// Puts an engine before the scenes of a data folder; `manifests` are those of the engine's packs.
    pub fn new(engine: Engine, manifests: Vec<Manifest>, data_dir: &Path, open_scene_count: usize) -> Self {
        Self::with_limits(engine, manifests, data_dir, open_scene_count, ChangeLimits::default())
    }

    /// The same with other limits for the scenarios and plans that are kept.
    pub fn with_limits(
        engine: Engine,
        manifests: Vec<Manifest>,
        data_dir: &Path,
        open_scene_count: usize,
        limits: ChangeLimits,
    ) -> Self {
        let (scenes, changes) = (SceneStore::new(data_dir), ChangeStore::new(data_dir, limits));
        let shelf = Arc::new(SceneShelf::new(scenes, changes, open_scene_count));
        Self { engine, shelf, manifests, influences: InfluenceDesk::new() }
    }

    /// The engine: readiness, counters, what it runs on.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// The resident packs, by kind, then ascending in turbidity.
    pub fn atmospheres(&self) -> &[Manifest] {
        &self.manifests
    }

    /// Where the scenes are stored.
    pub fn store(&self) -> &SceneStore {
        self.shelf.store()
    }

    /// Number of scenes open.
    pub fn open_scene_count(&self) -> usize {
        self.shelf.len()
    }

    /// All scenes that can be read, by id; what is wrong with others is logged. Reads files.
    ///
    /// # Errors
    /// [`EngineError::Scene`].
    pub fn scenes(&self) -> Result<Vec<SceneMetadata>, EngineError> {
        let list = self.shelf.store().list()?;
        for error in &list.damaged {
            tracing::error!(%error, "a scene is left out of the list");
        }
        Ok(list.scenes)
    }

    /// A scene, open and as it is on disk now. May read files.
    ///
    /// # Errors
    /// [`EngineError::Scene`].
    pub fn scene(&self, id: &SceneId) -> Result<Arc<Scene>, EngineError> {
        self.shelf.scene(id)
    }

    /// The same with the changes of a scenario or plan.
    ///
    /// # Errors
    /// [`EngineError::Scene`], [`EngineError::ChangeStore`], [`EngineError::Change`].
    pub fn changed_scene(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
    ) -> Result<Arc<Scene>, EngineError> {
        self.shelf.changed_scene(id, scenario)
    }

    /// What is at a place. May read files.
    ///
    /// # Errors
    /// As [`Self::changed_scene`], and [`EngineError::OutsideScene`].
    pub fn site(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
        place: GeoPoint,
    ) -> Result<SiteAnswer, EngineError> {
        let scene = scene_around(&self.shelf, id, scenario, place)?;
        Ok(SiteAnswer {
            scene: scene.metadata().clone(),
            ground: scene.ground(place),
            radiance_nw_cm2_sr: scene.radiance_nw_cm2_sr(place),
        })
    }

    /// Numbers of a map tile. May read files.
    ///
    /// # Errors
    /// As [`Self::changed_scene`].
    pub fn tile(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
        layer: TileLayer,
        (z, x, y): (u8, u32, u32),
        size_px: u32,
    ) -> Result<RasterTile, EngineError> {
        Ok(self.shelf.changed_scene(id, scenario)?.tile(layer, z, x, y, size_px)?)
    }

    /// Renders a sky; file reading and gathering of light happen on tokio's blocking threads.
    ///
    /// # Errors
    /// Whatever is wrong with scene, place, altitude, turbidity or basis; a full queue; a device that fails.
    pub async fn sky(&self, request: SkyRequest) -> Result<SkyAnswer, EngineError> {
        let (shelf, wanted) = (Arc::clone(&self.shelf), request.clone());
        let hides_lights = self.hides_lights(request.kind());
        let basis = self.engine.basis_chooser();
        let prepare = move || {
            let view = View::of(&shelf, &wanted, hides_lights)?;
            let to_render = view.render_requests(&wanted, &basis)?;
            Ok::<_, EngineError>((view, to_render))
        };
        let (view, (to_render, bound)) =
            tokio::task::spawn_blocking(prepare).await.map_err(|_| EngineError::Stopped)??;
        let rendered = self.engine.render_together(&to_render).await?;
        Ok(view.answer(&request, rendered, bound))
    }

    /// [`Self::sky`] for threads outside an asynchronous runtime. Panics inside one.
    ///
    /// # Errors
    /// As [`Self::sky`].
    pub fn sky_blocking(&self, request: &SkyRequest) -> Result<SkyAnswer, EngineError> {
        let view = View::of(&self.shelf, request, self.hides_lights(request.kind()))?;
        self.render_view(view, request)
    }

    /// The sky of a view.
    fn render_view(&self, view: View, request: &SkyRequest) -> Result<SkyAnswer, EngineError> {
        let (to_render, bound) = view.render_requests(request, &self.engine.basis_chooser())?;
        let rendered = self.engine.render_together_blocking(&to_render)?;
        Ok(view.answer(request, rendered, bound))
    }

    /// Whether the packs of a kind know sources behind skylines.
    fn hides_lights(&self, kind: PackKind) -> bool {
        let kinds = &self.engine.info().kinds;
        kinds.iter().any(|resident| resident.kind == kind && resident.hides_lights)
    }
}

fn scene_around(
    shelf: &SceneShelf,
    id: &SceneId,
    scenario: Option<&ChangeId>,
    place: GeoPoint,
) -> Result<Arc<Scene>, EngineError> {
    let scene = shelf.changed_scene(id, scenario)?;
    if scene.contains(place) {
        return Ok(scene);
    }
    Err(EngineError::OutsideScene {
        scene: id.to_string(),
        latitude_deg: place.latitude_deg(),
        longitude_deg: place.longitude_deg(),
        bounds: scene.metadata().bounds,
    })
}
