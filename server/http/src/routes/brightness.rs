//! How bright the zenith is at every place of a scene.

use crate::{
    asker::{self, Asker},
    atlases::Atlas,
    error::ApiError,
    state::AppState,
};
use skyglow_app::fingerprint::{atlas_key, brightness_key};
use skyglow_observatory::{BrightnessMap, BrightnessRequest, SceneView};
use std::sync::Arc;
use tracing::Instrument;

/// A map that may be found: its scene is resolved.
#[derive(Clone, Debug)]
pub(super) struct PreparedBrightness {
    request: Arc<BrightnessRequest>,
    view: SceneView,
    /// What decides the map, as text for ETags.
    pub(super) key: String,
    /// The same map, made beforehand.
    pub(super) atlas: Option<Arc<Atlas>>,
}

impl PreparedBrightness {
    /// Resolves the scene; finds nothing yet.
    ///
    /// # Errors
    /// No such scene or scenario.
    pub(super) async fn prepare(state: &AppState, request: BrightnessRequest) -> Result<Self, ApiError> {
        let view = state.view(&request.scene, request.scenario.as_ref()).await?;
        let facts = state.source.facts();
        let key = brightness_key(&request, view.version(), facts)?;
        let step = view.scene().place_lattice(request.max_places).step;
        let atlas = state.atlases.get(&atlas_key(&request, view.version(), facts)?);
        let atlas = atlas.filter(|atlas| atlas.is_as_fine_as(step));
        Ok(Self { request: Arc::new(request), view, key, atlas })
    }

    /// What decides its tiles, as text for ETags.
    pub(super) fn tiles_key(&self) -> String {
        self.atlas.as_ref().map_or_else(|| self.key.clone(), |atlas| atlas.tiles_key())
    }

    /// What it is asked with.
    pub(super) fn request(&self) -> &BrightnessRequest {
        &self.request
    }

    /// The scene, with its changes.
    pub(super) fn view(&self) -> &SceneView {
        &self.view
    }

    /// None where the map is found, or its tiles are made already; if it is not, it is begun, nobody waits for it here, and the part that is done is answered.
    pub(super) fn begin(self, state: &AppState) -> Option<f64> {
        if self.atlas.is_some() || state.has_brightness(&self.key) {
            return None;
        }
        let progress = state.brightness_progress(&self.key).map_or(0.0, |(progress, _)| progress);
        let state = state.clone();
        // What is wrong with it the first tile says.
        let asker = Asker::new(asker::party(), Arc::default());
        tokio::spawn(asker.scope(async move { self.find(&state).await }.in_current_span()));
        Some(progress)
    }

    /// Finds the map, or takes the one found before.
    ///
    /// # Errors
    /// As [`AppState::brightness`].
    pub(super) async fn find(&self, state: &AppState) -> Result<Arc<BrightnessMap>, ApiError> {
        state.brightness(&self.key, Arc::clone(&self.request), self.view.clone()).await
    }
}
