//! `skyglow packs`: the table packs and celestial tables on disk.

use crate::{
    failure::Failure,
    flags::{JsonFlags, PacksFlags},
    folders, print,
    table::aligned,
};
use clap::{Args, Subcommand};
use serde::Serialize;
use skyglow_tables::{
    CelestialTable, Manifest, Pack, TablesError, celestial::manifest::CelestialManifest, celestial_tables_in,
    manifest::LobeError, packs_in,
};
use std::path::{Path, PathBuf};

/// List the table packs and celestial tables, each read whole and checked: turbidity, scattering, checksum, measured error; status 1 where one is damaged
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
    /// The same; for scripts that say what they are after
    #[command(after_help = "Example:\n  skyglow packs verify --packs precomputed")]
    Verify {
        #[command(flatten)]
        packs: PacksFlags,
        #[command(flatten)]
        json: JsonFlags,
    },
}

/// What a file holds.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Description {
    Pack(Box<Manifest>),
    Celestial(Box<CelestialManifest>),
}

/// A pack or celestial table, or why it is refused.
#[derive(Debug, Serialize)]
struct Entry {
    path: PathBuf,
    bytes: u64,
    #[serde(flatten)]
    manifest: Option<Description>,
    refused: Option<String>,
}

impl Packs {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let (folder, json) = match &self.action {
            Some(Action::Verify { packs, json }) => {
                (packs.given().unwrap_or_else(|| self.packs.folder()), json.json || self.json.json)
            }
            None => (self.packs.folder(), self.json.json),
        };
        let packs = packs_in(&folder).map_err(folders::no_packs)?;
        let celestial = celestial_tables_in(&folder).map_err(Failure::work)?;
        let packs = packs.into_iter().map(|path| entry(path, verified_pack));
        let entries: Vec<Entry> =
            packs.chain(celestial.into_iter().map(|path| entry(path, verified_celestial))).collect();
        if json {
            print::print_json(&entries)?;
        } else if entries.is_empty() {
            print::print_line(&format!("no packs in {}", folder.display()))?;
        } else {
            print::print_line(aligned(&rows(&entries)).trim_end())?;
        }
        let refused: Vec<&str> = entries.iter().filter_map(|entry| entry.refused.as_deref()).collect();
        if refused.is_empty() { Ok(()) } else { Err(Failure::Work(refused.join("; "))) }
    }
}

/// A pack that is read whole and checked: a manifest beside it says nothing about the pack's own bytes.
fn entry(path: PathBuf, verified: impl Fn(&Path) -> Result<Description, TablesError>) -> Entry {
    let bytes = std::fs::metadata(&path).map_or(0, |metadata| metadata.len());
    match verified(&path) {
        Ok(manifest) => Entry { path, bytes, manifest: Some(manifest), refused: None },
        Err(error) => Entry { path, bytes, manifest: None, refused: Some(error.to_string()) },
    }
}

fn verified_pack(path: &Path) -> Result<Description, TablesError> {
    Pack::open(path).map(|pack| Description::Pack(Box::new(pack.manifest().clone())))
}

fn verified_celestial(path: &Path) -> Result<Description, TablesError> {
    CelestialTable::open(path).map(|table| Description::Celestial(Box::new(table.manifest().clone())))
}

/// An error of the worst lobe.
fn percent(manifest: &Manifest, error: impl Fn(&LobeError) -> f64) -> String {
    let worst = manifest.measured_error.lobes.iter().map(error).fold(0.0, f64::max);
    format!("{:.2} %", 100.0 * worst)
}

fn rows(entries: &[Entry]) -> Vec<Vec<String>> {
    let head = [
        "pack",
        "MB",
        "turbidity",
        "scattering",
        "ground",
        "clouds",
        "basis",
        "error (median)",
        "(90 %)",
        "checksum",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for entry in entries {
        let name = entry.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let mut row = vec![name, format!("{:.1}", entry.bytes as f64 / 1e6)];
        match &entry.manifest {
            Some(Description::Pack(manifest)) => row.extend([
                manifest.turbidity.to_string(),
                manifest.scattering.name().to_owned(),
                manifest.ground_albedo.map_or_else(|| "-".to_owned(), |albedo| format!("albedo {albedo}")),
                manifest.clouds.map_or_else(|| "-".to_owned(), |clouds| format!("{} m", clouds.base_m())),
                manifest.basis_count.to_string(),
                percent(manifest, |lobe| lobe.median),
                percent(manifest, |lobe| lobe.p90),
                manifest.checksum.chars().take(16).collect(),
            ]),
            Some(Description::Celestial(manifest)) => row.extend([
                manifest.turbidity.to_string(),
                "celestial".to_owned(),
                format!("albedo {}", manifest.ground_albedo),
                "-".to_owned(),
                "-".to_owned(),
                format!("{:.2} %", 100.0 * manifest.measured_error.median),
                format!("{:.2} %", 100.0 * manifest.measured_error.p90),
                manifest.checksum.chars().take(16).collect(),
            ]),
            None => row.push("damaged".to_owned()),
        }
        rows.push(row);
    }
    rows
}
