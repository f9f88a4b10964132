//! Documents of the change store: JSON with a format number, the time of storage and a BLAKE3 hash of the content, renamed into
//! place.

use super::change_id::ChangeId;
use super::stored::ChangeStoreError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// Counts up with every change of the format.
const FORMAT: u32 = 1;

/// A file.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Document {
    format: u32,
    created_unix_s: u64,
    blake3: String,
    content: serde_json::Value,
}

pub(super) fn io(path: &Path) -> impl FnOnce(std::io::Error) -> ChangeStoreError + '_ {
    |source| ChangeStoreError::Io { path: path.to_owned(), source }
}

pub(super) fn damaged(path: &Path) -> impl FnOnce(String) -> ChangeStoreError + '_ {
    |reason| ChangeStoreError::Damaged { path: path.to_owned(), reason }
}

pub(super) fn unix_s(time: SystemTime) -> u64 {
    time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

pub(super) fn to_json<T: Serialize>(path: &Path, content: &T) -> Result<Vec<u8>, ChangeStoreError> {
    serde_json::to_vec(content).map_err(|error| io(path)(error.into()))
}

/// Writes a document.
pub(super) fn write<T: Serialize>(path: &Path, content: &T) -> Result<(), ChangeStoreError> {
    // The hash is over the text and not over its meaning, which has more than one text.
    let content = serde_json::to_value(content).map_err(|error| io(path)(error.into()))?;
    let text = to_json(path, &content)?;
    let document = Document {
        format: FORMAT,
        created_unix_s: unix_s(SystemTime::now()),
        blake3: blake3::hash(&text).to_hex().to_string(),
        content,
    };
    write_file(path, &to_json(path, &document)?)
}

/// The content of a document, checked, and the time of storage, seconds since 1970.
pub(super) fn read(path: &Path, id: &ChangeId) -> Result<(serde_json::Value, u64), ChangeStoreError> {
    let text = read_file(path, id)?;
    let document: Document = serde_json::from_slice(&text)
        .map_err(|error| damaged(path)(format!("is truncated or broken ({error})")))?;
    if document.format != FORMAT {
        return Err(damaged(path)(format!("is of format {}, this program reads {FORMAT}", document.format)));
    }
    if blake3::hash(&to_json(path, &document.content)?).to_hex().as_str() != document.blake3 {
        return Err(damaged(path)("was altered (its checksum is wrong)".to_owned()));
    }
    Ok((document.content, document.created_unix_s))
}

/// The content of a document as a type.
pub(super) fn parse<T: DeserializeOwned>(
    path: &Path,
    content: serde_json::Value,
) -> Result<T, ChangeStoreError> {
    serde_json::from_value(content).map_err(|error| damaged(path)(format!("is of another form ({error})")))
}

/// The bytes of a file; [`ChangeStoreError::Unknown`] where it does not exist.
pub(super) fn read_file(path: &Path, id: &ChangeId) -> Result<Vec<u8>, ChangeStoreError> {
    std::fs::read(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => ChangeStoreError::Unknown { id: id.clone() },
        _ => io(path)(error),
    })
}

/// Writes to a temporary file in the same folder, then renames it.
pub(super) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), ChangeStoreError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(io(folder))?;
    let write = || -> std::io::Result<()> {
        let mut file = tempfile::Builder::new().prefix(".change-").tempfile_in(folder)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        std::fs::File::open(folder)?.sync_all()
    };
    write().map_err(io(path))
}
