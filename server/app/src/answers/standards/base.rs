//! What the documents of all standards share: addresses, links, texts.

use serde::Serialize;
use serde_json::{Value, json};
use skyglow_scene::SceneMetadata;

/// Longitude and latitude of WGS 84.
pub(super) const CRS84: &str = "http://www.opengis.net/def/crs/OGC/1.3/CRS84";
/// The root of the relations that OGC defines.
pub(super) const OGC_REL: &str = "http://www.opengis.net/def/rel/ogc/1.0";
pub(super) const JSON: &str = "application/json";
pub(super) const GEO_JSON: &str = "application/geo+json";
pub(super) const PNG: &str = "image/png";

/// The address under which a server is known, for links: empty where nobody knows.
#[derive(Clone, Debug)]
pub struct Base(String);

impl Base {
    /// Without a slash at its end.
    pub fn new(base: String) -> Self {
        Self(base)
    }

    pub(super) fn ogc(&self, path: &str) -> String {
        format!("{}/api/ogc{path}", self.0)
    }

    pub(super) fn stac(&self, path: &str) -> String {
        format!("{}/api/stac{path}", self.0)
    }

    pub(super) fn api(&self, path: &str) -> String {
        format!("{}/api{path}", self.0)
    }
}

/// A link.
pub(super) fn link(href: &str, rel: &str, media_type: &str, title: &str) -> Value {
    json!({"href": href, "rel": rel, "type": media_type, "title": title})
}

/// West, south, east, north, the eastern edge counted on beyond the antimeridian.
pub(super) fn unwrapped(scene: &SceneMetadata) -> [f64; 4] {
    let [west, south, east, north] = scene.bounds;
    [west, south, if west > east { east + 360.0 } else { east }, north]
}

/// What is said of a scene in one sentence.
pub(super) fn description(scene: &SceneMetadata) -> String {
    let light = match scene.illustrative {
        true => "Made-up light that shows what the program does; it was not measured.",
        false => "The night sky brightened by the lights of a satellite's picture.",
    };
    let credit = scene.attribution.as_ref().map(|whom| format!(" Credit: {whom}.")).unwrap_or_default();
    format!("{}. {light}{credit}", scene.title)
}

/// A text in English, as CoverageJSON has texts.
pub(super) fn english(text: &str) -> Value {
    json!({ "en": text })
}

/// A value as JSON.
pub(super) fn value_of(value: &impl Serialize) -> Value {
    serde_json::to_value(value).unwrap_or_default()
}
