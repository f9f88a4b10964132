//! What layers of map tiles there are and how they are asked for (TileJSON).

use super::{
    brightness::PreparedBrightness,
    influence::PreparedInfluence,
    tiles::{
        MapLayer, brightness_description, description, influence_description, layer, scenario_of,
        tile_version,
    },
};
use crate::{
    error::ApiError, problem::Problem, refusals::OfSky, respond::CachePolicy, state::AppState,
    trust::PublicAddress,
};
use axum::{
    Extension,
    body::Body,
    extract::{Path, RawQuery, State},
    http::{HeaderMap, Response},
};
use skyglow_app::{
    accept::InfluenceFormat,
    answers::{TileJson, standards::finest_zoom},
    negotiated_parameters::LayerParameters,
    request::{brightness, influence, scene_id},
};
use skyglow_display::tile::{INFLUENCE_SPAN, RADIANCE_RANGE_NW_CM2_SR};
use skyglow_observatory::{MapLight, MapMeasure, Measure};
use skyglow_physics::Response as ResponseKind;
use skyglow_scene::{SceneMetadata, TileLayer};

/// Describes a layer of tiles (TileJSON 3.0). What takes seconds to find is begun by this, and `ready` says whether it is found. Its parameters are those of the layer's tiles, and are handed on to them; that of
/// `influence` needs the place.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/tiles/{layer}/tilejson.json",
    tag = "tiles",
    params(
        ("scene" = String, Path, description = "The scene's id"),
        ("layer" = String, Path, description = "`radiance`, `elevation`, `brightness` or `influence`"),
        LayerParameters,
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
    Extension(address): Extension<PublicAddress>,
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
            let version = tile_version(view.version())?;
            (Shown::Scene { layer, version, query: query.filter(|_| scenario.is_some()) }, view)
        }
        MapLayer::Brightness => {
            let request = brightness(query.as_deref(), id, facts)?;
            let seen = (request.measure, request.light, request.cloud_base_m, request.response.clone());
            let prepared = PreparedBrightness::prepare(&state, request).await?;
            let view = prepared.view().clone();
            let version = tile_version(&prepared.tiles_key())?;
            let deepest = prepared.atlas.as_ref().map(|atlas| atlas.zooms().1);
            (Shown::Brightness { seen, query, version, deepest, progress: prepared.begin(&state) }, view)
        }
        MapLayer::Influence => {
            let request = influence(query.as_deref(), None, id, facts, InfluenceFormat::Tiff)?.request;
            let measure = request.measure.clone();
            let unit = measure.unit(request.sky.response.unit());
            let prepared = PreparedInfluence::prepare(&state, request).await?;
            // What is wrong is refused here and not by every tile, and the tiles have their map.
            let most = prepared.find(&state).await?.brightest_colour();
            let query = query.unwrap_or_default();
            let version = tile_version(&prepared.key)?;
            (Shown::Influence { measure, unit, version, query, most }, prepared.view().clone())
        }
    };
    let document = tilejson(view.metadata(), &shown, &layer_name, &address.base());
    crate::respond::json_by_content(&headers, CachePolicy::Revalidate, &document)
}

/// A layer with what its tiles must be asked with.
enum Shown {
    Scene {
        layer: TileLayer,
        version: String,
        /// As it came, where it names a scenario.
        query: Option<String>,
    },
    Brightness {
        /// What of the sky, which light, under which clouds, and what sees it.
        seen: (MapMeasure, MapLight, Option<u32>, ResponseKind),
        /// As it came.
        query: Option<String>,
        version: String,
        /// The last zoom of tiles that were made beforehand.
        deepest: Option<u8>,
        /// The part that is found, where not all is.
        progress: Option<f64>,
    },
    Influence {
        measure: Measure,
        unit: String,
        version: String,
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
    let maxzoom = match shown {
        Shown::Brightness { deepest: Some(deepest), .. } => *deepest,
        _ => finest_zoom(scene, matches!(shown, Shown::Scene { layer: TileLayer::Elevation, .. })),
    };
    let illustrative = scene.illustrative;
    let given = |query: &Option<String>| query.clone().unwrap_or_default();
    let (description, query, version, unit, range) = match shown {
        Shown::Scene { layer, version, query } => {
            let (unit, range) = match layer {
                TileLayer::Radiance => ("nW cm-2 sr-1", Some(RADIANCE_RANGE_NW_CM2_SR.into())),
                TileLayer::Elevation => ("m", None),
            };
            (description(*layer, illustrative), given(query), version, unit.to_owned(), range)
        }
        Shown::Brightness { seen: (measure, light, cloud_base_m, response), query, version, .. } => {
            let range = Some(measure.colour_range(response).into());
            let description =
                brightness_description((*measure, *light, *cloud_base_m, response), illustrative);
            (description, given(query), version, measure.unit(response.unit()), range)
        }
        Shown::Influence { measure, unit, version, query, most } => {
            let range = Some([most / INFLUENCE_SPAN, *most]);
            (influence_description(measure, illustrative), query.clone(), version, unit.clone(), range)
        }
    };
    // What comes from another version has another address: caches may keep tiles for ever.
    let parameters = query.split('&').filter(|pair| !pair.is_empty() && !pair.starts_with("v="));
    let query: String = parameters.map(|pair| format!("&{pair}")).collect();
    let (progress, natural) = match shown {
        Shown::Brightness { progress, seen: (measure, _, _, response), .. } => {
            (*progress, Some(measure.natural_value(response)))
        }
        _ => (None, None),
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
        natural,
        ready: progress.is_none(),
        progress,
        tiles: vec![format!(
            "{base}/api/v1/scenes/{}/tiles/{name}/{{z}}/{{x}}/{{y}}.png?v={version}{query}",
            scene.id
        )],
        tile_size: 256,
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
