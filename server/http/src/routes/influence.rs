//! Which lights cause the sky of a place.

use super::sky::{PreparedSky, put_warnings};
use crate::{
    error::ApiError,
    etag::ETag,
    problem::Problem,
    refusals::{Accepted, BodyTooLong, NotAcceptable, OfSky},
    respond::{CachePolicy, Caching},
    state::{AppState, EncodedAnswer},
};
use axum::{
    body::{Body, Bytes},
    extract::{Path, RawQuery, State},
    http::{HeaderMap, HeaderValue, Response, header},
};
use skyglow_app::{
    accept::{INFLUENCES_OFFERED, InfluenceFormat, negotiate_influence},
    answers::{Assumptions, InfluenceAnswer},
    fingerprint::fingerprint,
    influence_file::encode_influences,
    negotiated_parameters::NegotiatedInfluenceParameters,
    parameters::{InfluenceParameters, InfluenceRasterParameters},
    request::{InfluenceBody, InfluenceListRequest, influence, scene_id},
    source::SkySource,
};
use skyglow_observatory::{InfluenceMap, InfluenceRequest, SceneView};
use std::sync::Arc;

/// Bytes that a raster of influences takes for each pixel while it is written, and a list of them, about.
const RASTER_BYTES_PER_PIXEL: usize = 12;
const LIST_BYTES: usize = 8 << 20;

/// Influences that may be found: the place is in the scene, which is resolved.
#[derive(Clone, Debug)]
pub struct PreparedInfluence {
    request: Arc<InfluenceRequest>,
    view: SceneView,
    /// What decides the map, as text for ETags.
    pub key: String,
}

impl PreparedInfluence {
    /// Resolves the scene and checks the place; finds nothing yet.
    ///
    /// # Errors
    /// As [`PreparedSky::prepare`].
    pub async fn prepare(state: &AppState, request: InfluenceRequest) -> Result<Self, ApiError> {
        let PreparedSky { view, key, .. } = PreparedSky::prepare(state, request.sky.clone()).await?;
        let key = fingerprint(&("influence", key, &request.measure))?;
        Ok(Self { request: Arc::new(request), view, key })
    }

    /// The scene.
    pub(super) fn view(&self) -> &SceneView {
        &self.view
    }

    /// Finds the influences, or takes those found before.
    ///
    /// # Errors
    /// As [`PreparedSky::render`], and a region without a visible direction.
    pub async fn find(&self, state: &AppState) -> Result<Arc<InfluenceMap>, ApiError> {
        state.influence(&self.key, Arc::clone(&self.request), self.view.clone()).await
    }
}

macro_rules! formats {
    ($($get:ident, $post:ident, $end:literal, $format:expr, $parameters:ident, {$($content:tt)*}, {$($refusal:tt)*}, $doc:literal;)*) => {$(
        #[doc = $doc]
        #[utoipa::path(
            get,
            path = concat!("/api/v1/scenes/{scene}/influence", $end),
            tag = "influence",
            params(("scene" = String, Path, description = "The scene's id"), $parameters),
            responses(
                (status = 200, description = "The influences", $($content)*, headers(
                    ("skyglow-warnings" = String, description = "What the sky had to do without, where anything: the same as `warnings` in JSON"),
                    ("server-timing" = String, description = "Milliseconds that each step of finding the map took, when it was found"),
                )),
                (status = 304, description = "The client has this answer already; nothing was computed"),
                OfSky,
                $($refusal)*
            )
        )]
        pub async fn $get(
            State(state): State<AppState>,
            Path(scene): Path<String>,
            RawQuery(query): RawQuery,
            headers: HeaderMap,
        ) -> Result<Response<Body>, ApiError> {
            answer(state, &scene, query.as_deref(), None, &headers, $format).await
        }

        #[doc = concat!($doc, " A body may give the region, and a boundary whose part is summed up in JSON and GeoJSON.")]
        #[utoipa::path(
            post,
            path = concat!("/api/v1/scenes/{scene}/influence", $end),
            tag = "influence",
            params(("scene" = String, Path, description = "The scene's id"), $parameters),
            request_body = InfluenceBody,
            responses(
                (status = 200, description = "The influences", $($content)*, headers(
                    ("skyglow-warnings" = String, description = "What the sky had to do without, where anything: the same as `warnings` in JSON"),
                    ("server-timing" = String, description = "Milliseconds that each step of finding the map took, when it was found"),
                )),
                OfSky,
                BodyTooLong,
                Accepted,
                (status = 400, description = "Bad parameters, or a body that cannot be meant", body = Problem, content_type = "application/problem+json"),
                $($refusal)*
            )
        )]
        pub async fn $post(
            State(state): State<AppState>,
            Path(scene): Path<String>,
            RawQuery(query): RawQuery,
            headers: HeaderMap,
            body: Bytes,
        ) -> Result<Response<Body>, ApiError> {
            answer(state, &scene, query.as_deref(), Some(body), &headers, $format).await
        }
    )*};
}

formats! {
    get_influence, post_influence, "", None, NegotiatedInfluenceParameters,
        {content(
            (InfluenceAnswer = "application/json"),
            (Vec<u8> = "image/tiff"),
            (Object = "application/geo+json"),
            (String = "text/csv"),
        )},
        {NotAcceptable,},
        "Which lights cause the sky of a place, in the format that the Accept header prefers: JSON, GeoTIFF, GeoJSON or CSV.";
    get_influence_json, post_influence_json, ".json", Some(InfluenceFormat::Json), InfluenceParameters,
        {body = InfluenceAnswer, content_type = "application/json"}, {},
        "Which lights cause the sky of a place: the most influential pixels, and all by distance and azimuth.";
    get_influence_tif, post_influence_tif, ".tif", Some(InfluenceFormat::Tiff), InfluenceRasterParameters,
        {body = Vec<u8>, content_type = "image/tiff"}, {},
        "What every lit pixel does, as GeoTIFF on the scene's own grid: one float32 band; pixels without light or beyond 300 km are no data.";
    get_influence_geojson, post_influence_geojson, ".geojson", Some(InfluenceFormat::GeoJson), InfluenceParameters,
        {body = serde_json::Value, content_type = "application/geo+json"}, {},
        "The most influential pixels as GeoJSON points.";
    get_influence_csv, post_influence_csv, ".csv", Some(InfluenceFormat::Csv), InfluenceParameters,
        {body = String, content_type = "text/csv"}, {},
        "The most influential pixels as a table; what they depend on stands in the JSON alone.";
}

/// The format that the Accept header prefers.
///
/// # Errors
/// [`ApiError::NotAcceptable`].
pub(super) fn preferred_format(headers: &HeaderMap) -> Result<InfluenceFormat, ApiError> {
    let accept = headers.get_all(header::ACCEPT).iter().filter_map(|value| value.to_str().ok());
    let preferred = negotiate_influence(&accept.collect::<Vec<_>>().join(","));
    preferred.ok_or(ApiError::NotAcceptable { offered: INFLUENCES_OFFERED })
}

/// `format`: None where the Accept header decides.
async fn answer(
    state: AppState,
    scene: &str,
    query: Option<&str>,
    body: Option<Bytes>,
    headers: &HeaderMap,
    format: Option<InfluenceFormat>,
) -> Result<Response<Body>, ApiError> {
    let vary = format.is_none().then_some("accept");
    let format = format.map_or_else(|| preferred_format(headers), Ok)?;
    let (id, text) = (scene_id(scene)?, query.map(str::to_owned));
    let body_tag = body.as_ref().map(|body| ETag::of_bytes(body).header());
    let is_get = body.is_none();
    // A body may be megabytes.
    let read = move |source: &dyn SkySource| {
        Ok(influence(text.as_deref(), body.as_deref(), id, source.facts(), format)?)
    };
    let request = if is_get { read(state.source.as_ref())? } else { state.blocking(read).await? };
    let prepared = PreparedInfluence::prepare(&state, request.request.clone()).await?;
    if let Some(area) = &request.boundary {
        area.check_within(prepared.view().metadata().bounds)?;
    }
    let listed = format.is_list().then_some(request.limit);
    let etag = ETag::of(&(&prepared.key, format.extension(), listed, body_tag))?;
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary };
    if is_get && let Some(response) = caching.not_modified(headers) {
        return Ok(response);
    }
    let make = async {
        let map = prepared.find(&state).await?;
        let assumptions = Assumptions::of_influences(&request.request, &map, state.source.facts());
        let warnings = assumptions.warnings.clone();
        let times = server_timing(&map);
        let bytes = encoded(&state, assumptions, map, request, format).await?;
        Ok(EncodedAnswer { bytes, warnings, times })
    };
    // A client that reads a raster in ranges has it made once.
    let made = state.answer(&caching.etag, make).await?;
    let mut response = made.response(&caching, format.media_type());
    put_warnings(&mut response, &made.warnings);
    if let Ok(times) = HeaderValue::from_str(&made.times) {
        response.headers_mut().insert("server-timing", times);
    }
    Ok(response)
}

async fn encoded(
    state: &AppState,
    assumptions: Assumptions,
    map: Arc<InfluenceMap>,
    request: InfluenceListRequest,
    format: InfluenceFormat,
) -> Result<Bytes, ApiError> {
    let bytes = match format {
        InfluenceFormat::Tiff => {
            let grid = &map.scene().grid;
            RASTER_BYTES_PER_PIXEL * grid.width as usize * grid.height as usize
        }
        _ => LIST_BYTES,
    };
    let encode =
        move |_: &_| encode_influences(assumptions, &map, &request, format).map_err(ApiError::internal);
    state.work.drawn(bytes, encode).await
}

/// How long finding a map took, step by step.
fn server_timing(map: &InfluenceMap) -> String {
    let step =
        |(name, time): &(&str, std::time::Duration)| format!("{name};dur={:.3}", 1e3 * time.as_secs_f64());
    map.steps.iter().map(step).collect::<Vec<_>>().join(", ")
}
