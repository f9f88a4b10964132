//! What those who run the server see: readiness, counters, and whether dashboard and alerts ask for what is there.

use crate::server::{Server, header};
use serde_json::json;
use skyglow_app::facts::LeftOut;
use skyglow_http::metrics::REFUSAL_REASONS;
use std::collections::BTreeMap;

const DASHBOARD: &str = include_str!("../../../../deploy/grafana/skyglow.json");
const ALERTS: &str = include_str!("../../../../deploy/grafana/alerts.yaml");

/// The labels of each sample of a scrape, by the sample's name.
fn samples(metrics: &str) -> BTreeMap<&str, Vec<BTreeMap<&str, &str>>> {
    let mut samples = BTreeMap::<_, Vec<_>>::new();
    for line in metrics.lines().filter(|line| !line.starts_with('#')) {
        let (series, _) = line.rsplit_once(' ').unwrap();
        let (name, labels) = series.split_once('{').unwrap_or((series, ""));
        samples.entry(name).or_default().push(pairs(labels.trim_end_matches('}')));
    }
    samples
}

/// `a="b",c="d"`
fn pairs(labels: &str) -> BTreeMap<&str, &str> {
    let pairs = labels.split(',').filter_map(|pair| pair.split_once('='));
    pairs.map(|(name, value)| (name.trim(), value.trim().trim_matches('"'))).collect()
}

/// The expressions of both files, as Prometheus reads them.
fn expressions() -> Vec<String> {
    let dashboard: serde_json::Value = serde_json::from_str(DASHBOARD).unwrap();
    let panels = dashboard["panels"].as_array().unwrap().iter();
    let targets = panels.flat_map(|panel| panel["targets"].as_array().unwrap());
    let shown = targets.map(|target| target["expr"].as_str().unwrap().to_owned());
    let alerts = ALERTS.lines().filter_map(|line| line.trim().strip_prefix("expr: ")).map(str::to_owned);
    shown.chain(alerts).collect()
}

/// What is wrong with an expression before a scrape: metrics, labels and groups that are not there.
fn missing(expression: &str, served: &BTreeMap<&str, Vec<BTreeMap<&str, &str>>>) -> Vec<String> {
    let mut missing = Vec::new();
    let mut groups: Vec<&str> = Vec::new();
    for (start, _) in expression.match_indices("by (") {
        let list = expression[start + 4..].split(')').next().unwrap();
        groups.extend(list.split(',').map(str::trim));
    }
    for (start, _) in expression.match_indices("skyglow_") {
        let rest = &expression[start..];
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        let labels = rest[end..].strip_prefix('{').map_or("", |rest| rest.split('}').next().unwrap());
        let wanted = pairs(labels);
        let fits = |sample: &&BTreeMap<&str, &str>| {
            wanted.iter().all(|(name, value)| sample.get(name) == Some(value))
                && groups.iter().all(|name| sample.contains_key(name))
        };
        if !served.get(&rest[..end]).is_some_and(|samples| samples.iter().any(|sample| fits(&sample))) {
            missing.push(format!("{}{{{labels}}} by {groups:?}", &rest[..end]));
        }
    }
    missing
}

/// Dashboard and alerts ask for series that are there before anything went wrong: no sum is empty.
#[tokio::test]
async fn alerts_and_dashboard_ask_what_is_served() {
    let server = Server::start().await;
    assert_eq!(server.answer("/api/v1/scenes/demo/sky?lat=-1&lon=37").await.status(), 200);
    let metrics = server.answer("/metrics").await.text().await.unwrap();
    let served = samples(&metrics);
    let expressions = expressions();
    assert!(expressions.len() > 24, "{}", expressions.len());
    for expression in &expressions {
        let missing = missing(expression, &served);
        assert!(missing.is_empty(), "{expression}: {missing:?} in {metrics}");
    }
    // The detector finds what is not there.
    for wrong in [
        "sum(rate(skyglow_http_refused{reason=\"busy\"}[5m]))",
        "sum(rate(skyglow_http_refused_total{reason=\"bussy\"}[5m]))",
        "sum by (route) (rate(skyglow_http_requests_total[5m]))",
    ] {
        assert_eq!(missing(wrong, &served).len(), 1, "{wrong}");
    }
}

/// Every reason that the program counts is there from the start.
#[test]
fn every_reason_of_refusals_is_declared() {
    fn rust_files(folder: &std::path::Path, found: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                rust_files(&path, found);
            } else {
                found.push(std::fs::read_to_string(path).unwrap_or_default());
            }
        }
    }
    let mut files = Vec::new();
    rust_files(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
    let counted: Vec<&str> = files
        .iter()
        .flat_map(|text| text.split("count_refused(\"").skip(1).map(|rest| rest.split('"').next().unwrap()))
        .collect();
    assert!(counted.len() >= 6, "{counted:?}");
    for reason in counted {
        assert!(REFUSAL_REASONS.contains(&reason), "{reason}");
    }
}

/// What is left out is named, and with no scene left the server is not ready.
#[tokio::test]
async fn what_is_left_out_is_named() {
    let server = Server::start().await;
    let pack = "turbidity-2.50-multiple.skyglow";
    let left_out = LeftOut { packs: vec![pack.into()], scenes: vec!["old".into()], no_scene_left: false };
    *server.fake.left_out.lock().unwrap() = left_out.clone();
    let (status, ready) = server.json("/readyz").await;
    assert_eq!(status, 200);
    assert_eq!((&ready["packs_left_out"], &ready["scenes_left_out"]), (&json!([pack]), &json!(["old"])));
    let metrics = server.answer("/metrics").await.text().await.unwrap();
    for line in [
        "skyglow_packs_left_out 1",
        "skyglow_scenes_left_out 1",
        "skyglow_pack_left_out{pack=\"turbidity-2.50-multiple.skyglow\"} 1",
        "skyglow_scene_left_out{scene=\"old\"} 1",
    ] {
        assert!(metrics.lines().any(|known| known == line), "{line} in {metrics}");
    }
    *server.fake.left_out.lock().unwrap() = LeftOut { no_scene_left: true, ..left_out };
    let answer = server.answer("/readyz").await;
    assert_eq!(
        (answer.status().as_u16(), header(&answer, "content-type")),
        (503, "application/problem+json")
    );
    let problem: serde_json::Value = answer.json().await.unwrap();
    assert_eq!(problem["type"], "/problems/damaged-scene");
    assert!(problem["detail"].as_str().unwrap().contains("\"old\""), "{problem}");
}
