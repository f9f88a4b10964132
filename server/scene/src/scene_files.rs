//! The files of a scene's folder, and `metadata.json`, which lists them with their hashes.

use crate::metadata::SceneMetadata;
use crate::scene_id::SceneId;
use crate::sections::Flaw;
use serde::{Deserialize, Serialize};

pub(crate) const METADATA_FILE: &str = "metadata.json";
pub(crate) const LIGHT_FILE: &str = "light.bin";
pub(crate) const TERRAIN_FILE: &str = "terrain.bin";
pub(crate) const LAND_COVER_FILE: &str = "land_cover.bin";
pub(crate) const PLACES_FILE: &str = "places.json";
pub(crate) const SKYLINES_FILE: &str = "skylines.bin";
/// The folder of skylines that are made by tile, and of nothing else.
pub(crate) const TILES_FOLDER: &str = "skylines";
/// Counts up with every change of the format. Format 2 has the horizon profiles of lights where there is terrain; scenes of format 3
/// have them made by tile.
const FORMAT: u32 = 3;
/// That of scenes with nothing that is new since.
const PLAIN_FORMAT: u32 = 2;
/// The oldest format that is still read.
const MIN_FORMAT: u32 = 1;

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
    pub(crate) bytes: u64,
    blake3: String,
}

impl StoredFile {
    /// Of content about to be written.
    pub(crate) fn new(name: &str, content: &[u8]) -> Self {
        Self {
            name: name.to_owned(),
            bytes: content.len() as u64,
            blake3: blake3::hash(content).to_hex().to_string(),
        }
    }

    /// Whether `content` is what was written.
    pub(crate) fn check(&self, content: &[u8]) -> Result<(), Flaw> {
        self.check_hash(content.len() as u64, blake3::hash(content))
    }

    /// Whether it is as long as what was written.
    pub(crate) fn check_length(&self, bytes: u64) -> Result<(), Flaw> {
        match bytes == self.bytes {
            true => Ok(()),
            false => Err(format!("has {bytes} bytes where {} were written", self.bytes)),
        }
    }

    /// The same of content of this length and hash.
    pub(crate) fn check_hash(&self, bytes: u64, hash: blake3::Hash) -> Result<(), Flaw> {
        self.check_length(bytes)?;
        if hash.to_hex().as_str() != self.blake3 {
            return Err("was altered (its checksum is wrong)".to_owned());
        }
        Ok(())
    }
}

impl StoredScene {
    /// In the current format; fills in the version.
    pub(crate) fn new(metadata: SceneMetadata, files: Vec<StoredFile>) -> Result<Self, serde_json::Error> {
        let has_tiles = metadata.light_skylines && !files.iter().any(|file| file.name == SKYLINES_FILE);
        let format = if has_tiles { FORMAT } else { PLAIN_FORMAT };
        let mut stored = Self { format, metadata, files };
        stored.metadata.version = stored.version()?;
        Ok(stored)
    }

    /// Whether the skylines of its lights are made by tile.
    pub(crate) fn has_skyline_tiles(&self) -> bool {
        self.format > PLAIN_FORMAT && self.metadata.light_skylines
    }

    /// Hash over everything but the version itself and the time: the same light is the same scene.
    fn version(&self) -> Result<String, serde_json::Error> {
        let mut blank = self.clone();
        blank.metadata.version = String::new();
        blank.metadata.ingested_unix_s = None;
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
        if !(MIN_FORMAT..=FORMAT).contains(&form.format) {
            return Err(format!(
                "is of format {}, this program reads formats {MIN_FORMAT} to {FORMAT}",
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
