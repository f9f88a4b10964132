//! Tile sets of OGC API – Tiles (20-057) and the tile matrix set that they are in (17-083r4): all lead to the map tiles that there are.

use super::base::{Base, CRS84, JSON, OGC_REL, PNG, description, link, unwrapped};
use serde_json::{Value, json};
use skyglow_scene::{SceneMetadata, tile_column, tile_row, zoom_0_pixel_m};

/// The only tile matrix set.
const WEB_MERCATOR_QUAD: &str = "WebMercatorQuad";
const WEB_MERCATOR_QUAD_URI: &str = "http://www.opengis.net/def/tilematrixset/OGC/1.0/WebMercatorQuad";
const WEB_MERCATOR: &str = "http://www.opengis.net/def/crs/EPSG/0/3857";
/// Half of the world's width in Web Mercator, metres.
const HALF_WORLD_M: f64 = 20_037_508.342_789_2;
/// Metres of a pixel at scale 1: 0.28 mm.
const STANDARD_PIXEL_M: f64 = 0.28e-3;
/// The finest zoom level that there are tiles of.
const FINEST: u8 = 24;

/// The layers that there are tiles of without a place: name and what it is. The first is the collection's map.
const LAYERS: [(&str, &str); 3] = [
    ("brightness", "Artificial luminance at the zenith of every place"),
    ("radiance", "Upward radiance"),
    ("elevation", "Terrain elevation"),
];

/// The highest zoom level with detail of its own.
pub fn finest_zoom(scene: &SceneMetadata, is_terrain: bool) -> u8 {
    let finest = (zoom_0_pixel_m() / scene.pixel_size_m.max(1.0)).log2().ceil().clamp(4.0, 16.0);
    // Terrain is usually finer than the lights.
    finest as u8 + if is_terrain { 2 } else { 0 }
}

/// The list of a collection's tile sets.
pub fn tilesets(base: &Base, scene: &SceneMetadata) -> Value {
    let layers = LAYERS.iter().filter(|(name, _)| scene.terrain || *name != "elevation");
    json!({
        "links": [link(&base.ogc(&format!("/collections/{}/map/tiles", scene.id)), "self", JSON, "This document")],
        "tilesets": layers.map(|(name, title)| head(base, scene, name, title)).collect::<Vec<_>>(),
    })
}

/// What a list says of a tile set.
fn head(base: &Base, scene: &SceneMetadata, name: &str, title: &str) -> Value {
    let path = base.ogc(&format!("/collections/{}/map/tiles/{name}", scene.id));
    json!({
        "title": format!("{}: {title}", scene.title),
        "dataType": "map",
        "crs": WEB_MERCATOR,
        "tileMatrixSetId": WEB_MERCATOR_QUAD,
        "tileMatrixSetURI": WEB_MERCATOR_QUAD_URI,
        "links": [link(&path, "self", JSON, "The tile set"), tiling_scheme(base)],
    })
}

fn tiling_scheme(base: &Base) -> Value {
    let path = base.ogc(&format!("/tileMatrixSets/{WEB_MERCATOR_QUAD}"));
    link(&path, &format!("{OGC_REL}/tiling-scheme"), JSON, "The tile matrix set")
}

/// A tile set; None for a layer that the scene does not have.
pub fn tileset(base: &Base, scene: &SceneMetadata, layer: &str) -> Option<Value> {
    let (name, title) = LAYERS.into_iter().find(|(name, _)| *name == layer)?;
    if name == "elevation" && !scene.terrain {
        return None;
    }
    let tiles = base.api(&format!("/v1/scenes/{}/tiles/{name}", scene.id));
    let own = base.ogc(&format!("/collections/{}/map/tiles/{name}", scene.id));
    let mut item = link(&format!("{own}/{{tileMatrix}}/{{tileRow}}/{{tileCol}}"), "item", PNG, "A tile");
    item["templated"] = json!(true);
    let mut document = head(base, scene, name, title);
    let collection = base.ogc(&format!("/collections/{}", scene.id));
    let links = [
        item,
        link(
            &format!("{tiles}/tilejson.json"),
            "alternate",
            JSON,
            "The same as TileJSON, with colours and what they mean",
        ),
        link(&collection, &format!("{OGC_REL}/geodata"), JSON, "The collection"),
    ];
    if let Some(known) = document["links"].as_array_mut() {
        known.extend(links);
    }
    let [west, south, east, north] = unwrapped(scene);
    let finest = finest_zoom(scene, name == "elevation");
    document["description"] = json!(description(scene));
    document["attribution"] = json!(scene.attribution);
    document["mediaTypes"] = json!([PNG]);
    document["boundingBox"] = json!({"crs": CRS84, "lowerLeft": [west, south], "upperRight": [east, north]});
    document["tileMatrixSetLimits"] = (0..=finest).map(|zoom| limits_document(scene, zoom)).collect();
    if document["attribution"].is_null()
        && let Some(fields) = document.as_object_mut()
    {
        fields.remove("attribution");
    }
    Some(document)
}

/// Columns and rows of a zoom level that have something of the scene, the first and the last.
fn limits(scene: &SceneMetadata, zoom: u8) -> [[u32; 2]; 2] {
    let [west, south, east, north] = unwrapped(scene);
    // Columns do not go around: what crosses the antimeridian has all of them.
    let columns =
        if east > 180.0 { [0, (1u32 << zoom) - 1] } else { [west, east].map(|at| tile_column(at, zoom)) };
    [columns, [tile_row(north, zoom), tile_row(south, zoom)]]
}

fn limits_document(scene: &SceneMetadata, zoom: u8) -> Value {
    let [columns, rows] = limits(scene, zoom);
    json!({
        "tileMatrix": zoom.to_string(),
        "minTileCol": columns[0], "maxTileCol": columns[1],
        "minTileRow": rows[0], "maxTileRow": rows[1],
    })
}

/// Whether a tile lies within the limits of a tile set.
///
/// * `column`, `row`: of the tile at a zoom level.
pub fn is_in_tileset(scene: &SceneMetadata, layer: &str, zoom: u8, column: u32, row: u32) -> bool {
    let is_there = LAYERS.iter().any(|(name, _)| *name == layer) && (scene.terrain || layer != "elevation");
    let within = |[first, last]: [u32; 2], at: u32| (first..=last).contains(&at);
    let has = |zoom: u8| {
        let [columns, rows] = limits(scene, zoom);
        within(columns, column) && within(rows, row)
    };
    is_there && zoom <= finest_zoom(scene, layer == "elevation") && has(zoom)
}

/// The list of tile matrix sets.
pub fn tile_matrix_sets(base: &Base) -> Value {
    let path = base.ogc(&format!("/tileMatrixSets/{WEB_MERCATOR_QUAD}"));
    json!({"tileMatrixSets": [{
        "id": WEB_MERCATOR_QUAD, "uri": WEB_MERCATOR_QUAD_URI, "crs": WEB_MERCATOR,
        "links": [link(&path, "self", JSON, "The tile matrix set")],
    }]})
}

/// A tile matrix set; None for one that there is not.
pub fn tile_matrix_set(id: &str) -> Option<Value> {
    let matrix = |zoom: u8| {
        let count = 1u32 << zoom;
        let cell_m = 2.0 * HALF_WORLD_M / (256.0 * f64::from(count));
        json!({
            "id": zoom.to_string(), "scaleDenominator": cell_m / STANDARD_PIXEL_M, "cellSize": cell_m,
            "cornerOfOrigin": "topLeft", "pointOfOrigin": [-HALF_WORLD_M, HALF_WORLD_M],
            "tileWidth": 256, "tileHeight": 256, "matrixWidth": count, "matrixHeight": count,
        })
    };
    (id == WEB_MERCATOR_QUAD).then(|| {
        json!({
            "id": WEB_MERCATOR_QUAD, "title": "Google Maps Compatible for the World", "uri": WEB_MERCATOR_QUAD_URI,
            "crs": WEB_MERCATOR, "orderedAxes": ["X", "Y"],
            "wellKnownScaleSet": "http://www.opengis.net/def/wkss/OGC/1.0/GoogleMapsCompatible",
            "tileMatrices": (0..=FINEST).map(matrix).collect::<Vec<_>>(),
        })
    })
}
