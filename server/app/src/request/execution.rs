//! Executions of processes (OGC API – Processes 18-062r2): their inputs become the query and the body of the request that does it.

use super::{area::without_byte_order_mark, reference::value_at};
use crate::{
    error::AppError,
    parameters::{InfluenceParameters, Parameter, ParameterSet, PlanParameters},
    validation::{FieldError, ValidationCode, echo, message_with_echo},
};
use serde::Deserialize;
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// What can be executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Process {
    /// Which lights cause the sky of a place.
    Influence,
    /// What to dim.
    Plan,
}

impl Process {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Influence, Self::Plan];

    /// The process of an id.
    pub fn of_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|process| process.id() == id)
    }

    /// Its id.
    pub fn id(self) -> &'static str {
        match self {
            Self::Influence => "influence",
            Self::Plan => "plan",
        }
    }

    /// The name of its only output.
    pub fn output(self) -> &'static str {
        match self {
            Self::Influence => "influences",
            Self::Plan => "plan",
        }
    }

    /// Inputs that are parameters of a query elsewhere.
    pub fn parameters(self) -> &'static [Parameter] {
        match self {
            Self::Influence => InfluenceParameters::ALL,
            Self::Plan => PlanParameters::ALL,
        }
    }

    /// Inputs that are fields of a body elsewhere: name and meaning. What is both is a parameter where it is text.
    pub fn fields(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Influence => {
                &[("boundary", "A GeoJSON Polygon or MultiPolygon whose part of the influences is summed up")]
            }
            Self::Plan => &[
                ("method", "`threshold` or `target`"),
                ("site", "Of `threshold`: the site, with `lat` and `lon`"),
                ("measure", "Of `threshold`: `norm`, `zenith`, `mean`, `horizontal` or `region`"),
                (
                    "region",
                    "Of `threshold`: corners [azimuth_deg, elevation_deg] of a closed curve on the sky",
                ),
                (
                    "q_a",
                    "Of `threshold`: pixels of less influence are left alone; a number or a percentile such as \"p90\"",
                ),
                ("q_b", "Of `threshold`: pixels of more influence are cut by `gamma`"),
                ("gamma", "Of `threshold`: the part of the most influential lights that goes, 0 to 1"),
                ("sites", "Of `target`: 1 to 16 sites with what each wants"),
                ("max_cut", "Of `target`: the largest part of a light that may go, 0 to 1"),
                ("protect", "Of `target`: lights in these GeoJSON polygons are left alone"),
            ],
        }
    }

    /// Inputs that must be given, beside the scene.
    pub fn required(self) -> &'static [&'static str] {
        match self {
            Self::Influence => &["lat", "lon"],
            Self::Plan => &["method"],
        }
    }
}

/// What a process is executed with.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ExecutionBody {
    /// The inputs by their names: values, objects with a `value`, or with an `href` whose scheme is `data`.
    #[schema(value_type = Object)]
    pub inputs: Map<String, Value>,
    /// The outputs that are wanted; there is one.
    #[serde(default)]
    #[schema(value_type = Option<Object>)]
    pub outputs: Option<Map<String, Value>>,
    /// `raw` for the output itself (the default), `document` for an object that names it.
    #[serde(default)]
    #[schema(pattern = "^(raw|document)$")]
    pub response: Option<String>,
}

/// An execution as the request that does it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Execution {
    /// The scene's id as it came.
    pub scene: String,
    /// The query.
    pub query: String,
    /// The body, JSON.
    pub body: Vec<u8>,
    /// Whether the answer is an object that names the output.
    pub as_document: bool,
}

/// Reads what a process is executed with. Plans are made without being kept.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake that the request itself does not find.
pub fn execution(process: Process, bytes: &[u8]) -> Result<Execution, AppError> {
    let body: ExecutionBody = serde_json::from_slice(without_byte_order_mark(bytes)).map_err(|error| {
        let allowed = "a JSON object with `inputs`, and perhaps `outputs` and `response`";
        refused(vec![mistake("body", None, &error.to_string(), allowed, ValidationCode::Malformed)])
    })?;
    let mut mistakes = Vec::new();
    let as_document = match body.response.as_deref() {
        None | Some("raw") => false,
        Some("document") => true,
        Some(other) => {
            let message = "is no form of an answer";
            mistakes.push(mistake(
                "response",
                Some(other),
                message,
                "raw, document",
                ValidationCode::NotAllowed,
            ));
            false
        }
    };
    check_outputs(process, body.outputs.as_ref(), &mut mistakes);
    let mut query = form_urlencoded::Serializer::new(String::new());
    let (mut scene, mut fields) = (None, Map::new());
    for (name, value) in body.inputs {
        let value = match value_of(value) {
            Ok(value) => value,
            Err(message) => {
                mistakes.push(mistake(&name, None, message, "a value", ValidationCode::NotAllowed));
                continue;
            }
        };
        let is_parameter = process.parameters().iter().any(|parameter| parameter.name == name);
        let is_field = process.fields().iter().any(|(field, _)| *field == name);
        match value {
            Value::Null => {}
            Value::String(id) if name == "scene" => scene = Some(id),
            // A curve on the sky is text in a query and a list in a body.
            value @ Value::Array(_) if is_field || name == "region" => drop(fields.insert(name, value)),
            Value::String(text) if is_parameter => drop(query.append_pair(&name, &text)),
            value @ (Value::Number(_) | Value::Bool(_)) if is_parameter => {
                query.append_pair(&name, &value.to_string());
            }
            value if is_field => drop(fields.insert(name, value)),
            value => {
                let of_another_kind = is_parameter || name == "scene";
                let (code, message) = match of_another_kind {
                    true => (ValidationCode::Malformed, "is no text and no number"),
                    false => {
                        (ValidationCode::UnknownParameter, ValidationCode::UnknownParameter.description())
                    }
                };
                let names = inputs(process).join(", ");
                mistakes.push(mistake(&echo(&name), Some(&value.to_string()), message, &names, code));
            }
        }
    }
    let Some(scene) = scene.filter(|_| mistakes.is_empty()) else {
        if mistakes.is_empty() {
            let allowed = "the id of a collection";
            mistakes.push(mistake("scene", None, "is required", allowed, ValidationCode::Missing));
        }
        return Err(refused(mistakes));
    };
    let body = serde_json::to_vec(&fields).map_err(AppError::internal)?;
    if process == Process::Plan {
        query.append_pair("keep", "off");
    }
    Ok(Execution { scene, query: query.finish(), body, as_document })
}

/// The names of all inputs.
fn inputs(process: Process) -> Vec<&'static str> {
    let names = process.parameters().iter().map(|parameter| parameter.name);
    let names = names.chain(process.fields().iter().map(|(name, _)| *name));
    std::iter::once("scene").chain(names).collect()
}

/// An input's value, which may stand in an object that describes it or refers to it.
fn value_of(value: Value) -> Result<Value, &'static str> {
    let Value::Object(mut fields) = value else { return Ok(value) };
    if let Some(href) = fields.get("href") {
        return value_at(href.as_str().unwrap_or_default());
    }
    let describes = |name: &String| ["value", "mediaType", "encoding", "schema"].contains(&name.as_str());
    if fields.contains_key("value") && fields.keys().all(describes) {
        return Ok(fields.remove("value").unwrap_or_default());
    }
    Ok(Value::Object(fields))
}

fn check_outputs(process: Process, outputs: Option<&Map<String, Value>>, mistakes: &mut Vec<FieldError>) {
    for (name, wanted) in outputs.into_iter().flatten() {
        if name != process.output() {
            let message = "is no output of this process";
            mistakes.push(mistake(
                "outputs",
                Some(name),
                message,
                process.output(),
                ValidationCode::NotAllowed,
            ));
        }
        let mode = wanted.get("transmissionMode").and_then(Value::as_str);
        if let Some(other) = mode.filter(|mode| *mode != "value") {
            let message = "outputs are sent as values alone";
            mistakes.push(mistake(
                "transmissionMode",
                Some(other),
                message,
                "value",
                ValidationCode::NotAllowed,
            ));
        }
    }
}

fn mistake(
    parameter: &str,
    value: Option<&str>,
    message: &str,
    allowed: &str,
    code: ValidationCode,
) -> FieldError {
    FieldError {
        parameter: parameter.to_owned(),
        value: value.map(echo),
        allowed: allowed.to_owned(),
        message: message_with_echo(message),
        code,
    }
}

fn refused(mistakes: Vec<FieldError>) -> AppError {
    AppError::Parameters(mistakes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn read(process: Process, body: &Value) -> Result<Execution, AppError> {
        execution(process, body.to_string().as_bytes())
    }

    #[test]
    fn inputs_become_a_query_and_a_body() {
        let square = json!({"type": "Polygon", "coordinates": [[[8, 46], [9, 46], [9, 47], [8, 46]]]});
        let inputs = json!({"scene": "demo", "lat": 46.5, "lon": "8.6", "measure": "horizontal", "boundary": {"value": square}});
        let asked = read(Process::Influence, &json!({"inputs": inputs, "response": "document"})).unwrap();
        assert_eq!((asked.scene.as_str(), asked.as_document), ("demo", true));
        assert_eq!(asked.query, "lat=46.5&lon=8.6&measure=horizontal");
        assert_eq!(serde_json::from_slice::<Value>(&asked.body).unwrap(), json!({ "boundary": square }));
        let inputs = json!({"scene": {"href": "data:,demo"}, "lat": {"href": "data:application/json,46.5"}, "lon": 8.6});
        assert_eq!(read(Process::Influence, &json!({"inputs": inputs})).unwrap().query, "lat=46.5&lon=8.6");
        let curve = json!([[0, 20], [90, 20], [45, 60]]);
        let inputs = json!({"scene": "demo", "lat": 46.5, "lon": 8.6, "region": curve});
        assert_eq!(
            read(Process::Influence, &json!({"inputs": inputs})).unwrap().body,
            json!({"region": curve}).to_string().as_bytes()
        );
        let sites = json!([{"lat": 46.5, "lon": 8.6, "reduce_by": 0.3}]);
        let inputs = json!({"scene": "demo", "method": "target", "sites": sites, "turbidity": 3});
        let plan = read(
            Process::Plan,
            &json!({"inputs": inputs, "outputs": {"plan": {"transmissionMode": "value"}}}),
        )
        .unwrap();
        assert_eq!((plan.query.as_str(), plan.as_document), ("turbidity=3&keep=off", false));
    }

    #[test]
    fn what_cannot_be_executed_is_named() {
        let refused = |body: Value| {
            let refused = read(Process::Plan, &body).unwrap_err();
            refused
                .field_errors()
                .iter()
                .map(|error| (error.parameter.clone(), error.code))
                .collect::<Vec<_>>()
        };
        let named = |name: &str, code| vec![(name.to_owned(), code)];
        assert_eq!(refused(json!([])), named("body", ValidationCode::Malformed));
        assert_eq!(refused(json!({"inputs": {}})), named("scene", ValidationCode::Missing));
        let scene = |more: Value| json!({"inputs": {"scene": "demo", "x": more}});
        assert_eq!(refused(scene(json!(1))), named("x", ValidationCode::UnknownParameter));
        assert_eq!(
            refused(scene(json!({"href": "http://example.org"}))),
            named("x", ValidationCode::NotAllowed)
        );
        let inputs = json!({"scene": "demo"});
        let outputs = json!({"map": {"transmissionMode": "reference"}});
        let both = refused(json!({"inputs": inputs, "outputs": outputs, "response": "xml"}));
        let names: Vec<&str> = both.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["response", "outputs", "transmissionMode"]);
        // Nobody has a plan kept in this way.
        assert_eq!(
            refused(json!({"inputs": {"scene": "demo", "keep": "on"}})),
            named("keep", ValidationCode::UnknownParameter)
        );
    }
}
