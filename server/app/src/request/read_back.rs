//! Scenarios as they are answered, posted again: whole, or their edits in another one.

use super::{
    emission::EmissionBody,
    geojson::BoundaryBody,
    scenario::{BrushBody, EditBody, FixtureBody, LampBody, ReplaceBody, ScenarioBody, few_edits},
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

#[cfg(test)]
mod tests {
    use super::super::scenario::scenario;
    use crate::answers::EditAnswer;
    use skyglow_scene::{Scenario, SceneId};

    fn read(body: &str) -> Scenario {
        scenario(None, body.as_bytes(), SceneId::parse("demo").unwrap()).unwrap().0
    }

    /// The edits of an answer are, posted again, the same scenario, whatever they change.
    #[test]
    fn an_answer_is_posted_again() {
        let brush = r#""brush": {"points": [[8.6, 46.5], [8.7, 46.5]], "radius_m": 500}"#;
        let polygon =
            r#""polygon": {"type": "Polygon", "coordinates": [[[8, 46], [9, 46], [9, 47], [8, 46]]]}"#;
        let edits = [
            format!(r#"{{{brush}, "factor": 0.3}}"#),
            format!(r#"{{{polygon}, "lamp": "pc_amber", "emission": "full_cutoff", "factor": 0.7}}"#),
            format!(r#"{{{brush}, "lamp": {{"from": "hps", "to": "led_4000k", "keep": "dnb_flux"}}}}"#),
            format!(r#"{{{brush}, "lamp": [0.4, 0.5, 0.1]}}"#),
            format!(r#"{{{brush}, "lamp": "hps:0.5,led_4000k:0.5"}}"#),
            format!(r#"{{{polygon}, "lamp": "400:0.1,500:1.3,650:0.7"}}"#),
            format!(
                r#"{{{brush}, "add_radiance_nw_cm2_sr": 20, "lamp": "lps", "emission": [0.5, 0.3, 0.2]}}"#
            ),
        ];
        let first = read(&format!(r#"{{"title": "x", "edits": [{}]}}"#, edits.join(",")));
        let answered: Vec<_> =
            first.edits.iter().map(|edit| serde_json::to_value(EditAnswer::new(edit, 7)).unwrap()).collect();
        let whole = serde_json::json!({
            "id": "s-0", "title": "x", "base": null, "created": "2026-11-29T12:00:00Z", "edit_count": 7, "edits": answered,
            "scene": {"id": "demo"}, "changed_pixels": 1, "new_pixels": 0, "flux_before_dnb_w": 1.0, "flux_after_dnb_w": 0.5,
        });
        assert_eq!(read(&whole.to_string()), first);
        assert_eq!(read(&serde_json::json!({"title": "x", "edits": answered}).to_string()), first);
        let wrong = whole.to_string().replace("MultiPoint", "LineString");
        assert!(scenario(None, wrong.as_bytes(), SceneId::parse("demo").unwrap()).is_err());
    }
}
