//! Scenarios from their bodies: where a scene is painted, and with what.

use super::{
    emission::EmissionBody,
    geojson::polygons,
    influence::body_of,
    keeping::{Keeping, read_keeping},
    read_back,
    scenario_body::{EditBody, FixtureBody, LampBody, ScenarioBody},
    spectra::lamp_of,
};
use crate::{
    error::AppError,
    parameters::{self as p, ParameterSet},
    reader::Reader,
    validation::ValidationCode,
};
use skyglow_physics::{EmissionMix, Lamp, LampChange, LampPreset, PreservedFlux};
use skyglow_scene::{Area, Change, ChangeId, Edit, MAX_EDITS, Position, Scenario, SceneId};

/// Longest title, characters.
const MAX_TITLE_CHARS: usize = 200;
/// Largest factor on lights.
const MAX_FACTOR: f64 = 1000.0;
/// Brightest light that is added, nW cm⁻² sr⁻¹.
const MAX_ADDED_NW_CM2_SR: f64 = 1e6;

/// Reads a body into a scenario of a scene, and how it is kept. That its areas lie in the scene is seen when it is kept.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn scenario(query: Option<&str>, body: &[u8], scene: SceneId) -> Result<(Scenario, Keeping), AppError> {
    let mut reader = Reader::new(query, p::ScenarioPostParameters::ALL);
    let keeping = read_keeping(&mut reader);
    let body: ScenarioBody = match read_back::body(body) {
        Some(answered) => answered,
        None => body_of(body, &mut reader, "a JSON object with `edits`"),
    };
    if body.title.as_ref().is_some_and(|title| title.chars().count() > MAX_TITLE_CHARS) {
        reader.fail_body("title", &"is too long", &format!("{MAX_TITLE_CHARS} characters"));
    }
    let base = body.base.as_deref().and_then(|text| {
        let id = ChangeId::parse(text);
        if let Err(error) = &id {
            reader.fail_body("base", error, "the id of a scenario or plan of this scene");
        }
        id.ok()
    });
    if reader.is_fine() && body.edits.is_empty() {
        reader.fail_body("edits", &"there are none", &format!("1 to {MAX_EDITS} edits"));
    }
    let edits: Vec<Edit> = body
        .edits
        .iter()
        .enumerate()
        .filter_map(|(number, edit)| read_edit(&mut reader, number, edit))
        .collect();
    reader.finish()?;
    Ok((Scenario { scene, title: body.title, base, edits }, keeping))
}

fn read_edit(reader: &mut Reader, number: usize, body: &EditBody) -> Option<Edit> {
    let name = |part: &str| format!("edits[{number}].{part}");
    let area = read_area(reader, number, body);
    let emission = body.emission.as_ref().and_then(|body| {
        let emission = body.mix();
        if emission.is_none() {
            reader.fail_body(&name("emission"), &"is no emission", &EmissionBody::allowed());
        }
        emission
    });
    let change = match body.add_radiance_nw_cm2_sr {
        Some(radiance) => read_addition(reader, number, body, radiance, emission),
        None => read_alteration(reader, number, body, emission),
    };
    Some(Edit { area: area?, change: change? })
}

fn read_area(reader: &mut Reader, number: usize, body: &EditBody) -> Option<Area> {
    let name = |part: &str| format!("edits[{number}].{part}");
    let (part, area) = match (&body.polygon, &body.brush) {
        (Some(polygon), None) => match polygons(polygon) {
            Ok(polygons) => ("polygon", Area::Polygons(polygons)),
            Err(error) => {
                reader.fail_body(&name("polygon"), &error, "a GeoJSON Polygon or MultiPolygon in degrees");
                return None;
            }
        },
        (None, Some(brush)) => {
            let points: Vec<Position> = brush.points.clone();
            ("brush", Area::Brush { points, radius_m: brush.radius_m })
        }
        _ => {
            reader.fail_body(&name("polygon"), &"an edit has one area", "either `polygon` or `brush`");
            return None;
        }
    };
    if let Err(error) = area.check() {
        reader.fail_body(&name(part), &error, "an area of closed rings, or a stroke of places");
        return None;
    }
    Some(area)
}

/// New light.
fn read_addition(
    reader: &mut Reader,
    number: usize,
    body: &EditBody,
    radiance_nw_cm2_sr: f64,
    emission: Option<EmissionMix>,
) -> Option<Change> {
    let name = |part: &str| format!("edits[{number}].{part}");
    if body.factor.is_some() {
        let message = "an edit changes light that is there or adds light";
        reader.fail_part(
            &name("factor"),
            message,
            "either it or `add_radiance_nw_cm2_sr`",
            ValidationCode::Conflict,
        );
    }
    if !(radiance_nw_cm2_sr > 0.0 && radiance_nw_cm2_sr <= MAX_ADDED_NW_CM2_SR) {
        let allowed = format!("above 0, at most {MAX_ADDED_NW_CM2_SR} nW cm-2 sr-1");
        reader.fail_part(
            &name("add_radiance_nw_cm2_sr"),
            "is not allowed",
            &allowed,
            ValidationCode::NotAllowed,
        );
    }
    let lamp = match &body.lamp {
        None => None,
        Some(LampBody::All(lamp)) => Some(read_lamp(reader, &name("lamp"), lamp)?),
        Some(LampBody::Replace(_)) => {
            let message = "added light replaces no lamps";
            reader.fail_part(&name("lamp"), message, &p::LAMP.allowed(), ValidationCode::Conflict);
            return None;
        }
    };
    Some(Change::Add { radiance_nw_cm2_sr, lamp, emission })
}

/// Light that is there.
fn read_alteration(
    reader: &mut Reader,
    number: usize,
    body: &EditBody,
    emission: Option<EmissionMix>,
) -> Option<Change> {
    let name = |part: &str| format!("edits[{number}].{part}");
    let factor = body.factor.unwrap_or(1.0);
    if !(0.0..=MAX_FACTOR).contains(&factor) {
        let allowed = format!("0 to {MAX_FACTOR}");
        reader.fail_part(&name("factor"), "is not allowed", &allowed, ValidationCode::NotAllowed);
    }
    if body.factor.is_none() && body.lamp.is_none() && body.emission.is_none() {
        let allowed = "`factor`, `lamp`, `emission` or `add_radiance_nw_cm2_sr`";
        reader.fail_part(&name("factor"), "the edit changes nothing", allowed, ValidationCode::Missing);
    }
    let all = |to| LampChange { from: None, to, preserved: PreservedFlux::LuminousFlux };
    let lamp = match &body.lamp {
        None => None,
        Some(LampBody::All(lamp)) => Some(all(read_lamp(reader, &name("lamp"), lamp)?)),
        Some(LampBody::Replace(replace)) => {
            let to = read_lamp(reader, &name("lamp.to"), &replace.to)?;
            let from = match replace.from.as_deref().map(|name| LampPreset::from_name(name).ok_or(())) {
                None => None,
                Some(Ok(from)) => Some(from),
                Some(Err(())) => {
                    let names: Vec<&str> = LampPreset::ALL.iter().map(|preset| preset.name()).collect();
                    let (part, allowed) = (name("lamp.from"), names.join(", "));
                    reader.fail_part(
                        &part,
                        "is no lamp that has a name",
                        &allowed,
                        ValidationCode::NotAllowed,
                    );
                    return None;
                }
            };
            let keep = replace.keep.as_deref().unwrap_or(PreservedFlux::LuminousFlux.name());
            let Some(kept) = PreservedFlux::ALL.into_iter().find(|kept| kept.name() == keep) else {
                let allowed = PreservedFlux::ALL.map(PreservedFlux::name).join(", ");
                reader.fail_part(&name("lamp.keep"), "is not allowed", &allowed, ValidationCode::NotAllowed);
                return None;
            };
            Some(LampChange { from, to, preserved: kept })
        }
    };
    Some(Change::Alter { factor, lamp, emission })
}

fn read_lamp(reader: &mut Reader, name: &str, body: &FixtureBody) -> Option<Lamp> {
    match lamp_of(&body.text()) {
        Ok(lamp) => Some(lamp),
        Err(reason) => {
            let reason = reason.as_deref().unwrap_or("is no lamp");
            reader.fail_part(name, reason, &p::LAMP.allowed(), ValidationCode::NotAllowed);
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::GarstangLaw;

    fn read(body: &str) -> Result<Scenario, AppError> {
        scenario(None, body.as_bytes(), SceneId::parse("demo").unwrap()).map(|(scenario, _)| scenario)
    }

    fn refused(body: &str) -> Vec<String> {
        match read(body) {
            Err(AppError::Parameters(errors)) => errors.into_iter().map(|error| error.parameter).collect(),
            other => panic!("{body}: {other:?}"),
        }
    }

    const BRUSH: &str = r#""brush": {"points": [[8.6, 46.5]], "radius_m": 500}"#;

    #[test]
    fn every_kind_of_edit_is_read() {
        let body = format!(
            r#"{{"title": "LEDs", "base": "s-0123456789abcdef0123", "edits": [
                {{{BRUSH}, "factor": 0.5}},
                {{{BRUSH}, "lamp": "led_3000k", "emission": "shielded"}},
                {{{BRUSH}, "lamp": {{"from": "hps", "to": "led_4000k"}}}},
                {{{BRUSH}, "lamp": {{"to": [1, 2, 3], "keep": "dnb_flux"}}, "emission": [1, 1, 0]}},
                {{{BRUSH}, "emission": {{"direct_uplight": 0.05, "ground_reflectance": 0.6}}}},
                {{{BRUSH}, "add_radiance_nw_cm2_sr": 20, "lamp": [0.4, 0.6, 0.2]}},
                {{"polygon": {{"type": "Polygon", "coordinates": [[[7, 46], [8, 46], [8, 47], [7, 46]]]}}, "factor": 0}}
            ]}}"#
        );
        let scenario = read(&body).unwrap();
        assert_eq!((scenario.edits.len(), scenario.title.as_deref()), (7, Some("LEDs")));
        let lamps: Vec<_> = scenario.edits.iter().map(|edit| edit.change.clone()).collect();
        let change = LampChange {
            from: Some(LampPreset::Hps),
            to: LampPreset::Led4000k.lamp(),
            preserved: PreservedFlux::LuminousFlux,
        };
        assert_eq!(lamps[2], Change::Alter { factor: 1.0, lamp: Some(change), emission: None });
        let law = GarstangLaw::new(0.05, 0.6).unwrap();
        assert_eq!(lamps[4], Change::Alter { factor: 1.0, lamp: None, emission: Some(law.mix()) });
        assert!(matches!(lamps[5], Change::Add { radiance_nw_cm2_sr: 20.0, lamp: Some(_), emission: None }));
        assert!(matches!(scenario.edits[6].area, Area::Polygons(_)));
    }

    /// What cannot be meant is refused by the name of its part.
    #[test]
    fn a_wrong_part_is_refused_by_its_name() {
        for (edit, part) in [
            (format!("{{{BRUSH}}}"), "edits[0].factor"),
            (r#"{"factor": 0.5}"#.to_owned(), "edits[0].polygon"),
            (format!(r#"{{{BRUSH}, "polygon": {{"type": "Polygon", "coordinates": []}}, "factor": 1}}"#), "edits[0].polygon"),
            (r#"{"polygon": {"type": "Polygon", "coordinates": []}, "factor": 1}"#.to_owned(), "edits[0].polygon"),
            (r#"{"polygon": {"type": "Polygon", "coordinates": [[[7, 46], [8, 46], [8, 47]]]}, "factor": 1}"#.to_owned(), "edits[0].polygon"),
            (r#"{"brush": {"points": [], "radius_m": 5}, "factor": 1}"#.to_owned(), "edits[0].brush"),
            (r#"{"brush": {"points": [[7, 95]], "radius_m": 5}, "factor": 1}"#.to_owned(), "edits[0].brush"),
            (r#"{"brush": {"points": [[7, 46]], "radius_m": 0}, "factor": 1}"#.to_owned(), "edits[0].brush"),
            (format!(r#"{{{BRUSH}, "factor": -1}}"#), "edits[0].factor"),
            (format!(r#"{{{BRUSH}, "factor": 1e9}}"#), "edits[0].factor"),
            (format!(r#"{{{BRUSH}, "factor": 1, "add_radiance_nw_cm2_sr": 5}}"#), "edits[0].factor"),
            (format!(r#"{{{BRUSH}, "add_radiance_nw_cm2_sr": 0}}"#), "edits[0].add_radiance_nw_cm2_sr"),
            (format!(r#"{{{BRUSH}, "lamp": "candle"}}"#), "edits[0].lamp"),
            (format!(r#"{{{BRUSH}, "lamp": [0, 0, 0]}}"#), "edits[0].lamp"),
            (format!(r#"{{{BRUSH}, "lamp": {{"from": "candle", "to": "hps"}}}}"#), "edits[0].lamp.from"),
            (format!(r#"{{{BRUSH}, "lamp": {{"to": "hps", "keep": "calm"}}}}"#), "edits[0].lamp.keep"),
            (format!(r#"{{{BRUSH}, "lamp": {{"from": "hps", "to": "lps"}}, "add_radiance_nw_cm2_sr": 5}}"#), "edits[0].lamp"),
            (format!(r#"{{{BRUSH}, "emission": [-1, 0, 0]}}"#), "edits[0].emission"),
            (format!(r#"{{{BRUSH}, "emission": {{"direct_uplight": 2}}}}"#), "edits[0].emission"),
            (format!(r#"{{{BRUSH}, "emission": {{"direct_uplight": 0, "ground_reflectance": 0}}}}"#), "edits[0].emission"),
            (format!(r#"{{{BRUSH}, "emission": {{"uplight": 0}}}}"#), "body"),
            (format!(r#"{{{BRUSH}, "factor": NaN}}"#), "body"),
            (format!(r#"{{{BRUSH}, "colour": "red"}}"#), "body"),
        ] {
            let body = format!(r#"{{"edits": [{edit}]}}"#);
            assert_eq!(refused(&body), [part], "{body}");
        }
        assert_eq!(refused(r#"{"edits": []}"#), ["edits"]);
        let many = vec![format!("{{{BRUSH}, \"factor\": 0.5}}"); 101].join(",");
        assert_eq!(refused(&format!(r#"{{"edits": [{many}]}}"#)), ["body"]);
        assert_eq!(refused("{}"), ["body"]);
        assert_eq!(refused(&format!(r#"{{"base": "x", "edits": [{{{BRUSH}, "factor": 1}}]}}"#)), ["base"]);
        let title = "x".repeat(300);
        assert_eq!(
            refused(&format!(r#"{{"title": "{title}", "edits": [{{{BRUSH}, "factor": 1}}]}}"#)),
            ["title"]
        );
    }
}
