//! The numbers of a sky.

use crate::{
    error::ApiError,
    etag::ETag,
    problem::Problem,
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
    parameters::SkyParameters,
    request::{scene_id, sky},
    source::{RenderedSky, SkyQuery, SkySource, SourceError},
};
use skyglow_scene::{Ground, SceneMetadata};
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
        (status = 400, description = "Bad parameters", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such scene or scenario, or the place lies outside it: then with its bounds", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The scenario is a plan for an earlier state of the scene", body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Altitude or turbidity out of range", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "Busy; Retry-After says when to try again", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_sky(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let (query, light) = sky(query.as_deref(), scene_id(&scene)?, state.source.facts())?;
    let asked = PreparedSky::prepare(&state, query).await?;
    let etag = ETag::of(&["sky", &asked.key, &format!("{light:?}")]);
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&headers) {
        return Ok(response);
    }
    let rendered = asked.render(&state).await?;
    let answer =
        SkyAnswer { assumptions: asked.assumptions(&state, &rendered), sky: (&rendered.quantities).into() };
    let mut response = caching.json(&answer)?;
    put_times(&mut response, &times_of(&rendered));
    put_warnings(&mut response, &answer.assumptions.warnings);
    Ok(response)
}

/// A sky that may be rendered: the place is in the scene, the scene's version is known.
#[derive(Clone, Debug)]
pub struct PreparedSky {
    /// What is asked.
    pub query: Arc<SkyQuery>,
    /// The scene.
    pub scene: SceneMetadata,
    /// What decides the sky, as text for ETags.
    pub key: String,
}

impl PreparedSky {
    /// Looks up the scene and checks the place; renders nothing.
    ///
    /// # Errors
    /// [`AppError::UnknownScene`](skyglow_app::AppError::UnknownScene), [`AppError::OutsideScene`], an altitude out of range.
    pub async fn prepare(state: &AppState, query: SkyQuery) -> Result<Self, ApiError> {
        let (id, scenario, place) = (query.scene.clone(), query.scenario.clone(), query.place);
        let look = move |source: &dyn SkySource| {
            Ok(source.site(&id, scenario.as_ref(), place).map_err(|error| error.at(place))?)
        };
        let site = state.blocking(look).await?;
        check_altitude(&query, site.ground, state.source.facts().altitude_range_m)?;
        let key = state.sky_key(&query, &site.scene.version);
        Ok(Self { query: Arc::new(query), scene: site.scene, key })
    }

    /// Renders the sky, or takes the one rendered before.
    ///
    /// # Errors
    /// [`AppError::Busy`](skyglow_app::AppError::Busy), [`AppError::EngineDown`], an altitude out of range.
    pub async fn render(&self, state: &AppState) -> Result<Arc<RenderedSky>, ApiError> {
        Ok(state.sky(&self.key, self.query.clone()).await.map_err(|error| error.of_sky(&self.query))?)
    }

    /// What the numbers depend on.
    pub fn assumptions(&self, state: &AppState, rendered: &RenderedSky) -> Assumptions {
        Assumptions::new(&self.query, &self.scene, &rendered.context, state.source.facts())
    }
}

/// Refuses an eye that terrain and height together put above the tables.
fn check_altitude(
    query: &SkyQuery,
    ground: Ground,
    (minimum_m, maximum_m): (f64, f64),
) -> Result<(), ApiError> {
    let altitude_m = query.eye_height.altitude_m(ground);
    if altitude_m > maximum_m {
        return Err(SourceError::AltitudeOutOfRange { altitude_m, minimum_m, maximum_m }
            .of_sky(query)
            .into());
    }
    Ok(())
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
    let time = |(name, microseconds): &(&str, f64)| {
        format!("{};dur={:.3}", name.replace(' ', "_"), microseconds * 1e-3)
    };
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
