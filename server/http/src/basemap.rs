//! A basemap that the operator puts beside the scenes: vector tiles in one file (PMTiles, version 3), read tile by tile.

use crate::tile_file::{TileFile, TileFileError};
use axum::body::Bytes;
use pmtiles::{Compression, TileType};
use std::{fmt, path::Path};
use thiserror::Error;

/// Why a file is no basemap.
#[derive(Debug, Error)]
pub enum BasemapError {
    /// It cannot be read.
    #[error(transparent)]
    File(#[from] TileFileError),
    /// It holds other tiles.
    #[error("it is no file of vector tiles (MVT)")]
    NotVectorTiles,
    /// A browser could not read them.
    #[error("how its tiles are compressed is not known")]
    UnknownCompression,
}

/// A file of vector tiles.
pub struct Basemap {
    file: TileFile,
    /// How tiles are compressed, as HTTP names it.
    pub(crate) encoding: Option<&'static str>,
    pub(crate) zooms: (u8, u8),
    /// West, south, east, north, degrees.
    pub(crate) bounds: [f64; 4],
    /// Whose data it is, without markup.
    pub(crate) attribution: String,
    /// Names of the layers.
    pub(crate) layers: Vec<String>,
}

impl fmt::Debug for Basemap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Basemap").field("zooms", &self.zooms).field("layers", &self.layers).finish()
    }
}

impl Basemap {
    /// Opens a file.
    ///
    /// # Errors
    /// [`BasemapError`] for what is no PMTiles file of vector tiles.
    pub fn open(path: &Path) -> Result<Self, BasemapError> {
        let file = TileFile::open(path)?;
        let (header, metadata) = (file.header(), &file.metadata);
        if header.tile_type != TileType::Mvt {
            return Err(BasemapError::NotVectorTiles);
        }
        if header.tile_compression == Compression::Unknown {
            return Err(BasemapError::UnknownCompression);
        }
        let layers = metadata["vector_layers"].as_array().into_iter().flatten();
        let layers = layers.filter_map(|layer| layer["id"].as_str()).map(str::to_owned).collect();
        Ok(Self {
            encoding: header.tile_compression.content_encoding(),
            zooms: file.zooms(),
            bounds: [header.min_longitude, header.min_latitude, header.max_longitude, header.max_latitude],
            attribution: without_markup(metadata["attribution"].as_str().unwrap_or_default()),
            layers,
            file,
        })
    }

    /// The bytes of a tile; None where there is none.
    ///
    /// # Errors
    /// [`BasemapError`] for a file that has changed or is broken.
    pub fn tile(&self, z: u8, x: u32, y: u32) -> Result<Option<Bytes>, BasemapError> {
        Ok(self.file.tile(z, x, y)?)
    }
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
    use pmtiles::{PmTilesWriter, TileCoord, TileId};
    use std::fs::File;

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
