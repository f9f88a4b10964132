//! Web Mercator map tiles.

use super::{brightness::PreparedBrightness, influence::PreparedInfluence};
use crate::{
    atlases::TileParts,
    error::ApiError,
    etag::ETag,
    problem::Problem,
    refusals::OfSky,
    respond::{CachePolicy, Caching},
    state::{AppState, EncodedAnswer},
};
use axum::{
    body::{Body, Bytes},
    extract::{Path, RawQuery, State},
    http::{HeaderMap, Response},
};
use serde::Serialize;
use skyglow_app::{
    accept::InfluenceFormat,
    answers::{brightness_shows, measure_name, standards::is_in_tileset},
    error::AppError,
    negotiated_parameters::LayerParameters,
    parameters::BrightnessParameters,
    request::{brightness, influence, no_parameters, scenario_alone, scene_id},
    source::SkySource,
    validation::echo,
};
use skyglow_display::{
    Notes, notes,
    tile::{
        INFLUENCE_SPAN, RADIANCE_RANGE_NW_CM2_SR, brightness_tile_png, elevation_tile_png,
        influence_tile_png, radiance_tile_png,
    },
};
use skyglow_observatory::{MapLight, MapMeasure, Measure};
use skyglow_scene::{ChangeId, SceneId, TileLayer, tile_pixel_m};
use std::{future::Future, sync::Arc, time::Duration};
use utoipa::OpenApi;

/// The document of the tiles: their route's last part is one segment to the router and two things to a reader.
#[derive(OpenApi)]
#[openapi(paths(get_tile))]
pub struct TileDocument;

/// What a map tile shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MapLayer {
    /// What the scene has everywhere.
    Scene(TileLayer),
    /// What lights do to the sky of a place, which the query names.
    Influence,
    /// The zenith's brightness at every place.
    Brightness,
}

pub(super) fn layer(name: &str) -> Result<MapLayer, ApiError> {
    match name {
        "radiance" => Ok(MapLayer::Scene(TileLayer::Radiance)),
        "elevation" => Ok(MapLayer::Scene(TileLayer::Elevation)),
        "influence" => Ok(MapLayer::Influence),
        "brightness" => Ok(MapLayer::Brightness),
        other => Err(ApiError::App(AppError::UnknownTile {
            reason: format!(
                "the layers are radiance, elevation, brightness and influence, not \"{}\"",
                echo(other)
            ),
        })),
    }
}

/// Pixels a side, unless twice as many are asked for.
const PLAIN_TILE_PX: u32 = 256;

/// Zoom level, column and row, and pixels a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
struct Address {
    place: (u8, u32, u32),
    size_px: u32,
}

/// A map tile, 256 pixels a side, or 512 where `y` ends in `@2x`: `radiance` on a logarithmic scale, dark is transparent; `elevation`
/// with hypsometric tints and shading; `brightness`, the artificial luminance at the zenith of every place, from a hundredth of the
/// dark reference outside the air to forty times that on a logarithmic scale, less is transparent (the first tile of a map takes seconds); `influence` on a logarithmic scale down to a ten-thousandth of the 32nd most influential
/// pixel; TileJSON says from what to what. `radiance` takes the parameter `scenario`, `brightness` that and `turbidity`, `scattering`, `lamp`, `emission` and the shares beside it, `terrain`,
/// `influence` all parameters below, and needs the place.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/tiles/{layer}/{z}/{x}/{y}.png",
    tag = "tiles",
    params(
        ("scene" = String, Path, description = "The scene's id"),
        ("layer" = String, Path, description = "`radiance`, `elevation`, `brightness` or `influence`"),
        ("z" = u8, Path, description = "Zoom level"),
        ("x" = u32, Path, description = "Column, from 180° west"),
        ("y" = String, Path, description = "Row, from the north; with `@2x` behind it for 512 pixels a side"),
        ("v" = Option<String>, Query, description = "Version of what is shown, as TileJSON has it in the tiles' addresses: with it a tile may be kept for ever"),
        LayerParameters,
    ),
    responses(
        (status = 200, description = "The tile", body = Vec<u8>, content_type = "image/png"),
        (status = 304, description = "The client has this answer already"),
        OfSky,
        (status = 404, description = "No such scene, layer or tile or scenario, or the place lies outside the scene", body = Problem, content_type = "application/problem+json"),
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
    let address = address(&z, &x, &file).ok_or_else(|| {
        ApiError::App(AppError::UnknownTile {
            reason: "a tile's address ends in z/x/y.png or z/x/y@2x.png with whole numbers".to_owned(),
        })
    })?;
    let (version, query) = split_version(query.as_deref());
    let asked = Asked { state: &state, address, version, headers: &headers };
    match layer {
        MapLayer::Scene(layer) => {
            let scenario = scenario_of(query.as_deref(), layer)?;
            scene_tile(&asked, (id, scenario), layer, &layer_name).await
        }
        MapLayer::Influence => influence_tile(&asked, id, query.as_deref()).await,
        MapLayer::Brightness => brightness_tile(&asked, id, query.as_deref()).await,
    }
}

/// A tile of a tile set of OGC API – Tiles: the map tile of that layer. Beyond the limits of the set there is none.
#[utoipa::path(
    get,
    path = "/api/ogc/collections/{scene}/map/tiles/{tileset}/{tileMatrix}/{tileRow}/{tileCol}",
    tag = "standards",
    params(
        ("scene" = String, Path, description = "The scene's id"),
        ("tileset" = String, Path, description = "`brightness`, `radiance` (which takes `scenario` alone) or `elevation` (which takes nothing)"),
        ("tileMatrix" = u8, Path, description = "The tile matrix: a zoom level"),
        ("tileRow" = u32, Path, description = "Row, from the north"),
        ("tileCol" = u32, Path, description = "Column, from 180° west"),
        BrightnessParameters,
    ),
    responses(
        (status = 200, description = "The tile", body = Vec<u8>, content_type = "image/png"),
        (status = 304, description = "The client has this answer already"),
        OfSky,
        (status = 404, description = "No such scene, tile set or scenario, or the tile lies beyond the limits", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_tileset_tile(
    state: State<AppState>,
    Path((scene, tileset, matrix, row, column)): Path<(String, String, String, String, String)>,
    query: RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let file = format!("{row}.png");
    let there = address(&matrix, &column, &file).filter(|address| address.size_px == PLAIN_TILE_PX);
    let view = state.view(&scene_id(&scene)?, None).await?;
    let is_there = there
        .is_some_and(|Address { place: (z, x, y), .. }| is_in_tileset(view.metadata(), &tileset, z, x, y));
    if !is_there {
        let reason = "it lies beyond the limits of the tile set".to_owned();
        return Err(ApiError::App(AppError::UnknownTile { reason }));
    }
    get_tile(state, Path((scene, tileset, matrix, column, file)), query, headers).await
}

/// A request for a tile.
struct Asked<'a> {
    state: &'a AppState,
    address: Address,
    /// Of what the client takes it to be of.
    version: Option<String>,
    headers: &'a HeaderMap,
}

impl Asked<'_> {
    /// The tag of a tile, and how long it may be kept: for ever where its address names what it shows.
    fn caching(&self, key: &str, layer: &str) -> Result<Caching, ApiError> {
        let etag = ETag::of(&("tile", key, layer, self.address))?;
        let current = tile_version(key)?;
        let policy = match self.version.as_deref() {
            None => CachePolicy::Minutes,
            Some(version) if version == current => CachePolicy::Forever,
            // The scene was replaced since.
            Some(_) => CachePolicy::Revalidate,
        };
        Ok(Caching { etag, policy, vary: None })
    }

    /// 304 if the client has this tile already.
    fn not_modified(&self, caching: &Caching) -> Option<Response<Body>> {
        caching.not_modified(self.headers).filter(|_| exists(self.address))
    }
}

/// The version of what tiles show, short enough for their addresses; the program's own is in it.
pub(super) fn tile_version(key: &str) -> Result<String, ApiError> {
    Ok(ETag::of(&("tiles", key))?.header().trim_matches('"').chars().take(16).collect())
}

/// The version that tiles are asked for with, and the other parameters as they came.
fn split_version(query: Option<&str>) -> (Option<String>, Option<String>) {
    let Some(query) = query else { return (None, None) };
    let (versions, others): (Vec<&str>, Vec<&str>) =
        query.split('&').partition(|pair| pair.starts_with("v="));
    let version = versions.first().and_then(|pair| pair.strip_prefix("v=")).map(str::to_owned);
    (version, (!others.is_empty()).then(|| others.join("&")))
}

async fn scene_tile(
    asked: &Asked<'_>,
    (id, scenario): (SceneId, Option<ChangeId>),
    layer: TileLayer,
    layer_name: &str,
) -> Result<Response<Body>, ApiError> {
    let &Asked { state, address, .. } = asked;
    let view = state.view(&id, scenario.as_ref()).await?;
    let caching = asked.caching(view.version(), layer_name)?;
    if let Some(response) = asked.not_modified(&caching) {
        return Ok(response);
    }
    let notes = Notes::new(&description(layer, view.metadata().illustrative), "");
    let draw = state.work.drawn(tile_bytes(address), move |source| {
        let Address { place, size_px } = address;
        let tile = source.tile(&view, layer, place, size_px)?;
        match layer {
            TileLayer::Radiance => radiance_tile_png(&tile.values, &tile.has_data, size_px, &notes),
            TileLayer::Elevation => {
                let (z, _, y) = place;
                let pixel_m = tile_pixel_m(z, y, size_px);
                elevation_tile_png(&tile.values, &tile.has_data, size_px, pixel_m, &notes)
            }
        }
        .map_err(ApiError::internal)
    });
    drawn_once(state, &caching, draw).await
}

/// How long a tile of an atlas waits for others to be read.
const ATLAS_WAIT: Duration = Duration::from_secs(5);
/// Bytes that a tile takes for each pixel while it is drawn.
const BYTES_PER_PIXEL: usize = 24;

fn tile_bytes(address: Address) -> usize {
    (address.size_px as usize).pow(2) * BYTES_PER_PIXEL
}

/// A tile, drawn once for all who ask at the same time and stored for a while.
async fn drawn_once(
    state: &AppState,
    caching: &Caching,
    draw: impl Future<Output = Result<Bytes, ApiError>>,
) -> Result<Response<Body>, ApiError> {
    let made = state.answer(&caching.etag, async { draw.await.map(EncodedAnswer::from) }).await?;
    Ok(made.response(caching, "image/png"))
}

/// The scenario that a layer is shown of: terrain has none.
pub(super) fn scenario_of(query: Option<&str>, layer: TileLayer) -> Result<Option<ChangeId>, ApiError> {
    match layer {
        TileLayer::Radiance => Ok(scenario_alone(query)?),
        TileLayer::Elevation => {
            no_parameters(query)?;
            Ok(None)
        }
    }
}

/// All tiles of one map are cut from one computation.
async fn influence_tile(
    asked: &Asked<'_>,
    id: SceneId,
    query: Option<&str>,
) -> Result<Response<Body>, ApiError> {
    let &Asked { state, address, .. } = asked;
    let request = influence(query, None, id, state.source.facts(), InfluenceFormat::Tiff)?;
    let measure = request.request.measure.clone();
    let prepared = PreparedInfluence::prepare(state, request.request).await?;
    let caching = asked.caching(&prepared.key, "influence")?;
    if let Some(response) = asked.not_modified(&caching) {
        return Ok(response);
    }
    let draw = async {
        let map = prepared.find(state).await?;
        let notes = Notes::new(&influence_description(&measure, map.scene().illustrative), "");
        let draw = move |_: &dyn SkySource| {
            let Address { place, size_px } = address;
            let tile = map.tile(place, size_px).map_err(AppError::from)?;
            influence_tile_png(&tile.values, &tile.has_data, size_px, map.brightest_colour(), &notes)
                .map_err(ApiError::internal)
        };
        state.work.drawn(tile_bytes(address), draw).await
    };
    drawn_once(state, &caching, draw).await
}

/// All tiles of one map are cut from one computation, or come from one file.
async fn brightness_tile(
    asked: &Asked<'_>,
    id: SceneId,
    query: Option<&str>,
) -> Result<Response<Body>, ApiError> {
    let &Asked { state, address, .. } = asked;
    let prepared = PreparedBrightness::prepare(state, brightness(query, id, state.source.facts())?).await?;
    let caching = asked.caching(&prepared.tiles_key(), "brightness")?;
    if let Some(response) = asked.not_modified(&caching) {
        return Ok(response);
    }
    if !exists(address) {
        // Nobody is to wait seconds to be told so.
        return Err(ApiError::App(AppError::UnknownTile { reason: "there is no such tile".to_owned() }));
    }
    let request = prepared.request();
    let seen = (request.measure, request.light, request.cloud_base_m, &request.response);
    let notes = Notes::new(&brightness_description(seen, prepared.view().metadata().illustrative), "");
    if let Some(atlas) = prepared.atlas.clone() {
        let Address { place, size_px } = address;
        let draw = async {
            // A store that hangs is to keep threads from no other work.
            let reads =
                tokio::time::timeout(ATLAS_WAIT, Arc::clone(&state.atlas_reads).acquire_owned()).await;
            let Ok(Ok(permit)) = reads else { return Err(AppError::Busy { retry_after_s: 5 }.into()) };
            let read = move |_: &dyn SkySource| {
                let _until_read = permit;
                Ok(atlas.read(place, size_px)?)
            };
            let parts = state.blocking(read).await?;
            if let TileParts::Itself(tile) = parts {
                return Ok(tile);
            }
            let draw = move |_: &dyn SkySource| Ok(parts.draw(size_px, &notes)?);
            state.work.drawn(tile_bytes(address), draw).await
        };
        return drawn_once(state, &caching, draw).await;
    }
    let draw = async {
        let map = prepared.find(state).await?;
        let draw = move |_: &dyn SkySource| {
            let Address { place, size_px } = address;
            let tile = map.tile(place, size_px).map_err(AppError::from)?;
            brightness_tile_png(&tile.values, &tile.has_data, size_px, map.colour_range(), &notes)
                .map_err(ApiError::internal)
        };
        state.work.drawn(tile_bytes(address), draw).await
    };
    drawn_once(state, &caching, draw).await
}

/// An address that does not exist has no tag to match.
fn exists(Address { place: (z, x, y), .. }: Address) -> bool {
    z <= 24 && x >> z == 0 && y >> z == 0
}

/// From the parts of a path.
fn address(z: &str, x: &str, file: &str) -> Option<Address> {
    let row = file.strip_suffix(".png")?;
    let (row, size_px) = row.strip_suffix("@2x").map_or((row, PLAIN_TILE_PX), |row| (row, 2 * PLAIN_TILE_PX));
    Some(Address { place: (z.parse().ok()?, x.parse().ok()?, row.parse().ok()?), size_px })
}

/// What a layer shows, and whether that was measured.
pub(super) fn description(layer: TileLayer, illustrative: bool) -> String {
    let shows = match layer {
        TileLayer::Radiance => {
            let (dark, bright) = RADIANCE_RANGE_NW_CM2_SR;
            format!(
                "Upward radiance, {dark} to {bright} nW cm-2 sr-1 on a logarithmic scale; dark is transparent"
            )
        }
        TileLayer::Elevation => "Terrain elevation: hypsometric tints with shading".to_owned(),
    };
    notes::description(shows, illustrative)
}

/// What is said of the layer of brightness.
pub(super) fn brightness_description(
    (measure, light, cloud_base_m, response): (MapMeasure, MapLight, Option<u32>, &skyglow_physics::Response),
    illustrative: bool,
) -> String {
    let (dark, bright) = measure.colour_range(response);
    let what = brightness_shows(measure, light, cloud_base_m, response);
    let shows = format!(
        "{what}: {dark:.3e} to {bright:.3e} {} (a hundredth of the dark reference outside the air to forty times that) on a logarithmic scale; less is \
         transparent",
        measure.unit(response.unit())
    );
    notes::description(shows, illustrative)
}

/// What is said of a layer of influences.
pub(super) fn influence_description(measure: &Measure, illustrative: bool) -> String {
    let shows = format!(
        "Influence of each pixel's light on the sky of a place ({}), from 1/{INFLUENCE_SPAN:.0} of the 32nd most influential pixel \
         to that on a logarithmic scale; less is transparent",
        measure_name(measure)
    );
    notes::description(shows, illustrative)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tile_addresses_are_whole_numbers_and_png() {
        assert_eq!(address("3", "1", "2.png"), Some(Address { place: (3, 1, 2), size_px: 256 }));
        assert_eq!(address("3", "1", "2@2x.png"), Some(Address { place: (3, 1, 2), size_px: 512 }));
        for (z, x, file) in [
            ("3", "1", "2"),
            ("3", "1", "2@3x.png"),
            ("3", "-1", "2.png"),
            ("300", "1", "2.png"),
            ("a", "1", "2.png"),
        ] {
            assert_eq!(address(z, x, file), None);
        }
    }
}
