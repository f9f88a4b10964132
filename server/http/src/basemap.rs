//! A basemap that the operator puts beside the scenes: vector tiles in one file (PMTiles, version 3), read tile by tile.

use flate2::read::GzDecoder;
use pmtiles::{TileCoord, TileId};
use serde_json::Value;
use std::{
    collections::HashMap,
    fs::File,
    io::Read,
    os::unix::fs::FileExt,
    path::Path,
    sync::{Arc, Mutex, PoisonError},
};
use thiserror::Error;

const MAGIC: &[u8] = b"PMTiles\x03";
const HEADER_BYTES: usize = 127;
/// Directories and metadata of real files have some megabytes at most.
const MAX_DIRECTORY_BYTES: u64 = 64 << 20;
/// A tile of a map has a megabyte at most.
const MAX_TILE_BYTES: u64 = 8 << 20;
/// Directories below the root lie below each other so deep at most, as the specification has it.
const MAX_DEPTH: usize = 4;
/// Directories that are kept.
const KEPT_DIRECTORIES: usize = 64;
/// Vector tiles of Mapbox's kind.
const VECTOR_TILES: u8 = 1;

/// Why a file is no basemap.
#[derive(Debug, Error)]
pub enum BasemapError {
    /// It cannot be read.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// It is none of these.
    #[error("it is {0}")]
    Invalid(&'static str),
}

/// An entry of a directory: tiles from an id on, or a directory where it has no run.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    id: u64,
    run: u64,
    length: u64,
    offset: u64,
}

/// A file of vector tiles.
#[derive(Debug)]
pub struct Basemap {
    file: File,
    root: Vec<Entry>,
    leaves_at: u64,
    tiles_at: u64,
    is_directory_gzip: bool,
    /// How tiles are compressed, as HTTP names it.
    pub(crate) encoding: Option<&'static str>,
    pub(crate) zooms: (u8, u8),
    /// West, south, east, north, degrees.
    pub(crate) bounds: [f64; 4],
    /// Whose data it is, without markup.
    pub(crate) attribution: String,
    /// Names of the layers.
    pub(crate) layers: Vec<String>,
    kept: Mutex<HashMap<u64, Arc<Vec<Entry>>>>,
}

impl Basemap {
    /// Opens a file.
    ///
    /// # Errors
    /// [`BasemapError`] for what is no PMTiles file of vector tiles.
    pub fn open(path: &Path) -> Result<Self, BasemapError> {
        let file = File::open(path)?;
        let mut header = [0; HEADER_BYTES];
        file.read_exact_at(&mut header, 0)?;
        if !header.starts_with(MAGIC) {
            return Err(BasemapError::Invalid("no PMTiles file of version 3"));
        }
        if header[99] != VECTOR_TILES {
            return Err(BasemapError::Invalid("no file of vector tiles (MVT)"));
        }
        let number = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| header[at + i]));
        let degrees =
            |at: usize| f64::from(i32::from_le_bytes(std::array::from_fn(|i| header[at + i]))) * 1e-7;
        let is_directory_gzip = match header[97] {
            1 => false,
            2 => true,
            _ => return Err(BasemapError::Invalid("compressed otherwise than by gzip")),
        };
        let encoding = match header[98] {
            1 => None,
            2 => Some("gzip"),
            3 => Some("br"),
            4 => Some("zstd"),
            _ => return Err(BasemapError::Invalid("compressed in an unknown way")),
        };
        let read = |at: u64, length: u64| read_part(&file, (at, length), is_directory_gzip);
        let root = directory(&read(number(8), number(16))?)?;
        let metadata: Value = serde_json::from_slice(&read(number(24), number(32))?).unwrap_or_default();
        let layers = metadata["vector_layers"].as_array().into_iter().flatten();
        let layers = layers.filter_map(|layer| layer["id"].as_str()).map(str::to_owned).collect();
        Ok(Self {
            root,
            leaves_at: number(40),
            tiles_at: number(56),
            is_directory_gzip,
            encoding,
            zooms: (header[100], header[101]),
            bounds: [degrees(102), degrees(106), degrees(110), degrees(114)],
            attribution: without_markup(metadata["attribution"].as_str().unwrap_or_default()),
            layers,
            kept: Mutex::default(),
            file,
        })
    }

    /// The bytes of a tile; None where there is none.
    ///
    /// # Errors
    /// [`BasemapError`] for a file that has changed or is broken.
    pub fn tile(&self, z: u8, x: u32, y: u32) -> Result<Option<Vec<u8>>, BasemapError> {
        let Ok(coord) = TileCoord::new(z, x, y) else { return Ok(None) };
        let id = TileId::from(coord).value();
        let mut found = entry(&self.root, id);
        for _ in 0..MAX_DEPTH {
            match found {
                Some(Entry { run: 0, length, offset, .. }) => {
                    found = entry(&self.leaf(offset, length)?, id);
                }
                Some(Entry { length, offset, .. }) => {
                    if length > MAX_TILE_BYTES {
                        return Err(BasemapError::Invalid("broken: a tile is too long"));
                    }
                    return Ok(Some(read_part(
                        &self.file,
                        (self.tiles_at.saturating_add(offset), length),
                        false,
                    )?));
                }
                None => return Ok(None),
            }
        }
        Err(BasemapError::Invalid("broken: its directories are too deep"))
    }

    fn leaf(&self, offset: u64, length: u64) -> Result<Arc<Vec<Entry>>, BasemapError> {
        if let Some(known) = self.kept.lock().unwrap_or_else(PoisonError::into_inner).get(&offset) {
            return Ok(Arc::clone(known));
        }
        let part = (self.leaves_at.saturating_add(offset), length);
        let leaf = Arc::new(directory(&read_part(&self.file, part, self.is_directory_gzip)?)?);
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.len() >= KEPT_DIRECTORIES {
            kept.clear();
        }
        kept.insert(offset, Arc::clone(&leaf));
        Ok(leaf)
    }
}

/// Bytes of the file from a place on, uncompressed where they are compressed.
fn read_part(file: &File, (at, length): (u64, u64), is_gzip: bool) -> Result<Vec<u8>, BasemapError> {
    if length > MAX_DIRECTORY_BYTES {
        return Err(BasemapError::Invalid("broken: a part is too long"));
    }
    let mut bytes = vec![0; length as usize];
    file.read_exact_at(&mut bytes, at)?;
    if !is_gzip {
        return Ok(bytes);
    }
    let mut plain = Vec::new();
    GzDecoder::new(&bytes[..]).take(MAX_DIRECTORY_BYTES).read_to_end(&mut plain)?;
    Ok(plain)
}

/// The entries of a directory: ids as differences, runs, lengths, and offsets, of which 0 is "after the one before".
fn directory(mut bytes: &[u8]) -> Result<Vec<Entry>, BasemapError> {
    let count = varint(&mut bytes)?;
    if count > bytes.len() as u64 / 4 {
        return Err(BasemapError::Invalid("broken: a directory is cut off"));
    }
    let mut entries = vec![Entry::default(); count as usize];
    let mut id = 0u64;
    for entry in &mut entries {
        id = id.saturating_add(varint(&mut bytes)?);
        entry.id = id;
    }
    for entry in &mut entries {
        entry.run = varint(&mut bytes)?;
    }
    for entry in &mut entries {
        entry.length = varint(&mut bytes)?;
    }
    let mut after = 0u64;
    for entry in &mut entries {
        entry.offset = match varint(&mut bytes)? {
            0 => after,
            offset => offset - 1,
        };
        after = entry.offset.saturating_add(entry.length);
    }
    Ok(entries)
}

fn varint(bytes: &mut &[u8]) -> Result<u64, BasemapError> {
    let mut value = 0;
    for shift in (0..64).step_by(7) {
        let (&byte, rest) =
            bytes.split_first().ok_or(BasemapError::Invalid("broken: a directory is cut off"))?;
        *bytes = rest;
        value |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Ok(value);
        }
    }
    Err(BasemapError::Invalid("broken: a number is too long"))
}

/// The entry that has an id, or the directory that may have it.
fn entry(entries: &[Entry], id: u64) -> Option<Entry> {
    let last = entries.partition_point(|entry| entry.id <= id).checked_sub(1)?;
    let found = entries[last];
    (found.run == 0 || id - found.id < found.run).then_some(found)
}

/// Text of HTML without its tags.
fn without_markup(html: &str) -> String {
    let mut is_tag = false;
    let text = html.chars().filter(|&sign| {
        let was_tag = is_tag;
        is_tag = if sign == '<' { true } else { is_tag && sign != '>' };
        !(is_tag || was_tag)
    });
    text.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pmtiles::{Compression, PmTilesWriter, TileType};

    /// A file of so many tiles of a zoom, each of its own bytes, written by another program than ours.
    fn written(path: &Path, z: u8, side: u32) {
        let file = File::create(path).unwrap();
        let metadata = r#"{"attribution":"<a href=\"https://osm.org\">OpenStreetMap</a>","vector_layers":[{"id":"water"},{"id":"roads"}]}"#;
        let mut writer = PmTilesWriter::new(TileType::Mvt)
            .tile_compression(Compression::None)
            .metadata(metadata)
            .min_zoom(z)
            .max_zoom(z)
            .bounds(5.5, 45.0, 10.5, 48.0)
            .create(file)
            .unwrap();
        let mut coords: Vec<TileCoord> =
            (0..side).flat_map(|x| (0..side).map(move |y| TileCoord::new(z, x, y).unwrap())).collect();
        coords.sort_by_key(|coord| TileId::from(*coord).value());
        for coord in coords {
            writer.add_tile(coord, format!("tile {} {}", coord.x(), coord.y()).as_bytes()).unwrap();
        }
        writer.finalize().unwrap();
    }

    /// Every tile is found by its place, with directories below the root too; beyond them there is none.
    #[test]
    fn tiles_are_found_by_their_place() {
        let folder = tempfile::tempdir().unwrap();
        for (z, side) in [(1, 2), (8, 180)] {
            let path = folder.path().join(format!("{z}.pmtiles"));
            written(&path, z, side);
            let map = Basemap::open(&path).unwrap();
            for (x, y) in [(0, 0), (1, 0), (side - 1, side - 1), (side / 2, side / 3)] {
                let tile = map.tile(z, x, y).unwrap().unwrap();
                assert_eq!(tile, format!("tile {x} {y}").as_bytes());
            }
            assert!(map.tile(z, side + 60, 3).unwrap().is_none() && map.tile(0, 0, 0).unwrap().is_none());
            assert!(map.tile(9, 600, 0).unwrap().is_none(), "no such tile in the world");
            assert_eq!(
                (map.attribution.as_str(), &map.layers[..]),
                ("OpenStreetMap", &["water".to_owned(), "roads".to_owned()][..])
            );
            assert_eq!((map.zooms, map.bounds[3]), ((z, z), 48.0));
        }
    }

    /// What is no basemap is refused in words, and what is cut off as well.
    #[test]
    fn other_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.pmtiles");
        let refused = || Basemap::open(&path).unwrap_err().to_string();
        std::fs::write(&path, [0; 200]).unwrap();
        assert!(refused().contains("PMTiles"));
        written(&path, 1, 2);
        let mut bytes = std::fs::read(&path).unwrap();
        bytes[99] = 2;
        std::fs::write(&path, &bytes).unwrap();
        assert!(refused().contains("vector"));
        std::fs::write(&path, &bytes[..100]).unwrap();
        assert!(Basemap::open(&path).is_err());
    }
}
