//! Skylines made by tile when they are first needed, and kept.
//!
//! In a scene of millions of lights most skylines are never asked for, and all of them take hours to find. Such a scene has none when
//! it is stored. A tile is a block of the light pyramid of 128 × 128 pixels; the skylines of its lights and of the blocks within it
//! are the same numbers whenever they are made. They are kept in memory while there is room, and in files beside the scene's.
//! For one observer a part of them is enough ([`skyline_part`](crate::skyline_part)), until the whole is there.

use crate::error::SceneError;
use crate::sections::{self, Sections};
use crate::skyline_of_light::skyline_of_light;
use crate::skyline_part::{Observer, Parts};
use crate::skyline_queue::SkylineQueue;
pub(crate) use crate::skyline_tile::{SkylineTile, TileGround};
use crate::skylines::{Skyline, Skylines};
use rayon::prelude::*;
use std::collections::HashMap;
use std::fs::Permissions;
use std::ops::Range;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Bytes of tiles that stay in memory.
pub(crate) const MAX_KEPT_BYTES: usize = 768 << 20;
/// What others may do with the file of a tile: nothing, and the group may read, as with those of the scene.
const FILE_MODE: u32 = 0o640;
/// Bytes of the hash before a stored tile.
const HASH_BYTES: usize = 32;

/// Tiles in memory, by the index of their block, each with the turn in which it was last used.
#[derive(Debug, Default)]
struct Kept {
    tiles: HashMap<usize, (Arc<SkylineTile>, u64)>,
    bytes: usize,
    turn: u64,
    parts: Parts,
}

/// A tile that somebody wants.
enum Wanted {
    Known(Arc<SkylineTile>),
    Whole,
    /// A part is enough, unless all of it is stored.
    Part,
}

/// The skylines of a scene that are made by tile.
#[derive(Debug)]
pub(crate) struct SkylineTiles {
    /// Where they are stored.
    folder: PathBuf,
    /// Of the scene whose lights they are.
    version: String,
    kept: Mutex<Kept>,
    /// Those that somebody waits for.
    pub(crate) queue: SkylineQueue,
    /// How many are waiting for parts of tiles just now.
    waiting: AtomicUsize,
}

/// Somebody who waits, until it is dropped: also where what it waits for panics.
struct Waiting<'a>(&'a AtomicUsize);

impl<'a> Waiting<'a> {
    fn new(count: &'a AtomicUsize) -> Self {
        count.fetch_add(1, Ordering::Relaxed);
        Self(count)
    }
}

impl Drop for Waiting<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

impl SkylineTiles {
    /// Of a scene that may have some in a folder.
    pub(crate) fn new(folder: PathBuf, version: &str) -> Self {
        let version = version.to_owned();
        Self {
            folder,
            version,
            kept: Mutex::default(),
            queue: SkylineQueue::default(),
            waiting: AtomicUsize::new(0),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        // The map is valid whatever a panicking holder was doing.
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tiles by the indices of their blocks: from memory, from their files, else made and stored.
    ///
    /// * `observer`: who alone needs them, for whom a part of what is not there is made, unless that happened often.
    pub(crate) fn tiles(
        &self,
        ground: &TileGround<'_>,
        wanted: &[usize],
        observer: Option<&Observer>,
    ) -> Vec<Arc<SkylineTile>> {
        let found = self.lock().find(wanted, observer, |tile| self.queue.has(tile));
        if found.iter().all(|found| matches!(found, Wanted::Known(_))) {
            let known = |found| if let Wanted::Known(tile) = found { Some(tile) } else { None };
            return found.into_iter().filter_map(known).collect();
        }
        let _waiting = Waiting::new(&self.waiting);
        let get = |(&tile, found): (&usize, Wanted)| match found {
            Wanted::Known(known) => (known, Wanted::Part, false),
            found => match self.load(ground, tile) {
                Some(stored) => (Arc::new(stored), Wanted::Whole, true),
                None if matches!(found, Wanted::Whole) => {
                    (Arc::new(self.make(ground, tile).0), Wanted::Whole, true)
                }
                None => (Arc::new(Self::find_skylines(ground, tile, observer)), Wanted::Part, true),
            },
        };
        let found: Vec<(Arc<SkylineTile>, Wanted, bool)> = wanted.par_iter().zip(found).map(get).collect();
        let mut kept = self.lock();
        let mut parts = Vec::new();
        for (tile, (found, kind, is_new)) in wanted.iter().zip(&found) {
            match kind {
                _ if !is_new => {}
                Wanted::Part => parts.push((*tile, Arc::clone(found))),
                _ => kept.keep(*tile, found),
            }
        }
        if let Some(observer) = observer.filter(|_| !parts.is_empty()) {
            kept.parts.keep(observer, parts);
        }
        drop(kept);
        found.into_iter().map(|(tile, ..)| tile).collect()
    }

    /// Whether somebody waits for parts of tiles, to whom the processor belongs.
    pub(crate) fn is_waited_for(&self) -> bool {
        self.waiting.load(Ordering::Relaxed) > 0
    }

    /// Those of some tiles that are neither in memory nor stored. A stored one is taken to be good.
    pub(crate) fn missing(
        &self,
        ground: &TileGround<'_>,
        wanted: impl IntoIterator<Item = usize>,
    ) -> Vec<usize> {
        let kept = self.lock();
        let not_kept: Vec<usize> = wanted.into_iter().filter(|tile| !kept.tiles.contains_key(tile)).collect();
        drop(kept);
        not_kept.into_iter().filter(|tile| !self.path(ground, *tile).exists()).collect()
    }

    /// The skyline of a light by its index; None under an open sky.
    pub(crate) fn skyline(&self, ground: &TileGround<'_>, light: usize) -> Skyline {
        let tile = tile_of(ground, light);
        let tiles = self.tiles(ground, &[tile], None);
        tiles[0].skylines(0).skyline(light - tiles[0].first(0))
    }

    /// Makes a tile, unless it is stored already, and says whether it had to.
    ///
    /// # Errors
    /// [`SceneError::Io`] where it cannot be stored.
    pub(crate) fn prepare(&self, ground: &TileGround<'_>, tile: usize) -> Result<bool, SceneError> {
        if self.load_lights(ground, tile).is_some() {
            return Ok(false);
        }
        self.make(ground, tile).1.map_err(SceneError::io(self.path(ground, tile)))?;
        Ok(true)
    }

    /// Finds the skylines of a tile and stores them. One that cannot be stored is made again next time.
    fn make(&self, ground: &TileGround<'_>, tile: usize) -> (SkylineTile, std::io::Result<()>) {
        let made = Self::find_skylines(ground, tile, None);
        let stored = self.store(ground, tile, made.skylines(0));
        (made, stored)
    }

    /// Finds the skylines of a tile, or of each a part.
    fn find_skylines(ground: &TileGround<'_>, tile: usize, observer: Option<&Observer>) -> SkylineTile {
        let lights = ground.pyramid.pixels(ground.level(), tile);
        let pixels = &ground.pixels;
        let find = |light: usize| skyline_of_light(ground.terrain, ground.grid, pixels, light, observer);
        let found: Vec<Skyline> = lights.into_par_iter().map(find).collect();
        let mut skylines = Skylines::default();
        found.iter().for_each(|skyline| skylines.push(skyline));
        SkylineTile::new(ground, tile, skylines)
    }

    fn path(&self, ground: &TileGround<'_>, tile: usize) -> PathBuf {
        let code = ground.pyramid.level(ground.level()).codes[tile];
        self.folder.join(format!("{code:010x}.bin"))
    }

    /// The hash of a stored tile: of the scene's version, of where the tile is, and of its content.
    fn hash(&self, path: &Path, content: &[u8]) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.version.as_bytes());
        hasher.update(path.file_name().map_or(b"".as_slice(), |name| name.as_encoded_bytes()));
        hasher.update(content).finalize()
    }

    fn store(&self, ground: &TileGround<'_>, tile: usize, skylines: &Skylines) -> std::io::Result<()> {
        let path = self.path(ground, tile);
        let content = sections::pack(&skylines.to_sections())?;
        // Not the scene's: it may have been removed meanwhile.
        match std::fs::create_dir(&self.folder) {
            Err(error) if error.kind() != std::io::ErrorKind::AlreadyExists => return Err(error),
            _ => {}
        }
        let mode = Permissions::from_mode(FILE_MODE);
        let mut file = tempfile::Builder::new().permissions(mode).tempfile_in(&self.folder)?;
        std::io::Write::write_all(&mut file, self.hash(&path, &content).as_bytes())?;
        std::io::Write::write_all(&mut file, &content)?;
        file.persist(&path).map(|_| ()).map_err(|error| error.error)
    }

    fn load(&self, ground: &TileGround<'_>, tile: usize) -> Option<SkylineTile> {
        Some(SkylineTile::new(ground, tile, self.load_lights(ground, tile)?))
    }

    /// None where there is no file, or one of another scene, or a damaged one.
    fn load_lights(&self, ground: &TileGround<'_>, tile: usize) -> Option<Skylines> {
        let path = self.path(ground, tile);
        let bytes = std::fs::read(&path).ok()?;
        let (hash, content) = bytes.split_at_checked(HASH_BYTES)?;
        if self.hash(&path, content).as_bytes() != hash {
            return None;
        }
        let lights = ground.pyramid.pixels(ground.level(), tile).len();
        Skylines::from_sections(&Sections::parse(content).ok()?, lights).ok()
    }
}

impl Kept {
    /// Tiles that are there, and what is to be made of the others.
    ///
    /// * `is_coming`: whether somebody else makes a tile, for which nobody has to wait.
    fn find(
        &mut self,
        wanted: &[usize],
        observer: Option<&Observer>,
        is_coming: impl Fn(usize) -> bool,
    ) -> Vec<Wanted> {
        self.turn += 1;
        let parts = observer.and_then(|observer| self.parts.of(observer));
        let mut found = Vec::with_capacity(wanted.len());
        for tile in wanted {
            found.push(match (self.tiles.get_mut(tile), parts.and_then(|parts| parts.get(tile))) {
                (Some((known, used)), _) => {
                    *used = self.turn;
                    Wanted::Known(Arc::clone(known))
                }
                (None, Some(part)) => Wanted::Known(Arc::clone(part)),
                (None, None) if observer.is_none() => Wanted::Whole,
                (None, None) if self.parts.are_many(*tile) && !is_coming(*tile) => Wanted::Whole,
                (None, None) => Wanted::Part,
            });
        }
        found
    }

    fn keep(&mut self, tile: usize, found: &Arc<SkylineTile>) {
        let turn = self.turn;
        self.bytes += found.byte_count();
        self.parts.forget(tile);
        if let Some((before, _)) = self.tiles.insert(tile, (Arc::clone(found), turn)) {
            self.bytes -= before.byte_count();
        }
        if self.bytes <= MAX_KEPT_BYTES {
            return;
        }
        // A quarter more than has to go, so that this is seldom.
        let mut by_use: Vec<(u64, usize)> =
            self.tiles.iter().map(|(tile, (_, used))| (*used, *tile)).collect();
        by_use.sort_unstable();
        for (_, tile) in by_use {
            if self.bytes <= MAX_KEPT_BYTES / 4 * 3 {
                break;
            }
            if let Some((gone, _)) = self.tiles.remove(&tile) {
                self.bytes -= gone.byte_count();
            }
        }
    }
}

/// The tile of a light.
pub(crate) fn tile_of(ground: &TileGround<'_>, light: usize) -> usize {
    let codes = &ground.pyramid.level(ground.level()).codes;
    let code = ground.pixels.codes[light] >> (2 * ground.level());
    codes.partition_point(|&other| other < code)
}

/// The tiles whose lights lie within bounds, in degrees: west, south, east, north; west of east beyond the antimeridian.
pub(crate) fn tiles_within(ground: &TileGround<'_>, bounds: [f64; 4], margin_m: f64) -> Vec<usize> {
    let level = ground.level();
    let is_near = |tile: &usize| {
        let block = &ground.pyramid.level(level).blocks[*tile];
        crate::metadata::is_within_margin(bounds, block.direction, block.radius_m + margin_m)
    };
    (0..ground.pyramid.level(level).blocks.len()).filter(is_near).collect()
}

/// The lights of a tile.
pub(crate) fn lights_of(ground: &TileGround<'_>, tile: usize) -> Range<usize> {
    ground.pyramid.pixels(ground.level(), tile)
}
