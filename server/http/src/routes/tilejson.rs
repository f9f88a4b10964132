//! What layers of map tiles there are and how they are asked for (TileJSON).

use super::{
    brightness::PreparedBrightness,
    influence::PreparedInfluence,
    tiles::{MapLayer, brightness_description, description, influence_description, layer, scenario_of},
};
use crate::{
    error::ApiError, listener::Ends, problem::Problem, refusals::OfSky, respond::CachePolicy, state::AppState,
};
use axum::{
    Extension,
    body::Body,
    extract::{ConnectInfo, Path, RawQuery, State},
    http::{HeaderMap, Response, header},
};
use skyglow_app::{
    accept::InfluenceFormat,
    answers::TileJson,
    parameters::OptionalInfluenceParameters,
    request::{brightness, influence, scene_id},
};
use skyglow_display::tile::{BRIGHTNESS_RANGE_CD_M2, INFLUENCE_SPAN, RADIANCE_RANGE_NW_CM2_SR};
use skyglow_observatory::Measure;
use skyglow_scene::{SceneMetadata, TileLayer, zoom_0_pixel_m};
use std::net::{Ipv6Addr, SocketAddr};

/// Describes a layer of tiles (TileJSON 3.0). What takes seconds to find is begun by this, and `ready` says whether it is found. Its parameters are those of the layer's tiles, and are handed on to them; that of
/// `influence` needs the place.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/tiles/{layer}/tilejson.json",
    tag = "tiles",
    params(
        ("scene" = String, Path, description = "The scene's id"),
        ("layer" = String, Path, description = "`radiance`, `elevation`, `brightness` or `influence`"),
        OptionalInfluenceParameters,
    ),
    responses(
        (status = 200, description = "The description", body = TileJson),
        (status = 304, description = "The client has this answer already"),
        OfSky,
        (status = 404, description = "No such scene or layer or scenario, or the place lies outside the scene", body = Problem, content_type = "application/problem+json"),
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
    let facts = state.source.facts();
    let (shown, view) = match layer(&layer_name)? {
        MapLayer::Scene(layer) => {
            let scenario = scenario_of(query.as_deref(), layer)?;
            // A layer of a scenario that is not there is refused here, not by every tile.
            let view = state.view(&id, scenario.as_ref()).await?;
            (Shown::Scene { layer, query: query.filter(|_| scenario.is_some()) }, view)
        }
        MapLayer::Brightness => {
            let request = brightness(query.as_deref(), id, facts)?;
            let prepared = PreparedBrightness::prepare(&state, request).await?;
            let view = prepared.view().clone();
            (Shown::Brightness { query, is_ready: prepared.begin(&state) }, view)
        }
        MapLayer::Influence => {
            let request = influence(query.as_deref(), None, id, facts, InfluenceFormat::Tiff)?.request;
            let measure = request.measure.clone();
            let prepared = PreparedInfluence::prepare(&state, request).await?;
            // What is wrong is refused here and not by every tile, and the tiles have their map.
            let most = prepared.find(&state).await?.brightest_colour();
            let query = query.unwrap_or_default();
            (Shown::Influence { measure, query, most }, prepared.view().clone())
        }
    };
    let reached = connection.and_then(|Extension(ConnectInfo(ends))| ends.server);
    let base = base_url(state.config.public_url.as_deref(), &headers, reached);
    let document = tilejson(view.metadata(), &shown, &layer_name, &base);
    crate::respond::json_by_content(&headers, CachePolicy::Revalidate, &document)
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

/// A layer with what its tiles must be asked with.
enum Shown {
    Scene {
        layer: TileLayer,
        /// As it came, where it names a scenario.
        query: Option<String>,
    },
    Brightness {
        /// As it came.
        query: Option<String>,
        is_ready: bool,
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
    let finest = (zoom_0_pixel_m() / scene.pixel_size_m.max(1.0)).log2().ceil().clamp(4.0, 16.0);
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
        Shown::Brightness { query, .. } => {
            let query = query.as_ref().map_or_else(String::new, |query| format!("?{query}"));
            (brightness_description(illustrative), query, "cd m-2", Some(BRIGHTNESS_RANGE_CD_M2.into()))
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
        ready: !matches!(shown, Shown::Brightness { is_ready: false, .. }),
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
}
