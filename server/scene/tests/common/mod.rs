//! Rasters made for tests, and the rule for tests of real ones.

#![allow(dead_code, reason = "each test file uses its own part of this module")]

use gdal::DriverManager;
use gdal::raster::{Buffer, GdalType, RasterCreationOptions};
use gdal::spatial_ref::SpatialRef;
use skyglow_physics::GeoPoint;
use skyglow_scene::{IngestOptions, Scene, SceneError, SceneMetadata, SceneStore, ingest};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A raster to write: 15″ pixels around 37° east, 1° south unless changed.
#[derive(Clone)]
pub(crate) struct TestRaster {
    pub(crate) size: (usize, usize),
    pub(crate) geotransform: [f64; 6],
    pub(crate) epsg: Option<u32>,
    pub(crate) no_data: Option<f64>,
    pub(crate) scale_offset: Option<(f64, f64)>,
    pub(crate) values: Vec<f64>,
}

pub(crate) const STEP: f64 = 1.0 / 240.0;

impl TestRaster {
    pub(crate) fn new(width: usize, height: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        Self {
            size: (width, height),
            geotransform: [37.0, STEP, 0.0, -1.0, 0.0, -STEP],
            epsg: Some(4326),
            no_data: None,
            scale_offset: None,
            values: (0..width * height).map(|i| value(i % width, i / width)).collect(),
        }
    }

    /// A few scattered lights, by a hash of the pixel.
    pub(crate) fn scattered(width: usize, height: usize) -> Self {
        Self::new(width, height, |c, r| {
            let hash = (c as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
                ^ (r as u64).wrapping_mul(0xd1b5_4a32_d192_ed03);
            let hash = (hash ^ (hash >> 31)).wrapping_mul(0x94d0_49bb_1331_11eb) >> 20;
            if hash.is_multiple_of(23) { 0.5 + (hash / 23 % 400) as f64 / 10.0 } else { 0.0 }
        })
    }

    pub(crate) fn write<T: GdalType + Copy>(&self, path: &Path, convert: impl Fn(f64) -> T) {
        let driver = DriverManager::get_driver_by_name("GTiff").unwrap();
        let options = RasterCreationOptions::from_iter(["COMPRESS=DEFLATE", "TILED=YES"]);
        let (width, height) = self.size;
        let mut dataset =
            driver.create_with_band_type_with_options::<T, _>(path, width, height, 1, &options).unwrap();
        dataset.set_geo_transform(&self.geotransform).unwrap();
        if let Some(epsg) = self.epsg {
            dataset.set_spatial_ref(&SpatialRef::from_epsg(epsg).unwrap()).unwrap();
        }
        let mut band = dataset.rasterband(1).unwrap();
        if self.no_data.is_some() {
            band.set_no_data_value(self.no_data).unwrap();
        }
        if let Some((scale, offset)) = self.scale_offset {
            band.set_scale(scale).unwrap();
            band.set_offset(offset).unwrap();
        }
        let values = self.values.iter().map(|v| convert(*v)).collect();
        band.write((0, 0), self.size, &mut Buffer::new(self.size, values)).unwrap();
        dataset.close().unwrap();
    }

    pub(crate) fn write_f32(&self, path: &Path) {
        self.write(path, |v| v as f32);
    }
}

/// A store in a temporary folder.
pub(crate) struct TestStore {
    pub(crate) dir: TempDir,
    pub(crate) store: SceneStore,
}

impl TestStore {
    pub(crate) fn new() -> Self {
        let dir = tempfile::tempdir().unwrap();
        let store = SceneStore::new(dir.path().join("data"));
        Self { dir, store }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub(crate) fn ingest(&self, options: &IngestOptions) -> Result<SceneMetadata, SceneError> {
        ingest(&self.store, options, &mut |_| {})
    }

    /// Writes, ingests and opens a raster, with changed options.
    pub(crate) fn scene_with(&self, raster: &TestRaster, change: impl FnOnce(&mut IngestOptions)) -> Scene {
        let path = self.path("light.tif");
        raster.write_f32(&path);
        let mut options = IngestOptions::new(path);
        options.replace = true;
        change(&mut options);
        let metadata = self.ingest(&options).unwrap();
        self.store.open(&metadata.id).unwrap()
    }

    pub(crate) fn scene(&self, raster: &TestRaster) -> Scene {
        self.scene_with(raster, |_| {})
    }

    /// The error of a refused raster; nothing may be left behind.
    pub(crate) fn refusal(&self, options: &IngestOptions) -> String {
        let error = self.ingest(options).unwrap_err().to_string();
        let left: Vec<_> =
            std::fs::read_dir(self.store.scenes_dir()).map(|d| d.flatten().collect()).unwrap_or_default();
        assert!(left.is_empty(), "{left:?} left behind by: {error}");
        assert!(!error.contains('\n'), "one sentence: {error}");
        println!("{error}");
        error
    }
}

pub(crate) fn place(latitude_deg: f64, longitude_deg: f64) -> GeoPoint {
    GeoPoint::from_deg(latitude_deg, longitude_deg).unwrap()
}

/// A raster of a real product, from the folder that `SKYGLOW_TEST_DATA` names, by default `../shared/data` beside the repository.
///
/// The rule for tests that need files outside the repository: they are `#[ignore]`d, so that `cargo test` reports them as ignored
/// and never as passed, and where they do run (`cargo test -p skyglow-scene --test real_rasters -- --ignored`; `make test` does it
/// where that folder is there or named, and else reports that it did not) a missing file fails them. No test returns early and passes.
pub(crate) fn real_raster(name: &str) -> PathBuf {
    let beside = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    let dir = std::env::var_os("SKYGLOW_TEST_DATA").map_or(beside, PathBuf::from);
    let path = dir.join(name);
    assert!(path.is_file(), "{} is missing; SKYGLOW_TEST_DATA names the folder", path.display());
    path
}
