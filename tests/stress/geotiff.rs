//! GeoTIFFs of made-up light, and the scenes that they become.

use skyglow_scene::{IngestOptions, Scene, SceneMetadata, SceneStore, ingest};
use std::{error::Error, fs::File, path::Path};
use tempfile::TempDir;
use tiff::{
    encoder::{TiffEncoder, colortype},
    tags::Tag,
};

/// A raster of radiances along parallels and meridians.
#[derive(Clone, Debug)]
pub(crate) struct Raster {
    /// Longitude of the western edge, degrees.
    pub(crate) west_deg: f64,
    /// Latitude of the northern edge, degrees.
    pub(crate) north_deg: f64,
    /// Width and height of a pixel, degrees.
    pub(crate) step_deg: (f64, f64),
    /// Columns and rows.
    pub(crate) size: (u32, u32),
    /// Radiance row by row, nW cm⁻² sr⁻¹.
    pub(crate) radiance_nw_cm2_sr: Vec<f32>,
}

impl Raster {
    /// A raster whose pixel (column, row) has the radiance `of`.
    pub(crate) fn new(
        (west_deg, north_deg): (f64, f64),
        step_deg: (f64, f64),
        size: (u32, u32),
        of: impl Fn(u32, u32) -> f32,
    ) -> Self {
        let pixels = (0..size.1).flat_map(|row| (0..size.0).map(move |column| (column, row)));
        let radiance_nw_cm2_sr = pixels.map(|(column, row)| of(column, row)).collect();
        Self { west_deg, north_deg, step_deg, size, radiance_nw_cm2_sr }
    }

    /// The raster with its rows upside down, as far south of the equator as it was north.
    pub(crate) fn mirrored(&self) -> Self {
        let (width, height) = (self.size.0 as usize, self.size.1);
        Self {
            north_deg: -(self.north_deg - self.step_deg.1 * f64::from(height)),
            radiance_nw_cm2_sr: self
                .radiance_nw_cm2_sr
                .chunks_exact(width)
                .rev()
                .flatten()
                .copied()
                .collect(),
            ..self.clone()
        }
    }

    fn write(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        let mut encoder = TiffEncoder::new(File::create(path)?)?;
        let mut image = encoder.new_image::<colortype::Gray32Float>(self.size.0, self.size.1)?;
        let directory = image.encoder();
        directory.write_tag(Tag::ModelPixelScaleTag, &[self.step_deg.0, self.step_deg.1, 0.0][..])?;
        let corner = [0.0, 0.0, 0.0, self.west_deg, self.north_deg, 0.0];
        directory.write_tag(Tag::ModelTiepointTag, &corner[..])?;
        // Header (version 1.1.0, number of keys), then key, location, count, value: geographic, pixel is area, WGS84.
        let keys: &[u16] = &[1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326];
        directory.write_tag(Tag::GeoKeyDirectoryTag, keys)?;
        image.write_data(&self.radiance_nw_cm2_sr)?;
        Ok(())
    }
}

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
    pub(crate) fn write(&self, raster: &Raster) -> Result<IngestOptions, Box<dyn Error>> {
        let path = self.folder.path().join("light.tif");
        raster.write(&path)?;
        Ok(IngestOptions { replace: true, ..IngestOptions::new(path) })
    }

    /// Ingests a file.
    pub(crate) fn ingest(&self, options: &IngestOptions) -> Result<SceneMetadata, Box<dyn Error>> {
        Ok(ingest(&self.store, options, &mut |_| ())?)
    }

    /// Writes, ingests and opens a raster.
    pub(crate) fn scene(&self, raster: &Raster) -> Result<Scene, Box<dyn Error>> {
        let metadata = self.ingest(&self.write(raster)?)?;
        Ok(self.store.open(&metadata.id)?)
    }
}
