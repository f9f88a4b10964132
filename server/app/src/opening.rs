//! Scenes, packs and engine put together: what the command line and the Python package ask without a server, and what a server serves.

use crate::observatory::ObservatorySource;
use skyglow_observatory::{CacheSizes, OPEN_SCENE_COUNT, Observatory};
use skyglow_render::{
    DeviceChoice, Engine, EngineConfig, LeftOutPack, RenderError, UndamagedTables,
    celestial::{CelestialTables, tables::MAX_KEPT_BYTES},
    resident_tables, undamaged_tables,
};
use skyglow_scene::{ChangeLimits, ChangeStore, SharedScenes};
use skyglow_tables::{Manifest, packs_in};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};
use thiserror::Error;

/// Why there is no engine.
#[derive(Debug, Error)]
pub enum OpenError {
    /// A folder without packs.
    #[error("no table packs in {}: `skyglow precompute` makes them", folder.display())]
    NoPacks {
        /// The folder.
        folder: PathBuf,
    },
    /// A pack is refused, the packs do not fit, or there is no such device.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The system gives no threads.
    #[error("no threads to wait for skies with: {0}")]
    Threads(#[from] std::io::Error),
}

/// An engine with its packs.
#[derive(Debug)]
pub struct LoadedEngine {
    engine: Engine,
    manifests: Vec<Manifest>,
    left_out: Vec<LeftOutPack>,
    celestial: Option<CelestialTables>,
    refused_celestial: Option<String>,
}

/// The celestial tables beside packs, or the name of a file that is refused. Skies without a time need none, so that is only told.
fn celestial_tables(packs: &Path) -> (Option<CelestialTables>, Option<String>) {
    CelestialTables::open(packs).map_or_else(
        |error| {
            tracing::warn!("no sky of a time is served: {error}");
            let name = match &error {
                RenderError::Tables(error) => error.file_name(),
                _ => None,
            };
            (None, Some(name.unwrap_or_else(|| "celestial tables".to_owned())))
        },
        |tables| (tables, None),
    )
}

/// Whether a pack under clouds was fitted as before the lit cloud counted more than the dark horizon below it.
fn has_dark_clouds(manifest: &Manifest) -> bool {
    manifest.clouds.is_some() && manifest.parameters.fit.floor_overcast == [0.0; 2]
}

impl LoadedEngine {
    /// An engine over the packs of a folder; takes a second or two.
    ///
    /// * `within_bytes`: of memory that packs may take, for a server, which does without those that are damaged; None refuses them.
    ///
    /// # Errors
    /// [`OpenError`].
    pub fn start(packs: &Path, device: DeviceChoice, within_bytes: Option<u64>) -> Result<Self, OpenError> {
        let paths = packs_in(packs).map_err(RenderError::from)?;
        if paths.is_empty() {
            return Err(OpenError::NoPacks { folder: packs.to_owned() });
        }
        let found = match within_bytes {
            Some(most_bytes) => undamaged_tables(&paths, most_bytes),
            None => resident_tables(&paths).map(|(tables, manifests)| UndamagedTables {
                tables,
                manifests,
                left_out: Vec::new(),
            }),
        };
        let UndamagedTables { tables, manifests, left_out } = found?;
        for pack in &left_out {
            tracing::warn!(pack = pack.name, "a damaged pack is left out: {}", pack.reason);
        }
        for old in manifests.iter().filter(|manifest| has_dark_clouds(manifest)) {
            tracing::warn!(
                turbidity = old.turbidity,
                "a pack under clouds of an earlier program: high above near lights it is up to 30 % too dark; make it again: {}",
                old.command
            );
        }
        let engine = Engine::start(EngineConfig { device, tables, ..EngineConfig::default() })?;
        let (celestial, refused_celestial) = celestial_tables(packs);
        Ok(Self { engine, manifests, left_out, celestial, refused_celestial })
    }

    /// Bytes of main memory that packs and celestial tables take, with what is kept of them.
    pub fn main_memory_bytes(&self) -> u64 {
        let celestial = if self.celestial.is_some() { MAX_KEPT_BYTES as u64 } else { 0 };
        self.engine.main_memory_bytes() + celestial
    }

    /// The engine before the scenes of a folder.
    ///
    /// * `limits`: what is kept of scenarios and plans.
    /// * `sizes`: what is kept in memory.
    /// * `max_places`: of a map of the zenith's brightness.
    pub fn before(
        self,
        data: &Path,
        limits: ChangeLimits,
        sizes: &CacheSizes,
        max_places: usize,
    ) -> ObservatorySource {
        self.before_kept(data, ChangeStore::new(data, limits), None, sizes, max_places)
    }

    /// The same with scenarios and plans that are kept elsewhere than in the folder, and scenes that servers share.
    pub fn before_kept(
        self,
        data: &Path,
        changes: ChangeStore,
        shared: Option<SharedScenes>,
        sizes: &CacheSizes,
        max_places: usize,
    ) -> ObservatorySource {
        let Self { engine, manifests, left_out, celestial, refused_celestial } = self;
        // Commands have no limits.
        let is_server = !changes.has_no_limits();
        let mut observatory =
            Observatory::with_changes(engine, manifests, data, OPEN_SCENE_COUNT, changes, sizes);
        if let Some(tables) = celestial {
            observatory = observatory.with_celestial_tables(tables);
        }
        if let Some(shared) = shared {
            observatory = observatory.with_shared_scenes(shared);
        }
        if is_server {
            observatory = observatory.with_lights_checked_later();
            let changes = observatory.changes().clone();
            std::thread::spawn(move || crate::stored::read_index(&changes));
        }
        let source = ObservatorySource::new(Arc::new(observatory));
        source.with_max_places(max_places).without_packs(&left_out, refused_celestial)
    }
}
