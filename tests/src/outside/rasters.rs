//! Rasters and lists of places, as an operator uploads them.

use skyglow_scene::{IngestOptions, SceneStore, ingest};
use std::{io::Cursor, path::Path};
use tiff::{
    encoder::{TiffEncoder, colortype::Gray32Float},
    tags::Tag,
};

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

/// A GeoTIFF of 8 × 8 pixels, two of them lit, that is understood.
///
/// # Panics
/// Never: it writes into memory.
#[must_use]
#[expect(clippy::panic, reason = "nothing fails in memory")]
pub fn smallest_raster() -> Vec<u8> {
    let write = || -> tiff::TiffResult<Vec<u8>> {
        let mut file = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut file)?;
        let mut image = encoder.new_image::<Gray32Float>(8, 8)?;
        let tags = image.encoder();
        tags.write_tag(Tag::ModelPixelScaleTag, &[0.01, 0.01, 0.0][..])?;
        tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 36.0, -1.0, 0.0][..])?;
        // Geographic coordinates, pixels as areas, WGS 84.
        let keys: [u16; 16] = [1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326];
        tags.write_tag(Tag::GeoKeyDirectoryTag, &keys[..])?;
        let mut pixels = [0.0f32; 64];
        (pixels[27], pixels[28]) = (12.5, 80.0);
        image.write_data(&pixels)?;
        Ok(file.into_inner())
    };
    write().unwrap_or_else(|error| panic!("{error}"))
}
