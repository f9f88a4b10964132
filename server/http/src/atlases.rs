//! Maps of brightness that were made beforehand (`skyglow atlas`, `skyglow.export.pmtiles`): their tiles are shown where the server
//! would compute the same map, which for a planet takes hours.

use crate::{
    error::ApiError,
    tile_file::{TileFile, TileFileError},
};
use axum::body::Bytes;
use pmtiles::TileType;
use skyglow_app::{
    error::AppError,
    fingerprint::{ATLAS_KEY, ATLAS_QUERY, atlas_key},
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

/// Why a file is no atlas, or a tile of it cannot be had.
#[derive(Debug, Error)]
pub enum AtlasError {
    /// It cannot be read.
    #[error(transparent)]
    File(#[from] TileFileError),
    /// It holds other tiles.
    #[error("it is no file of PNG tiles")]
    NoPictures,
    /// Nothing says what of.
    #[error(
        "it does not say which map it is: it is of another program, of an older Skyglow, of another layer than brightness, or of a map of which parts \
         were missing; make it anew with skyglow atlas or skyglow.export.pmtiles"
    )]
    NoKey,
    /// One of its pictures is none.
    #[error("a tile is broken: {0}")]
    BrokenTile(#[from] DisplayError),
}

impl From<AtlasError> for ApiError {
    fn from(error: AtlasError) -> Self {
        match error {
            AtlasError::File(reason) => Self::App(AppError::StoreAway { reason: reason.to_string() }),
            error => Self::internal(error),
        }
    }
}

/// A map that was made beforehand.
pub struct Atlas {
    file: TileFile,
    /// [`skyglow_app::fingerprint::atlas_key`] of what it shows.
    key: String,
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
        if file.header().tile_type != TileType::Png {
            return Err(AtlasError::NoPictures);
        }
        let key = file.metadata[ATLAS_KEY].as_str().ok_or(AtlasError::NoKey)?.to_owned();
        Ok(Self { file, key })
    }

    fn said(&self, name: &str) -> &str {
        self.file.metadata[name].as_str().unwrap_or_default()
    }

    /// Whether it is what the source would compute now: of the same version of its scene, by the same packs and program.
    fn is_current(&self, source: &dyn SkySource) -> bool {
        let key = || {
            let facts = source.facts();
            let request = brightness(Some(self.said(ATLAS_QUERY)), scene_id(self.said("scene"))?, facts)?;
            let view = source.view(&request.scene, request.scenario.as_ref())?;
            Ok::<_, AppError>(atlas_key(&request, view.version(), facts)? == self.key)
        };
        key().unwrap_or(false)
    }

    /// Zooms that it has tiles of.
    pub(crate) fn zooms(&self) -> (u8, u8) {
        self.file.zooms()
    }

    /// What decides its tiles, as text for ETags.
    pub(crate) fn tiles_key(&self) -> String {
        format!("{} {}", self.key, self.file.version)
    }

    /// A tile as PNG: as it is in the file, larger than there joined of those of the next zoom, and beyond the last zoom enlarged.
    ///
    /// # Errors
    /// [`AtlasError`] where the file has changed or is broken, or its store is away.
    pub(crate) fn tile(
        &self,
        (z, x, y): (u8, u32, u32),
        size_px: u32,
        notes: &Notes,
    ) -> Result<Bytes, AtlasError> {
        let (_, deepest) = self.zooms();
        if size_px > TILE_PX && z < deepest {
            let mut four = Vec::new();
            for (down, right) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                four.push(self.file.tile(z + 1, 2 * x + right, 2 * y + down)?);
            }
            if four.iter().any(Option::is_some) {
                let four: Vec<Option<&[u8]>> = four.iter().map(Option::as_deref).collect();
                return Ok(joined_tiles_png(&four, TILE_PX, notes)?.into());
            }
        }
        let beyond = z.saturating_sub(deepest);
        match self.file.tile(z - beyond, x >> beyond, y >> beyond)? {
            None => {
                let count = (size_px * size_px) as usize;
                let nothing = (vec![f32::NAN; count], vec![false; count]);
                Ok(brightness_tile_png(&nothing.0, &nothing.1, size_px, (1.0, 2.0), notes)?.into())
            }
            Some(tile) if beyond == 0 && size_px == TILE_PX => Ok(tile),
            Some(tile) => {
                let inside = (1u32 << beyond) - 1;
                Ok(enlarged_tile_png(&tile, (beyond, x & inside, y & inside), size_px, notes)?.into())
            }
        }
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
    /// Whether it could be opened the last time; what was open stays open.
    is_there: bool,
}

impl Atlases {
    /// Opens files, and looks every minute for what was made anew, until this is dropped. What cannot be opened is told and left out.
    pub(crate) fn watched(addresses: &[String], source: &Arc<dyn SkySource>) -> Arc<Self> {
        let slot = |address: &String| Slot { address: address.clone(), atlas: None, is_there: true };
        let atlases = Arc::new(Self(RwLock::new(addresses.iter().map(slot).collect())));
        if !addresses.is_empty() {
            atlases.refresh(&|atlas| atlas.is_current(&**source));
            let of: (Weak<Self>, Weak<dyn SkySource>) = (Arc::downgrade(&atlases), Arc::downgrade(source));
            std::thread::spawn(move || {
                loop {
                    std::thread::sleep(LOOK_EVERY);
                    let (Some(atlases), Some(source)) = (of.0.upgrade(), of.1.upgrade()) else { break };
                    atlases.refresh(&|atlas| atlas.is_current(&*source));
                }
            });
        }
        atlases
    }

    fn refresh(&self, is_current: &dyn Fn(&Atlas) -> bool) {
        let mut slots = self.0.read().unwrap_or_else(PoisonError::into_inner).clone();
        for slot in &mut slots {
            let opened = Atlas::open(&slot.address);
            let was_there = std::mem::replace(&mut slot.is_there, opened.is_ok());
            match opened {
                Err(reason) if was_there => tracing::error!(%reason, address = slot.address, "no atlas"),
                Err(_) => {}
                Ok(atlas) => {
                    let is_known = |known: &Arc<Atlas>| known.tiles_key() == atlas.tiles_key();
                    if !slot.atlas.as_ref().is_some_and(is_known) {
                        tell(&atlas, &slot.address, is_current(&atlas));
                        slot.atlas = Some(Arc::new(atlas));
                    }
                }
            }
        }
        *self.0.write().unwrap_or_else(PoisonError::into_inner) = slots;
    }

    /// That of a map.
    pub(crate) fn get(&self, key: &str) -> Option<Arc<Atlas>> {
        let slots = self.0.read().unwrap_or_else(PoisonError::into_inner);
        slots.iter().filter_map(|slot| slot.atlas.as_ref()).find(|atlas| atlas.key == key).cloned()
    }
}

fn tell(atlas: &Atlas, address: &str, is_current: bool) {
    let name = atlas.said("name");
    if is_current {
        tracing::info!(%address, "atlas of {name}");
    } else {
        tracing::warn!(
            %address,
            scene = atlas.said("scene"),
            "the atlas of {name} is not shown: its scene is not here or has changed, or it was made with other packs or another version of \
             Skyglow; make it anew"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pmtiles::{PmTilesWriter, TileCoord};
    use std::path::Path;

    fn written(path: &Path, key: &str) {
        let metadata = serde_json::json!({ATLAS_KEY: key}).to_string();
        // Written beside it and renamed, as the program does.
        let unfinished = path.with_extension("unfinished");
        let file = std::fs::File::create(&unfinished).unwrap();
        let mut writer = PmTilesWriter::new(TileType::Png).metadata(&metadata).create(file).unwrap();
        writer.add_tile(TileCoord::new(0, 0, 0).unwrap(), b"a picture").unwrap();
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
            is_there: true,
        };
        let atlases = Atlases(RwLock::new(paths.iter().map(slot).collect()));
        let keys = |keys: [&str; 3]| keys.map(|key| atlases.get(key).is_some());
        let refresh = || atlases.refresh(&|_| true);
        written(&paths[0], "a");
        refresh();
        assert_eq!(keys(["a", "b", "c"]), [true, false, false]);
        let before = atlases.get("a").unwrap();
        written(&paths[1], "b");
        refresh();
        assert!(Arc::ptr_eq(&before, &atlases.get("a").unwrap()), "it is the same file");
        assert_eq!(keys(["a", "b", "c"]), [true, true, false]);
        std::fs::write(&paths[0], b"damaged").unwrap();
        written(&paths[1], "c");
        refresh();
        assert_eq!(keys(["a", "b", "c"]), [true, false, true]);
    }
}
