//! Numbers of lit pixels as GeoTIFF: read back by GDAL, in the right place.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{TestRaster, TestStore};
use gdal::{Dataset, Metadata, vsi};
use skyglow_scene::{RasterMetadata, Scene};

const WORDS: RasterMetadata<'static> = RasterMetadata {
    description: "what it is",
    unit: "cd m-2",
    notes: &[("ASSUMPTIONS", "{\"a\": \"<b>\"}")],
};

/// The file's values, row by row, after its frame was compared with the scene's.
fn read_back(scene: &Scene, bytes: Vec<u8>, name: &str) -> Vec<f32> {
    let path = format!("/vsimem/read-back-{name}.tif");
    vsi::create_mem_file(&path, bytes).unwrap();
    let dataset = Dataset::open(&path).unwrap();
    let grid = &scene.metadata().grid;
    let size = (grid.width as usize, grid.height as usize);
    assert_eq!(dataset.raster_size(), size);
    assert_eq!(dataset.geo_transform().unwrap(), grid.geotransform);
    let reference = dataset.spatial_ref().unwrap();
    let wanted = gdal::spatial_ref::SpatialRef::from_wkt(&grid.crs_wkt).unwrap();
    assert_eq!(reference.auth_code().ok(), wanted.auth_code().ok());
    assert_eq!(dataset.metadata_item("ASSUMPTIONS", "").as_deref(), Some("{\"a\": \"<b>\"}"));
    let band = dataset.rasterband(1).unwrap();
    assert!(band.no_data_value().unwrap().is_nan());
    assert_eq!((band.description().unwrap().as_str(), band.unit().as_str()), ("what it is", "cd m-2"));
    let values = band.read_as::<f32>((0, 0), size, size, None).unwrap();
    values.data().to_vec()
}

/// Every number is in its pixel, and everything else is no data.
#[test]
fn pixel_geotiffs_hold_numbers_in_place() {
    let test_store = TestStore::new();
    // Not a multiple of the tiles; and metres of a projection whose rows run north.
    let mut projected = TestRaster::scattered(333, 290);
    (projected.epsg, projected.geotransform) =
        (Some(32632), [300_000.0, 500.0, 0.0, 5_100_000.0, 0.0, 500.0]);
    for (name, raster) in [("degrees", TestRaster::scattered(700, 530)), ("metres", projected)] {
        let scene = test_store.scene(&raster);
        let numbers: Vec<u32> = (0..u32::try_from(scene.metadata().lit_pixels).unwrap())
            .filter(|number| number % 3 != 1)
            .collect();
        let values: Vec<f32> = numbers.iter().map(|number| 1e-7 * (1 + number) as f32).collect();
        let read = read_back(&scene, scene.pixels_geotiff(&numbers, &values, &WORDS).unwrap(), name);
        let mut wanted = vec![f32::NAN; raster.values.len()];
        for (number, value) in numbers.iter().zip(&values) {
            let (column, row) = scene.column_and_row(*number);
            assert!(raster.values[row as usize * raster.size.0 + column as usize] > 0.0);
            wanted[row as usize * raster.size.0 + column as usize] = *value;
        }
        let alike = read.iter().zip(&wanted).filter(|(a, b)| a == b || (a.is_nan() && b.is_nan())).count();
        assert_eq!(alike, wanted.len());
    }
}

#[test]
fn few_pixels_of_a_large_raster_are_a_small_file() {
    let test_store = TestStore::new();
    let raster = TestRaster::new(4000, 3000, |c, r| if (c, r) == (3999, 2999) { 5.0 } else { 0.0 });
    let scene = test_store.scene(&raster);
    let bytes = scene.pixels_geotiff(&[0], &[0.5], &WORDS).unwrap();
    assert!(bytes.len() < 20_000, "{} bytes", bytes.len());
    let read = read_back(&scene, bytes, "large");
    assert_eq!((read[4000 * 3000 - 1], read.iter().filter(|value| !value.is_nan()).count()), (0.5, 1));
    // Nothing at all is a raster too.
    let empty = read_back(&scene, scene.pixels_geotiff(&[], &[], &WORDS).unwrap(), "empty");
    assert!(empty.iter().all(|value| value.is_nan()));
}
