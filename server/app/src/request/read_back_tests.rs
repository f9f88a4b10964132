//! Answers of scenarios, posted again.

use crate::answers::EditAnswer;
use crate::request::scenario;
use skyglow_scene::{Scenario, SceneId};

fn read(body: &str) -> Scenario {
    scenario(None, body.as_bytes(), SceneId::parse("demo").unwrap()).unwrap().0
}

/// The edits of an answer are, posted again, the same scenario, whatever they change.
#[test]
fn an_answer_is_posted_again() {
    let brush = r#""brush": {"points": [[8.6, 46.5], [8.7, 46.5]], "radius_m": 500}"#;
    let polygon = r#""polygon": {"type": "Polygon", "coordinates": [[[8, 46], [9, 46], [9, 47], [8, 46]]]}"#;
    let edits = [
        format!(r#"{{{brush}, "factor": 0.3}}"#),
        format!(r#"{{{polygon}, "lamp": "pc_amber", "emission": "full_cutoff", "factor": 0.7}}"#),
        format!(r#"{{{brush}, "lamp": {{"from": "hps", "to": "led_4000k", "keep": "dnb_flux"}}}}"#),
        format!(r#"{{{brush}, "lamp": [0.4, 0.5, 0.1]}}"#),
        format!(r#"{{{brush}, "lamp": "hps:0.5,led_4000k:0.5"}}"#),
        format!(r#"{{{polygon}, "lamp": "400:0.1,500:1.3,650:0.7"}}"#),
        format!(r#"{{{brush}, "add_radiance_nw_cm2_sr": 20, "lamp": "lps", "emission": [0.5, 0.3, 0.2]}}"#),
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
