//! How bright the zenith is at every place of a scene.

use super::tiles::metadata;
use crate::{error::ApiError, etag::ETag, state::AppState};
use skyglow_app::error::AppError;
use skyglow_observatory::{BrightnessMap, BrightnessRequest};
use skyglow_scene::SceneMetadata;
use std::sync::Arc;
use tracing::Instrument;

/// A map that may be found: the scene's version is known.
#[derive(Clone, Debug)]
pub(super) struct PreparedBrightness {
    query: Arc<BrightnessRequest>,
    /// The scene, with its changes.
    pub(super) scene: SceneMetadata,
    /// What decides the map, as text for ETags. It is found on the processor, whatever renders skies.
    pub(super) key: String,
}

impl PreparedBrightness {
    /// Looks up the scene; finds nothing yet.
    ///
    /// # Errors
    /// No such scene or scenario.
    pub(super) async fn prepare(state: &AppState, query: BrightnessRequest) -> Result<Self, ApiError> {
        let scene = metadata(state, &query.scene, query.scenario.as_ref()).await?;
        let checksums = &state.source.facts().pack_checksums;
        let key = ETag::of(&["brightness", &format!("{query:?}"), &scene.version, checksums]).header();
        Ok(Self { query: Arc::new(query), scene, key })
    }

    /// What it is asked with.
    pub(super) fn query(&self) -> &BrightnessRequest {
        &self.query
    }

    /// Whether the map is found; if not, it is begun, and nobody waits for it here.
    pub(super) fn begin(self, state: &AppState) -> bool {
        if state.has_brightness(&self.key) {
            return true;
        }
        let state = state.clone();
        // What is wrong with it the first tile says.
        tokio::spawn(async move { self.find(&state).await }.in_current_span());
        false
    }

    /// Finds the map, or takes the one found before.
    ///
    /// # Errors
    /// As [`AppState::brightness`], and [`AppError::Busy`] where the scene was ingested again meanwhile.
    pub(super) async fn find(&self, state: &AppState) -> Result<Arc<BrightnessMap>, ApiError> {
        let map = state.brightness(&self.key, Arc::clone(&self.query)).await?;
        if map.scene().version != self.scene.version {
            // The key is that of the scene before.
            state.forget_brightness(&self.key).await;
            return Err(ApiError::App(AppError::Busy { retry_after_s: 1 }));
        }
        Ok(map)
    }
}
