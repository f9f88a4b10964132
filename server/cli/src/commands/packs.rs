//! `skyglow packs`: the table packs on disk.

use crate::{
    failure::Failure,
    flags::{JsonFlags, PacksFlags},
    table::aligned,
};
use clap::{Args, Subcommand};
use serde::Serialize;
use skyglow_tables::{Manifest, Pack, TablesError, manifest::LobeError, packs_in};
use std::path::{Path, PathBuf};

/// List the table packs: turbidity, checksum, measured error
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow packs\n  skyglow packs verify")]
pub(crate) struct Packs {
    #[command(subcommand)]
    action: Option<Action>,
    #[command(flatten)]
    packs: PacksFlags,
    #[command(flatten)]
    json: JsonFlags,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Read every pack whole and recompute its checksum; status 1 where one is refused
    #[command(after_help = "Example:\n  skyglow packs verify --packs precomputed")]
    Verify {
        #[command(flatten)]
        packs: PacksFlags,
        #[command(flatten)]
        json: JsonFlags,
    },
}

/// How a pack's manifest is got.
type Read = fn(&Path) -> Result<Manifest, TablesError>;

/// A pack, or why it is refused.
#[derive(Debug, Serialize)]
struct Entry {
    path: PathBuf,
    bytes: u64,
    #[serde(flatten)]
    manifest: Option<Manifest>,
    refused: Option<String>,
}

impl Packs {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let (folder, json, read): (PathBuf, bool, Read) = match &self.action {
            Some(Action::Verify { packs, json }) => {
                let folder = packs.given().unwrap_or_else(|| self.packs.folder());
                (folder, json.json || self.json.json, verified)
            }
            None => (self.packs.folder(), self.json.json, described),
        };
        let entries: Vec<Entry> =
            packs_in(&folder).map_err(Failure::work)?.into_iter().map(|path| entry(path, read)).collect();
        if json {
            super::print_json(&entries)?;
        } else if entries.is_empty() {
            super::print_line(&format!("no packs in {}", folder.display()))?;
        } else {
            super::print_line(aligned(&rows(&entries)).trim_end())?;
        }
        let refused: Vec<&str> = entries.iter().filter_map(|entry| entry.refused.as_deref()).collect();
        if refused.is_empty() { Ok(()) } else { Err(Failure::Work(refused.join("; "))) }
    }
}

fn entry(path: PathBuf, read: Read) -> Entry {
    let bytes = std::fs::metadata(&path).map_or(0, |metadata| metadata.len());
    match read(&path) {
        Ok(manifest) => Entry { path, bytes, manifest: Some(manifest), refused: None },
        Err(error) => Entry { path, bytes, manifest: None, refused: Some(error.to_string()) },
    }
}

/// The manifest of a pack that was read whole and checked.
fn verified(path: &Path) -> Result<Manifest, TablesError> {
    Pack::open(path).map(|pack| pack.manifest().clone())
}

/// The manifest beside a pack; where there is none, the pack's own.
fn described(path: &Path) -> Result<Manifest, TablesError> {
    let beside = std::fs::read(path.with_extension("json")).ok();
    match beside.and_then(|text| serde_json::from_slice(&text).ok()) {
        Some(manifest) => Ok(manifest),
        None => verified(path),
    }
}

/// An error of the worst lobe.
fn percent(manifest: &Manifest, error: impl Fn(&LobeError) -> f64) -> String {
    let worst = manifest.measured_error.lobes.iter().map(error).fold(0.0, f64::max);
    format!("{:.2} %", 100.0 * worst)
}

fn rows(entries: &[Entry]) -> Vec<Vec<String>> {
    let head = ["pack", "MB", "turbidity", "scattering", "basis", "error (median)", "(90 %)", "checksum"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for entry in entries {
        let name = entry.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let mut row = vec![name, format!("{:.1}", entry.bytes as f64 / 1e6)];
        match &entry.manifest {
            Some(manifest) => row.extend([
                manifest.turbidity.to_string(),
                format!("{:?}", manifest.scattering).to_lowercase(),
                manifest.basis_count.to_string(),
                percent(manifest, |lobe| lobe.median),
                percent(manifest, |lobe| lobe.p90),
                manifest.checksum.chars().take(16).collect(),
            ]),
            None => row.push("refused".to_owned()),
        }
        rows.push(row);
    }
    rows
}
