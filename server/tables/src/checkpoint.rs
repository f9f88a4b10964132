//! Checkpoints of a precompute: finished parts on disk, so that a killed run resumes where it stopped.

use crate::{error::TablesError, manifest::PackParameters, pack::write_atomically};
use std::path::{Path, PathBuf};

const HASH_LEN: usize = 32;

/// A folder of finished parts that belong to one set of parameters.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    folder: PathBuf,
}

impl Checkpoint {
    /// Opens or starts the checkpoint of these parameters in `out`. The folder's name holds their hash, so runs
    /// with other parameters do not touch it.
    pub(crate) fn open(out: &Path, parameters: &PackParameters) -> Result<Self, TablesError> {
        let description = (
            parameters,
            crate::manifest::FORMAT_VERSION,
            crate::manifest::MODEL_VERSION,
            env!("CARGO_PKG_VERSION"),
        );
        let json = serde_json::to_vec(&description)
            .map_err(|error| TablesError::Manifest { path: out.to_owned(), reason: error.to_string() })?;
        let hash = blake3::hash(&json).to_hex();
        let folder = out.join(format!(
            ".turbidity-{:.2}-{}{}-{}.partial",
            parameters.turbidity,
            parameters.scattering.name(),
            crate::clouds::Clouds::file_name_part(parameters.clouds),
            &hash.as_str()[..8]
        ));
        std::fs::create_dir_all(&folder).map_err(TablesError::io(&folder))?;
        write_atomically(&folder.join("parameters.json"), &json)?;
        Ok(Self { folder })
    }

    /// A finished part, or None when it is missing or damaged.
    pub(crate) fn load(&self, name: &str) -> Option<Vec<f32>> {
        let bytes = std::fs::read(self.folder.join(name)).ok()?;
        let (body, hash) = bytes.split_at_checked(bytes.len().checked_sub(HASH_LEN)?)?;
        (blake3::hash(body).as_bytes() == hash && body.len() % 4 == 0)
            .then(|| bytemuck::pod_collect_to_vec::<u8, f32>(body))
    }

    /// Stores a finished part.
    pub(crate) fn store(&self, name: &str, values: &[f32]) -> Result<(), TablesError> {
        let body: &[u8] = bytemuck::cast_slice(values);
        let hash = blake3::hash(body);
        write_atomically(&self.folder.join(name), &[body, hash.as_bytes()].concat())
    }

    /// Removes the folder once the pack is written.
    pub(crate) fn finish(self) -> Result<(), TablesError> {
        std::fs::remove_dir_all(&self.folder).map_err(TablesError::io(&self.folder))
    }
}
