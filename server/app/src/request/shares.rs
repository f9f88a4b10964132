//! Requests for shares in a sky: of named places, and of areas.

use super::{
    area::{BoundedArea, other_format, without_byte_order_mark},
    geojson::{BoundaryBody, FeatureBody},
    influence::{read_measure, read_region},
    sky::read_sky,
};
use crate::{
    error::AppError,
    facts::SourceFacts,
    parameters::{self as p, ParameterSet},
    reader::Reader,
    validation::ValidationCode,
};
use serde_json::{Map, Value};
use skyglow_observatory::InfluenceRequest;
use skyglow_scene::SceneId;

/// Named places listed where nobody says how many.
const DEFAULT_PLACES: usize = 50;
/// Areas of a request at most.
const MAX_AREAS: usize = 10_000;
/// Longest name that is kept, characters.
const MAX_NAME_LENGTH: usize = 200;
/// Properties that hold names where none is asked for, the first that is there counts.
const NAME_FIELDS: [&str; 13] = [
    "name",
    "name_en",
    "nom",
    "nombre",
    "nome",
    "naam",
    "namn",
    "label",
    "title",
    "municipality",
    "gemeinde",
    "commune",
    "comune",
];
/// Properties that are named to those who asked for one that is not there.
const MAX_NAMED_FIELDS: usize = 20;
const AREAS_ALLOWED: &str = "a GeoJSON FeatureCollection of Polygons or MultiPolygons in degrees, each closed, with names in their properties";

/// A request for the shares of the scene's named places.
#[derive(Clone, Debug)]
pub struct SharesRequest {
    /// Of which sky, and of what in it.
    pub request: InfluenceRequest,
    /// Places listed.
    pub limit: usize,
}

/// An area with its name.
#[derive(Clone, Debug)]
pub struct NamedArea {
    /// Its name, or `area` with its number where it has none.
    pub name: String,
    /// Where it is.
    pub area: BoundedArea,
}

/// A request for the shares of areas.
#[derive(Clone, Debug)]
pub struct AreaSharesRequest {
    /// Of which sky, and of what in it.
    pub request: InfluenceRequest,
    /// The areas, in the order of the body.
    pub areas: Vec<NamedArea>,
}

impl AreaSharesRequest {
    /// Refuses areas none of which can hold a pixel of a scene.
    ///
    /// * `bounds`: as in [`BoundedArea::check_within`].
    ///
    /// # Errors
    /// [`AppError::Parameters`].
    pub fn check_within(&self, bounds: [f64; 4]) -> Result<(), AppError> {
        if self.areas.iter().any(|area| area.area.check_within(bounds).is_ok()) {
            return Ok(());
        }
        self.areas.first().map_or(Ok(()), |area| area.area.check_within(bounds))
    }
}

/// Reads the parameters of shares by named places.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn shares(query: Option<&str>, scene: SceneId, facts: &SourceFacts) -> Result<SharesRequest, AppError> {
    let mut reader = Reader::new(query, p::SharesParameters::ALL);
    let request = read_shared(&mut reader, scene, facts);
    let limit = reader.integer(&p::LISTED_PLACES).map_or(DEFAULT_PLACES, |limit| limit as usize);
    reader.finish()?;
    let request = request.ok_or_else(|| AppError::internal("shares were neither read nor refused"))?;
    Ok(SharesRequest { request, limit })
}

/// Reads the parameters of shares by areas, and the areas from a body of GeoJSON.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn area_shares(
    query: Option<&str>,
    body: &[u8],
    scene: SceneId,
    facts: &SourceFacts,
) -> Result<AreaSharesRequest, AppError> {
    let mut reader = Reader::new(query, p::AreaSharesParameters::ALL);
    let request = read_shared(&mut reader, scene, facts);
    let areas = read_areas(&mut reader, body);
    reader.finish()?;
    let request = request.ok_or_else(|| AppError::internal("shares were neither read nor refused"))?;
    Ok(AreaSharesRequest { request, areas })
}

fn read_shared(reader: &mut Reader, scene: SceneId, facts: &SourceFacts) -> Option<InfluenceRequest> {
    let sky = read_sky(reader, scene, facts);
    let region = read_region(reader, None);
    let measure = region.and_then(|region| read_measure(reader, &p::SHARED_MEASURE, region));
    Some(InfluenceRequest { sky: sky?, measure: measure? })
}

fn read_areas(reader: &mut Reader, body: &[u8]) -> Vec<NamedArea> {
    let features = match area_features(body) {
        Ok(features) => features,
        Err(error) => {
            reader.fail_body("body", &other_format(body).unwrap_or_else(|| error.to_string()), AREAS_ALLOWED);
            return Vec::new();
        }
    };
    if features.is_empty() || features.len() > MAX_AREAS {
        let message = format!("it has {} features", features.len());
        reader.fail_part("body", &message, &format!("1 to {MAX_AREAS} features"), ValidationCode::NotAllowed);
        return Vec::new();
    }
    let field = reader.text(&p::NAME_FIELD).map(str::to_owned);
    if let Some(field) = &field
        && !features.iter().any(|feature| feature.properties.contains_key(field))
    {
        let mut names: Vec<&str> =
            features.iter().flat_map(|f| f.properties.keys()).map(String::as_str).collect();
        names.sort_unstable();
        names.dedup();
        names.truncate(MAX_NAMED_FIELDS);
        let message = Some("is a property of no feature".to_owned());
        let allowed =
            if names.is_empty() { "features here have no properties".to_owned() } else { names.join(", ") };
        reader.fail(&p::NAME_FIELD, ValidationCode::NotAllowed, message, Some(allowed));
    }
    let mut areas = Vec::with_capacity(features.len());
    for (number, FeatureBody { properties, area }) in (1..).zip(features) {
        let name = name(&properties, field.as_deref()).unwrap_or_else(|| format!("area {number}"));
        match BoundedArea::new(&area) {
            Ok(area) => areas.push(NamedArea { name, area }),
            Err(reason) => {
                let part = format!("features[{}]", number - 1);
                reader.fail_body(&part, &format!("\"{name}\": {reason}"), AREAS_ALLOWED);
            }
        }
    }
    areas
}

/// The features of a body that [`area_shares`] took, in their order.
///
/// # Errors
/// Only where it would not have taken it.
pub fn area_features(body: &[u8]) -> Result<Vec<FeatureBody>, serde_json::Error> {
    Ok(serde_json::from_slice::<BoundaryBody>(without_byte_order_mark(body))?.into_features())
}

/// The name of a feature: that of the field asked for, or of the usual ones the first that it has.
fn name(properties: &Map<String, Value>, field: Option<&str>) -> Option<String> {
    let value = match field {
        Some(field) => properties.get(field),
        None => NAME_FIELDS.iter().find_map(|usual| {
            let is_one = |(key, value): &(&String, &Value)| key.to_lowercase() == *usual && !value.is_null();
            properties.iter().find(is_one).map(|(_, value)| value)
        }),
    };
    let name = match value? {
        Value::String(text) => text.trim().to_owned(),
        Value::Number(number) => number.to_string(),
        _ => return None,
    };
    (!name.is_empty()).then(|| name.chars().take(MAX_NAME_LENGTH).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::tests::facts;
    use serde_json::json;
    use skyglow_observatory::Measure;

    fn square(west: f64, properties: Value) -> Value {
        let ring = [[west, 46.0], [west + 1.0, 46.0], [west + 1.0, 47.0], [west, 47.0], [west, 46.0]];
        json!({"type": "Feature", "properties": properties,
               "geometry": {"type": "Polygon", "coordinates": [ring]}})
    }

    fn ask(query: &str, body: &Value) -> Result<AreaSharesRequest, AppError> {
        let scene = SceneId::parse("demo").unwrap();
        let query = format!("lat=46.1&lon=8.8&{query}");
        area_shares(Some(&query), body.to_string().as_bytes(), scene, &facts())
    }

    fn names(query: &str, features: &[Value]) -> Vec<String> {
        let body = json!({"type": "FeatureCollection", "features": features});
        ask(query, &body).unwrap().areas.into_iter().map(|area| area.name).collect()
    }

    /// Names are found in any case, by the field asked for, and made up by number where there are none.
    #[test]
    fn areas_keep_their_names() {
        let features = [
            square(8.0, json!({"NAME": "Locarno", "code": 5113})),
            square(9.0, json!({"nom": "Ascona", "name": null, "code": 5091})),
            square(10.0, json!({"code": 5091})),
        ];
        assert_eq!(names("", &features), ["Locarno", "Ascona", "area 3"]);
        assert_eq!(names("name_field=code", &features), ["5113", "5091", "5091"]);
        assert_eq!(names("name_field=NAME", &features), ["Locarno", "area 2", "area 3"]);
        assert_eq!(ask("", &square(8.0, Value::Null)["geometry"]).unwrap().areas[0].name, "area 1");
        assert_eq!(ask("measure=mean", &features[0]).unwrap().request.measure, Measure::Mean);
    }

    /// What cannot be meant is refused by the number of its feature, and a field that is none with those that there are.
    #[test]
    fn areas_that_are_none_are_refused() {
        let refused = |query: &str, body: Value| match ask(query, &body) {
            Err(AppError::Parameters(errors)) => (errors[0].parameter.clone(), errors[0].allowed.clone()),
            other => panic!("{other:?}"),
        };
        let collection = |features: Value| json!({"type": "FeatureCollection", "features": features});
        let point = json!({"type": "Feature", "properties": {},
                           "geometry": {"type": "Point", "coordinates": [8, 46]}});
        assert_eq!(refused("", collection(json!([square(8.0, json!({})), point]))).0, "features[1]");
        assert_eq!(refused("", collection(json!([]))), ("body".to_owned(), "1 to 10000 features".to_owned()));
        assert_eq!(refused("", json!([])).0, "body");
        let one = collection(json!([square(8.0, json!({"GEN": "Bern", "AGS": 351}))]));
        assert_eq!(refused("name_field=name", one.clone()), ("name_field".to_owned(), "AGS, GEN".to_owned()));
        assert_eq!(refused("measure=norm", one).0, "measure");
    }

    #[test]
    fn fifty_places_are_listed_unless_said() {
        let scene = || SceneId::parse("demo").unwrap();
        let ask = |query: &str| shares(Some(query), scene(), &facts());
        assert_eq!(ask("lat=46&lon=8").unwrap().limit, 50);
        assert_eq!(p::LISTED_PLACES.default, "50");
        assert_eq!(ask("lat=46&lon=8&limit=3").unwrap().limit, 3);
        assert!(ask("lat=46&lon=8&measure=norm").is_err() && ask("lat=46&lon=8&limit=0").is_err());
    }
}
