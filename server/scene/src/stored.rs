//! The form of a scene's folder, and how one is written: beside its place first, then moved there.

use crate::error::SceneError;
use crate::grid_sections;
use crate::metadata::SceneMetadata;
use crate::scene::Scene;
use crate::scene_id::SceneId;
use crate::sections::{self, Flaw};
use crate::staging::Staging;
use crate::store::SceneStore;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fs::File;
use std::io::Write;
use std::path::Path;

pub(crate) const METADATA_FILE: &str = "metadata.json";
pub(crate) const LIGHT_FILE: &str = "light.bin";
pub(crate) const TERRAIN_FILE: &str = "terrain.bin";
pub(crate) const PLACES_FILE: &str = "places.json";
pub(crate) const SKYLINES_FILE: &str = "skylines.bin";
/// Counts up with every change of the files' form. Form 2 has the skylines of lights where there is terrain.
const FORMAT: u32 = 2;
/// The oldest form that is still read.
const OLDEST_FORMAT: u32 = 1;

/// `metadata.json`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StoredScene {
    format: u32,
    pub(crate) metadata: SceneMetadata,
    pub(crate) files: Vec<StoredFile>,
}

/// A file of the scene and what it must be.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StoredFile {
    pub(crate) name: String,
    bytes: u64,
    blake3: String,
}

impl StoredFile {
    fn of(name: &str, content: &[u8]) -> Self {
        Self {
            name: name.to_owned(),
            bytes: content.len() as u64,
            blake3: blake3::hash(content).to_hex().to_string(),
        }
    }

    /// Whether `content` is what was written.
    pub(crate) fn check(&self, content: &[u8]) -> Result<(), Flaw> {
        if content.len() as u64 != self.bytes {
            return Err(format!("has {} bytes where {} were written", content.len(), self.bytes));
        }
        if blake3::hash(content).to_hex().as_str() != self.blake3 {
            return Err("was altered (its checksum is wrong)".to_owned());
        }
        Ok(())
    }
}

impl StoredScene {
    /// Hash over everything but the version itself.
    fn version(&self) -> Result<String, serde_json::Error> {
        let mut blank = self.clone();
        blank.metadata.version = String::new();
        Ok(blake3::hash(&serde_json::to_vec(&blank)?).to_hex()[..32].to_owned())
    }

    /// Reads and checks `metadata.json` of scene `id`.
    pub(crate) fn parse(text: &[u8], id: &SceneId) -> Result<Self, Flaw> {
        let broken = |error: serde_json::Error| format!("is truncated or broken ({error})");
        #[derive(Deserialize)]
        struct Form {
            format: u32,
        }
        let form: Form = serde_json::from_slice(text).map_err(broken)?;
        if !(OLDEST_FORMAT..=FORMAT).contains(&form.format) {
            return Err(format!(
                "is of format {}, this program reads formats {OLDEST_FORMAT} to {FORMAT}",
                form.format
            ));
        }
        let stored: Self = serde_json::from_slice(text).map_err(broken)?;
        if stored.version().map_err(broken)? != stored.metadata.version {
            return Err("was altered (its version does not fit its content)".to_owned());
        }
        if stored.metadata.id != *id {
            return Err(format!("belongs to scene \"{}\"", stored.metadata.id));
        }
        Ok(stored)
    }
}

/// Writes a scene and moves it to its place. `metadata.version` is filled in.
pub(crate) fn write(store: &SceneStore, scene: &mut Scene, replace: bool) -> Result<(), SceneError> {
    let target = store.scene_dir(&scene.metadata.id);
    let parent = store.scenes_dir();
    std::fs::create_dir_all(parent).map_err(SceneError::io(parent))?;
    let staging = Staging::below(parent)?;
    let mut files = Vec::new();
    let mut put = |name: &str, content: &[u8]| {
        files.push(StoredFile::of(name, content));
        write_synced(&staging.path().join(name), content)
    };
    put(LIGHT_FILE, &light_bytes(scene).map_err(SceneError::io(staging.path()))?)?;
    if !scene.terrain.is_empty() {
        let bytes = sections::pack(&scene.terrain.to_sections()).map_err(SceneError::io(staging.path()))?;
        put(TERRAIN_FILE, &bytes)?;
    }
    if let Some(skylines) = &scene.first_layer().lights.skylines {
        let bytes = sections::pack(&skylines.to_sections()).map_err(SceneError::io(staging.path()))?;
        put(SKYLINES_FILE, &bytes)?;
    }
    if !scene.places.is_empty() {
        put(PLACES_FILE, &json(&&*scene.places, staging.path())?)?;
    }
    let mut stored = StoredScene { format: FORMAT, metadata: scene.metadata.clone(), files };
    let version = stored.version().map_err(|error| SceneError::io(staging.path())(error.into()))?;
    stored.metadata.version.clone_from(&version);
    scene.metadata.version = version;
    write_synced(&staging.path().join(METADATA_FILE), &json(&stored, staging.path())?)?;
    sync_dir(staging.path())?;
    staging.move_to(&target, &scene.metadata.id, replace)?;
    sync_dir(parent)
}

fn json<T: Serialize>(value: &T, path: &Path) -> Result<Vec<u8>, SceneError> {
    serde_json::to_vec_pretty(value).map_err(|error| SceneError::io(path)(error.into()))
}

fn light_bytes(scene: &Scene) -> Result<Vec<u8>, std::io::Error> {
    let (row_start, runs) = scene.mask.parts();
    let mut parts = grid_sections::to_sections(&scene.grid, "");
    parts.push((
        "codes".into(),
        Cow::Owned(sections::pack_ascending(&scene.first_layer().lights.pixels.codes)),
    ));
    parts.push((
        "radiance".into(),
        Cow::Borrowed(bytemuck::cast_slice(&scene.first_layer().lights.pixels.radiance_nw_cm2_sr)),
    ));
    parts.push((
        "altitude".into(),
        Cow::Borrowed(bytemuck::cast_slice(&scene.first_layer().lights.pixels.altitude_m)),
    ));
    parts.push(("row_start".into(), Cow::Borrowed(bytemuck::cast_slice(row_start))));
    parts.push(("runs".into(), Cow::Borrowed(bytemuck::cast_slice(runs))));
    sections::pack(&parts)
}

fn write_synced(path: &Path, content: &[u8]) -> Result<(), SceneError> {
    let write = || -> std::io::Result<()> {
        let mut file = File::create(path)?;
        file.write_all(content)?;
        file.sync_all()
    };
    write().map_err(SceneError::io(path))
}

fn sync_dir(path: &Path) -> Result<(), SceneError> {
    File::open(path).and_then(|dir| dir.sync_all()).map_err(SceneError::io(path))
}
