//! What the handlers of plain JSON resources have in common.

use crate::{
    error::ApiError,
    respond::{CachePolicy, json_by_content},
    state::AppState,
};
use axum::{
    body::Body,
    extract::{FromRequestParts, RawPathParams, RawQuery, rejection::RawPathParamsRejection},
    http::{HeaderMap, Response, request::Parts},
};
use serde::Serialize;
use skyglow_app::{
    request::{no_parameters, scene_id},
    source::SkySource,
};
use skyglow_scene::SceneId;

/// What a handler answers.
pub(super) type Answer = Result<Response<Body>, ApiError>;

/// A request for a resource that is read from the program behind and answered as JSON.
pub struct JsonRequest {
    pub(super) state: AppState,
    pub(super) query: Option<String>,
    pub(super) headers: HeaderMap,
    scene: Option<String>,
}

impl FromRequestParts<AppState> for JsonRequest {
    /// A path that is not UTF-8.
    type Rejection = RawPathParamsRejection;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, Self::Rejection> {
        let path = RawPathParams::from_request_parts(parts, state).await?;
        let scene = path.iter().find(|(name, _)| *name == "scene").map(|(_, scene)| scene.to_owned());
        let Ok(RawQuery(query)) = RawQuery::from_request_parts(parts, state).await;
        Ok(Self { state: state.clone(), query, headers: parts.headers.clone(), scene })
    }
}

impl JsonRequest {
    /// The scene that the path names.
    pub(super) fn scene(&self) -> Result<SceneId, ApiError> {
        Ok(scene_id(self.scene.as_deref().unwrap_or_default())?)
    }

    /// Checks that there are no parameters.
    pub(super) fn without_parameters(&self) -> Result<(), ApiError> {
        Ok(no_parameters(self.query.as_deref())?)
    }

    /// Reads something off the async threads and answers it, tagged by its content.
    pub(super) async fn answer<A: Serialize + Send + 'static>(
        self,
        policy: CachePolicy,
        read: impl FnOnce(&dyn SkySource) -> Result<A, ApiError> + Send + 'static,
    ) -> Answer {
        let answer = self.state.blocking(read).await?;
        json_by_content(&self.headers, policy, &answer)
    }
}
