//! Requests for many skies at once: the parameters of one sky for each place, and what all have in common.

use super::{area::without_byte_order_mark, sky};
use crate::{
    error::AppError,
    facts::SourceFacts,
    parameters::{self as p, ParameterSet},
    reader::Reader,
    validation::ValidationCode,
};
use serde::Deserialize;
use serde_json::{Map, Value};
use skyglow_observatory::SkyRequest;
use skyglow_scene::{ChangeId, SceneId};
use utoipa::ToSchema;

/// Skies of a request at most.
pub const MAX_SKIES: usize = 1000;
/// Stands for the times of the places where what is common is read.
const SOME_TIME: &str = "&time=2026-01-01T00:00:00Z";
const PLACES_ALLOWED: &str =
    "1 to 1000 objects with `lat`, `lon`, and what else `GET sky` takes; `name` comes back";

/// The places, and the times that each of them is asked for.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SkiesBody {
    /// Up to 1000 places: objects with `lat` and `lon`, any other parameter of a sky but `scenario`, and a `name` that comes back.
    #[schema(value_type = Vec<Object>)]
    pub places: Vec<Map<String, Value>>,
    /// Times of each place, RFC 3339; places times times are 1000 at most.
    pub times: Option<Vec<String>>,
}

/// One of many skies: its parameters are read when its turn comes.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyOfMany {
    /// Place in the body, from 0.
    pub place: usize,
    /// The name that it came with.
    pub name: Option<String>,
    query: String,
}

/// Many skies.
#[derive(Clone, Debug)]
pub struct SkiesRequest {
    /// The scenario of all.
    pub scenario: Option<ChangeId>,
    /// The skies, place by place, each time of a place.
    pub skies: Vec<SkyOfMany>,
}

impl SkyOfMany {
    /// Reads its parameters.
    ///
    /// # Errors
    /// [`AppError::Parameters`] with every mistake.
    pub fn read(&self, scene: SceneId, facts: &SourceFacts) -> Result<SkyRequest, AppError> {
        sky(Some(&self.query), scene, facts)
    }
}

/// Reads a body of places, and the parameters that all skies have in common. What is wrong with one place is said when its turn comes.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake in what is common.
pub fn skies(
    query: Option<&str>,
    body: &[u8],
    scene: SceneId,
    facts: &SourceFacts,
) -> Result<SkiesRequest, AppError> {
    let query = query.unwrap_or_default();
    let mut reader = Reader::new(Some(query), p::SkiesParameters::ALL);
    let body = match serde_json::from_slice::<SkiesBody>(without_byte_order_mark(body)) {
        Ok(body) => body,
        Err(error) => {
            let allowed = format!("a JSON object with `places`, {PLACES_ALLOWED}, and perhaps `times`");
            reader.fail_body("body", &error, &allowed);
            return Err(refused(reader));
        }
    };
    let has_common_time = reader.text(&p::TIME).is_some();
    if has_common_time && body.times.is_some() {
        let message = "excludes `time`, which is given too";
        reader.fail_part("times", message, "one of the two", ValidationCode::Conflict);
    }
    if !reader.is_fine() {
        return Err(refused(reader));
    }
    // What is common is good or bad wherever and whenever it is.
    let has_time = body.times.is_some() || body.places.iter().any(|place| place.contains_key(p::TIME.name));
    let some_time = if has_time && !has_common_time { SOME_TIME } else { "" };
    let common = sky(Some(&format!("lat=0&lon=0{some_time}&{query}")), scene, facts)?;
    let times: Vec<Option<&str>> = match &body.times {
        Some(times) => times.iter().map(|time| Some(time.as_str())).collect(),
        None => vec![None],
    };
    let count = body.places.len().saturating_mul(times.len());
    if count == 0 || count > MAX_SKIES {
        let message = format!("{} places at {} times are {count} skies", body.places.len(), times.len());
        reader.fail_part("places", &message, &format!("1 to {MAX_SKIES} skies"), ValidationCode::NotAllowed);
        return Err(refused(reader));
    }
    let one = |(place, fields): (usize, &Map<String, Value>)| {
        let name = fields.get("name").map(text);
        let times = times.iter();
        times
            .map(move |time| SkyOfMany { place, name: name.clone(), query: query_of(query, fields, *time) })
            .collect::<Vec<_>>()
    };
    let skies = body.places.iter().enumerate().flat_map(one).collect();
    Ok(SkiesRequest { scenario: common.scenario, skies })
}

fn refused(reader: Reader) -> AppError {
    reader.finish().err().unwrap_or_else(|| AppError::internal("a body was neither read nor refused"))
}

/// The query of one sky: what is common but for what the place says itself, and the place.
fn query_of(common: &str, fields: &Map<String, Value>, time: Option<&str>) -> String {
    let mut query = form_urlencoded::Serializer::new(String::new());
    let is_own = |name: &str| fields.contains_key(name) || name == p::TIME.name && time.is_some();
    let is_height = |name: &str| name == p::HEIGHT.name || name == p::ALTITUDE.name;
    let has_height = fields.keys().any(|name| is_height(name));
    for (name, value) in form_urlencoded::parse(common.as_bytes()) {
        if !(is_own(&name) || has_height && is_height(&name)) {
            query.append_pair(&name, &value);
        }
    }
    for (name, value) in fields.iter().filter(|(name, value)| *name != "name" && !value.is_null()) {
        // One of its own would be another scene: of that name nothing is known here.
        let name = if name == p::SCENARIO.name { "scenario (in the query alone)" } else { name.as_str() };
        query.append_pair(name, &text(value));
    }
    if let Some(time) = time {
        query.append_pair(p::TIME.name, time);
    }
    query.finish()
}

/// A value as a query has it.
fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::tests::facts;
    use skyglow_observatory::ObserverHeight;

    fn scene() -> SceneId {
        SceneId::parse("demo").unwrap()
    }

    fn ask(query: &str, body: &str) -> Result<SkiesRequest, AppError> {
        skies(Some(query), body.as_bytes(), scene(), &facts())
    }

    /// Places override what is common; a mistake of one place is its own.
    #[test]
    fn places_have_parameters_of_their_own() {
        let body = r#"{"places": [{"lat": 46, "lon": 8, "name": "a"}, {"lat": 46, "lon": 8, "turbidity": 4, "altitude": 900},
                       {"lat": 99, "lon": 8}, {"lat": 46, "lon": 8, "scenario": "s-00000000000000000000"}]}"#;
        let asked = ask("turbidity=3&height=10", body).unwrap();
        let read: Vec<_> = asked.skies.iter().map(|sky| sky.read(scene(), &facts())).collect();
        let sky = read[0].as_ref().unwrap();
        assert_eq!((sky.turbidity.value(), sky.observer_height), (3.0, ObserverHeight::AboveGround(10.0)));
        let sky = read[1].as_ref().unwrap();
        assert_eq!((sky.turbidity.value(), sky.observer_height), (4.0, ObserverHeight::AboveSea(900.0)));
        assert_eq!(read[2].as_ref().unwrap_err().field_errors()[0].parameter, "lat");
        assert_eq!(read[3].as_ref().unwrap_err().field_errors()[0].code, ValidationCode::UnknownParameter);
        assert_eq!((asked.skies[0].name.as_deref(), asked.skies[1].place), (Some("a"), 1));
    }

    /// Each place at each time, place by place.
    #[test]
    fn every_place_has_every_time() {
        let body = r#"{"places": [{"lat": 46, "lon": 8}, {"lat": 47, "lon": 8}],
                       "times": ["2026-08-12T22:00:00Z", "2026-08-12T23:00:00+02:00"]}"#;
        assert!(ask("time=2026-08-12T22:00:00Z", body).is_err());
        let asked = ask("solar_flux=150", body).unwrap();
        let places: Vec<usize> = asked.skies.iter().map(|sky| sky.place).collect();
        assert_eq!(places, [0, 0, 1, 1]);
        let time = asked.skies[1].read(scene(), &facts()).unwrap().time.unwrap();
        assert_eq!(
            (time.instant.to_rfc3339().as_str(), time.solar_flux_sfu),
            ("2026-08-12T21:00:00Z", 150.0)
        );
    }

    /// What is common, and too many or no places, is refused before anything is rendered.
    #[test]
    fn bad_batches_are_refused_as_a_whole() {
        let refused = |query: &str, body: &str| match ask(query, body) {
            Err(AppError::Parameters(errors)) => errors[0].parameter.clone(),
            other => panic!("{other:?}"),
        };
        let one = r#"{"places": [{"lat": 46, "lon": 8}]}"#;
        assert_eq!(refused("turbidity=99", one), "turbidity");
        assert_eq!(refused("lat=46", one), "lat");
        assert_eq!(refused("", r#"{"places": []}"#), "places");
        assert_eq!(refused("", r#"{"sites": []}"#), "body");
        assert_eq!(refused("", "lat,lon"), "body");
        let many = format!(r#"{{"places": [{}]}}"#, vec![r#"{"lat": 46, "lon": 8}"#; 1001].join(","));
        assert_eq!(refused("", &many), "places");
    }
}
