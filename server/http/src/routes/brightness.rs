//! How bright the zenith is at every place of a scene.

use crate::{
    asker::{self, Asker},
    error::ApiError,
    state::AppState,
};
use skyglow_app::fingerprint::brightness_key;
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
}

impl PreparedBrightness {
    /// Resolves the scene; finds nothing yet.
    ///
    /// # Errors
    /// No such scene or scenario.
    pub(super) async fn prepare(state: &AppState, request: BrightnessRequest) -> Result<Self, ApiError> {
        let view = state.view(&request.scene, request.scenario.as_ref()).await?;
        let key = brightness_key(&request, view.version(), state.source.facts())?;
        Ok(Self { request: Arc::new(request), view, key })
    }

    /// What it is asked with.
    pub(super) fn request(&self) -> &BrightnessRequest {
        &self.request
    }

    /// The scene, with its changes.
    pub(super) fn view(&self) -> &SceneView {
        &self.view
    }

    /// None where the map is found; if it is not, it is begun, nobody waits for it here, and the part that is done is answered.
    pub(super) fn begin(self, state: &AppState) -> Option<f64> {
        if state.has_brightness(&self.key) {
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
