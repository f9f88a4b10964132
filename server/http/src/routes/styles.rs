//! How QGIS shows rasters: a style at the address of each, with `.qml` in place of `.tif`.

use super::influence::PreparedInfluence;
use crate::{
    error::ApiError,
    etag::ETag,
    problem::Problem,
    refusals::{BadParameters, OfSky},
    respond::{CachePolicy, Caching, bytes_by_content},
    state::AppState,
};
use axum::{
    body::Body,
    extract::{Path, RawQuery, State},
    http::{HeaderMap, Response},
};
use skyglow_app::{
    accept::InfluenceFormat,
    parameters::{BrightnessParameters, InfluenceRasterParameters},
    qgis_style,
    request::{brightness, influence, scene_id},
};

const XML: &str = "text/xml; charset=utf-8";

/// The QGIS style of `brightness.tif` with the same parameters, to lie beside it: classes relative to the dark reference of the natural sky.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/layers/brightness.qml",
    tag = "tiles",
    params(("scene" = String, Path, description = "The scene's id"), BrightnessParameters),
    responses(
        (status = 200, description = "The style", body = String, content_type = "text/xml"),
        (status = 304, description = "The client has this answer already"),
        BadParameters,
        (status = 404, description = "No such scene", body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Turbidity out of range", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_brightness_qml(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let id = scene_id(&scene)?;
    let request = brightness(query.as_deref(), id.clone(), state.source.facts())?;
    state.view(&id, None).await?;
    let style = qgis_style::of_brightness(request.measure, &request.response);
    bytes_by_content(&headers, CachePolicy::Revalidate, XML, style.into_bytes())
}

/// The QGIS style of `influence.tif` with the same parameters, to lie beside it: classes by each pixel's part in the whole.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/influence.qml",
    tag = "influence",
    params(("scene" = String, Path, description = "The scene's id"), InfluenceRasterParameters),
    responses(
        (status = 200, description = "The style", body = String, content_type = "text/xml"),
        (status = 304, description = "The client has this answer already; nothing was computed"),
        OfSky,
    )
)]
pub async fn get_influence_qml(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let (id, facts) = (scene_id(&scene)?, state.source.facts());
    let request = influence(query.as_deref(), None, id, facts, InfluenceFormat::Tiff)?.request;
    let prepared = PreparedInfluence::prepare(&state, request).await?;
    let etag = ETag::of(&(&prepared.key, "qml"))?;
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&headers) {
        return Ok(response);
    }
    let map = prepared.find(&state).await?;
    Ok(caching.ok(XML, qgis_style::of_influence(map.total().influence)))
}
