//! Files that refer to others, or would like to lie elsewhere, are refused or kept in their place.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{TestRaster, TestStore};
use skyglow_scene::{IngestOptions, SceneId};

/// A GeoTIFF whose overviews lie in another file is refused.
#[test]
fn a_geotiff_that_names_files_is_refused() {
    let test_store = TestStore::new();
    let path = test_store.path("light.tif");
    TestRaster::scattered(40, 30).write_f32(&path);
    let mut dataset = gdal::Dataset::open_ex(
        &path,
        gdal::DatasetOptions { open_flags: gdal::GdalOpenFlags::GDAL_OF_UPDATE, ..Default::default() },
    )
    .unwrap();
    gdal::Metadata::set_metadata_item(&mut dataset, "OVERVIEW_FILE", "/etc/passwd", "OVERVIEWS").unwrap();
    dataset.close().unwrap();
    let told = test_store.refusal(&IngestOptions::new(&path));
    assert!(told.contains("another file") && told.contains("/etc/passwd"), "{told}");
}

/// Members of an archive land under their own names in a folder of their own, wherever they would like to lie, and links and files
/// beside a raster are left.
#[test]
fn members_of_archives_stay_in_their_folder() {
    let test_store = TestStore::new();
    let light = test_store.path("light.tif");
    TestRaster::scattered(40, 30).write_f32(&light);
    let bytes = std::fs::read(&light).unwrap();
    let path = test_store.path("light.zip");
    let plain = zip::write::SimpleFileOptions::default();
    let mut archive = zip::ZipWriter::new(std::fs::File::create(&path).unwrap());
    archive.start_file("../../../escaped.tif", plain).unwrap();
    std::io::Write::write_all(&mut archive, &bytes).unwrap();
    archive.add_symlink("linked.tif", "/etc/passwd", plain).unwrap();
    archive.start_file("inside/good.tif", plain).unwrap();
    std::io::Write::write_all(&mut archive, &bytes).unwrap();
    archive.start_file("inside/good.tif.aux.xml", plain).unwrap();
    std::io::Write::write_all(
        &mut archive,
        b"<PAMDataset><GeoTransform>0,1,0,0,0,1</GeoTransform></PAMDataset>",
    )
    .unwrap();
    archive.finish().unwrap();
    let mut options = IngestOptions::new(&path);
    options.id = Some(SceneId::parse("town").unwrap());
    let metadata = test_store.ingest(&options).unwrap();
    assert_eq!((metadata.grid.width, metadata.grid.geotransform[0]), (40, 37.0));
    let mut outside = test_store.dir.path().ancestors();
    assert!(!outside.any(|folder| folder.join("escaped.tif").exists()));
}
