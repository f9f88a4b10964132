//! Web Mercator map tiles.

use super::influence::AskedInfluence;
use crate::{
    accept::InfluenceFormat,
    answers::{TileJson, measure_name},
    error::ApiError,
    etag::ETag,
    listener::Ends,
    parameters::OptionalInfluenceParameters,
    problem::{Problem, echo},
    request::{influence, no_parameters, scenario_alone, scene_id},
    respond::{Caching, Keep},
    source::{SkySource, SourceError},
    state::AppState,
};
use axum::{
    Extension,
    body::Body,
    extract::{ConnectInfo, Path, RawQuery, State},
    http::{HeaderMap, Response, header},
};
use skyglow_display::{
    Notes,
    notes::ILLUSTRATIVE,
    tile::{
        INFLUENCE_SPAN, RADIANCE_RANGE_NW_CM2_SR, elevation_tile_png, influence_tile_png, radiance_tile_png,
    },
};
use skyglow_engine::Measure;
use skyglow_scene::{ChangeId, SceneId, SceneMetadata, TileLayer};
use std::net::{Ipv6Addr, SocketAddr};
use utoipa::OpenApi;

/// Pixels a side.
const TILE_PX: u32 = 256;
/// Ground size of a pixel of zoom level 0 on the equator, metres.
const PIXEL_0_M: f64 = std::f64::consts::TAU * skyglow_physics::EARTH_RADIUS_M / 256.0;

/// The document of the tiles: their route's last part is one segment to the router and two things to a reader.
#[derive(OpenApi)]
#[openapi(paths(get_tile))]
pub struct TileDocument;

/// What a map tile shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Layer {
    /// What the scene has everywhere.
    Scene(TileLayer),
    /// What lights do to the sky of a place, which the query names.
    Influence,
}

fn layer(name: &str) -> Result<Layer, ApiError> {
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
        (status = 404, description = "No such scene, layer or tile, or the place lies outside the scene", body = Problem, content_type = "application/problem+json"),
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
fn scenario_of(query: Option<&str>, layer: TileLayer) -> Result<Option<ChangeId>, ApiError> {
    match layer {
        TileLayer::Radiance => scenario_alone(query),
        TileLayer::Elevation => no_parameters(query).map(|()| None),
    }
}

/// What is said of a scene, with the version that its changes make.
async fn metadata(
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

/// Describes a layer of tiles (TileJSON 3.0). That of `radiance` takes the parameter `scenario`, that of `influence` all below,
/// and needs the place; they are handed on to the tiles.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/tiles/{layer}/tilejson.json",
    tag = "tiles",
    params(
        ("scene" = String, Path, description = "The scene's id"),
        ("layer" = String, Path, description = "`radiance`, `elevation` or `influence`"),
        OptionalInfluenceParameters,
    ),
    responses(
        (status = 200, description = "The description", body = TileJson),
        (status = 304, description = "The client has this answer already"),
        (status = 400, description = "Bad parameters", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such scene or layer, or the place lies outside the scene", body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Altitude or turbidity out of range", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "Busy; Retry-After says when to try again", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_tilejson(
    State(state): State<AppState>,
    connection: Option<Extension<ConnectInfo<Ends>>>,
    Path((scene, layer_name)): Path<(String, String)>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let id = scene_id(&scene)?;
    let shown = match layer(&layer_name)? {
        Layer::Scene(layer) => {
            let scenario = scenario_of(query.as_deref(), layer)?;
            // A layer of a scenario that is not there is said here, not by every tile.
            metadata(&state, &id, scenario.as_ref()).await?;
            Shown::Scene { layer, query: query.filter(|_| scenario.is_some()) }
        }
        Layer::Influence => {
            let facts = state.source.facts();
            let ask = influence(query.as_deref(), None, id.clone(), facts, InfluenceFormat::Tiff)?;
            let measure = ask.query.measure.clone();
            // What is wrong is said here and not by every tile, and the tiles have their map.
            let map = AskedInfluence::prepare(&state, ask.query).await?.find(&state).await?;
            Shown::Influence { measure, query: query.unwrap_or_default(), most: map.brightest_colour() }
        }
    };
    let scene = state.blocking(move |source| Ok(source.scene(&id)?)).await?;
    let reached = connection.and_then(|Extension(ConnectInfo(ends))| ends.server);
    let base = base_url(state.config.public_url.as_deref(), &headers, reached);
    let document = tilejson(&scene, &shown, &layer_name, &base);
    crate::respond::json_by_content(&headers, Keep::Revalidate, &document)
}

/// Where the client reached the server: what is configured, else the Host header if it is a host, else the
/// address that the connection came to.
fn base_url(public_url: Option<&str>, headers: &HeaderMap, reached: Option<SocketAddr>) -> String {
    if let Some(url) = public_url {
        return url.trim_end_matches('/').to_owned();
    }
    let host = headers.get(header::HOST).and_then(|host| host.to_str().ok()).filter(|host| is_host(host));
    let authority = host.map(str::to_owned).or_else(|| reached.map(|address| address.to_string()));
    authority.map_or_else(String::new, |authority| format!("http://{authority}"))
}

/// Whether a text is a name or an address with a port or without, and nothing else that an authority may be: its
/// letters go into addresses that other programs put together.
fn is_host(text: &str) -> bool {
    let (host, port) = match text.rsplit_once(':') {
        Some((host, port)) if !port.ends_with(']') => (host, Some(port)),
        _ => (text, None),
    };
    let is_port = |port: &str| port.bytes().all(|b| b.is_ascii_digit()) && port.parse::<u16>().is_ok();
    let is_name = |name: &str| {
        (1..=253).contains(&name.len())
            && name.trim_end_matches('.').split('.').all(|label| {
                (1..=63).contains(&label.len())
                    && label.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-' || b == b'_')
            })
    };
    let is_address = match host.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
        Some(address) => address.parse::<Ipv6Addr>().is_ok(),
        None => is_name(host),
    };
    is_address && port.is_none_or(is_port)
}

/// What a layer shows, and whether that was measured.
fn description(layer: TileLayer, illustrative: bool) -> String {
    let shows = match layer {
        TileLayer::Radiance => {
            "Upward radiance, 0.2 to 200 nW cm-2 sr-1 on a logarithmic scale; dark is transparent"
        }
        TileLayer::Elevation => "Terrain elevation: hypsometric tints with shading",
    };
    if illustrative { format!("{shows}; {ILLUSTRATIVE}") } else { shows.to_owned() }
}

/// What is said of a layer of influences.
fn influence_description(measure: &Measure, illustrative: bool) -> String {
    let shows = format!(
        "Influence of each pixel's light on the sky of a place ({}), from 1/{INFLUENCE_SPAN:.0} of the 32nd most influential pixel \
         to that on a logarithmic scale; less is transparent",
        measure_name(measure)
    );
    if illustrative { format!("{shows}; {ILLUSTRATIVE}") } else { shows }
}

/// A layer with what its tiles must be asked with.
enum Shown {
    Scene {
        layer: TileLayer,
        /// As it came, where it names a scenario.
        query: Option<String>,
    },
    Influence {
        measure: Measure,
        /// As it came.
        query: String,
        /// The influence that is shown brightest.
        most: f64,
    },
}

fn tilejson(scene: &SceneMetadata, shown: &Shown, name: &str, base: &str) -> TileJson {
    let [west, south, east, north] = scene.bounds;
    // Across the antimeridian the eastern edge is counted on.
    let width_deg = if west > east { east + 360.0 - west } else { east - west };
    let centre_deg = (west + 0.5 * width_deg + 180.0).rem_euclid(360.0) - 180.0;
    let finest = (PIXEL_0_M / scene.pixel_size_m.max(1.0)).log2().ceil().clamp(4.0, 16.0);
    // Terrain is usually finer than the lights.
    let maxzoom =
        finest as u8 + if matches!(shown, Shown::Scene { layer: TileLayer::Elevation, .. }) { 2 } else { 0 };
    let illustrative = scene.illustrative;
    let (description, query, unit, range) = match shown {
        Shown::Scene { layer, query } => {
            let query = query.as_ref().map_or_else(String::new, |query| format!("?{query}"));
            let (unit, range) = match layer {
                TileLayer::Radiance => ("nW cm-2 sr-1", Some(RADIANCE_RANGE_NW_CM2_SR.into())),
                TileLayer::Elevation => ("m", None),
            };
            (description(*layer, illustrative), query, unit, range)
        }
        Shown::Influence { measure, query, most } => {
            let range = Some([most / INFLUENCE_SPAN, *most]);
            (influence_description(measure, illustrative), format!("?{query}"), measure.unit(), range)
        }
    };
    TileJson {
        tilejson: "3.0.0".to_owned(),
        name: format!("{}: {name}", scene.title),
        description,
        attribution: scene.attribution.clone(),
        version: "1.0.0".to_owned(),
        scheme: "xyz".to_owned(),
        unit: unit.to_owned(),
        range,
        tiles: vec![format!("{base}/api/v1/scenes/{}/tiles/{name}/{{z}}/{{x}}/{{y}}.png{query}", scene.id)],
        minzoom: 0,
        maxzoom,
        bounds: if west > east { [-180.0, south, 180.0, north] } else { scene.bounds },
        center: [
            centre_deg,
            0.5 * (south + north),
            (360.0 / width_deg.max(0.01)).log2().floor().clamp(0.0, 12.0),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    #[test]
    fn a_host_header_that_is_no_host_is_not_repeated() {
        let reached = Some(SocketAddr::from(([10, 0, 0, 7], 8080)));
        let with = |host: &[u8]| {
            let host = HeaderValue::from_bytes(host).unwrap();
            base_url(None, &HeaderMap::from_iter([(header::HOST, host)]), reached)
        };
        for host in [
            "localhost:8080",
            "sky.example.org",
            "a_b-c.example:80",
            "[::1]:8080",
            "[2001:db8::1]",
            "10.1.2.3",
        ] {
            assert_eq!(with(host.as_bytes()), format!("http://{host}"));
        }
        for nasty in [
            "a\"b<script>",
            "user@evil",
            "evil/path",
            "evil?x=",
            "evil#x",
            "evil\\x",
            "a';alert(1)//",
            "a b",
            "a,b",
            "{z}",
            "[::1",
            "[zz]",
            ":80",
            "host:99999",
            "host:+80",
            "host:80:90",
            "..",
            "a..b",
            "",
            "höst",
        ] {
            assert_eq!(with(nasty.as_bytes()), "http://10.0.0.7:8080", "{nasty}");
        }
        assert_eq!(base_url(None, &HeaderMap::new(), None), "");
        assert_eq!(base_url(Some("https://sky.example/"), &HeaderMap::new(), reached), "https://sky.example");
    }

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
