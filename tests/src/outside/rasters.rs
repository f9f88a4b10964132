//! Rasters and lists of places, as an operator uploads them.

use skyglow_lab::seeds::smallest_raster;
use skyglow_scene::{IngestOptions, SceneStore, ingest};
use std::path::Path;

/// Ingests and opens; a refusal leaves nothing behind.
#[expect(clippy::panic, reason = "a rule that is broken ends the fuzzer")]
fn ingest_in(folder: &Path, options: &IngestOptions) {
    let store = SceneStore::new(folder.join("data"));
    match ingest(&store, options, &mut |_| {}) {
        Ok(metadata) => {
            let scene = store.open(&metadata.id).unwrap_or_else(|error| panic!("{error}"));
            let [west, south, east, north] = scene.metadata().bounds;
            assert!([west, south, east, north].iter().all(|degrees| degrees.is_finite()) && south < north);
            assert!(scene.metadata().lit_pixels > 0);
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            let left = std::fs::read_dir(store.scenes_dir()).map_or(0, Iterator::count);
            assert_eq!(left, 0, "left behind by: {error}");
        }
    }
}

fn with_folder(work: impl FnOnce(&Path)) {
    if let Ok(folder) = tempfile::tempdir() {
        work(folder.path());
    }
}

/// A file of any kind as a raster of radiances.
pub fn raster(bytes: &[u8]) {
    with_folder(|folder| {
        let path = folder.join("light.tif");
        if std::fs::write(&path, bytes).is_ok() {
            let mut options = IngestOptions::new(path);
            options.max_pixels = Some(10_000);
            ingest_in(folder, &options);
        }
    });
}

/// A list of places beside a good raster.
pub fn places(bytes: &[u8]) {
    with_folder(|folder| {
        let (light, places) = (folder.join("light.tif"), folder.join("places.csv"));
        if std::fs::write(&light, smallest_raster()).is_ok() && std::fs::write(&places, bytes).is_ok() {
            let mut options = IngestOptions::new(light);
            options.places = Some(places);
            ingest_in(folder, &options);
        }
    });
}
