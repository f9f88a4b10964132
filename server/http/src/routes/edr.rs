//! OGC API – EDR and Maps: the sky of a place, along a path and over an area as CoverageJSON, and maps as pictures.

use super::{
    brightness::PreparedBrightness,
    sky::{PreparedSky, put_times, put_warnings, times_of},
    tiles::brightness_description,
};
use crate::{
    error::ApiError,
    etag::ETag,
    refusals::OfSky,
    respond::{CachePolicy, Caching, json_bytes},
    state::{AppState, EncodedAnswer},
};
use axum::{
    body::Body,
    extract::{Path, RawQuery, State},
    http::{HeaderMap, HeaderName, HeaderValue, Response},
};
use serde::Serialize;
use skyglow_app::{
    answers::{
        BrightnessAssumptions,
        standards::{LonLatGrid, area_coverage, position_coverage, trajectory_coverage},
    },
    error::AppError,
    quantities::MapQuantity,
    request::{AreaRequest, area, map, position, scene_id, trajectory},
    source::SkySource,
    standard_parameters::{
        AREA_COORDS, AreaParameters, MapParameters, PositionParameters, TrajectoryParameters,
    },
    validation::ValidationCode,
};
use skyglow_display::{Notes, tile::brightness_map_png};
use skyglow_observatory::BrightnessMap;
use skyglow_physics::{GeoPoint, SkyQuantities};
use std::sync::Arc;

/// CoverageJSON, as EDR 1.1 names it.
const COVERAGE_JSON: &str = "application/prs.coverage+json";
/// Places of an area at most; more of the scene's share one by blocks.
const MAX_AREA_PLACES: usize = 200_000;
/// Bytes that a place of an area takes while it is written, for each number.
const BYTES_PER_PLACE: usize = 40;
/// Bytes that a pixel of a map takes while it is drawn.
const BYTES_PER_PIXEL: usize = 24;

/// The numbers of the sky of a place, as a CoverageJSON Point: those of `GET sky`.
#[utoipa::path(
    get,
    path = "/api/ogc/collections/{scene}/position",
    tag = "standards",
    params(("scene" = String, Path, description = "The scene's id"), PositionParameters),
    responses(
        (status = 200, description = "The coverage", body = Object, content_type = "application/prs.coverage+json"),
        (status = 304, description = "The client has this answer already; nothing was rendered"),
        OfSky,
    )
)]
pub async fn get_position(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let asked = position(query.as_deref(), scene_id(&scene)?, state.source.facts())?;
    let prepared = PreparedSky::prepare(&state, asked.sky).await?;
    let names: Vec<&str> = asked.quantities.iter().map(|quantity| quantity.name).collect();
    let etag = ETag::of(&("position", &prepared.key, names, asked.position.map(f64::to_bits)))?;
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&headers) {
        return Ok(response);
    }
    let sky = prepared.render(&state).await?;
    let assumptions = prepared.assumptions(&state, &sky);
    let time = prepared.request.time.map(|time| time.instant);
    let coverage = position_coverage(asked.position, time, &asked.quantities, &sky.quantities, &assumptions);
    let mut response = caching.ok(COVERAGE_JSON, json_bytes(&coverage)?);
    put_times(&mut response, &times_of(&sky));
    put_warnings(&mut response, &assumptions.warnings);
    Ok(response)
}

/// The numbers of the skies along a path, as a CoverageJSON Trajectory where points have times, by M or by `datetime`, else as a
/// MultiPoint, for a Trajectory needs them.
#[utoipa::path(
    get,
    path = "/api/ogc/collections/{scene}/trajectory",
    tag = "standards",
    params(("scene" = String, Path, description = "The scene's id"), TrajectoryParameters),
    responses(
        (status = 200, description = "The coverage", body = Object, content_type = "application/prs.coverage+json"),
        (status = 304, description = "The client has this answer already; nothing was rendered"),
        OfSky,
    )
)]
pub async fn get_trajectory(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let asked = trajectory(query.as_deref(), scene_id(&scene)?, state.source.facts())?;
    let mut prepared = Vec::with_capacity(asked.skies.len());
    for sky in asked.skies {
        // A point outside is refused before any sky is rendered.
        prepared.push(PreparedSky::prepare(&state, sky).await?);
    }
    let keys: Vec<&str> = prepared.iter().map(|sky| sky.key.as_str()).collect();
    let names: Vec<&str> = asked.quantities.iter().map(|quantity| quantity.name).collect();
    let caching =
        Caching { etag: ETag::of(&("trajectory", keys, names))?, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&headers) {
        return Ok(response);
    }
    let mut numbers: Vec<SkyQuantities> = Vec::with_capacity(prepared.len());
    let (mut first, mut warnings) = (None, Vec::new());
    for sky in &prepared {
        let rendered = sky.render(&state).await?;
        let assumptions = sky.assumptions(&state, &rendered);
        for warning in &assumptions.warnings {
            if !warnings.contains(warning) {
                warnings.push(warning.clone());
            }
        }
        numbers.push(rendered.quantities.clone());
        first.get_or_insert(assumptions);
    }
    let mut assumptions = first.ok_or_else(|| ApiError::internal("a path without points"))?;
    assumptions.warnings = warnings;
    let times = prepared.iter().map(|sky| sky.request.time.map(|time| time.instant));
    let points: Vec<_> = asked.positions.into_iter().zip(times).collect();
    let coverage = trajectory_coverage(&points, &asked.quantities, &numbers, &assumptions);
    let mut response = caching.ok(COVERAGE_JSON, json_bytes(&coverage)?);
    put_warnings(&mut response, &assumptions.warnings);
    Ok(response)
}

/// The sky over every place of an area, as a CoverageJSON Grid: from the map of brightness, under an open sky two metres above the
/// ground. Places outside the area are null. The first time a map takes seconds: a refusal of the kind `being-made` says that it
/// goes on.
#[utoipa::path(
    get,
    path = "/api/ogc/collections/{scene}/area",
    tag = "standards",
    params(("scene" = String, Path, description = "The scene's id"), AreaParameters),
    responses(
        (status = 200, description = "The coverage", body = Object, content_type = "application/prs.coverage+json"),
        (status = 304, description = "The client has this answer already; nothing was computed"),
        OfSky,
    )
)]
pub async fn get_area(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let id = scene_id(&scene)?;
    // Its text may be long.
    let read = move |source: &dyn SkySource| Ok(area(query.as_deref(), id, source.facts())?);
    let asked = state.blocking(read).await?;
    let mut prepared = Vec::with_capacity(asked.maps.len());
    for map in &asked.maps {
        prepared.push(PreparedBrightness::prepare(&state, map.clone()).await?);
    }
    if let Some(map) = prepared.first() {
        asked.area.check_within_as(AREA_COORDS.name, "WKT", map.view().metadata().bounds)?;
    }
    let keys: Vec<&str> = prepared.iter().map(|map| map.key.as_str()).collect();
    let names: Vec<&str> = asked.quantities.iter().map(|quantity| quantity.name).collect();
    let etag = ETag::of(&("area", keys, names, &asked.area.boundary))?;
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&headers) {
        return Ok(response);
    }
    let make = async {
        let mut maps = Vec::with_capacity(prepared.len());
        let mut assumptions = Vec::with_capacity(prepared.len());
        for one in &prepared {
            let map = one.find(&state).await?;
            assumptions.push(BrightnessAssumptions::new(one.request(), &map, state.source.facts()));
            maps.push(map);
        }
        let warnings = assumptions.first().map(|one| one.warnings.clone()).unwrap_or_default();
        let bytes = MAX_AREA_PLACES * BYTES_PER_PLACE * asked.quantities.len();
        let draw = move |_: &dyn SkySource| coverage_of(&asked, &maps, &assumptions);
        let bytes = state.work.drawn(bytes, draw).await?;
        Ok(EncodedAnswer { bytes, warnings, ..EncodedAnswer::default() })
    };
    let made = state.answer(&caching.etag, make).await?;
    let mut response = made.response(&caching, COVERAGE_JSON);
    put_warnings(&mut response, &made.warnings);
    Ok(response)
}

/// An area's coverage as JSON.
fn coverage_of(
    asked: &AreaRequest,
    maps: &[Arc<BrightnessMap>],
    assumptions: &[impl Serialize],
) -> Result<Vec<u8>, ApiError> {
    let first = maps.first().ok_or_else(|| ApiError::internal("an area without a map"))?;
    let step = first.places().lattice().step;
    let nothing = || {
        let allowed =
            format!("an area with a place of the map in it: they are {step} pixels of the scene apart");
        let message = "holds no place of the map".to_owned();
        ApiError::parameter(AREA_COORDS.name, "…".to_owned(), allowed, message, ValidationCode::NotAllowed)
    };
    let grid = LonLatGrid::over(asked.area.extent_deg(), first.scene(), step, MAX_AREA_PLACES);
    let grid = grid.ok_or_else(nothing)?;
    let inside: Vec<Option<GeoPoint>> = (0..grid.len())
        .map(|index| {
            let [longitude_deg, latitude_deg] = grid.place_deg(index);
            let place = GeoPoint::from_deg(latitude_deg, longitude_deg).ok()?;
            asked.area.boundary.contains(place).then_some(place)
        })
        .collect();
    if inside.iter().all(Option::is_none) {
        return Err(nothing());
    }
    let cell_m = grid.cell_m();
    let of = |quantity: &'static MapQuantity| {
        let map = maps.iter().find(|map| map.measure == quantity.measure)?;
        let value =
            |place: &Option<GeoPoint>| quantity.of(map.at((*place)?, cell_m)?).map(|value| value as f32);
        Some((quantity, inside.iter().map(value).collect()))
    };
    let values = asked.quantities.iter().filter_map(|quantity| of(quantity)).collect();
    let assumptions = serde_json::to_value(assumptions).map_err(ApiError::internal)?;
    json_bytes(&area_coverage(&grid, values, assumptions))
}

/// The brightness of the sky over every place as a picture, in longitude and latitude: the colours of the map tiles. The first time
/// it takes seconds: a refusal of the kind `being-made` says that it goes on.
#[utoipa::path(
    get,
    path = "/api/ogc/collections/{scene}/map",
    tag = "standards",
    params(("scene" = String, Path, description = "The scene's id"), MapParameters),
    responses(
        (status = 200, description = "The map", body = Vec<u8>, content_type = "image/png", headers(
            ("content-bbox" = String, description = "West, south, east, north that are shown, degrees"),
        )),
        (status = 304, description = "The client has this answer already; nothing was computed"),
        OfSky,
    )
)]
pub async fn get_map(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let asked = map(query.as_deref(), scene_id(&scene)?, state.source.facts())?;
    let prepared = PreparedBrightness::prepare(&state, asked.map.clone()).await?;
    let (shown, size_px) = asked.frame(prepared.view().metadata().bounds)?;
    let etag = ETag::of(&("map", &prepared.key, shown.map(f64::to_bits), size_px))?;
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&headers) {
        return Ok(response);
    }
    let make = async {
        let map = prepared.find(&state).await?;
        let bytes = size_px[0] as usize * size_px[1] as usize * BYTES_PER_PIXEL;
        state.work.drawn(bytes, move |_| picture_of(&map, shown, size_px)).await.map(EncodedAnswer::from)
    };
    let made = state.answer(&caching.etag, make).await?;
    let mut response = made.response(&caching, "image/png");
    let [west, south, east, north] = shown;
    let east = if east > 180.0 && west <= 180.0 { east - 360.0 } else { east };
    let bbox = format!("{west},{south},{east},{north}");
    let bbox = HeaderValue::from_str(&bbox).map_err(ApiError::internal)?;
    response.headers_mut().insert(HeaderName::from_static("content-bbox"), bbox);
    Ok(response)
}

fn picture_of(
    map: &BrightnessMap,
    [west, south, east, north]: [f64; 4],
    size_px: [u32; 2],
) -> Result<Vec<u8>, ApiError> {
    let [width, height] = size_px.map(f64::from);
    let (across_deg, down_deg) = ((east - west) / width, (north - south) / height);
    let count = size_px[0] as usize * size_px[1] as usize;
    let (mut values, mut has_data) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let metres_per_degree = skyglow_physics::EARTH_RADIUS_M.to_radians();
    for row in 0..size_px[1] {
        let latitude_deg = north - (f64::from(row) + 0.5) * down_deg;
        let pixel_m = metres_per_degree * (across_deg * latitude_deg.to_radians().cos()).min(down_deg);
        for column in 0..size_px[0] {
            let longitude_deg = west + (f64::from(column) + 0.5) * across_deg;
            let place = GeoPoint::from_deg(latitude_deg, longitude_deg).map_err(AppError::internal)?;
            let value = map.at(place, pixel_m);
            has_data.push(value.is_some());
            values.push(value.unwrap_or_default() as f32);
        }
    }
    let words = brightness_description(
        (map.measure, map.light, map.cloud_base_m, &map.response),
        map.scene().illustrative,
    );
    brightness_map_png(&values, &has_data, size_px, map.colour_range(), &Notes::new(&words, ""))
        .map_err(ApiError::internal)
}
