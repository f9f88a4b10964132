//! Documents of the change store: JSON with a format number, the time of storage, who had it stored, and BLAKE3 hashes, renamed
//! into place.

use super::change_id::ChangeId;
use super::posting::Posted;
use super::stored::ChangeStoreError;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};
use std::fs::Permissions;
use std::io::{ErrorKind, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};
use tempfile::NamedTempFile;

/// Counts up with every change of the format.
const FORMAT: u32 = 1;
/// Who may read what is written: the program's user, and its group for backups.
pub(super) const FILE_MODE: u32 = 0o640;
/// Before the content, which is the last member.
const CONTENT: &[u8] = b",\"content\":";
/// What files begin with that are not renamed to their place yet.
pub(super) const UNFINISHED: &str = ".change-";

/// A file.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Document<C> {
    format: u32,
    created_unix_s: u64,
    blake3: String,
    #[serde(default)]
    posted: Posted,
    /// None in documents of older programs, which did not say who had them stored.
    posted_blake3: Option<String>,
    content: C,
}

/// What stands before a document's content.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Head {
    pub(super) created_unix_s: u64,
    pub(super) posted: Posted,
}

impl Head {
    /// Nanoseconds since 1970.
    pub(super) fn created_unix_ns(&self) -> u64 {
        self.created_unix_s.saturating_mul(1_000_000_000).saturating_add(self.posted.created_ns.into())
    }
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

pub(super) fn unix_ns(time: SystemTime) -> u64 {
    time.duration_since(UNIX_EPOCH).map_or(0, |since| u64::try_from(since.as_nanos()).unwrap_or(u64::MAX))
}

pub(super) fn to_json<T: Serialize>(path: &Path, content: &T) -> Result<Vec<u8>, ChangeStoreError> {
    serde_json::to_vec(content).map_err(|error| io(path)(error.into()))
}

fn hash_of(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// The bytes of a document.
pub(super) fn bytes_of<T: Serialize>(
    path: &Path,
    head: &Head,
    content: &T,
) -> Result<Vec<u8>, ChangeStoreError> {
    // The hash is over the text and not over its meaning, which has more than one text.
    let content = serde_json::to_value(content).map_err(|error| io(path)(error.into()))?;
    let text = to_json(path, &content)?;
    let document = Document {
        format: FORMAT,
        created_unix_s: head.created_unix_s,
        blake3: hash_of(&text),
        posted_blake3: Some(hash_of(&to_json(path, &head.posted)?)),
        posted: head.posted.clone(),
        content,
    };
    to_json(path, &document)
}

/// The content of a document and what stands before it, checked.
pub(super) fn read<T: DeserializeOwned>(path: &Path, id: &ChangeId) -> Result<(T, Head), ChangeStoreError> {
    read_bytes(path, &read_file(path, id)?)
}

/// The same of its bytes.
pub(super) fn read_bytes<T: DeserializeOwned>(
    path: &Path,
    text: &[u8],
) -> Result<(T, Head), ChangeStoreError> {
    let broken = |error: serde_json::Error| damaged(path)(format!("is truncated or broken ({error})"));
    let of_another_form = |error: serde_json::Error| damaged(path)(format!("is of another form ({error})"));
    // As this program wrote it, the content is hashed and read where it stands.
    if let Some((head, content)) = taken_apart(text)
        && head.format == FORMAT
        && hash_of(content) == head.blake3
    {
        let head = checked(path, head)?;
        return Ok((serde_json::from_slice(content).map_err(of_another_form)?, head));
    }
    let document: Document<serde_json::Value> = serde_json::from_slice(text).map_err(broken)?;
    if document.format != FORMAT {
        return Err(damaged(path)(format!("is of format {}, this program reads {FORMAT}", document.format)));
    }
    if hash_of(&to_json(path, &document.content)?) != document.blake3 {
        return Err(altered(path));
    }
    let Document { format, created_unix_s, blake3, posted, posted_blake3, content } = document;
    let head = Document { format, created_unix_s, blake3, posted, posted_blake3, content: IgnoredAny };
    let head = checked(path, head)?;
    Ok((serde_json::from_value(content).map_err(of_another_form)?, head))
}

fn altered(path: &Path) -> ChangeStoreError {
    damaged(path)("was altered (its checksum is wrong)".to_owned())
}

/// What stands before the content, and the content's text.
fn taken_apart(text: &[u8]) -> Option<(Document<IgnoredAny>, &[u8])> {
    let at = text.windows(CONTENT.len()).take(4096).position(|window| window == CONTENT)? + CONTENT.len();
    let content = text.get(at..text.len().checked_sub(1)?)?;
    let head = [text.get(..at)?, b"null}"].concat();
    Some((serde_json::from_slice(&head).ok()?, content))
}

fn checked(path: &Path, head: Document<IgnoredAny>) -> Result<Head, ChangeStoreError> {
    if let Some(hash) = &head.posted_blake3
        && hash_of(&to_json(path, &head.posted)?) != *hash
    {
        return Err(altered(path));
    }
    Ok(Head { created_unix_s: head.created_unix_s, posted: head.posted })
}

/// The bytes of a file; [`ChangeStoreError::Unknown`] where it does not exist.
pub(super) fn read_file(path: &Path, id: &ChangeId) -> Result<Vec<u8>, ChangeStoreError> {
    std::fs::read(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => ChangeStoreError::Unknown { id: id.clone() },
        _ => io(path)(error),
    })
}

/// A file that is written and on disk, but not at its place yet; gone where it is dropped before.
#[derive(Debug)]
pub(super) struct Unfinished {
    file: NamedTempFile,
    path: PathBuf,
}

/// Writes to a temporary file in the folder of `path`.
pub(super) fn write_beside(path: PathBuf, bytes: &[u8]) -> Result<Unfinished, ChangeStoreError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(io(folder))?;
    let write = || -> std::io::Result<NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        let mut file =
            builder.prefix(UNFINISHED).permissions(Permissions::from_mode(FILE_MODE)).tempfile_in(folder)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        Ok(file)
    };
    let file = write().map_err(io(&path))?;
    Ok(Unfinished { file, path })
}

impl Unfinished {
    /// Renames it to its place.
    pub(super) fn put(self) -> Result<(), ChangeStoreError> {
        self.file.persist(&self.path).map(drop).map_err(|error| io(&self.path)(error.error))
    }
}

/// Has what was put into a folder, or removed from it, on disk.
pub(super) fn sync_folder(folder: &Path) -> Result<(), ChangeStoreError> {
    std::fs::File::open(folder).and_then(|folder| folder.sync_all()).map_err(io(folder))
}
