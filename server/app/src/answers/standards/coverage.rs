//! Coverages as CoverageJSON 1.0 (OGC 21-069r2).

use super::{
    base::{CRS84, english, value_of},
    collection::unit,
    grid::LonLatGrid,
};
use crate::{
    answers::Assumptions,
    quantities::{MapQuantity, Quantity},
};
use serde::Serialize;
use serde_json::{Value, json};
use skyglow_celestial::Instant;
use skyglow_physics::SkyQuantities;
use std::collections::BTreeMap;

/// A coverage.
#[derive(Clone, Debug, Serialize)]
pub struct Coverage {
    #[serde(rename = "type")]
    kind: &'static str,
    domain: Value,
    parameters: BTreeMap<&'static str, Value>,
    ranges: BTreeMap<&'static str, NdArray>,
    /// What the numbers depend on: a member of our own, as the format allows.
    #[serde(rename = "skyglow:assumptions")]
    assumptions: Value,
}

/// Numbers along axes.
#[derive(Clone, Debug, Serialize)]
struct NdArray {
    #[serde(rename = "type")]
    kind: &'static str,
    #[serde(rename = "dataType")]
    data_type: &'static str,
    #[serde(rename = "axisNames", skip_serializing_if = "Vec::is_empty")]
    axis_names: Vec<&'static str>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    shape: Vec<usize>,
    values: Numbers,
}

/// Single precision has fewer digits to send.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
enum Numbers {
    Exact(Vec<Option<f64>>),
    Many(Vec<Option<f32>>),
}

/// The numbers of the sky of a place.
pub fn position_coverage(
    [longitude_deg, latitude_deg]: [f64; 2],
    time: Option<Instant>,
    quantities: &[&'static Quantity],
    sky: &SkyQuantities,
    assumptions: &Assumptions,
) -> Coverage {
    let mut axes = json!({"x": {"values": [longitude_deg]}, "y": {"values": [latitude_deg]}});
    let mut systems = vec![horizontal()];
    if let Some(time) = time {
        axes["t"] = json!({"values": [time.to_rfc3339()]});
        systems.push(temporal());
    }
    let range = |quantity: &&'static Quantity| {
        (quantity.name, array(&[], Vec::new(), Numbers::Exact(vec![quantity.of(sky)])))
    };
    Coverage {
        kind: "Coverage",
        domain: json!({"type": "Domain", "domainType": "Point", "axes": axes, "referencing": systems}),
        parameters: quantities.iter().map(|quantity| (quantity.name, parameter(quantity))).collect(),
        ranges: quantities.iter().map(range).collect(),
        assumptions: value_of(assumptions),
    }
}

/// The numbers of skies along a path. A trajectory has times; without them it is points, for the format has no other name for it.
///
/// * `points`: longitude and latitude of each, and when.
pub fn trajectory_coverage(
    points: &[([f64; 2], Option<Instant>)],
    quantities: &[&'static Quantity],
    skies: &[SkyQuantities],
    assumptions: &Assumptions,
) -> Coverage {
    let times: Option<Vec<Instant>> = points.iter().map(|(_, time)| *time).collect();
    let (kind, coordinates, systems) = match times {
        Some(_) => ("Trajectory", json!(["t", "x", "y"]), vec![temporal(), horizontal()]),
        None => ("MultiPoint", json!(["x", "y"]), vec![horizontal()]),
    };
    let tuple = |([longitude_deg, latitude_deg], time): &([f64; 2], Option<Instant>)| match time {
        Some(time) => json!([time.to_rfc3339(), longitude_deg, latitude_deg]),
        None => json!([longitude_deg, latitude_deg]),
    };
    let values: Vec<Value> = points.iter().map(tuple).collect();
    let axes = json!({"composite": {"dataType": "tuple", "coordinates": coordinates, "values": values}});
    let range = |quantity: &&'static Quantity| {
        let values = skies.iter().map(|sky| quantity.of(sky)).collect();
        (quantity.name, array(&["composite"], vec![skies.len()], Numbers::Exact(values)))
    };
    Coverage {
        kind: "Coverage",
        domain: json!({"type": "Domain", "domainType": kind, "axes": axes, "referencing": systems}),
        parameters: quantities.iter().map(|quantity| (quantity.name, parameter(quantity))).collect(),
        ranges: quantities.iter().map(range).collect(),
        assumptions: value_of(assumptions),
    }
}

/// The numbers of maps on a grid.
///
/// * `values`: of each quantity, row by row, None where there is none.
pub fn area_coverage(
    grid: &LonLatGrid,
    values: Vec<(&'static MapQuantity, Vec<Option<f32>>)>,
    assumptions: Value,
) -> Coverage {
    let axes = json!({"x": grid.longitude_axis(), "y": grid.latitude_axis()});
    let shape = vec![grid.rows, grid.columns];
    let described = |quantity: &'static MapQuantity| Some((quantity.name, parameter(quantity.quantity()?)));
    Coverage {
        kind: "Coverage",
        domain: json!({"type": "Domain", "domainType": "Grid", "axes": axes, "referencing": [horizontal()]}),
        parameters: values.iter().filter_map(|(quantity, _)| described(quantity)).collect(),
        ranges: values
            .into_iter()
            .map(|(quantity, values)| {
                (quantity.name, array(&["y", "x"], shape.clone(), Numbers::Many(values)))
            })
            .collect(),
        assumptions,
    }
}

fn array(axis_names: &[&'static str], shape: Vec<usize>, values: Numbers) -> NdArray {
    NdArray { kind: "NdArray", data_type: "float", axis_names: axis_names.to_vec(), shape, values }
}

fn parameter(quantity: &Quantity) -> Value {
    json!({
        "type": "Parameter",
        "description": english(quantity.description),
        "unit": unit(quantity.unit),
        "observedProperty": {"id": quantity.name, "label": english(quantity.label)},
    })
}

fn horizontal() -> Value {
    json!({"coordinates": ["x", "y"], "system": {"type": "GeographicCRS", "id": CRS84}})
}

fn temporal() -> Value {
    json!({"coordinates": ["t"], "system": {"type": "TemporalRS", "calendar": "Gregorian"}})
}
