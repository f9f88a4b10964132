//! Which addresses there are: part of the HTTP interface's document, with the same parameters.

use serde_json::{Value, json};
use skyglow_app::parameters::{self as p, Parameter, ParameterSet};

/// Where all addresses begin.
pub const BASE: &str = "/api/v1/";

/// What is answered at an address.
#[derive(Clone, Copy, Debug)]
pub struct Operation {
    /// The last part of its name in the interface's document, after `get_`, `list_` or `post_`.
    pub name: &'static str,
    /// `get`, or `post` with a body.
    pub method: &'static str,
    /// The address below [`BASE`].
    pub below: &'static str,
    /// The parameters of its query.
    pub parameters: &'static [Parameter],
}

const fn get(name: &'static str, below: &'static str, parameters: &'static [Parameter]) -> Operation {
    Operation { name, method: "get", below, parameters }
}

const fn post(name: &'static str, below: &'static str, parameters: &'static [Parameter]) -> Operation {
    Operation { name, method: "post", below, parameters }
}

/// All of them.
pub const OPERATIONS: &[Operation] = &[
    get("get_openapi", "openapi.json", &[]),
    get("list_atmospheres", "atmospheres", &[]),
    get("list_scenes", "scenes", &[]),
    get("get_night", "night", p::NightParameters::ALL),
    get("list_nights", "nights", p::NightsParameters::ALL),
    get("get_scene", "scenes/{scene}", &[]),
    get("list_places", "scenes/{scene}/places", &[]),
    get("get_site", "scenes/{scene}/site", p::PlaceParameters::ALL),
    get("get_sky", "scenes/{scene}/sky", p::SkyParameters::ALL),
    get("get_panorama_json", "scenes/{scene}/panorama.json", p::GridParameters::ALL),
    get("get_panorama_png", "scenes/{scene}/panorama.png", p::PanoramaParameters::ALL),
    get("get_panorama_webp", "scenes/{scene}/panorama.webp", p::WebPParameters::ALL),
    get("get_panorama_tif", "scenes/{scene}/panorama.tif", p::RasterParameters::ALL),
    get("get_panorama_exr", "scenes/{scene}/panorama.exr", p::RasterParameters::ALL),
    get("get_panorama_sky", "scenes/{scene}/panorama.sky", p::CompactParameters::ALL),
    get("get_influence_json", "scenes/{scene}/influence.json", p::InfluenceParameters::ALL),
    post("post_influence_json", "scenes/{scene}/influence.json", p::InfluenceParameters::ALL),
    get("get_influence_geojson", "scenes/{scene}/influence.geojson", p::InfluenceParameters::ALL),
    post("post_influence_geojson", "scenes/{scene}/influence.geojson", p::InfluenceParameters::ALL),
    get("get_influence_csv", "scenes/{scene}/influence.csv", p::InfluenceParameters::ALL),
    post("post_influence_csv", "scenes/{scene}/influence.csv", p::InfluenceParameters::ALL),
    get("get_influence_tif", "scenes/{scene}/influence.tif", p::InfluenceRasterParameters::ALL),
    post("post_influence_tif", "scenes/{scene}/influence.tif", p::InfluenceRasterParameters::ALL),
    get("get_shares", "scenes/{scene}/shares", p::SharesParameters::ALL),
    post("post_shares", "scenes/{scene}/shares", p::AreaSharesParameters::ALL),
    get("get_radiance_tif", "scenes/{scene}/layers/radiance.tif", p::ScenarioParameters::ALL),
    get("get_elevation_tif", "scenes/{scene}/layers/elevation.tif", p::NoParameters::ALL),
    get("get_brightness_tif", "scenes/{scene}/layers/brightness.tif", p::BrightnessParameters::ALL),
    post("post_skies", "scenes/{scene}/skies", p::SkiesParameters::ALL),
    post("post_plan", "scenes/{scene}/plans", p::PlanPostParameters::ALL),
    post("post_scenario", "scenes/{scene}/scenarios", p::ScenarioPostParameters::ALL),
];

/// An operation, and the scene of its address where it has one.
///
/// * `has_body`: whether a body is sent.
pub fn find(address: &str, has_body: bool) -> Option<(&'static Operation, &str)> {
    let below = address.strip_prefix(BASE)?;
    let method = if has_body { "post" } else { "get" };
    OPERATIONS
        .iter()
        .filter(|operation| operation.method == method)
        .find_map(|operation| Some((operation, scene_of(operation.below, below)?)))
}

/// The scene of an address of this form; empty where the form has none.
fn scene_of<'a>(form: &str, below: &'a str) -> Option<&'a str> {
    let Some((before, after)) = form.split_once("{scene}") else {
        return (form == below).then_some("");
    };
    let scene = below.strip_prefix(before)?.strip_suffix(after)?;
    (!scene.is_empty() && !scene.contains('/')).then_some(scene)
}

/// The interface's document, as far as parameters go.
pub fn document() -> Value {
    let mut paths = serde_json::Map::new();
    for operation in OPERATIONS {
        let parameters: Vec<_> = operation.parameters.iter().map(Parameter::openapi).collect();
        let described = json!({ "operationId": operation.name, "parameters": parameters });
        let path = paths.entry(format!("{BASE}{}", operation.below)).or_insert_with(|| json!({}));
        path[operation.method] = described;
    }
    json!({ "paths": paths })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(address: &str, has_body: bool) -> Option<(&'static str, &str)> {
        find(address, has_body).map(|(operation, scene)| (operation.name, scene))
    }

    #[test]
    fn addresses_are_those_of_the_interface() {
        assert_eq!(found("/api/v1/scenes", false), Some(("list_scenes", "")));
        assert_eq!(found("/api/v1/scenes/demo", false), Some(("get_scene", "demo")));
        assert_eq!(found("/api/v1/scenes/demo/sky", false), Some(("get_sky", "demo")));
        assert_eq!(found("/api/v1/scenes/demo/influence.json", true), Some(("post_influence_json", "demo")));
        for nothing in ["/api/v1/", "/api/v1/scenes/", "/api/v1/scenes/a/b/sky", "/api/v2/scenes", "/scenes"]
        {
            assert_eq!(found(nothing, false), None, "{nothing}");
        }
        assert_eq!(found("/api/v1/scenes/demo/sky", true), None);
    }

    /// Every operation is one of the server's own document, with its name and its parameters.
    #[test]
    fn the_document_is_part_of_the_servers() {
        let snapshot = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../server/http/tests/interface/snapshots/interface__document__openapi.snap"
        );
        let text = std::fs::read_to_string(snapshot).unwrap();
        let server: Value = serde_json::from_str(text.splitn(3, "---").nth(2).unwrap()).unwrap();
        for (path, item) in document()["paths"].as_object().unwrap() {
            for (method, operation) in item.as_object().unwrap() {
                let theirs = &server["paths"][path][method];
                assert_eq!(operation["operationId"], theirs["operationId"], "{path}");
                let of_query: Vec<&Value> = theirs["parameters"]
                    .as_array()
                    .map(|all| all.iter().filter(|one| one["in"] == "query").collect())
                    .unwrap_or_default();
                let ours: Vec<&Value> = operation["parameters"].as_array().unwrap().iter().collect();
                assert_eq!(ours, of_query, "{path}");
            }
        }
    }
}
