//! An engine before the scenes of a data folder: skies, sites and map tiles of them.

use crate::{
    error::ObservatoryError,
    influence_map::InfluenceCache,
    scene_cache::SceneCache,
    scene_view::{View, scene_around},
    sky::{SiteAnswer, SkyAnswer, SkyRequest},
};
use skyglow_physics::GeoPoint;
use skyglow_render::RenderError;
use skyglow_render::{engine::Engine, packs::PackKind};
use skyglow_scene::{
    ChangeId, ChangeLimits, ChangeStore, RasterTile, Scene, SceneId, SceneMetadata, SceneStore, TileLayer,
};
use skyglow_tables::Manifest;
use std::{path::Path, sync::Arc};

/// Scenes that an observatory keeps open unless told otherwise.
pub const OPEN_SCENE_COUNT: usize = 8;

/// An engine, the scenes it may be asked about, and what is known of its packs.
#[derive(Debug)]
pub struct Observatory {
    pub(crate) engine: Engine,
    pub(crate) shelf: Arc<SceneCache>,
    pub(crate) manifests: Vec<Manifest>,
    pub(crate) influences: InfluenceCache,
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
        let shelf = Arc::new(SceneCache::new(scenes, changes, open_scene_count));
        Self { engine, shelf, manifests, influences: InfluenceCache::new() }
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
    /// [`ObservatoryError::Scene`].
    pub fn scenes(&self) -> Result<Vec<SceneMetadata>, ObservatoryError> {
        let list = self.shelf.store().list()?;
        for error in &list.damaged {
            tracing::error!(%error, "a scene is left out of the list");
        }
        Ok(list.scenes)
    }

    /// A scene, open and as it is on disk now. May read files.
    ///
    /// # Errors
    /// [`ObservatoryError::Scene`].
    pub fn scene(&self, id: &SceneId) -> Result<Arc<Scene>, ObservatoryError> {
        self.shelf.scene(id)
    }

    /// The same with the changes of a scenario or plan.
    ///
    /// # Errors
    /// [`ObservatoryError::Scene`], [`ObservatoryError::ChangeStore`], [`ObservatoryError::Change`].
    pub fn changed_scene(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
    ) -> Result<Arc<Scene>, ObservatoryError> {
        self.shelf.changed_scene(id, scenario)
    }

    /// What is at a place. May read files.
    ///
    /// # Errors
    /// As [`Self::changed_scene`], and [`ObservatoryError::OutsideScene`].
    pub fn site(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
        place: GeoPoint,
    ) -> Result<SiteAnswer, ObservatoryError> {
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
    ) -> Result<RasterTile, ObservatoryError> {
        Ok(self.shelf.changed_scene(id, scenario)?.tile(layer, z, x, y, size_px)?)
    }

    /// Renders a sky; file reading and gathering of light happen on tokio's blocking threads.
    ///
    /// # Errors
    /// Whatever is wrong with scene, place, altitude, turbidity or basis; a full queue; a device that fails.
    pub async fn sky(&self, request: SkyRequest) -> Result<SkyAnswer, ObservatoryError> {
        let (shelf, wanted) = (Arc::clone(&self.shelf), request.clone());
        let hides_lights = self.hides_lights(request.kind());
        let basis = self.engine.basis_chooser();
        let prepare = move || {
            let view = View::of(&shelf, &wanted, hides_lights)?;
            let to_render = view.render_requests(&wanted, &basis)?;
            Ok::<_, ObservatoryError>((view, to_render))
        };
        let (view, (to_render, bound)) =
            tokio::task::spawn_blocking(prepare).await.map_err(|_| RenderError::Stopped)??;
        let rendered = self.engine.render_together(&to_render).await?;
        Ok(view.answer(&request, rendered, bound))
    }

    /// [`Self::sky`] for threads outside an asynchronous runtime. Panics inside one.
    ///
    /// # Errors
    /// As [`Self::sky`].
    pub fn sky_blocking(&self, request: &SkyRequest) -> Result<SkyAnswer, ObservatoryError> {
        let view = View::of(&self.shelf, request, self.hides_lights(request.kind()))?;
        self.render_view(view, request)
    }

    /// The sky of a view.
    pub(crate) fn render_view(
        &self,
        view: View,
        request: &SkyRequest,
    ) -> Result<SkyAnswer, ObservatoryError> {
        let (to_render, bound) = view.render_requests(request, &self.engine.basis_chooser())?;
        let rendered = self.engine.render_together_blocking(&to_render)?;
        Ok(view.answer(request, rendered, bound))
    }

    /// Whether the packs of a kind know sources behind skylines.
    pub(crate) fn hides_lights(&self, kind: PackKind) -> bool {
        let kinds = &self.engine.info().kinds;
        kinds.iter().any(|resident| resident.kind == kind && resident.hides_lights)
    }
}
