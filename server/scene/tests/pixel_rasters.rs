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
        assert_alike(&read, &wanted);
    }
}

fn assert_alike(read: &[f32], wanted: &[f32]) {
    let alike = read.iter().zip(wanted).filter(|(a, b)| a == b || (a.is_nan() && b.is_nan())).count();
    assert_eq!((alike, read.len()), (wanted.len(), wanted.len()));
}

/// Overviews are means of the pixels that have a number, and lie in the file as a cloud-optimized GeoTIFF has them: directories first, then
/// the coarsest.
#[test]
fn pixel_geotiffs_are_cloud_optimized() {
    let test_store = TestStore::new();
    let raster = TestRaster::scattered(1301, 530);
    let scene = test_store.scene(&raster);
    let numbers: Vec<u32> = (0..u32::try_from(scene.metadata().lit_pixels).unwrap()).collect();
    let values: Vec<f32> = numbers.iter().map(|number| 1.0 + (number % 7) as f32).collect();
    let path = "/vsimem/cloud-optimized.tif";
    vsi::create_mem_file(path, scene.pixels_geotiff(&numbers, &values, &WORDS).unwrap()).unwrap();
    let dataset = Dataset::open(path).unwrap();
    let band = dataset.rasterband(1).unwrap();
    assert_eq!(band.overview_count().unwrap(), 2);
    let mut bands = vec![band];
    for index in 0..2 {
        let overview = bands[0].overview(index).unwrap();
        bands.push(overview);
    }
    assert_eq!(
        bands.iter().map(|band| band.size()).collect::<Vec<_>>(),
        [(1301, 530), (651, 265), (326, 133)]
    );
    let all: Vec<Vec<f32>> = bands
        .iter()
        .map(|band| band.read_as::<f32>((0, 0), band.size(), band.size(), None).unwrap().data().to_vec())
        .collect();
    for level in 1..3 {
        let ((columns, rows), (width, height)) = (bands[level].size(), bands[level - 1].size());
        let mean = |index: usize| {
            let (column, row) = (2 * (index % columns), 2 * (index / columns));
            let around = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(c, r)| (column + c, row + r));
            let inside = around.into_iter().filter(|(c, r)| *c < width && *r < height);
            let lit: Vec<f32> =
                inside.map(|(c, r)| all[level - 1][r * width + c]).filter(|value| !value.is_nan()).collect();
            lit.iter().sum::<f32>() / lit.len() as f32
        };
        let wanted: Vec<f32> = (0..columns * rows).map(mean).collect();
        assert!(wanted.iter().any(|value| value.is_nan()) && wanted.iter().any(|value| *value > 1.0));
        let differs = |(a, b): (&f32, &f32)| !((a - b).abs() < 1e-5 || (a.is_nan() && b.is_nan()));
        assert!(!all[level].iter().zip(&wanted).any(differs), "{level}");
    }
    let at = |level: usize, item: &str| -> u64 {
        bands[level].metadata_item(item, "TIFF").unwrap().parse().unwrap()
    };
    let directories: Vec<u64> = (0..3).map(|level| at(level, "IFD_OFFSET")).collect();
    let tiles: Vec<u64> = (0..3).rev().map(|level| at(level, "BLOCK_OFFSET_0_0")).collect();
    let order = [directories, tiles].concat();
    assert!(order.is_sorted_by(|a, b| a < b), "{order:?}");
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
