//! Scenes on disk: `<data>/scenes/<id>/` with `metadata.json`, `light.bin`, and, where there are any, `terrain.bin`,
//! `skylines.bin` (not in scenes of format 1) and `places.json`.
//!
//! `metadata.json` names each file with its length and BLAKE3 hash, and itself by `version`; what is read
//! when a scene is opened is checked. A scene appears by one rename, so it is complete or absent.
//!
//! The lights of a large scene stay in a file too, one that is made when the scene is first opened (`pyramid_file.rs`).
//!
//! Of large terrain the packed tiles stay in the file: what is read when the scene is opened has a hash of its own, and each tile a
//! checksum. The folder `skylines` has what was found since: skylines that are made by tile (`skyline_tiles.rs`). It is not listed, and
//! what is damaged in it is made again.

use crate::error::SceneError;
use crate::grid::Grid;
use crate::grid_sections;
use crate::land_cover::LandCover;
use crate::light_layer::{LightLayer, Lights};
use crate::lit_pixels::LitPixels;
use crate::mask::ValidMask;
use crate::memory::LightCount;
use crate::metadata::{NamedPlace, SceneMetadata};
use crate::pyramid_file::{self, StoredPyramid};
use crate::scene::Scene;
use crate::scene_files::{
    LAND_COVER_FILE, LIGHT_FILE, METADATA_FILE, PLACES_FILE, SKYLINES_FILE, StoredScene, TERRAIN_FILE,
    TILES_FOLDER,
};
use crate::scene_id::SceneId;
use crate::scene_writer;
use crate::sections::{Flaw, Inside, Sections, unpack_ascending};
use crate::skyline_tiles::SkylineTiles;
use crate::skylines::Skylines;
use crate::staging::{self, Staging};
use crate::terrain::Terrain;
use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The folder of scenes.
#[derive(Clone, Debug)]
pub struct SceneStore {
    scenes_dir: PathBuf,
    /// Lights from which on a scene's stay in a file.
    least_in_file: u64,
}

/// A folder for uploaded files.
#[derive(Debug)]
pub struct UploadFolder(Staging);

impl UploadFolder {
    /// Where it is.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// A data folder within it, as of [`SceneStore::new`], for the scene that is made of the files.
    pub fn made(&self) -> PathBuf {
        self.path().join("made")
    }
}

/// The scenes of a folder.
#[derive(Debug, Default)]
pub struct SceneList {
    /// Those that can be read, by id.
    pub scenes: Vec<SceneMetadata>,
    /// What is wrong with the others.
    pub damaged: Vec<SceneError>,
}

impl SceneStore {
    /// The scenes of a data folder; the folder need not exist.
    pub fn new(data_dir: impl AsRef<Path>) -> Self {
        Self { scenes_dir: data_dir.as_ref().join("scenes"), least_in_file: pyramid_file::MIN_LIGHTS }
    }

    /// The folder that holds one folder for each scene.
    pub fn scenes_dir(&self) -> &Path {
        &self.scenes_dir
    }

    /// The same, whose scenes keep their lights in a file from so many on ([`Self::new`]: a million).
    pub fn with_lights_in_file(self, least: u64) -> Self {
        Self { least_in_file: least, ..self }
    }

    pub(crate) fn scene_dir(&self, id: &SceneId) -> PathBuf {
        self.scenes_dir.join(id.as_str())
    }

    /// Whether there is a scene of that id.
    pub fn exists(&self, id: &SceneId) -> bool {
        self.scene_dir(id).join(METADATA_FILE).is_file()
    }

    /// Clears what killed ingests left among the scenes; the folder of one that still runs, in any process, stays. Returns how many folders were removed.
    pub fn clear_stale(&self) -> usize {
        staging::clear_stale(&self.scenes_dir)
    }

    /// A new folder for uploaded files, beside the scenes: removed when it is dropped, or as stale after a crash.
    ///
    /// # Errors
    /// [`SceneError::Io`].
    pub fn upload_folder(&self) -> Result<UploadFolder, SceneError> {
        std::fs::create_dir_all(&self.scenes_dir).map_err(SceneError::io(&self.scenes_dir))?;
        Ok(UploadFolder(Staging::below(&self.scenes_dir)?))
    }

    /// Moves the scene that was made in an upload's folder to its place, where it takes that of the one before, and says whether
    /// there was one. Whoever made it is not trusted: nothing but plain files is taken.
    ///
    /// # Errors
    /// [`SceneError::UnknownScene`], [`SceneError::Damaged`], [`SceneError::Io`].
    pub fn adopt(&self, upload: &UploadFolder, id: &SceneId) -> Result<(SceneMetadata, bool), SceneError> {
        let made = Self::new(upload.made());
        let folder = made.scene_dir(id);
        let known = [METADATA_FILE, LIGHT_FILE, TERRAIN_FILE, SKYLINES_FILE, PLACES_FILE];
        let is_folder = |path: &Path| std::fs::symlink_metadata(path).is_ok_and(|found| found.is_dir());
        if ![&made.scenes_dir, &folder].into_iter().all(|path| is_folder(path)) {
            return Err(SceneError::UnknownScene { id: id.to_string() });
        }
        for entry in std::fs::read_dir(&folder).map_err(SceneError::io(&folder))? {
            let entry = entry.map_err(SceneError::io(&folder))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let kind = entry.file_type().map_err(SceneError::io(&folder))?;
            if !kind.is_file() || !known.contains(&name.as_str()) {
                return Err(damaged(id, &name)("is no file of a scene".to_owned()));
            }
        }
        let metadata = made.read_metadata(id)?.metadata;
        let was_there = self.exists(id);
        upload.0.put(&folder, &self.scene_dir(id), id, true)?;
        scene_writer::sync_dir(&self.scenes_dir)?;
        Ok((metadata, was_there))
    }

    /// Removes a scene. Opened scenes stay usable.
    ///
    /// # Errors
    /// [`SceneError::UnknownScene`], [`SceneError::Io`].
    pub fn remove(&self, id: &SceneId) -> Result<(), SceneError> {
        if !self.exists(id) {
            return Err(SceneError::UnknownScene { id: id.to_string() });
        }
        staging::remove(&self.scene_dir(id), &self.scenes_dir)
    }

    /// The metadata of each scene, by id. Reads `metadata.json` alone; a damaged scene does not hide the others.
    ///
    /// # Errors
    /// [`SceneError::Io`] where the folder cannot be read.
    pub fn list(&self) -> Result<SceneList, SceneError> {
        let mut list = SceneList::default();
        let entries = match std::fs::read_dir(&self.scenes_dir) {
            Ok(entries) => entries,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(list),
            Err(error) => return Err(SceneError::io(&self.scenes_dir)(error)),
        };
        for entry in entries {
            let name = entry.map_err(SceneError::io(&self.scenes_dir))?.file_name();
            // Folders of unfinished ingests start with a dot and are no ids.
            let Some(id) = name.to_str().and_then(|name| SceneId::parse(name).ok()) else { continue };
            if self.exists(&id) {
                match self.read_metadata(&id) {
                    Ok(stored) => list.scenes.push(stored.metadata),
                    Err(error) => list.damaged.push(error),
                }
            }
        }
        list.scenes.sort_by(|a, b| a.id.cmp(&b.id));
        Ok(list)
    }

    /// When a scene was stored, seconds since 1970; None for one that is not there, and where the disk does not say.
    pub fn stored_unix_s(&self, id: &SceneId) -> Option<u64> {
        let file = std::fs::metadata(self.scene_dir(id).join(METADATA_FILE)).ok()?;
        let since = file.modified().ok()?.duration_since(std::time::UNIX_EPOCH).ok()?;
        Some(since.as_secs())
    }

    pub(crate) fn read_metadata(&self, id: &SceneId) -> Result<StoredScene, SceneError> {
        let path = self.scene_dir(id).join(METADATA_FILE);
        let text = match std::fs::read(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return Err(SceneError::UnknownScene { id: id.to_string() });
            }
            Err(error) => return Err(SceneError::io(path)(error)),
        };
        StoredScene::parse(&text, id).map_err(damaged(id, METADATA_FILE))
    }

    /// Bytes of memory that a scene takes when it is opened, about, by its metadata.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn scene_bytes(&self, id: &SceneId) -> Result<u64, SceneError> {
        let stored = self.read_metadata(id)?;
        let of_files: u64 = stored.files.iter().map(|file| file.bytes).sum();
        if self.keeps_lights_in_file(&stored)
            && pyramid_file::is_there(&self.scene_dir(id), &stored.metadata.version)
        {
            return Ok(of_files);
        }
        // Half as many blocks as lights: more where they lie apart, fewer where they touch.
        let lit = stored.metadata.lit_pixels;
        Ok(2 * of_files + LightCount { lit, blocks: lit / 2, skylines: 0 }.scene_bytes())
    }

    /// Opens a scene; files that are read whole are checked against their hashes, of those that stay on disk the length. One that is replaced or removed meanwhile is the new one, or none.
    ///
    /// # Errors
    /// [`SceneError::UnknownScene`]; [`SceneError::Damaged`] naming the file; [`SceneError::Io`].
    pub fn open(&self, id: &SceneId) -> Result<Scene, SceneError> {
        self.open_within(id, u64::MAX)
    }

    /// [`Self::open`] of a scene that may take so many bytes of memory.
    ///
    /// # Errors
    /// The same, and [`SceneError::TooLarge`], which is known before the most of them is taken.
    pub fn open_within(&self, id: &SceneId, limit_bytes: u64) -> Result<Scene, SceneError> {
        self.open_checking(id, limit_bytes, true)
    }

    /// [`Self::open_within`] without reading all of the file that lights of a large scene stay in: for who answers first and checks that
    /// afterwards by [`Self::verify_lights`].
    ///
    /// # Errors
    /// As [`Self::open_within`].
    pub fn open_unchecked(&self, id: &SceneId, limit_bytes: u64) -> Result<Scene, SceneError> {
        self.open_checking(id, limit_bytes, false)
    }

    fn open_checking(
        &self,
        id: &SceneId,
        limit_bytes: u64,
        checks_lights: bool,
    ) -> Result<Scene, SceneError> {
        let mut stored = self.read_metadata(id)?;
        loop {
            let version = stored.metadata.version.clone();
            let error = match self.open_stored(id, stored, limit_bytes, checks_lights) {
                Err(error @ (SceneError::Damaged { .. } | SceneError::Io { .. })) => error,
                opened => return opened,
            };
            stored = self.read_metadata(id)?;
            if stored.metadata.version == version {
                return Err(error);
            }
        }
    }

    /// Reads every file of a scene and checks it against its hash, in little memory.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn verify(&self, id: &SceneId) -> Result<(), SceneError> {
        let stored = self.read_metadata(id)?;
        let Err(error) = self.verify_stored(id, &stored) else { return Ok(()) };
        // One that was replaced meanwhile is another scene.
        match self.read_metadata(id)?.metadata.version == stored.metadata.version {
            true => Err(error),
            false => self.verify(id),
        }
    }

    /// Makes the file that the lights of a large scene stay in where there is none, so that who opens it first need not. Takes as much
    /// memory as that scene in memory.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn store_lights(&self, id: &SceneId) -> Result<(), SceneError> {
        let stored = self.read_metadata(id)?;
        let is_there = || pyramid_file::is_there(&self.scene_dir(id), &stored.metadata.version);
        if self.keeps_lights_in_file(&stored) && !is_there() {
            self.open_unchecked(id, u64::MAX)?;
        }
        Ok(())
    }

    /// Reads the file through that the lights of a large scene stay in, and says whether it is whole, or there is none. A damaged one
    /// is removed: it is made anew when the scene is next opened.
    pub fn verify_lights(&self, id: &SceneId) -> bool {
        pyramid_file::verify(&self.scene_dir(id))
    }

    fn verify_stored(&self, id: &SceneId, stored: &StoredScene) -> Result<(), SceneError> {
        for stored in &stored.files {
            let path = self.scene_dir(id).join(&stored.name);
            let flaw = damaged(id, &stored.name);
            let file = match std::fs::File::open(&path) {
                Ok(file) => file,
                Err(error) if error.kind() == ErrorKind::NotFound => {
                    return Err(flaw("is missing".to_owned()));
                }
                Err(error) => return Err(SceneError::io(path)(error)),
            };
            let mut hasher = blake3::Hasher::new();
            hasher.update_reader(file).map_err(SceneError::io(path))?;
            stored.check_hash(hasher.count(), hasher.finalize()).map_err(flaw)?;
        }
        Ok(())
    }

    /// Whether the lights of a scene stay in a file.
    fn keeps_lights_in_file(&self, stored: &StoredScene) -> bool {
        let metadata = &stored.metadata;
        metadata.lit_pixels >= self.least_in_file
            && (!metadata.light_skylines || stored.has_skyline_tiles())
            && pyramid_file::stays_mapped(&self.scene_dir(&metadata.id))
    }

    fn open_stored(
        &self,
        id: &SceneId,
        stored: StoredScene,
        limit_bytes: u64,
        checks_lights: bool,
    ) -> Result<Scene, SceneError> {
        let check = |needed_bytes: u64| match needed_bytes <= limit_bytes {
            true => Ok(()),
            false => Err(SceneError::TooLarge { scene: id.to_string(), needed_bytes, limit_bytes }),
        };
        check(stored.files.iter().map(|file| file.bytes).sum())?;
        let dir = self.scene_dir(id);
        let read = |name: &str| -> Result<Option<Vec<u8>>, SceneError> {
            let Some(file) = stored.files.iter().find(|file| file.name == name) else { return Ok(None) };
            let bytes = match std::fs::read(dir.join(name)) {
                Ok(bytes) => bytes,
                Err(error) if error.kind() == ErrorKind::NotFound => {
                    return Err(damaged(id, name)("is missing".to_owned()));
                }
                Err(error) => return Err(SceneError::io(dir.join(name))(error)),
            };
            file.check(&bytes).map_err(damaged(id, name))?;
            Ok(Some(bytes))
        };
        let read_all_light = || {
            let bytes =
                read(LIGHT_FILE)?.ok_or_else(|| damaged(id, LIGHT_FILE)("is not listed".to_owned()))?;
            let parsed = Sections::parse(&bytes).map_err(damaged(id, LIGHT_FILE))?;
            check(parsed.unpacked_bytes())?;
            read_light(&parsed).map_err(damaged(id, LIGHT_FILE))
        };
        let version = stored.metadata.version.clone();
        let in_file = self.keeps_lights_in_file(&stored);
        let of_file = in_file.then(|| pyramid_file::open(&dir, &version, checks_lights)).flatten();
        let light = match &of_file {
            Some(_) => {
                check_is_there(id, &stored, &dir.join(LIGHT_FILE))?;
                None
            }
            None => Some(read_all_light()?),
        };
        // A large file is read where something is wanted of it.
        let open_raster = |name: &str| -> Result<Option<RasterFile>, SceneError> {
            if let Some((file, inside)) = read_inside(id, &stored, &dir.join(name))? {
                return Ok(Some(RasterFile::Outside(file, inside)));
            }
            Ok(read(name)?.map(RasterFile::Whole))
        };
        let terrain = match open_raster(TERRAIN_FILE)? {
            Some(raster) => raster.parse(check, Terrain::from_sections, damaged(id, TERRAIN_FILE))?,
            None => Terrain::default(),
        };
        let land_cover = match open_raster(LAND_COVER_FILE)? {
            Some(raster) => raster.parse(check, LandCover::from_sections, damaged(id, LAND_COVER_FILE))?,
            None if stored.metadata.land_cover => {
                return Err(damaged(id, LAND_COVER_FILE)("is not listed".to_owned()));
            }
            None => LandCover::default(),
        };
        let mut skylines = None;
        if let Some(bytes) = read(SKYLINES_FILE)? {
            let parsed = Sections::parse(&bytes).map_err(damaged(id, SKYLINES_FILE))?;
            check(parsed.unpacked_bytes())?;
            let count = light.as_ref().map_or(0, |light| light.pixels.len());
            let parsed = Skylines::from_sections(&parsed, count);
            skylines = Some(parsed.map_err(damaged(id, SKYLINES_FILE))?);
        } else if stored.metadata.light_skylines && !stored.has_skyline_tiles() {
            return Err(damaged(id, SKYLINES_FILE)("is not listed".to_owned()));
        }
        let mut places: Vec<NamedPlace> = Vec::new();
        if let Some(bytes) = read(PLACES_FILE)? {
            let parsed = serde_json::from_slice(&bytes);
            places = parsed.map_err(|error| damaged(id, PLACES_FILE)(format!("is broken ({error})")))?;
        }
        let StoredPyramid { grid, mask, mut lights } = match (of_file, light) {
            (Some(of_file), _) => of_file,
            (None, None) => return Err(damaged(id, LIGHT_FILE)("was not read".to_owned())),
            (None, Some(StoredLight { grid, mask, pixels })) => {
                let with_skylines = skylines.as_ref().map_or(0, |skylines| skylines.blocked_count() as u64);
                check(LightCount::of_codes(&pixels.codes, with_skylines).scene_bytes())?;
                let lights = Lights::new(&grid, pixels, skylines, stored.metadata.calibration);
                // Where it cannot be stored the lights stay in memory, and it is tried again next time.
                let is_stored =
                    in_file && pyramid_file::write(&dir, &version, (&grid, &mask), &lights).is_ok();
                let in_memory = StoredPyramid { grid, mask, lights };
                match is_stored.then(|| pyramid_file::open(&dir, &version, false)).flatten() {
                    Some(in_file) => in_file,
                    None => in_memory,
                }
            }
        };
        if stored.has_skyline_tiles() {
            lights = lights.with_tiles(SkylineTiles::new(dir.join(TILES_FOLDER), &stored.metadata.version));
        }
        Ok(Scene {
            metadata: stored.metadata,
            grid: Arc::new(grid),
            mask: Arc::new(mask),
            light_layers: vec![LightLayer::whole(lights)],
            terrain: Arc::new(terrain),
            land_cover: Arc::new(land_cover),
            places: places.into(),
        })
    }
}

/// A file of rasters, whole or with its large sections left in it.
enum RasterFile {
    Whole(Vec<u8>),
    Outside(File, Inside),
}

impl RasterFile {
    fn parse<T>(
        self,
        check: impl Fn(u64) -> Result<(), SceneError>,
        from_sections: impl Fn(&Sections<'_>, Option<&File>) -> Result<T, Flaw>,
        flawed: impl Fn(Flaw) -> SceneError,
    ) -> Result<T, SceneError> {
        match self {
            Self::Outside(file, inside) => from_sections(&inside.sections(), Some(&file)).map_err(flawed),
            Self::Whole(bytes) => {
                let sections = Sections::parse(&bytes).map_err(&flawed)?;
                check(sections.unpacked_bytes())?;
                from_sections(&sections, None).map_err(flawed)
            }
        }
    }
}

/// That a file which is not read is there, and as long as it was.
fn check_is_there(id: &SceneId, stored: &StoredScene, path: &Path) -> Result<(), SceneError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let length = match std::fs::metadata(path) {
        Ok(found) => found.len(),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err(damaged(id, &name)("is missing".to_owned()));
        }
        Err(error) => return Err(SceneError::io(path)(error)),
    };
    let listed = stored.files.iter().find(|file| *file.name == *name);
    listed.map_or(Ok(()), |listed| listed.check_length(length)).map_err(damaged(id, &name))
}

/// A file of sections without those that stay in it; None where none does, and where there is no file. What is read is checked, and
/// the length of the file; its hash by [`SceneStore::verify`] alone.
fn read_inside(
    id: &SceneId,
    stored: &StoredScene,
    path: &Path,
) -> Result<Option<(File, Inside)>, SceneError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let Some(listed) = stored.files.iter().find(|file| *file.name == *name) else { return Ok(None) };
    let file = match File::open(path) {
        Ok(file) => file,
        // Whoever reads it whole says what is wrong.
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(SceneError::io(path)(error)),
    };
    let bytes = file.metadata().map_err(SceneError::io(path))?.len();
    listed.check_length(bytes).map_err(damaged(id, &name))?;
    let inside = Inside::read(&file).map_err(SceneError::io(path))?.map_err(damaged(id, &name))?;
    Ok(inside.map(|inside| (file, inside)))
}

fn damaged(id: &SceneId, file: &str) -> impl Fn(Flaw) -> SceneError {
    let (scene, file) = (id.to_string(), file.to_owned());
    move |reason| SceneError::Damaged { scene: scene.clone(), file: file.clone(), reason }
}

/// What `light.bin` holds.
struct StoredLight {
    grid: Grid,
    mask: ValidMask,
    pixels: LitPixels,
}

fn read_light(sections: &Sections<'_>) -> Result<StoredLight, Flaw> {
    let grid = grid_sections::from_sections(sections, "")?;
    // The three are nearly all of the file; to unpack a planet's takes seconds.
    let (codes, radiance, altitude) = std::thread::scope(|scope| {
        let radiance = scope.spawn(|| sections.numbers("radiance"));
        let altitude = scope.spawn(|| sections.numbers("altitude"));
        let codes = sections.bytes("codes").and_then(|bytes| unpack_ascending(&bytes));
        (codes, radiance.join(), altitude.join())
    });
    let died = || "could not be unpacked".to_owned();
    let pixels = LitPixels {
        codes: codes?.into(),
        radiance_nw_cm2_sr: radiance.map_err(|_| died())??.into(),
        altitude_m: altitude.map_err(|_| died())??.into(),
    };
    if !pixels.is_consistent(&grid) {
        return Err("holds pixels that contradict each other".to_owned());
    }
    let mask = ValidMask::from_sections(sections, &grid)?;
    Ok(StoredLight { grid, mask, pixels })
}
