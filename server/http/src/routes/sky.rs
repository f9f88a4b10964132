//! The numbers of a sky.

use crate::{
    asker,
    error::ApiError,
    etag::ETag,
    refusals::OfSky,
    respond::{CachePolicy, Caching},
    state::AppState,
};
use axum::{
    body::Body,
    extract::{Path, RawQuery, State},
    http::{HeaderMap, HeaderValue, Response},
};
use skyglow_app::{
    answers::{Assumptions, SkyAnswer},
    conversion::check_altitude,
    fingerprint::sky_key,
    parameters::SkyParameters,
    request::{scene_id, sky},
    source::SkySource,
};
use skyglow_observatory::{RenderedSky, SceneView, SkyRequest};
use skyglow_render::PassTime;
use std::sync::Arc;

/// The numbers of the sky at a place.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/sky",
    tag = "sky",
    params(("scene" = String, Path, description = "The scene's id"), SkyParameters),
    responses(
        (status = 200, description = "The numbers", body = SkyAnswer, headers(
            ("skyglow-warnings" = String, description = "What the sky had to do without, where anything: the same as `warnings`"),
            ("server-timing" = String, description = "Milliseconds of each pass of the rendering"),
        )),
        (status = 304, description = "The client has this answer already; nothing was rendered"),
        OfSky,
    )
)]
pub async fn get_sky(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let request = sky(query.as_deref(), scene_id(&scene)?, state.source.facts())?;
    let prepared = PreparedSky::prepare(&state, request).await?;
    let caching =
        Caching { etag: ETag::of(&("sky", &prepared.key))?, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&headers) {
        return Ok(response);
    }
    let rendered = prepared.render(&state).await?;
    let answer = SkyAnswer::new(prepared.assumptions(&state, &rendered), &rendered);
    let mut response = caching.json(&answer)?;
    put_times(&mut response, &times_of(&rendered));
    put_warnings(&mut response, &answer.assumptions.warnings);
    Ok(response)
}

/// A sky that may be rendered: the place is in the scene, which is resolved.
#[derive(Clone, Debug)]
pub struct PreparedSky {
    /// What is asked.
    pub request: Arc<SkyRequest>,
    /// The scene.
    pub view: SceneView,
    /// What decides the sky, as text for ETags.
    pub key: String,
}

impl PreparedSky {
    /// Resolves the scene and checks the place; renders nothing.
    ///
    /// # Errors
    /// [`AppError::UnknownScene`](skyglow_app::AppError::UnknownScene),
    /// [`AppError::OutsideScene`](skyglow_app::AppError::OutsideScene), an altitude out of range.
    pub async fn prepare(state: &AppState, request: SkyRequest) -> Result<Self, ApiError> {
        let request = Arc::new(request);
        let wanted = Arc::clone(&request);
        let resolve = move |source: &dyn SkySource| {
            let view = source.view(&wanted.scene, wanted.scenario.as_ref())?;
            let site = source.site(&view, wanted.place)?;
            check_altitude(&wanted, site.ground, source.facts().altitude_range_m)?;
            Ok(view)
        };
        let view = state.work.resolve(request.scenario.is_some(), resolve).await?;
        // A job waits for what takes long.
        let view = if asker::current().work().is_job() { view } else { view.coming_again() };
        let key = sky_key(&request, view.version(), state.source.facts())?;
        Ok(Self { request, view, key })
    }

    /// Renders the sky, or takes the one rendered before.
    ///
    /// # Errors
    /// [`AppError::Busy`](skyglow_app::AppError::Busy), [`AppError::EngineDown`](skyglow_app::AppError::EngineDown).
    pub async fn render(&self, state: &AppState) -> Result<Arc<RenderedSky>, ApiError> {
        Ok(state.sky(&self.key, Arc::clone(&self.request), self.view.clone()).await?)
    }

    /// What the numbers depend on.
    pub fn assumptions(&self, state: &AppState, rendered: &RenderedSky) -> Assumptions {
        Assumptions::new(&self.request, self.view.metadata(), &rendered.context, state.source.facts())
    }
}

/// Says what the sky had to do without where the body is a picture or a raster and cannot.
pub fn put_warnings(response: &mut Response<Body>, warnings: &[String]) {
    if let Ok(value) = HeaderValue::from_str(&warnings.join("; "))
        && !warnings.is_empty()
    {
        response.headers_mut().insert("skyglow-warnings", value);
    }
}

/// How long the passes took, as the header has it.
pub fn times_of(rendered: &RenderedSky) -> String {
    let time =
        |pass: &PassTime| format!("{};dur={:.3}", pass.name.replace(' ', "_"), pass.microseconds * 1e-3);
    rendered.passes.iter().map(time).collect::<Vec<_>>().join(", ")
}

/// Says how long the passes took, outside the body, which stays the same for the same request.
pub fn put_times(response: &mut Response<Body>, times: &str) {
    if let Ok(value) = HeaderValue::from_str(times)
        && !times.is_empty()
    {
        response.headers_mut().insert("server-timing", value);
    }
}
