//! Landing page, conformance and collections of OGC API – Common (19-072, 20-024) and EDR (19-086r6): a collection is a scene.

use super::base::{Base, CRS84, JSON, OGC_REL, PNG, description, link};
use crate::quantities::{MAP_QUANTITIES, SKY_QUANTITIES, Unit};
use serde_json::{Map, Value, json};
use skyglow_scene::SceneMetadata;

/// The same system as Well-Known Text, which EDR asks for.
const CRS84_WKT: &str = "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563,AUTHORITY[\"EPSG\",\"7030\"]],\
     AUTHORITY[\"EPSG\",\"6326\"]],PRIMEM[\"Greenwich\",0,AUTHORITY[\"EPSG\",\"8901\"]],UNIT[\"degree\",0.01745329251994328,\
     AUTHORITY[\"EPSG\",\"9122\"]],AXIS[\"Longitude\",EAST],AXIS[\"Latitude\",NORTH],AUTHORITY[\"OGC\",\"CRS84\"]]";

/// What is conformed to.
const CONFORMANCE: [&str; 18] = [
    "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/json",
    "http://www.opengis.net/spec/ogcapi-common-2/1.0/conf/collections",
    "http://www.opengis.net/spec/ogcapi-edr-1/1.1/conf/core",
    "http://www.opengis.net/spec/ogcapi-edr-1/1.1/conf/collections",
    "http://www.opengis.net/spec/ogcapi-edr-1/1.1/conf/json",
    "http://www.opengis.net/spec/ogcapi-edr-1/1.1/conf/covjson",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/tileset",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/tilesets-list",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/geodata-tilesets",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/png",
    "http://www.opengis.net/spec/tms/2.0/conf/json-tilematrixset",
    "http://www.opengis.net/spec/ogcapi-maps-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-maps-1/1.0/conf/collection-map",
    "http://www.opengis.net/spec/ogcapi-maps-1/1.0/conf/png",
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/json",
];
const DISMISS: &str = "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/dismiss";
const DESCRIPTION: &str = "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/ogc-process-description";

/// The landing page.
pub fn landing(base: &Base) -> Value {
    json!({
        "title": "Skyglow",
        "description": "The night sky of a place, brightened by the lights around it.",
        "keywords": ["light pollution", "night sky brightness", "skyglow"],
        "links": [
            link(&base.ogc(""), "self", JSON, "This document"),
            link(&base.api("/v1/openapi.json"), "service-desc", "application/vnd.oai.openapi+json;version=3.1", "The interface (OpenAPI)"),
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
    let all: Vec<&str> = CONFORMANCE.into_iter().chain([DESCRIPTION, DISMISS]).collect();
    json!({ "conformsTo": all })
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
