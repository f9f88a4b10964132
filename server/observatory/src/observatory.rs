//! An engine before the scenes of a data folder: views of scenes, and skies in them.

use crate::{
    cache_sizes::CacheSizes,
    error::ObservatoryError,
    influence_cache::InfluenceCache,
    scene_cache::SceneCache,
    scene_view::SceneView,
    sky::{RenderedSky, SkyRequest},
    surroundings::Surroundings,
};
use skyglow_physics::CloudBase;
use skyglow_render::{RenderError, celestial::CelestialTables, engine::Engine, pack_kind::PackKind};
use skyglow_scene::{
    ChangeId, ChangeLimits, ChangeStore, SceneError, SceneId, SceneMetadata, SceneStore, SharedScenes,
    UploadFolder,
};
use skyglow_tables::{Clouds, Manifest};
use std::{path::Path, sync::Arc};

/// Scenes that an observatory keeps open unless told otherwise.
pub const OPEN_SCENE_COUNT: usize = 8;

/// An engine, the scenes it may be asked about, and what is known of its packs.
#[derive(Debug)]
pub struct Observatory {
    pub(crate) engine: Engine,
    pub(crate) scenes: SceneCache,
    pub(crate) manifests: Vec<Manifest>,
    pub(crate) influences: InfluenceCache,
    celestial: Option<Arc<CelestialTables>>,
    /// Where servers share scenes.
    shared_scenes: Option<SharedScenes>,
}

impl Observatory {
    /// Puts an engine before the scenes of a data folder; `manifests` are those of the engine's packs.
    pub fn new(engine: Engine, manifests: Vec<Manifest>, data_dir: &Path, open_scene_count: usize) -> Self {
        let sizes = CacheSizes::of_machine();
        Self::with_limits(engine, manifests, data_dir, open_scene_count, ChangeLimits::default(), &sizes)
    }

    /// The same with other limits for the scenarios and plans that are stored, and for what is kept in memory.
    pub fn with_limits(
        engine: Engine,
        manifests: Vec<Manifest>,
        data_dir: &Path,
        open_scene_count: usize,
        limits: ChangeLimits,
        sizes: &CacheSizes,
    ) -> Self {
        let changes = ChangeStore::new(data_dir, limits);
        Self::with_changes(engine, manifests, data_dir, open_scene_count, changes, sizes)
    }

    /// The same with scenarios and plans that are stored elsewhere than in the data folder.
    pub fn with_changes(
        engine: Engine,
        manifests: Vec<Manifest>,
        data_dir: &Path,
        open_scene_count: usize,
        changes: ChangeStore,
        sizes: &CacheSizes,
    ) -> Self {
        let scenes = SceneCache::new(SceneStore::new(data_dir), changes, open_scene_count, sizes);
        Self {
            engine,
            scenes,
            manifests,
            influences: InfluenceCache::new(sizes),
            celestial: None,
            shared_scenes: None,
        }
    }

    /// The same with tables for the natural sky of an instant.
    #[must_use]
    pub fn with_celestial_tables(self, tables: CelestialTables) -> Self {
        Self { celestial: Some(Arc::new(tables)), ..self }
    }

    /// The same, which opens large scenes before it has read all of them: for who calls [`Self::check_scenes`] while it answers.
    #[must_use]
    pub fn with_lights_checked_later(self) -> Self {
        Self { scenes: self.scenes.with_lights_checked_later(), ..self }
    }

    /// The same with the scenes of a store that servers share.
    #[must_use]
    pub fn with_shared_scenes(self, scenes: SharedScenes) -> Self {
        Self { shared_scenes: Some(scenes), ..self }
    }

    /// Copies what is new among the scenes that servers share, lets go of what is open of those that changed, and logs what went wrong
    /// with single scenes.
    ///
    /// # Errors
    /// As [`SharedScenes::refresh`].
    pub fn refresh_scenes(&self) -> Result<(), SceneError> {
        let Some(shared) = &self.shared_scenes else { return Ok(()) };
        let (changed, failed) = shared.refresh(self.store())?;
        for error in failed {
            tracing::error!(%error, "a scene of the store that servers share is not copied");
        }
        for id in &changed {
            tracing::info!(scene = %id, "the scene of the store that servers share is new here, or gone");
            self.scenes.forget(id);
        }
        Ok(())
    }

    /// Tables for the natural sky of an instant.
    pub fn celestial_tables(&self) -> Option<&CelestialTables> {
        self.celestial.as_deref()
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
        self.scenes.store()
    }

    /// Removes a scene, also where servers share it, and lets go of what is open of it. Requests under way keep it.
    ///
    /// # Errors
    /// [`SceneError::UnknownScene`], [`SceneError::Io`], [`SceneError::StoreAway`].
    pub fn remove_scene(&self, id: &SceneId) -> Result<(), SceneError> {
        if let Some(shared) = self.shared_scenes.as_ref().filter(|_| self.store().exists(id)) {
            shared.remove(self.store(), id)?;
        }
        self.store().remove(id)?;
        self.scenes.forget(id);
        Ok(())
    }

    /// Puts the scene of an upload in its place, also where servers share scenes, and lets go of what is open of the one before, if
    /// there was one, which it says.
    ///
    /// # Errors
    /// As [`SceneStore::adopt`], and [`SceneError::StoreAway`]: then it is here alone.
    pub fn adopt_scene(
        &self,
        upload: &UploadFolder,
        id: &SceneId,
    ) -> Result<(SceneMetadata, bool), SceneError> {
        let adopted = self.store().adopt(upload, id)?;
        self.scenes.forget(id);
        if let Some(shared) = &self.shared_scenes {
            shared.put(self.store(), id, true)?;
        }
        Ok(adopted)
    }

    /// Bytes of memory that one open scene may take.
    pub fn max_scene_bytes(&self) -> u64 {
        self.scenes.most_bytes()
    }

    /// Number of scenes open.
    pub fn open_scene_count(&self) -> usize {
        self.scenes.len()
    }

    /// All scenes but those known to be damaged, by id. Reads files.
    ///
    /// # Errors
    /// [`ObservatoryError::Scene`].
    pub fn scenes(&self) -> Result<Vec<SceneMetadata>, ObservatoryError> {
        let mut scenes = self.scenes.store().list()?.scenes;
        scenes.retain(|scene| !self.scenes.is_damaged(&scene.id));
        Ok(scenes)
    }

    /// Reads every scene through that was not yet, and logs which are damaged: those are left out. Others are opened where there is room.
    /// Takes as long as the disk does.
    ///
    /// # Errors
    /// [`ObservatoryError::Scene`] where the folder cannot be read.
    pub fn check_scenes(&self) -> Result<(), ObservatoryError> {
        let sound = self.scenes.check_all()?;
        self.scenes.open_ahead(&sound);
        Ok(self.scenes.check_lights()?)
    }

    /// The scenes known to be damaged, and the number of the others that [`Self::check_scenes`] saw.
    pub fn damaged_scenes(&self) -> (Vec<SceneId>, usize) {
        self.scenes.damaged()
    }

    /// A scene as it is on disk now, with the changes of a scenario or plan. May read files.
    ///
    /// # Errors
    /// [`ObservatoryError::Scene`], [`ObservatoryError::ChangeStore`], [`ObservatoryError::Change`].
    pub fn view(&self, id: &SceneId, scenario: Option<&ChangeId>) -> Result<SceneView, ObservatoryError> {
        self.scenes.view(id, scenario)
    }

    /// Renders a sky; gathering of light happens on tokio's blocking threads.
    ///
    /// # Errors
    /// Whatever is wrong with place, altitude, turbidity or basis; a full queue; a device that fails.
    pub async fn sky(
        &self,
        view: SceneView,
        request: Arc<SkyRequest>,
    ) -> Result<RenderedSky, ObservatoryError> {
        let hides_lights = self.hides_lights_of(&request);
        let basis = self.engine.basis_chooser();
        let wanted = Arc::clone(&request);
        let (celestial, cloud_albedo) = (self.celestial.clone(), self.cloud_albedo(request.kind()));
        let prepare = move || {
            let surroundings = Surroundings::of(&view, &wanted, hides_lights)?;
            let to_render = surroundings.render_requests(&wanted, &basis)?;
            let natural = surroundings.natural(&wanted, cloud_albedo, celestial.as_deref())?;
            Ok::<_, ObservatoryError>((surroundings, natural, to_render))
        };
        let (surroundings, natural, (to_render, bound)) =
            tokio::task::spawn_blocking(prepare).await.map_err(|_| RenderError::Stopped)??;
        let rendered = self.engine.render_each(&to_render).await?;
        Ok(surroundings.finish(&request, rendered, bound, natural, self.celestial_tables()))
    }

    /// A sky of the scene as it is now, for threads outside an asynchronous runtime. Panics inside one.
    ///
    /// # Errors
    /// As [`Self::view`] and [`Self::sky`].
    pub fn sky_blocking(&self, request: &SkyRequest) -> Result<RenderedSky, ObservatoryError> {
        let view = self.view(&request.scene, request.scenario.as_ref())?;
        self.render(Surroundings::of(&view, request, self.hides_lights_of(request))?, request)
    }

    /// The sky of surroundings.
    pub(crate) fn render(
        &self,
        surroundings: Surroundings,
        request: &SkyRequest,
    ) -> Result<RenderedSky, ObservatoryError> {
        let (to_render, bound) = surroundings.render_requests(request, &self.engine.basis_chooser())?;
        let natural =
            surroundings.natural(request, self.cloud_albedo(request.kind()), self.celestial_tables())?;
        let rendered = self.engine.render_each_blocking(&to_render)?;
        Ok(surroundings.finish(request, rendered, bound, natural, self.celestial_tables()))
    }

    /// Whether the packs of a kind know sources behind skylines.
    pub(crate) fn hides_lights(&self, kind: PackKind) -> bool {
        let kinds = &self.engine.info().kinds;
        kinds.iter().any(|resident| resident.kind == kind && resident.hides_lights)
    }

    /// Albedo from below of the clouds of a kind.
    pub(crate) fn cloud_albedo(&self, kind: PackKind) -> f64 {
        let set = self.engine.table_set();
        let of_kind = set.tables().iter().find(|tables| PackKind::of(tables) == kind);
        of_kind.and_then(|tables| tables.clouds).map_or(CloudBase::DEFAULT_ALBEDO, Clouds::albedo)
    }

    /// The same for a sky; between broken clouds it is that of a clear one, and packs that know no skylines do without.
    pub(crate) fn hides_lights_of(&self, request: &SkyRequest) -> bool {
        let clear = PackKind { cloud_base_m: None, ..request.kind() };
        self.hides_lights(if request.broken_clouds.is_some() { clear } else { request.kind() })
    }
}
