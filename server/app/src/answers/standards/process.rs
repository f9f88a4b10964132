//! Documents of OGC API – Processes (18-062r2).

use super::base::{Base, JSON, OGC_REL, link, value_of};
use crate::request::Process;
use serde_json::{Map, Value, json};

fn words(process: Process) -> (&'static str, &'static str) {
    match process {
        Process::Influence => (
            "Whose light it is",
            "Which lights cause the sky of a place: the most influential pixels, and all by distance and azimuth",
        ),
        Process::Plan => (
            "What to dim",
            "A reduction plan: by how influential lights are on a site, or the least flux such that sites meet limits. It is held for \
             some ten minutes after it was last asked for, and its id is a `scenario` of any query; `POST …/plans` keeps one",
        ),
    }
}

fn summary(base: &Base, process: Process) -> Map<String, Value> {
    let path = base.ogc(&format!("/processes/{}", process.id()));
    let (title, description) = words(process);
    let summary = json!({
        "id": process.id(), "title": title, "description": description, "version": env!("CARGO_PKG_VERSION"),
        "jobControlOptions": ["sync-execute", "async-execute"], "outputTransmission": ["value"],
        "links": [
            link(&path, "self", JSON, "The process"),
            link(&format!("{path}/execution"), &format!("{OGC_REL}/execute"), JSON, "Where it is executed"),
        ],
    });
    summary.as_object().cloned().unwrap_or_default()
}

/// The list of processes.
///
/// * `limit`: of them at most.
pub fn process_list(base: &Base, limit: usize) -> Value {
    let processes: Vec<_> =
        Process::ALL.into_iter().take(limit).map(|process| summary(base, process)).collect();
    json!({
        "processes": processes,
        "links": [link(&base.ogc("/processes"), "self", JSON, "This document")],
    })
}

/// A process with its inputs and its output.
pub fn process_description(base: &Base, process: Process) -> Value {
    let input = |name: &str, description: &str, schema: Value| {
        let least = u8::from(name == "scene" || process.required().contains(&name));
        (
            name.to_owned(),
            json!({"title": name, "description": description, "minOccurs": least, "schema": schema}),
        )
    };
    let scene = input("scene", "The id of a collection", json!({"type": "string"}));
    let parameters = process.parameters().iter().map(|parameter| {
        let words = format!("{} Allowed: {}.", parameter.description, parameter.allowed());
        let schema = parameter.openapi().schema.map(|schema| value_of(&schema)).unwrap_or_default();
        input(parameter.name, &words, schema)
    });
    let of_field = |name: &str| match name {
        "method" | "measure" => json!({"type": "string"}),
        "gamma" | "max_cut" => json!({"type": "number", "minimum": 0, "maximum": 1}),
        "sites" | "region" => json!({"type": "array", "items": {}}),
        "q_a" | "q_b" => json!({"oneOf": [{"type": "number"}, {"type": "string"}]}),
        "boundary" | "protect" => json!({"type": "object", "format": "geojson-geometry"}),
        _ => json!({"type": "object"}),
    };
    let fields = process.fields().iter().map(|(name, words)| input(name, words, of_field(name)));
    let inputs: Map<String, Value> = std::iter::once(scene).chain(parameters).chain(fields).collect();
    let mut description = summary(base, process);
    let output = json!({
        "title": process.output(),
        "description": match process {
            Process::Influence => "An InfluenceAnswer of the OpenAPI document",
            Process::Plan => "A PlanAnswer of the OpenAPI document",
        },
        "schema": {"type": "object", "contentMediaType": JSON},
    });
    description.insert("inputs".to_owned(), Value::Object(inputs));
    description.insert("outputs".to_owned(), json!({ process.output(): output }));
    Value::Object(description)
}

/// How a job stands.
///
/// * `status`: `accepted`, `running`, `successful`, `failed` or `dismissed`.
/// * `done`: the part that is done, 0 to 1.
pub fn status_info(base: &Base, job: &str, status: &str, done: f64) -> Value {
    let path = base.ogc(&format!("/jobs/{job}"));
    let results = match status {
        "successful" => Some("results"),
        "failed" => Some("exceptions"),
        _ => None,
    };
    let result_link =
        results.map(|rel| link(&format!("{path}/results"), &format!("{OGC_REL}/{rel}"), JSON, rel));
    let links: Vec<Value> =
        std::iter::once(link(&path, "self", JSON, "This document")).chain(result_link).collect();
    json!({
        "jobID": job, "type": "process", "status": status, "progress": (100.0 * done.clamp(0.0, 1.0)).floor() as u8,
        "links": links,
    })
}
