//! What may lie in precomputed/: packs, each with a manifest that says how to rebuild it.

use serde_json::Value;
use std::collections::BTreeMap;

/// Largest size of all packs together, bytes: they come with the project.
pub const MAX_TOTAL_BYTES: u64 = 150_000_000;

/// Files of precomputed/ that are neither packs nor manifests.
const OTHERS: [&str; 2] = ["README.md", "turbidities.txt"];

/// A file of precomputed/: its size and, of a `.json` file, its text.
#[derive(Clone, Debug, Default)]
pub struct Entry {
    /// Size, bytes.
    pub bytes: u64,
    /// Text of a manifest.
    pub text: Option<String>,
}

/// The turbidities of `turbidities.txt`, or the line that is none.
///
/// # Errors
/// The offending line.
pub fn listed_turbidities(text: &str) -> Result<Vec<f64>, String> {
    text.lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(|line| line.parse().map_err(|_| line.to_owned()))
        .collect()
}

/// What is wrong with the files of precomputed/, by name.
pub fn violations(entries: &BTreeMap<String, Entry>, listed: &[f64]) -> Vec<String> {
    let mut found = Vec::new();
    let total: u64 = entries.values().map(|entry| entry.bytes).sum();
    if total > MAX_TOTAL_BYTES {
        found.push(format!("{total} bytes in all; at most {MAX_TOTAL_BYTES} come with the project"));
    }
    for (name, entry) in entries.iter().filter(|(name, _)| !OTHERS.contains(&name.as_str())) {
        match (name.strip_suffix(".json"), &entry.text) {
            (Some(stem), text) => {
                if !entries.keys().any(|other| other != name && other.starts_with(stem)) {
                    found.push(format!("{name} describes a pack that is not there"));
                }
                found.extend(manifest_violations(name, text.as_deref().unwrap_or_default(), listed));
            }
            (None, _) => {
                let stem = name.rsplit_once('.').map_or(name.as_str(), |(stem, _)| stem);
                if ![format!("{stem}.json"), format!("{name}.json")].iter().any(|m| entries.contains_key(m)) {
                    found.push(format!("{name} has no manifest that rebuilds it"));
                }
            }
        }
    }
    found
}

fn manifest_violations(name: &str, text: &str, listed: &[f64]) -> Vec<String> {
    let Ok(manifest) = serde_json::from_str::<Value>(text) else {
        return vec![format!("{name} is not JSON")];
    };
    let mut found = Vec::new();
    if !manifest["checksum"].is_string() {
        found.push(format!("{name} has no checksum"));
    }
    match manifest["turbidity"].as_f64() {
        None => found.push(format!("{name} has no turbidity")),
        Some(turbidity) if !listed.contains(&turbidity) => {
            found.push(format!("{name}: turbidity {turbidity} is not in turbidities.txt"));
        }
        Some(_) => {}
    }
    found
}
