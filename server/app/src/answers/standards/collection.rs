//! Landing page, conformance and collections of OGC API – Common (19-072, 20-024) and EDR (19-086r6): a collection is a scene.

use super::base::{Base, CRS84, JSON, OGC_REL, PNG, description, link};
use crate::quantities::{MAP_QUANTITIES, SKY_QUANTITIES, Unit};
use serde_json::{Map, Value, json};
use skyglow_scene::SceneMetadata;

/// The same system as Well-Known Text, which EDR asks for.
const CRS84_WKT: &str = "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563,AUTHORITY[\"EPSG\",\"7030\"]],\
     AUTHORITY[\"EPSG\",\"6326\"]],PRIMEM[\"Greenwich\",0,AUTHORITY[\"EPSG\",\"8901\"]],UNIT[\"degree\",0.01745329251994328,\
     AUTHORITY[\"EPSG\",\"9122\"]],AXIS[\"Longitude\",EAST],AXIS[\"Latitude\",NORTH],AUTHORITY[\"OGC\",\"CRS84\"]]";

/// The root of the names of classes.
const SPEC: &str = "http://www.opengis.net/spec";
/// What is conformed to: a standard, and its classes.
const CONFORMANCE: [(&str, &[&str]); 7] = [
    ("ogcapi-common-1/1.0", &["core", "landing-page", "json"]),
    ("ogcapi-common-2/1.0", &["collections", "json"]),
    ("ogcapi-edr-1/1.1", &["core", "collections", "json", "covjson"]),
    ("ogcapi-tiles-1/1.0", &["core", "tileset", "tilesets-list", "geodata-tilesets", "png"]),
    (
        "tms/2.0",
        &[
            "tilematrixset",
            "tilematrixsetlimits",
            "tilesetmetadata",
            "json-tilematrixset",
            "json-tilematrixsetlimits",
            "json-tilesetmetadata",
        ],
    ),
    ("ogcapi-maps-1/1.0", &["core", "collection-map", "png"]),
    ("ogcapi-processes-1/1.0", &["core", "json", "ogc-process-description", "dismiss"]),
];
/// Standards whose text names its classes by https; others have taken them by http since before it was agreed.
const NAMED_BY_HTTPS: [&str; 2] = ["ogcapi-common-2/1.0", "ogcapi-maps-1/1.0"];

/// How the standard of maps names the relation of a map.
const MAP_BY_HTTPS: &str = "https://www.opengis.net/def/rel/ogc/1.0/map";

/// The landing page.
pub fn landing(base: &Base) -> Value {
    json!({
        "title": "Skyglow",
        "description": "The night sky of a place, brightened by the lights around it.",
        "keywords": ["light pollution", "night sky brightness", "skyglow"],
        "links": [
            link(&base.ogc(""), "self", JSON, "This document"),
            link(&base.api("/v1/openapi.json"), "service-desc", JSON, "The interface (OpenAPI 3.1)"),
            link(&base.api("/docs"), "service-doc", "text/html", "The interface, to read and try"),
            link(&base.ogc("/conformance"), "conformance", JSON, "What is conformed to"),
            link(&base.ogc("/conformance"), &format!("{OGC_REL}/conformance"), JSON, "What is conformed to"),
            link(&base.ogc("/collections"), "data", JSON, "Collections: a scene each"),
            link(&base.ogc("/processes"), &format!("{OGC_REL}/processes"), JSON, "Processes"),
            link(&base.ogc("/tileMatrixSets"), &format!("{OGC_REL}/tiling-schemes"), JSON, "Tile matrix sets"),
            link(&base.stac(""), "alternate", JSON, "The same scenes as a STAC catalogue"),
        ],
    })
}

/// What is conformed to.
pub fn conformance() -> Value {
    let name = |(standard, class): (&str, &&str)| format!("{SPEC}/{standard}/conf/{class}");
    let names =
        CONFORMANCE.iter().flat_map(|(standard, classes)| classes.iter().map(|class| (*standard, class)));
    let is_by_https = |(standard, _): &(&str, &&str)| NAMED_BY_HTTPS.contains(standard);
    let secure = names.clone().filter(is_by_https).map(|of| name(of).replacen("http:", "https:", 1));
    json!({ "conformsTo": names.map(name).chain(secure).collect::<Vec<_>>() })
}

/// All collections.
pub fn collections(base: &Base, scenes: &[SceneMetadata]) -> Value {
    json!({
        "links": [link(&base.ogc("/collections"), "self", JSON, "This document")],
        "collections": scenes.iter().map(|scene| collection(base, scene)).collect::<Vec<_>>(),
    })
}

/// A scene as a collection.
pub fn collection(base: &Base, scene: &SceneMetadata) -> Value {
    let path = |end: &str| base.ogc(&format!("/collections/{}{end}", scene.id));
    let query = |kind: &str, title: &str, words: &str| {
        json!({"link": {
            "href": path(&format!("/{kind}")), "rel": "data", "type": "application/prs.coverage+json", "title": title,
            "templated": false,
            "variables": {
                "title": title, "description": words, "query_type": kind, "output_formats": ["CoverageJSON"],
                "default_output_format": "CoverageJSON", "crs_details": [{"crs": CRS84, "wkt": CRS84_WKT}],
            },
        }})
    };
    let of_map: Vec<&str> = MAP_QUANTITIES.iter().map(|quantity| quantity.name).collect();
    let area_words = format!(
        "The sky over every place of a POLYGON or MULTIPOLYGON, from a map that takes seconds the first time; of {}",
        of_map.join(", ")
    );
    json!({
        "id": scene.id.as_str(),
        "title": scene.title,
        "description": description(scene),
        "keywords": ["light pollution", "night sky brightness"],
        "attribution": scene.attribution,
        "links": [
            link(&path(""), "self", JSON, "This document"),
            link(&path(""), "collection", JSON, "This document"),
            link(&path("/position"), "data", "application/prs.coverage+json", "The sky of a place"),
            link(&path("/area"), "data", "application/prs.coverage+json", "The sky over an area"),
            link(&path("/trajectory"), "data", "application/prs.coverage+json", "The skies along a path"),
            link(&path("/map"), &format!("{OGC_REL}/map"), PNG, "The brightness of the sky as a map"),
            link(&path("/map"), MAP_BY_HTTPS, PNG, "The brightness of the sky as a map"),
            link(&path("/map/tiles"), &format!("{OGC_REL}/tilesets-map"), JSON, "Map tiles"),
            link(&base.api(&format!("/v1/scenes/{}", scene.id)), "describedby", JSON, "The scene"),
            link(&base.stac(&format!("/collections/{}", scene.id)), "alternate", JSON, "The scene's layers as files (STAC)"),
        ],
        "extent": {"spatial": {"bbox": [scene.bounds], "crs": CRS84}},
        "crs": [CRS84],
        "output_formats": ["CoverageJSON"],
        "data_queries": {
            "position": query("position", "The sky of a place", "The numbers of the sky of a POINT"),
            "area": query("area", "The sky over an area", &area_words),
            "trajectory": query("trajectory", "The skies along a path", "The numbers of the skies along a LINESTRING, or a LINESTRING M with times"),
        },
        "parameter_names": parameter_names(),
    })
}

/// All numbers, as EDR describes them.
fn parameter_names() -> Map<String, Value> {
    let one = |quantity: &crate::quantities::Quantity| {
        let parameter = json!({
            "type": "Parameter",
            "id": quantity.name,
            "description": quantity.description,
            "data-type": "float",
            "unit": unit(quantity.unit),
            "observedProperty": {"id": quantity.name, "label": quantity.label},
        });
        (quantity.name.to_owned(), parameter)
    };
    SKY_QUANTITIES.iter().map(one).collect()
}

/// A unit, as EDR and CoverageJSON describe it.
pub(super) fn unit(unit: Unit) -> Value {
    let symbol = match unit.is_ucum {
        true => json!({"value": unit.symbol, "type": "http://www.opengis.net/def/uom/UCUM/"}),
        false => json!(unit.symbol),
    };
    json!({"label": {"en": unit.label}, "symbol": symbol})
}
