//! Scenarios as they are answered, posted again: whole, or their edits in another one.

use super::{
    emission::EmissionBody,
    geojson::BoundaryBody,
    scenario_body::{BrushBody, EditBody, FixtureBody, LampBody, ReplaceBody, ScenarioBody, few_edits},
};
use serde::{Deserialize, de::IgnoredAny};

/// The fields of a scenario's answer; what was found out of it says nothing anew.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Answered {
    title: Option<String>,
    base: Option<String>,
    #[serde(deserialize_with = "few_edits")]
    edits: Vec<AnsweredEdit>,
    #[serde(rename = "id")]
    _id: Option<IgnoredAny>,
    #[serde(rename = "created")]
    _created: Option<IgnoredAny>,
    #[serde(rename = "edit_count")]
    _edit_count: Option<IgnoredAny>,
    #[serde(rename = "scene")]
    _scene: Option<IgnoredAny>,
    #[serde(rename = "changed_pixels")]
    _changed_pixels: Option<IgnoredAny>,
    #[serde(rename = "new_pixels")]
    _new_pixels: Option<IgnoredAny>,
    #[serde(rename = "flux_before_dnb_w")]
    _flux_before_dnb_w: Option<IgnoredAny>,
    #[serde(rename = "flux_after_dnb_w")]
    _flux_after_dnb_w: Option<IgnoredAny>,
}

/// An edit as it is answered.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AnsweredEdit {
    area: AnsweredArea,
    radius_m: Option<f64>,
    factor: Option<f64>,
    add_radiance_nw_cm2_sr: Option<f64>,
    lamp: Option<FixtureBody>,
    lamp_from: Option<String>,
    keep: Option<String>,
    emission: Option<EmissionBody>,
    #[serde(rename = "lit_pixels")]
    _lit_pixels: Option<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum AnsweredArea {
    Stroke(Stroke),
    Polygons(BoundaryBody),
}

#[derive(Deserialize)]
#[serde(tag = "type")]
enum Stroke {
    MultiPoint { coordinates: Vec<[f64; 2]> },
}

/// The body that posts an answer again; None of what is no such answer.
pub(super) fn body(bytes: &[u8]) -> Option<ScenarioBody> {
    // What is posted for the first time is not read twice.
    bytes.windows(AREA.len()).any(|part| part == AREA).then_some(())?;
    let Answered { title, base, edits, .. } = serde_json::from_slice(bytes).ok()?;
    let edits = edits.into_iter().map(AnsweredEdit::posted).collect::<Option<_>>()?;
    Some(ScenarioBody { title, base, edits })
}

/// What stands in the edits of answers alone.
const AREA: &[u8] = b"\"area\"";

impl AnsweredEdit {
    fn posted(self) -> Option<EditBody> {
        let (polygon, brush) = match (self.area, self.radius_m) {
            (AnsweredArea::Stroke(Stroke::MultiPoint { coordinates }), Some(radius_m)) => {
                (None, Some(BrushBody { points: coordinates, radius_m }))
            }
            (AnsweredArea::Polygons(polygon), None) => (Some(polygon), None),
            _ => return None,
        };
        let is_added = self.add_radiance_nw_cm2_sr.is_some();
        let (from, keep) = (self.lamp_from, self.keep);
        let lamp = self.lamp.map(|to| match is_added {
            true => LampBody::All(to),
            false => LampBody::Replace(ReplaceBody { from, to, keep }),
        });
        let Self { factor, add_radiance_nw_cm2_sr, emission, .. } = self;
        Some(EditBody { polygon, brush, factor, lamp, emission, add_radiance_nw_cm2_sr })
    }
}
