//! Requests for influences: of which sky, of what in it, and whose.

use super::{
    area::{BoundedArea, other_format, without_byte_order_mark},
    points::curve_schema,
    sky::read_sky,
};
use crate::{
    accept::InfluenceFormat,
    error::AppError,
    facts::SourceFacts,
    parameters::{self as p, Parameter, ParameterSet},
    reader::Reader,
    request::geojson::BoundaryBody,
    validation::{FieldError, ValidationCode, message_with_echo},
};
use serde::{Deserialize, de::DeserializeOwned};
use skyglow_observatory::{InfluenceRequest, Measure};
use skyglow_physics::{Direction, PhysicsError, SkyCurve};
use skyglow_scene::SceneId;
use std::fmt::Display;
use utoipa::ToSchema;

/// Pixels listed where nobody says how many.
pub(super) const DEFAULT_LIMIT: usize = 100;

/// What a body may say beside the query.
#[derive(Clone, Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct InfluenceBody {
    /// A closed curve on the sky, corner by corner as `[azimuth_deg, elevation_deg]`; instead of the query's `region`.
    #[schema(schema_with = curve_schema)]
    pub region: Option<Vec<[f64; 2]>>,
    /// An area, as a GeoJSON Polygon or MultiPolygon, or a Feature or FeatureCollection of such: how much of the measure comes
    /// from inside it.
    #[schema(value_type = Option<Object>)]
    pub boundary: Option<BoundaryBody>,
}

/// A request for influences.
#[derive(Clone, Debug)]
pub struct InfluenceListRequest {
    /// Of which sky, and of what in it.
    pub request: InfluenceRequest,
    /// Pixels listed.
    pub limit: usize,
    /// Whose share is asked for.
    pub boundary: Option<BoundedArea>,
}

/// Reads the parameters of influences, and a body where there is one.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn influence(
    query: Option<&str>,
    body: Option<&[u8]>,
    scene: SceneId,
    facts: &SourceFacts,
    format: InfluenceFormat,
) -> Result<InfluenceListRequest, AppError> {
    let known =
        if format.is_list() { p::InfluenceParameters::ALL } else { p::InfluenceRasterParameters::ALL };
    let mut reader = Reader::new(query, known);
    let body = match body {
        Some(bytes) => body_of(bytes, &mut reader, "a JSON object with `region`, `boundary` or both"),
        None => InfluenceBody::default(),
    };
    let sky = read_sky(&mut reader, scene, facts);
    let region = read_region(&mut reader, body.region);
    let measure = region.and_then(|region| read_measure(&mut reader, &p::MEASURE, region));
    let limit = reader.integer(&p::LIMIT).map_or(DEFAULT_LIMIT, |limit| limit as usize);
    let boundary = body.boundary.and_then(|body| match BoundedArea::new(&body) {
        Ok(boundary) => Some(boundary),
        Err(reason) => {
            reader.fail_body(
                "boundary",
                &reason,
                "a GeoJSON Polygon or MultiPolygon in degrees, closed rings",
            );
            None
        }
    });
    if boundary.is_some() && !format.has_room_for_sums() {
        let message = format!("means nothing for {}", format.media_type());
        let allowed = "nothing here; JSON and GeoJSON sum it up";
        reader.fail_part("boundary", &message, allowed, ValidationCode::UnknownParameter);
    }
    reader.finish()?;
    let read = sky.zip(measure).ok_or_else(|| AppError::internal("influences were neither read nor refused"));
    let (sky, measure) = read?;
    Ok(InfluenceListRequest { request: InfluenceRequest { sky, measure }, limit, boundary })
}

/// A body from JSON; empty where it is refused.
pub(super) fn body_of<T: DeserializeOwned + Default>(bytes: &[u8], reader: &mut Reader, allowed: &str) -> T {
    serde_json::from_slice(without_byte_order_mark(bytes)).unwrap_or_else(|error| {
        reader.fail_body("body", &other_format(bytes).unwrap_or_else(|| error.to_string()), allowed);
        T::default()
    })
}

/// The curve of the body, or that of the query; None where one was refused.
pub(super) fn read_region(reader: &mut Reader, body: Option<Vec<[f64; 2]>>) -> Option<Option<SkyCurve>> {
    let text = reader.text(&p::REGION).map(str::to_owned);
    if body.is_some() && text.is_some() {
        let message = Some("is in the body too".to_owned());
        reader.fail(&p::REGION, ValidationCode::Conflict, message, Some("one of the two".to_owned()));
        return None;
    }
    if let Some(text) = text {
        let corners: Option<Vec<[f64; 2]>> = text.split(';').map(two_numbers).collect();
        let refused = match corners.map(curve) {
            Some(Ok(curve)) => return Some(Some(curve)),
            Some(Err(reason)) => Some(reason),
            None => None,
        };
        reader.fail(&p::REGION, ValidationCode::Malformed, refused, None);
        return None;
    }
    match body.map(curve).transpose() {
        Ok(region) => Some(region),
        Err(error) => {
            reader.fail_body(p::REGION.name, &error, &p::REGION.allowed());
            None
        }
    }
}

/// The curve through corners in degrees, or why there is none.
pub(super) fn curve(corners_deg: Vec<[f64; 2]>) -> Result<SkyCurve, String> {
    let outside = |[_, elevation_deg]: &[f64; 2]| !(0.0..=90.0).contains(elevation_deg);
    if let Some(which) = corners_deg.iter().position(outside) {
        return Err(format!("the elevation of corner {} is {} degrees", which + 1, corners_deg[which][1]));
    }
    let direction = |[azimuth_deg, elevation_deg]: [f64; 2]| Direction {
        azimuth_rad: azimuth_deg.to_radians(),
        elevation_rad: elevation_deg.to_radians(),
    };
    SkyCurve::new(corners_deg.into_iter().map(direction).collect()).map_err(|error| match error {
        PhysicsError::Invalid { reason, .. } => reason,
        PhysicsError::OutOfRange { .. } => error.to_string(),
    })
}

/// `azimuth,elevation`.
fn two_numbers(text: &str) -> Option<[f64; 2]> {
    let (azimuth, elevation) = text.split_once(',')?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    Some([number(azimuth)?, number(elevation)?])
}

/// What lights have their part in, of those that a parameter knows.
pub(super) fn read_measure(
    reader: &mut Reader,
    parameter: &Parameter,
    region: Option<SkyCurve>,
) -> Option<Measure> {
    let name = reader.choice(parameter);
    if name.is_some_and(|name| name != "region") && region.is_some() {
        let message = Some("a region is given, and this measure takes none".to_owned());
        reader.fail(parameter, ValidationCode::Conflict, message, Some("region".to_owned()));
        return None;
    }
    Some(match (name, region) {
        (None | Some("region"), Some(curve)) => Measure::Region(curve),
        (Some("norm"), _) => Measure::Norm,
        (Some("mean"), _) => Measure::Mean,
        (Some("horizontal"), _) => Measure::Horizontal,
        (Some("region"), None) => {
            let message = Some("needs the parameter `region`, or a body with one".to_owned());
            reader.fail(parameter, ValidationCode::Missing, message, None);
            return None;
        }
        _ => Measure::Zenith,
    })
}

impl Reader {
    /// Notes a part of the body that cannot be read.
    pub(super) fn fail_body(&mut self, name: &str, reason: &impl Display, allowed: &str) {
        self.fail_part(name, &reason.to_string(), allowed, ValidationCode::Malformed);
    }

    /// Notes a mistake in a part of the body.
    pub(super) fn fail_part(&mut self, name: &str, message: &str, allowed: &str, code: ValidationCode) {
        self.fail_field(FieldError {
            parameter: name.to_owned(),
            value: None,
            allowed: allowed.to_owned(),
            message: message_with_echo(message),
            code,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::tests::facts;

    fn ask(query: &str, body: Option<&str>) -> Result<InfluenceListRequest, AppError> {
        let query = format!("lat=-1.3&lon=36.8&{query}");
        let scene = SceneId::parse("demo").unwrap();
        influence(Some(&query), body.map(str::as_bytes), scene, &facts(), InfluenceFormat::Json)
    }

    fn refused(query: &str, body: Option<&str>) -> Vec<(String, ValidationCode)> {
        match ask(query, body) {
            Err(AppError::Parameters(errors)) => {
                errors.into_iter().map(|error| (error.parameter, error.code)).collect()
            }
            other => panic!("{query} {body:?}: {other:?}"),
        }
    }

    /// The measure is the zenith and with a region the region.
    #[test]
    fn the_default_measure_is_zenith_or_region() {
        assert_eq!(ask("", None).unwrap().request.measure, Measure::Zenith);
        assert_eq!(ask("measure=norm", None).unwrap().request.measure, Measure::Norm);
        let by_query = ask("region=10,20;50,20;30,60", None).unwrap().request;
        let by_body = ask("", Some(r#"{"region": [[10, 20], [50, 20], [30, 60]]}"#)).unwrap().request;
        assert_eq!(by_query, by_body);
        assert!(matches!(by_query.measure, Measure::Region(_)));
        assert_eq!(ask("limit=7", None).unwrap().limit, 7);
    }

    /// Bodies that cannot be meant are refused by the name of their part.
    #[test]
    fn a_wrong_body_is_refused_by_its_part() {
        for (query, body, name, code) in [
            ("", Some("{"), "body", ValidationCode::Malformed),
            ("", Some("[]"), "body", ValidationCode::Malformed),
            ("", Some(r#"{"regoin": []}"#), "body", ValidationCode::Malformed),
            ("", Some(r#"{"region": [[10, 20], [50, 20]]}"#), "region", ValidationCode::Malformed),
            ("", Some(r#"{"region": [[10, 20], [50, 20, 3], [1, 2]]}"#), "body", ValidationCode::Malformed),
            ("", Some(r#"{"region": [[10, 20], [50, -20], [30, 60]]}"#), "region", ValidationCode::Malformed),
            ("", Some(r#"{"region": [[10, 20], [NaN, 20], [30, 60]]}"#), "body", ValidationCode::Malformed),
            ("region=10,20;50,20", None, "region", ValidationCode::Malformed),
            ("region=10,20;50,NaN;1,2", None, "region", ValidationCode::Malformed),
            ("region=a;b;c", None, "region", ValidationCode::Malformed),
            ("measure=region", None, "measure", ValidationCode::Missing),
            ("measure=zenith&region=10,20;50,20;30,60", None, "measure", ValidationCode::Conflict),
            (
                "region=1,2;3,4;5,60",
                Some(r#"{"region": [[10, 20], [50, 20], [30, 60]]}"#),
                "region",
                ValidationCode::Conflict,
            ),
            (
                "",
                Some(r#"{"boundary": {"type": "Point", "coordinates": [7, 46]}}"#),
                "boundary",
                ValidationCode::Malformed,
            ),
            (
                "",
                Some(r#"{"boundary": {"type": "Polygon", "coordinates": []}}"#),
                "boundary",
                ValidationCode::Malformed,
            ),
            (
                "",
                Some(r#"{"boundary": {"type": "Polygon", "coordinates": [[[7, 46], [8, 46], [8, 47]]]}}"#),
                "boundary",
                ValidationCode::Malformed,
            ),
        ] {
            assert_eq!(refused(query, body), [(name.to_owned(), code)], "{query} {body:?}");
        }
    }
}
