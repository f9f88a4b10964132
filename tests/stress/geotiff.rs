//! GeoTIFFs of made-up light, and the scenes that they become.

use skyglow_lab::light_raster::LightRaster;
use skyglow_scene::{IngestOptions, Scene, SceneMetadata, SceneStore, ingest};
use std::error::Error;
use tempfile::TempDir;

/// Scattered lights: one pixel in 23, 0.5 to 40 nW cm⁻² sr⁻¹, by a hash of the pixel.
pub(crate) fn scattered(column: u32, row: u32) -> f32 {
    let hash = u64::from(column).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ u64::from(row).wrapping_mul(0xd1b5_4a32_d192_ed03);
    let hash = (hash ^ (hash >> 31)).wrapping_mul(0x94d0_49bb_1331_11eb) >> 20;
    if hash.is_multiple_of(23) { 0.5 + (hash / 23 % 400) as f32 / 10.0 } else { 0.0 }
}

/// A store in a folder that goes away with it.
pub(crate) struct Folder {
    folder: TempDir,
    store: SceneStore,
}

impl Folder {
    /// An empty one.
    pub(crate) fn new() -> std::io::Result<Self> {
        let folder = tempfile::tempdir()?;
        let store = SceneStore::new(folder.path().join("data"));
        Ok(Self { folder, store })
    }

    /// The store.
    pub(crate) fn store(&self) -> &SceneStore {
        &self.store
    }

    /// Writes a raster as a file.
    pub(crate) fn write(&self, raster: &LightRaster) -> Result<IngestOptions, Box<dyn Error>> {
        let path = self.folder.path().join("light.tif");
        std::fs::write(&path, raster.to_geotiff()?)?;
        Ok(IngestOptions { replace: true, ..IngestOptions::new(path) })
    }

    /// Ingests a file.
    pub(crate) fn ingest(&self, options: &IngestOptions) -> Result<SceneMetadata, Box<dyn Error>> {
        Ok(ingest(&self.store, options, &mut |_| ())?)
    }

    /// Writes, ingests and opens a raster.
    pub(crate) fn scene(&self, raster: &LightRaster) -> Result<Scene, Box<dyn Error>> {
        let metadata = self.ingest(&self.write(raster)?)?;
        Ok(self.store.open(&metadata.id)?)
    }
}
