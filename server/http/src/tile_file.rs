//! Map tiles in one file (PMTiles, version 3) on disk or in an object store, read tile by tile.

use crate::kept_store::{KeptStore, KeptStoreError};
use axum::body::Bytes;
use futures_util::FutureExt;
use pmtiles::{
    AsyncBackend, AsyncPmTilesReader, BackendResponse, DirEntry, Directory, DirectoryCache, Header, PmtError,
    PmtResult, TileCoord, TileId,
};
use serde_json::Value;
use std::{
    collections::HashMap,
    fs::File,
    future::Future,
    io::{Error, ErrorKind},
    os::unix::fs::{FileExt, MetadataExt},
    path::Path,
    sync::{Arc, PoisonError, RwLock},
};
use thiserror::Error;

/// Directories, metadata and tiles of real files have some megabytes at most.
const MAX_PART_BYTES: usize = 64 << 20;
/// Header and root directory: another file has others.
const HEAD_BYTES: usize = 16_384;
const MAGIC: &[u8] = b"PMTiles";
/// Where the header says where the tiles begin, and how many bytes they are.
const DATA_START_AT: usize = 56;
const DATA_LENGTH_AT: usize = 64;
/// Directories that are kept at once: some thousand tiles each.
const MAX_DIRECTORIES: usize = 64;

/// Why tiles cannot be read.
#[derive(Debug, Error)]
pub enum TileFileError {
    /// It cannot be opened.
    #[error("{0}")]
    Io(#[from] Error),
    /// Its store cannot be had.
    #[error("{0}")]
    Store(#[from] KeptStoreError),
    /// It was written into, or replaced, since it was opened.
    #[error("it has changed since it was opened")]
    Changed,
    /// Its end is not there.
    #[error("it is cut short")]
    CutShort,
    /// It is no PMTiles file, or a broken one.
    #[error("it is no sound PMTiles file of version 3: {0}")]
    Unreadable(PmtError),
}

impl From<PmtError> for TileFileError {
    fn from(error: PmtError) -> Self {
        match error {
            PmtError::Reading(error) => Self::Io(error),
            PmtError::SourceModified => Self::Changed,
            PmtError::UnexpectedNumberOfBytesReturned(..) => Self::CutShort,
            error => Self::Unreadable(error),
        }
    }
}

/// A file of tiles.
pub(crate) struct TileFile {
    reader: AsyncPmTilesReader<Parts, Directories>,
    pub(crate) metadata: Value,
    /// What tells its tiles from those of another file, wherever either lies.
    pub(crate) version: String,
    /// What tells it from what was or will be at its address.
    pub(crate) identity: String,
}

impl TileFile {
    /// Opens a file on disk.
    ///
    /// # Errors
    /// [`TileFileError`] for what is no PMTiles file.
    pub(crate) fn open(path: &Path) -> Result<Self, TileFileError> {
        Self::of_parts(Parts::File(File::open(path)?))
    }

    /// Opens a file at an address: a path, or as [`KeptStore`] has them with the name of the file behind.
    ///
    /// # Errors
    /// As [`Self::open`], and [`TileFileError::Store`].
    pub(crate) fn open_at(address: &str) -> Result<Self, TileFileError> {
        if let Some(path) = address.strip_prefix("file://").or((!address.contains("://")).then_some(address))
        {
            return Self::open(Path::new(path));
        }
        let bad = || KeptStoreError::BadAddress { address: address.to_owned() };
        let (folder, name) = address.rsplit_once('/').filter(|(_, name)| !name.is_empty()).ok_or_else(bad)?;
        let store = Arc::new(KeptStore::of_environment(folder)?);
        Self::of_parts(Parts::Object { store, name: name.to_owned() })
    }

    fn of_parts(parts: Parts) -> Result<Self, TileFileError> {
        let head = at_once(parts.read(0, HEAD_BYTES))?;
        let identity = head.data_version_string.unwrap_or_default();
        // Its tiles are at the end (specification of version 3, header).
        let number = |at: usize| Some(u64::from_le_bytes(head.bytes.get(at..at + 8)?.try_into().ok()?));
        if head.bytes.starts_with(MAGIC)
            && let (Some(start), Some(length)) = (number(DATA_START_AT), number(DATA_LENGTH_AT))
            && let Some(last) = start.checked_add(length).and_then(|end| end.checked_sub(1))
            && at_once(parts.read(last, 1))?.bytes.is_empty()
        {
            return Err(TileFileError::CutShort);
        }
        let version = blake3::hash(&head.bytes).to_hex()[..16].to_owned();
        let reader = at_once(AsyncPmTilesReader::try_from_cached_source(parts, Directories::default()))?;
        let metadata = serde_json::from_str(&at_once(reader.get_metadata())?).unwrap_or_default();
        Ok(Self { reader, metadata, version, identity })
    }

    pub(crate) fn header(&self) -> &Header {
        self.reader.get_header()
    }

    pub(crate) fn zooms(&self) -> (u8, u8) {
        (self.header().min_zoom, self.header().max_zoom)
    }

    /// The bytes of a tile; None where there is none.
    ///
    /// # Errors
    /// [`TileFileError`] for a file that has changed or is broken, or whose store is away.
    pub(crate) fn tile(&self, z: u8, x: u32, y: u32) -> Result<Option<Bytes>, TileFileError> {
        let Ok(coord) = TileCoord::new(z, x, y) else { return Ok(None) };
        Ok(at_once(self.reader.get_tile(coord))?)
    }
}

/// Reads parts of a file at once: what waits for them never waits.
enum Parts {
    File(File),
    Object { store: Arc<KeptStore>, name: String },
}

impl AsyncBackend for Parts {
    async fn read(&self, offset: u64, length: usize) -> PmtResult<BackendResponse> {
        if length > MAX_PART_BYTES {
            return Err(PmtError::InvalidEntry);
        }
        match self {
            Self::File(file) => {
                let mut bytes = vec![0; length];
                let mut filled = 0;
                while filled < length {
                    match file.read_at(&mut bytes[filled..], offset.saturating_add(filled as u64))? {
                        0 => break,
                        more => filled += more,
                    }
                }
                bytes.truncate(filled);
                // Who writes into the file instead of replacing it is found out.
                let found = file.metadata()?;
                let version =
                    format!("{} {} {}.{}", found.ino(), found.len(), found.mtime(), found.mtime_nsec());
                Ok(BackendResponse::new_with_version(bytes.into(), version))
            }
            Self::Object { store, name } => {
                let missing = || Error::new(ErrorKind::NotFound, format!("{name} is not in its store"));
                let part = store.part(name, (offset, length)).map_err(Error::other)?;
                let (bytes, version) = part.ok_or_else(missing)?;
                Ok(BackendResponse::new_with_version(bytes, version))
            }
        }
    }
}

/// The directories of a file that were read lately.
#[derive(Default)]
struct Directories(RwLock<HashMap<u64, Directory>>);

impl DirectoryCache for Directories {
    async fn get_dir_entry_or_insert(
        &self,
        offset: u64,
        tile: TileId,
        fetch: impl Future<Output = PmtResult<Directory>> + Send,
    ) -> PmtResult<Option<DirEntry>> {
        let known = {
            let directories = self.0.read().unwrap_or_else(PoisonError::into_inner);
            directories.get(&offset).map(|directory| directory.find_tile_id(tile).copied())
        };
        if let Some(entry) = known {
            return Ok(entry);
        }
        let directory = fetch.await?;
        let entry = directory.find_tile_id(tile).copied();
        let mut directories = self.0.write().unwrap_or_else(PoisonError::into_inner);
        if directories.len() >= MAX_DIRECTORIES {
            directories.clear();
        }
        directories.insert(offset, directory);
        Ok(entry)
    }
}

/// What comes without waiting, as all that [`Parts`] reads does.
fn at_once<T>(reading: impl Future<Output = PmtResult<T>>) -> PmtResult<T> {
    let waiting = || PmtError::Reading(ErrorKind::WouldBlock.into());
    reading.now_or_never().unwrap_or_else(|| Err(waiting()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pmtiles::{PmTilesWriter, TileType};

    /// A file in a store is read as one on disk, and of one that has changed nothing is taken.
    #[test]
    fn files_in_stores_are_read_by_parts() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.pmtiles");
        let write = |tile: &[u8]| {
            let mut writer = PmTilesWriter::new(TileType::Png).create(File::create(&path).unwrap()).unwrap();
            writer.add_tile(TileCoord::new(0, 0, 0).unwrap(), tile).unwrap();
            writer.finalize().unwrap();
        };
        write(b"one");
        let store = KeptStore::open(&format!("file://{}", folder.path().display()), &[]).unwrap();
        let parts = Parts::Object { store: Arc::new(store), name: "map.pmtiles".to_owned() };
        let files = [TileFile::of_parts(parts).unwrap(), TileFile::open(&path).unwrap()];
        assert_eq!(files[0].version, files[1].version);
        for file in &files {
            assert_eq!(file.tile(0, 0, 0).unwrap().unwrap(), "one");
            assert!(file.tile(1, 0, 0).unwrap().is_none());
        }
        write(b"another");
        for file in &files {
            assert!(matches!(file.tile(0, 0, 0), Err(TileFileError::Changed)));
        }
        assert_ne!(TileFile::open(&path).unwrap().version, files[0].version);
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() - 1]).unwrap();
        assert!(matches!(TileFile::open(&path), Err(TileFileError::CutShort)));
        let missing = TileFile::open_at("s3://").err().unwrap().to_string();
        assert!(missing.contains("s3://BUCKET"), "{missing}");
    }
}
