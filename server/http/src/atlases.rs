//! Maps of brightness that were made beforehand (`skyglow atlas`, `skyglow.export.pmtiles`): their tiles are shown where the server
//! would compute the same map, which for a planet takes hours.

use crate::{
    error::ApiError,
    tile_file::{TileFile, TileFileError},
};
use axum::body::Bytes;
use pmtiles::{Compression, TileType};
use skyglow_app::{
    error::AppError,
    fingerprint::{ATLAS_EXTENT, ATLAS_KEY, ATLAS_QUERY, ATLAS_STEP, atlas_key},
    request::{brightness, scene_id},
    source::SkySource,
};
use skyglow_display::{
    DisplayError, Notes,
    tile::{brightness_tile_png, enlarged_tile_png, joined_tiles_png},
};
use std::{
    fmt,
    sync::{Arc, PoisonError, RwLock, Weak},
    time::Duration,
};
use thiserror::Error;

/// How often it is looked for atlases that were made anew.
const LOOK_EVERY: Duration = Duration::from_secs(60);

/// Pixels a side of its tiles.
const TILE_PX: u32 = 256;
/// Tiles that are read at a time: a store that hangs is to keep no more threads from other work.
pub(crate) const READS: usize = 4;
/// Degrees that an edge may differ by.
const EDGE_DEG: f64 = 1e-4;
/// Begins every PNG.
const PNG: &[u8] = b"\x89PNG";

/// Why a file is no atlas, or a tile of it cannot be had.
#[derive(Debug, Error)]
pub enum AtlasError {
    /// It cannot be read.
    #[error(transparent)]
    File(#[from] TileFileError),
    /// It holds other tiles.
    #[error("it is no file of plain PNG tiles")]
    NoPictures,
    /// Beyond its edges it would look as if there were no light.
    #[error("it is a part of a map, cut out of another file")]
    Part,
    /// Nothing says what of.
    #[error(
        "it does not say which map it is: it is of another program, of an older Skyglow, of another layer than brightness, without its last zooms, or of a map of \
         which parts were missing; make it anew with skyglow atlas or skyglow.export.pmtiles"
    )]
    NoKey,
    /// A tile of it cannot be read.
    #[error("{address}: {reason}")]
    Tile {
        /// Where it is.
        address: String,
        /// Why.
        reason: TileFileError,
    },
    /// One of its pictures is none.
    #[error("a tile is broken: {0}")]
    BrokenTile(#[from] DisplayError),
}

impl From<AtlasError> for ApiError {
    fn from(error: AtlasError) -> Self {
        match error {
            // It is opened anew within a minute.
            error @ AtlasError::Tile {
                reason: TileFileError::Io(_) | TileFileError::Changed | TileFileError::CutShort,
                ..
            } => Self::App(AppError::AtlasAway { reason: error.to_string() }),
            error => Self::internal(error),
        }
    }
}

/// A map that was made beforehand.
pub struct Atlas {
    address: String,
    file: TileFile,
    /// [`skyglow_app::fingerprint::atlas_key`] of what it shows.
    key: String,
    /// Pixels of the scene from one place to the next.
    step: u64,
}

impl fmt::Debug for Atlas {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Atlas").field("key", &self.key).field("zooms", &self.file.zooms()).finish()
    }
}

impl Atlas {
    /// Opens a PMTiles file.
    ///
    /// * `address`: a path, or that of a store (`s3://BUCKET/NAME.pmtiles`, `gs://`, `az://`).
    ///
    /// # Errors
    /// [`AtlasError`].
    pub fn open(address: &str) -> Result<Self, AtlasError> {
        let file = TileFile::open_at(address)?;
        let header = file.header();
        if header.tile_type != TileType::Png || header.tile_compression != Compression::None {
            return Err(AtlasError::NoPictures);
        }
        let said = |name: &str| &file.metadata[name];
        let (Some(key), Some(step)) = (said(ATLAS_KEY).as_str(), said(ATLAS_STEP).as_u64()) else {
            return Err(AtlasError::NoKey);
        };
        let found = [
            header.min_longitude,
            header.min_latitude,
            header.max_longitude,
            header.max_latitude,
            f64::from(header.min_zoom),
            f64::from(header.max_zoom),
        ];
        let is_there = |(at, found): (usize, &f64)| {
            said(ATLAS_EXTENT)[at].as_f64().is_some_and(|said| (said - found).abs() < EDGE_DEG)
        };
        if !found.iter().enumerate().all(is_there) {
            return Err(AtlasError::Part);
        }
        Ok(Self { address: address.to_owned(), key: key.to_owned(), step, file })
    }

    fn said(&self, name: &str) -> &str {
        self.file.metadata[name].as_str().unwrap_or_default()
    }

    /// Why it is not what the source would compute now; None where it is.
    fn is_not_shown_for(&self, source: &dyn SkySource) -> Result<Option<String>, AppError> {
        let facts = source.facts();
        let request = brightness(Some(self.said(ATLAS_QUERY)), scene_id(self.said("scene"))?, facts)?;
        let view = source.view(&request.scene, request.scenario.as_ref())?;
        let step = view.scene().place_lattice(request.max_places).step;
        Ok(if self.said("scene_version") != view.metadata().version {
            Some("its scene has changed since".to_owned())
        } else if atlas_key(&request, view.version(), facts)? != self.key {
            Some("it was made with other packs, or by another version of Skyglow".to_owned())
        } else if !self.is_as_fine_as(step) {
            Some(format!(
                "its places are {} pixels of the scene apart, and those that this server computes {step} (more --places of skyglow atlas, or fewer \
                 --brightness-places of skyglow serve)",
                self.step
            ))
        } else {
            None
        })
    }

    /// Whether its places are as near to each other as those of a map with so many pixels from one to the next.
    pub(crate) fn is_as_fine_as(&self, step: u32) -> bool {
        self.step <= u64::from(step)
    }

    /// Zooms that it has tiles of.
    pub(crate) fn zooms(&self) -> (u8, u8) {
        self.file.zooms()
    }

    /// What decides its tiles, as text for ETags.
    pub(crate) fn tiles_key(&self) -> String {
        format!("{} {}", self.key, self.file.version)
    }

    /// Reads what a tile is made of: itself, or of a larger one those of the next zoom, or beyond the last zoom the one that it is a part of.
    ///
    /// # Errors
    /// [`AtlasError`] where the file has changed or is broken, or its store is away.
    pub(crate) fn read(&self, (z, x, y): (u8, u32, u32), size_px: u32) -> Result<TileParts, AtlasError> {
        let (_, deepest) = self.zooms();
        if size_px > TILE_PX && z < deepest {
            let mut four = Vec::new();
            for (down, right) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                four.push(self.picture(z + 1, 2 * x + right, 2 * y + down)?);
            }
            if four.iter().any(Option::is_some) {
                return Ok(TileParts::Four(four));
            }
        }
        let beyond = z.saturating_sub(deepest);
        let inside = (1u32 << beyond) - 1;
        Ok(match self.picture(z - beyond, x >> beyond, y >> beyond)? {
            None => TileParts::Nothing,
            Some(tile) if beyond == 0 && size_px == TILE_PX => TileParts::Itself(tile),
            Some(tile) => TileParts::Part(tile, (beyond, x & inside, y & inside)),
        })
    }

    fn picture(&self, z: u8, x: u32, y: u32) -> Result<Option<Bytes>, AtlasError> {
        let failed = |reason| AtlasError::Tile { address: self.address.clone(), reason };
        let tile = self.file.tile(z, x, y).map_err(failed)?;
        match tile.as_ref().is_none_or(|tile| tile.starts_with(PNG)) {
            true => Ok(tile),
            false => Err(failed(TileFileError::Changed)),
        }
    }
}

/// What a tile is made of.
pub(crate) enum TileParts {
    /// It is in the file.
    Itself(Bytes),
    /// Those of the next zoom: north-west, north-east, south-west, south-east.
    Four(Vec<Option<Bytes>>),
    /// One of an earlier zoom, and which part of it, as of [`enlarged_tile_png`].
    Part(Bytes, (u8, u32, u32)),
    Nothing,
}

impl TileParts {
    /// The tile as PNG.
    ///
    /// # Errors
    /// [`AtlasError::BrokenTile`].
    pub(crate) fn draw(self, size_px: u32, notes: &Notes) -> Result<Vec<u8>, AtlasError> {
        Ok(match self {
            Self::Itself(tile) => tile.into(),
            Self::Four(four) => {
                let four: Vec<Option<&[u8]>> = four.iter().map(Option::as_deref).collect();
                joined_tiles_png(&four, TILE_PX, notes)?
            }
            Self::Part(tile, part) => enlarged_tile_png(&tile, part, size_px, notes)?,
            Self::Nothing => {
                let count = (size_px * size_px) as usize;
                let values = vec![f32::NAN; count];
                brightness_tile_png(&values, &vec![false; count], size_px, (1.0, 2.0), notes)?
            }
        })
    }
}

/// The atlases of a server.
#[derive(Debug, Default)]
pub struct Atlases(RwLock<Vec<Slot>>);

/// What is at an address.
#[derive(Clone, Debug)]
struct Slot {
    address: String,
    atlas: Option<Arc<Atlas>>,
    /// What was last said of it.
    told: String,
}

impl Atlases {
    /// Opens files, and looks every minute for what was made anew, until this is dropped. What cannot be opened is told and left out.
    pub(crate) fn watched(addresses: &[String], source: &Arc<dyn SkySource>) -> Arc<Self> {
        let slot = |address: &String| Slot { address: address.clone(), atlas: None, told: String::new() };
        let atlases = Arc::new(Self(RwLock::new(addresses.iter().map(slot).collect())));
        if !addresses.is_empty() {
            atlases.refresh(&|atlas| atlas.is_not_shown_for(&**source));
            let of: (Weak<Self>, Weak<dyn SkySource>) = (Arc::downgrade(&atlases), Arc::downgrade(source));
            std::thread::spawn(move || {
                loop {
                    std::thread::sleep(LOOK_EVERY);
                    let (Some(atlases), Some(source)) = (of.0.upgrade(), of.1.upgrade()) else { break };
                    atlases.refresh(&|atlas| atlas.is_not_shown_for(&*source));
                }
            });
        }
        atlases
    }

    fn refresh(&self, is_not_shown_for: &dyn Fn(&Atlas) -> Result<Option<String>, AppError>) {
        let mut slots = self.0.read().unwrap_or_else(PoisonError::into_inner).clone();
        for slot in &mut slots {
            let (is_fine, told) = match Atlas::open(&slot.address) {
                Err(reason) => {
                    // A store may be away for a while; what is gone or broken is computed.
                    let is_away = |error: &std::io::Error| error.kind() == std::io::ErrorKind::Other;
                    if !matches!(&reason, AtlasError::File(TileFileError::Io(error)) if is_away(error)) {
                        slot.atlas = None;
                    }
                    (false, format!("no atlas: {reason}"))
                }
                Ok(atlas) => {
                    let of = format!("{} ({})", atlas.said("name"), atlas.said(ATLAS_QUERY));
                    let (_, deepest) = atlas.zooms();
                    let told = match is_not_shown_for(&atlas) {
                        Ok(None) => (true, format!("atlas of {of}, down to zoom {deepest}")),
                        Ok(Some(reason)) => (false, format!("the atlas of {of} is not shown: {reason}")),
                        Err(reason) => (false, format!("the atlas of {of} is not shown: {reason}")),
                    };
                    if slot.atlas.as_ref().is_none_or(|known| known.file.identity != atlas.file.identity) {
                        slot.atlas = Some(Arc::new(atlas));
                        // It is told anew.
                        slot.told = String::new();
                    }
                    told
                }
            };
            if slot.told != told {
                match is_fine {
                    true => tracing::info!(address = slot.address, "{told}"),
                    false => tracing::warn!(address = slot.address, "{told}"),
                }
                slot.told = told;
            }
        }
        *self.0.write().unwrap_or_else(PoisonError::into_inner) = slots;
    }

    /// That of a map, the finest where there are several.
    pub(crate) fn get(&self, key: &str) -> Option<Arc<Atlas>> {
        let slots = self.0.read().unwrap_or_else(PoisonError::into_inner);
        let of_map = slots.iter().filter_map(|slot| slot.atlas.as_ref()).filter(|atlas| atlas.key == key);
        of_map.min_by_key(|atlas| atlas.step).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pmtiles::{PmTilesWriter, TileCoord};
    use std::path::Path;

    fn written(path: &Path, key: &str) {
        let extent = [-180.0, -85.0, 180.0, 85.0, 0.0, 0.0];
        let metadata = serde_json::json!({ATLAS_KEY: key, ATLAS_STEP: 1, ATLAS_EXTENT: extent}).to_string();
        // Written beside it and renamed, as the program does.
        let unfinished = path.with_extension("unfinished");
        let file = std::fs::File::create(&unfinished).unwrap();
        let mut writer = (PmTilesWriter::new(TileType::Png).metadata(&metadata).max_zoom(0))
            .bounds(-180.0, -85.0, 180.0, 85.0)
            .create(file)
            .unwrap();
        writer.add_tile(TileCoord::new(0, 0, 0).unwrap(), b"\x89PNG a picture").unwrap();
        writer.finalize().unwrap();
        std::fs::rename(unfinished, path).unwrap();
    }

    /// What is made anew is taken, what cannot be opened for a while stays, and what comes later is there then.
    #[test]
    fn atlases_are_looked_for_again() {
        let folder = tempfile::tempdir().unwrap();
        let paths = ["one", "two"].map(|name| folder.path().join(format!("{name}.pmtiles")));
        let slot = |path: &std::path::PathBuf| Slot {
            address: path.display().to_string(),
            atlas: None,
            told: String::new(),
        };
        let atlases = Atlases(RwLock::new(paths.iter().map(slot).collect()));
        let keys = |keys: [&str; 3]| keys.map(|key| atlases.get(key).is_some());
        let refresh = || atlases.refresh(&|_| Ok(None));
        written(&paths[0], "a");
        refresh();
        assert_eq!(keys(["a", "b", "c"]), [true, false, false]);
        let before = atlases.get("a").unwrap();
        written(&paths[1], "b");
        refresh();
        assert!(Arc::ptr_eq(&before, &atlases.get("a").unwrap()), "it is the same file");
        assert_eq!(keys(["a", "b", "c"]), [true, true, false]);
        // Damaged in place it is none, and mended with the same bytes it is there again.
        let whole = std::fs::read(&paths[0]).unwrap();
        std::fs::write(&paths[0], &whole[..whole.len() - 4]).unwrap();
        written(&paths[1], "c");
        refresh();
        assert_eq!(keys(["a", "b", "c"]), [false, false, true]);
        written(&paths[0], "a");
        refresh();
        let parts = atlases.get("a").unwrap().picture(0, 0, 0).unwrap();
        assert!(parts.unwrap().ends_with(b"a picture"));
    }
}
