//! Which crate may use which: `cli → {http, bench}`, `http → app → {observatory, display}`, `observatory → render`, `bench → render`,
//! `render → {tables, scene} → physics`, `display → physics`, `app → celestial → physics`, `lab` beside `cli`, and `engine`, which is Python's, beside
//! `http`. A crate may use whatever lies below it, and nothing beside or above it.

use serde_json::Value;
use std::collections::BTreeMap;

/// The layering of crates, as drawn in ARCHITECTURE.md.
const LAYERING: &[(&str, &[&str])] = &[
    ("skyglow-physics", &[]),
    ("skyglow-celestial", &["skyglow-physics"]),
    ("skyglow-tables", &["skyglow-physics"]),
    ("skyglow-scene", &["skyglow-physics"]),
    ("skyglow-render", &["skyglow-tables", "skyglow-scene"]),
    ("skyglow-observatory", &["skyglow-render", "skyglow-celestial"]),
    ("skyglow-bench", &["skyglow-render"]),
    ("skyglow-display", &["skyglow-physics"]),
    ("skyglow-app", &["skyglow-observatory", "skyglow-display"]),
    ("skyglow-http", &["skyglow-app"]),
    ("skyglow", &["skyglow-http", "skyglow-bench"]),
    ("skyglow-lab", &["skyglow-http", "skyglow-bench"]),
    ("skyglow-engine", &["skyglow-app"]),
];

/// Crates from outside that belong to one of ours alone. Tests of others may use them.
const HOMES: &[(&str, &str)] = &[
    ("wgpu", "skyglow-render"),
    ("naga", "skyglow-render"),
    ("axum", "skyglow-http"),
    ("hyper", "skyglow-http"),
    ("http", "skyglow-http"),
    ("tower-http", "skyglow-http"),
    ("utoipa-axum", "skyglow-http"),
    ("object_store", "skyglow-http"),
    ("redis", "skyglow-http"),
    ("gdal", "skyglow-scene"),
    ("gdal-sys", "skyglow-scene"),
    ("clap", "skyglow"),
    ("pyo3", "skyglow-engine"),
];

/// The measuring programs, a tool beside the program.
const LAB: &str = "skyglow-lab";

/// What of those homes the lab may use too.
const OF_LAB: &[&str] = &["clap"];

/// A dependency in a Cargo.toml.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dependency {
    /// Its name.
    pub name: String,
    /// Whether tests alone use it.
    pub for_tests: bool,
}

impl Dependency {
    /// One that is part of the crate.
    pub fn shipped(name: &str) -> Self {
        Self { name: name.to_owned(), for_tests: false }
    }
}

/// What each member of the workspace asks for in its own Cargo.toml.
pub type Dependencies = BTreeMap<String, Vec<Dependency>>;

/// Runs `cargo metadata` on the workspace.
///
/// # Panics
/// Where cargo does not answer.
pub fn workspace_dependencies() -> Dependencies {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let output = std::process::Command::new(cargo)
        .args(["metadata", "--no-deps", "--format-version", "1", "--offline"])
        .current_dir(crate::tree::root())
        .output()
        .unwrap_or_else(|e| panic!("cargo metadata: {e}"));
    assert!(output.status.success(), "cargo metadata: {}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("metadata: {e}"));
    let name_of = |value: &Value| value["name"].as_str().unwrap_or_default().to_owned();
    let packages = metadata["packages"].as_array().cloned().unwrap_or_default();
    packages
        .iter()
        .map(|package| {
            let dependencies = package["dependencies"].as_array().cloned().unwrap_or_default();
            let dependency =
                |value: &Value| Dependency { name: name_of(value), for_tests: value["kind"] == "dev" };
            (name_of(package), dependencies.iter().map(dependency).collect())
        })
        .collect()
}

/// Everything below `package` along the layering.
fn below(package: &str) -> Vec<&'static str> {
    let direct = LAYERING.iter().find(|(from, _)| *from == package).map_or(&[][..], |(_, to)| to);
    let mut all = direct.to_vec();
    for next in direct {
        all.extend(below(next));
    }
    all
}

/// What breaks the layering or lives outside its home.
pub fn violations(dependencies: &Dependencies) -> Vec<String> {
    let mut found = Vec::new();
    for (package, wanted) in dependencies {
        let crosses_crates = package == "skyglow-tests";
        if !crosses_crates && !LAYERING.iter().any(|(known, _)| known == package) {
            found.push(format!("{package} has no place in the layering"));
        }
        let allowed = below(package);
        for Dependency { name: dependency, for_tests } in wanted {
            let ours = LAYERING.iter().any(|(known, _)| known == dependency);
            if ours && !crosses_crates && dependency != package && !allowed.contains(&dependency.as_str()) {
                found.push(format!("{package} must not use {dependency}"));
            }
            if let Some((_, home)) = HOMES.iter().find(|(outside, _)| outside == dependency)
                && home != package
                && !for_tests
                && !(package == LAB && OF_LAB.contains(&dependency.as_str()))
            {
                found.push(format!("{dependency} belongs to {home} alone, not to {package}"));
            }
        }
    }
    for (package, _) in LAYERING {
        if !dependencies.contains_key(*package) {
            found.push(format!("{package} is missing from the workspace"));
        }
    }
    found
}
