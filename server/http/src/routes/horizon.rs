//! Horizons for planetarium and imaging programs.

use super::{
    frame::{Answer, JsonRequest},
    sky::{PreparedSky, put_warnings},
};
use crate::{
    error::ApiError,
    etag::ETag,
    refusals::{OfPlace, OfSky},
    respond::{CachePolicy, Caching, bytes_by_content},
    state::AppState,
};
use axum::{
    body::Body,
    extract::{Path, RawQuery, State},
    http::{HeaderMap, HeaderValue, Response, header},
};
use skyglow_app::{
    horizon_file::{horizon_text, stellarium_landscape},
    parameters::{HorizonParameters, LandscapeParameters},
    request::{check_terrain, horizon, landscape, scene_id},
    source::SkySource,
};

/// The horizon of a place as Stellarium or N.I.N.A. reads it: azimuth and altitude in degrees, a line each, for 256 azimuths.
///
/// From the scene's terrain with the Earth's curvature, without refraction. Save it as `.txt` for a polygonal landscape of Stellarium,
/// or as `.hrz` for N.I.N.A.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/horizon.txt",
    tag = "sky",
    params(("scene" = String, Path, description = "The scene's id"), HorizonParameters),
    responses(
        (status = 200, description = "The horizon", body = String, content_type = "text/plain"),
        (status = 304, description = "The client has this answer already"),
        OfPlace,
    )
)]
pub async fn get_horizon_txt(request: JsonRequest) -> Answer {
    let id = request.scene()?;
    let asked = horizon(request.query.as_deref(), request.state.source.facts())?;
    let read = move |source: &dyn SkySource| {
        let view = source.view(&id, None)?;
        check_terrain(view.metadata())?;
        let ground = source.site(&view, asked.place)?.ground;
        let eye_m = asked.observer_height.altitude_m(ground).max(0.0);
        let found = view.scene().horizon(asked.place, eye_m);
        Ok(horizon_text(asked.format, view.metadata(), asked.place, eye_m, &found))
    };
    let text = request.state.blocking(read).await?;
    bytes_by_content(&request.headers, CachePolicy::Minutes, "text/plain; charset=utf-8", text.into_bytes())
}

/// A landscape for Stellarium: a zip archive to install as it is, with the horizon, the position, the brightness that artificial light
/// gives the zenith, and the extinction of the air.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/landscape.zip",
    tag = "sky",
    params(("scene" = String, Path, description = "The scene's id"), LandscapeParameters),
    responses(
        (status = 200, description = "The archive", body = Vec<u8>, content_type = "application/zip"),
        (status = 304, description = "The client has this answer already; nothing was rendered"),
        OfSky,
    )
)]
pub async fn get_landscape_zip(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let request = landscape(query.as_deref(), scene_id(&scene)?, state.source.facts())?;
    let prepared = PreparedSky::prepare(&state, request).await?;
    check_terrain(prepared.view.metadata())?;
    let etag = ETag::of(&("landscape", &prepared.key))?;
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&headers) {
        return Ok(response);
    }
    let sky = prepared.render(&state).await?;
    let archive = stellarium_landscape(prepared.view.metadata(), prepared.request.place, &sky);
    let mut response = caching.ok("application/zip", archive.map_err(ApiError::internal)?);
    put_warnings(&mut response, &prepared.assumptions(&state, &sky).warnings);
    let name = HeaderValue::from_static("attachment; filename=\"skyglow-landscape.zip\"");
    response.headers_mut().insert(header::CONTENT_DISPOSITION, name);
    Ok(response)
}
