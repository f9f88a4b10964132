//! The operator's basemap: what it is, and its tiles.

use super::frame::{Answer, JsonRequest};
use crate::{
    error::ApiError,
    problem::Problem,
    respond::{CachePolicy, json_by_content},
    state::AppState,
    trust::PublicAddress,
};
use axum::{
    Extension,
    body::Body,
    extract::{Path, State},
    http::{HeaderValue, Response, StatusCode, header},
};
use serde::Serialize;
use std::sync::Arc;
use utoipa::ToSchema;

/// What basemap there is, as a TileJSON of vector tiles.
#[derive(Clone, Debug, Default, Serialize, ToSchema)]
pub struct BasemapAnswer {
    /// Version of the specification.
    tilejson: &'static str,
    /// Addresses of tiles; none where the operator has no basemap.
    tiles: Vec<String>,
    /// Whose data it is.
    attribution: String,
    /// Least zoom with tiles.
    minzoom: u8,
    /// Greatest zoom with tiles.
    maxzoom: u8,
    /// West, south, east, north, degrees.
    bounds: [f64; 4],
    /// Names of the layers.
    layers: Vec<String>,
}

/// The operator's basemap as TileJSON; without tiles where there is none.
#[utoipa::path(
    get,
    path = "/api/v1/basemap",
    tag = "tiles",
    responses(
        (status = 200, description = "The basemap", body = BasemapAnswer),
        (status = 304, description = "The client has this answer already"),
    )
)]
pub async fn get_basemap(Extension(address): Extension<PublicAddress>, request: JsonRequest) -> Answer {
    request.without_parameters()?;
    let answer = match &request.state.basemap {
        None => BasemapAnswer { tilejson: "3.0.0", ..BasemapAnswer::default() },
        Some(map) => BasemapAnswer {
            tilejson: "3.0.0",
            tiles: vec![format!("{}/api/v1/basemap/{{z}}/{{x}}/{{y}}", address.base())],
            attribution: map.attribution.clone(),
            minzoom: map.zooms.0,
            maxzoom: map.zooms.1,
            bounds: map.bounds,
            layers: map.layers.clone(),
        },
    };
    json_by_content(&request.headers, CachePolicy::Revalidate, &answer)
}

/// A vector tile of the basemap, as its file has it.
#[utoipa::path(
    get,
    path = "/api/v1/basemap/{z}/{x}/{y}",
    tag = "tiles",
    params(
        ("z" = u8, Path, description = "Zoom"),
        ("x" = u32, Path, description = "Column"),
        ("y" = u32, Path, description = "Row"),
    ),
    responses(
        (status = 200, description = "The tile", body = Vec<u8>, content_type = "application/vnd.mapbox-vector-tile"),
        (status = 204, description = "Nothing is there"),
        (status = 404, description = "This server has no basemap", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_basemap_tile(
    State(state): State<AppState>,
    Path((z, x, y)): Path<(u8, u32, u32)>,
) -> Result<Response<Body>, ApiError> {
    let Some(map) = state.basemap.clone() else { return Err(ApiError::NotFound) };
    let encoding = map.encoding;
    let read = move |_: &dyn skyglow_app::SkySource| {
        let map = Arc::clone(&map);
        map.tile(z, x, y).map_err(ApiError::internal)
    };
    let mut response = Response::new(Body::empty());
    match state.blocking(read).await? {
        None => *response.status_mut() = StatusCode::NO_CONTENT,
        Some(tile) => {
            *response.body_mut() = Body::from(tile);
            let headers = response.headers_mut();
            let media_type = HeaderValue::from_static("application/vnd.mapbox-vector-tile");
            headers.insert(header::CONTENT_TYPE, media_type);
            if let Some(encoding) = encoding {
                headers.insert(header::CONTENT_ENCODING, HeaderValue::from_static(encoding));
            }
        }
    }
    let for_a_day = HeaderValue::from_static("public, max-age=86400");
    response.headers_mut().insert(header::CACHE_CONTROL, for_a_day);
    Ok(response)
}
