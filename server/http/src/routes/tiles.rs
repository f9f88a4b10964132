//! Web Mercator map tiles.

use super::influence::AskedInfluence;
use crate::{
    accept::InfluenceFormat,
    answers::measure_name,
    error::ApiError,
    etag::ETag,
    parameters::OptionalInfluenceParameters,
    problem::{Problem, echo},
    request::{influence, no_parameters, scenario_alone, scene_id},
    respond::{Caching, Keep},
    source::{SkySource, SourceError},
    state::AppState,
};
use axum::{
    body::Body,
    extract::{Path, RawQuery, State},
    http::{HeaderMap, Response},
};
use skyglow_display::{
    Notes,
    notes::ILLUSTRATIVE,
    tile::{INFLUENCE_SPAN, elevation_tile_png, influence_tile_png, radiance_tile_png},
};
use skyglow_engine::Measure;
use skyglow_scene::{ChangeId, SceneId, SceneMetadata, TileLayer};
use utoipa::OpenApi;

/// Pixels a side.
const TILE_PX: u32 = 256;
/// Ground size of a pixel of zoom level 0 on the equator, metres.
pub(super) const PIXEL_0_M: f64 = std::f64::consts::TAU * skyglow_physics::EARTH_RADIUS_M / 256.0;

/// The document of the tiles: their route's last part is one segment to the router and two things to a reader.
#[derive(OpenApi)]
#[openapi(paths(get_tile))]
pub struct TileDocument;

/// What a map tile shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layer {
    /// What the scene has everywhere.
    Scene(TileLayer),
    /// What lights do to the sky of a place, which the query names.
    Influence,
}

pub(super) fn layer(name: &str) -> Result<Layer, ApiError> {
    match name {
        "radiance" => Ok(Layer::Scene(TileLayer::Radiance)),
        "elevation" => Ok(Layer::Scene(TileLayer::Elevation)),
        "influence" => Ok(Layer::Influence),
        other => Err(ApiError::UnknownTile {
            reason: format!("the layers are radiance, elevation and influence, not \"{}\"", echo(other)),
        }),
    }
}

/// Zoom level, column and row.
type Address = (u8, u32, u32);

/// A map tile, 256 pixels a side: `radiance` on a logarithmic scale, dark is transparent; `elevation` with
/// hypsometric tints and shading; `influence` on a logarithmic scale down to a ten-thousandth of the 32nd most influential
/// pixel; TileJSON says from what to what. `radiance` takes the parameter `scenario`, `influence` all parameters below, and needs the place.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/tiles/{layer}/{z}/{x}/{y}.png",
    tag = "tiles",
    params(
        ("scene" = String, Path, description = "The scene's id"),
        ("layer" = String, Path, description = "`radiance`, `elevation` or `influence`"),
        ("z" = u8, Path, description = "Zoom level"),
        ("x" = u32, Path, description = "Column, from 180° west"),
        ("y" = u32, Path, description = "Row, from the north"),
        OptionalInfluenceParameters,
    ),
    responses(
        (status = 200, description = "The tile", body = Vec<u8>, content_type = "image/png"),
        (status = 304, description = "The client has this answer already"),
        (status = 400, description = "Bad parameters", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such scene, layer or tile or scenario, or the place lies outside the scene", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The scenario is a plan for an earlier state of the scene", body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Altitude or turbidity out of range", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "Busy; Retry-After says when to try again", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_tile(
    State(state): State<AppState>,
    Path((scene, layer_name, z, x, file)): Path<(String, String, String, String, String)>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let id = scene_id(&scene)?;
    let layer = layer(&layer_name)?;
    let address = address(&z, &x, &file).ok_or_else(|| ApiError::UnknownTile {
        reason: "a tile's address ends in z/x/y.png with whole numbers".to_owned(),
    })?;
    match layer {
        Layer::Scene(layer) => {
            let scenario = scenario_of(query.as_deref(), layer)?;
            scene_tile(&state, (id, scenario), layer, &layer_name, address, &headers).await
        }
        Layer::Influence => influence_tile(&state, id, query.as_deref(), address, &headers).await,
    }
}

async fn scene_tile(
    state: &AppState,
    (id, scenario): (SceneId, Option<ChangeId>),
    layer: TileLayer,
    layer_name: &str,
    address: Address,
    headers: &HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let scene = metadata(state, &id, scenario.as_ref()).await?;
    let etag = ETag::of(&["tile", &scene.version, layer_name, &format!("{address:?}")]);
    let caching = Caching { etag, keep: Keep::Minutes, vary: None };
    if let Some(response) = caching.not_modified(headers).filter(|_| exists(address)) {
        return Ok(response);
    }
    let notes = Notes::new(&description(layer, scene.illustrative), "");
    let png = state
        .heavy(move |source| {
            let tile = source.tile(&id, scenario.as_ref(), layer, address, TILE_PX)?;
            match layer {
                TileLayer::Radiance => radiance_tile_png(&tile.values, &tile.has_data, TILE_PX, &notes),
                TileLayer::Elevation => {
                    let pixel_m = pixel_m(address.0, address.2);
                    elevation_tile_png(&tile.values, &tile.has_data, TILE_PX, pixel_m, &notes)
                }
            }
            .map_err(ApiError::internal)
        })
        .await?;
    Ok(caching.ok("image/png", png))
}

/// The scenario that a layer is shown of: terrain has none.
pub(super) fn scenario_of(query: Option<&str>, layer: TileLayer) -> Result<Option<ChangeId>, ApiError> {
    match layer {
        TileLayer::Radiance => scenario_alone(query),
        TileLayer::Elevation => no_parameters(query).map(|()| None),
    }
}

/// What is said of a scene, with the version that its changes make.
pub(super) async fn metadata(
    state: &AppState,
    id: &SceneId,
    scenario: Option<&ChangeId>,
) -> Result<SceneMetadata, ApiError> {
    let (id, scenario) = (id.clone(), scenario.cloned());
    let read = move |source: &dyn SkySource| match scenario {
        Some(scenario) => Ok(source.open_scene(&id, Some(&scenario))?.metadata().clone()),
        None => Ok(source.scene(&id)?),
    };
    state.blocking(read).await
}

/// All tiles of one map are cut from one computation.
async fn influence_tile(
    state: &AppState,
    id: SceneId,
    query: Option<&str>,
    address: Address,
    headers: &HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let ask = influence(query, None, id, state.source.facts(), InfluenceFormat::Tiff)?;
    let measure = ask.query.measure.clone();
    let asked = AskedInfluence::prepare(state, ask.query).await?;
    let etag = ETag::of(&["tile", &asked.key, &format!("{address:?}")]);
    let caching = Caching { etag, keep: Keep::Minutes, vary: None };
    if let Some(response) = caching.not_modified(headers).filter(|_| exists(address)) {
        return Ok(response);
    }
    let map = asked.find(state).await?;
    let notes = Notes::new(&influence_description(&measure, map.scene().illustrative), "");
    let png = state
        .heavy(move |_| {
            let tile =
                map.tile(address, TILE_PX).map_err(|error| ApiError::from(SourceError::from(error)))?;
            influence_tile_png(&tile.values, &tile.has_data, TILE_PX, map.brightest_colour(), &notes)
                .map_err(ApiError::internal)
        })
        .await?;
    Ok(caching.ok("image/png", png))
}

/// An address that does not exist has no tag to match.
fn exists((z, x, y): Address) -> bool {
    z <= 24 && x >> z == 0 && y >> z == 0
}

/// Zoom level, column and row.
fn address(z: &str, x: &str, file: &str) -> Option<Address> {
    Some((z.parse().ok()?, x.parse().ok()?, file.strip_suffix(".png")?.parse().ok()?))
}

/// Ground size of a pixel in the middle of a row of tiles, metres.
fn pixel_m(z: u8, y: u32) -> f64 {
    let rows = f64::from(z).exp2();
    let mercator = std::f64::consts::PI * (1.0 - 2.0 * (f64::from(y) + 0.5) / rows);
    // cos(gudermannian(m)) = 1/cosh(m).
    PIXEL_0_M / rows / mercator.cosh()
}

/// What a layer shows, and whether that was measured.
pub(super) fn description(layer: TileLayer, illustrative: bool) -> String {
    let shows = match layer {
        TileLayer::Radiance => {
            "Upward radiance, 0.2 to 200 nW cm-2 sr-1 on a logarithmic scale; dark is transparent"
        }
        TileLayer::Elevation => "Terrain elevation: hypsometric tints with shading",
    };
    if illustrative { format!("{shows}; {ILLUSTRATIVE}") } else { shows.to_owned() }
}

/// What is said of a layer of influences.
pub(super) fn influence_description(measure: &Measure, illustrative: bool) -> String {
    let shows = format!(
        "Influence of each pixel's light on the sky of a place ({}), from 1/{INFLUENCE_SPAN:.0} of the 32nd most influential pixel \
         to that on a logarithmic scale; less is transparent",
        measure_name(measure)
    );
    if illustrative { format!("{shows}; {ILLUSTRATIVE}") } else { shows }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tile_addresses_are_whole_numbers_and_png() {
        assert_eq!(address("3", "1", "2.png"), Some((3, 1, 2)));
        for (z, x, file) in
            [("3", "1", "2"), ("3", "-1", "2.png"), ("300", "1", "2.png"), ("a", "1", "2.png")]
        {
            assert_eq!(address(z, x, file), None);
        }
    }

    #[test]
    fn a_pixel_of_zoom_level_0_is_156_km_on_the_equator() {
        assert!((pixel_m(0, 0) - 156_366.0).abs() < 100.0);
        assert!(pixel_m(10, 0) < pixel_m(10, 512));
    }
}
