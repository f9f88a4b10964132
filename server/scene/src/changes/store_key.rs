//! The key of a data folder's hashes of addresses and of ids that nobody is to guess: `<data>/kept.key`, made when it is needed.

use super::document::io;
use super::stored::ChangeStoreError;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

const FILE: &str = "kept.key";

/// The key, once it was needed.
#[derive(Debug)]
pub(super) struct StoreKey {
    path: PathBuf,
    key: OnceLock<[u8; 32]>,
}

impl StoreKey {
    pub(super) fn new(data_dir: &Path) -> Self {
        Self { path: data_dir.join(FILE), key: OnceLock::new() }
    }

    /// A key that is in no file.
    pub(super) fn known(key: [u8; 32]) -> Self {
        Self { path: PathBuf::new(), key: OnceLock::from(key) }
    }

    /// The key; random, unless there is one.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`].
    pub(super) fn get(&self) -> Result<&[u8; 32], ChangeStoreError> {
        if let Some(key) = self.key.get() {
            return Ok(key);
        }
        let key = read_or_make(&self.path).map_err(io(&self.path))?;
        Ok(self.key.get_or_init(|| key))
    }
}

/// A random key.
pub(super) fn new_key() -> std::io::Result<[u8; 32]> {
    let mut key = [0; 32];
    getrandom::fill(&mut key).map_err(std::io::Error::other)?;
    Ok(key)
}

fn read_or_make(path: &Path) -> std::io::Result<[u8; 32]> {
    let read = || -> std::io::Result<[u8; 32]> {
        let text = std::fs::read_to_string(path)?;
        let hash = blake3::Hash::from_hex(text.trim()).map_err(std::io::Error::other)?;
        Ok(*hash.as_bytes())
    };
    match read() {
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        read => return read,
    }
    let key = new_key()?;
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    // For this user alone, as temporary files are.
    let mut file = tempfile::Builder::new().prefix(".kept-key-").tempfile_in(folder)?;
    writeln!(file, "{}", blake3::Hash::from_bytes(key).to_hex())?;
    file.as_file().sync_all()?;
    match file.persist_noclobber(path) {
        Ok(_) => Ok(key),
        // Another process was first.
        Err(error) if error.error.kind() == ErrorKind::AlreadyExists => read(),
        Err(error) => Err(error.error),
    }
}
