//! NASA Black Marble granules, made here as HDF5 files by GDAL's netCDF-4 driver.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{TestRaster, TestStore, place};
use gdal::raster::{Buffer, RasterCreationOptions};
use gdal::spatial_ref::SpatialRef;
use gdal::{DriverManager, Metadata};
use skyglow_scene::{IngestOptions, SceneMetadata};
use std::path::Path;

const DAILY: &str = "Gap_Filled_DNB_BRDF-Corrected_NTL";
const COMPOSITE: &str = "NearNadir_Composite_Snow_Free";
/// Pixels a side, instead of 2400.
const SIDE: usize = 240;

/// Writes a granule with a dataset of 16-bit numbers, and two more (`lat` and `lon`, which that driver makes
/// of any projection) unless `alone`; `scale` adds the attributes.
fn write_granule(
    path: &Path,
    name: &str,
    alone: bool,
    scale: Option<f64>,
    values: impl Fn(usize, usize) -> u16,
) {
    let memory = DriverManager::get_driver_by_name("MEM").unwrap();
    let mut dataset = memory.create_with_band_type::<u16, _>("", SIDE, SIDE, 1).unwrap();
    let mut band = dataset.rasterband(1).unwrap();
    band.set_metadata_item("NETCDF_VARNAME", name, "").unwrap();
    let data = (0..SIDE * SIDE).map(|i| values(i % SIDE, i / SIDE)).collect();
    band.write((0, 0), (SIDE, SIDE), &mut Buffer::new((SIDE, SIDE), data)).unwrap();
    if let Some(scale) = scale {
        band.set_no_data_value(Some(65_535.0)).unwrap();
        band.set_scale(scale).unwrap();
        band.set_offset(0.0).unwrap();
    }
    let mut options = RasterCreationOptions::from_iter(["FORMAT=NC4", "WRITE_BOTTOMUP=NO"]);
    if !alone {
        // Not the tile's place: that must come from its name.
        dataset.set_spatial_ref(&SpatialRef::from_epsg(32637).unwrap()).unwrap();
        dataset.set_geo_transform(&[400_000.0, 100.0, 0.0, 100_000.0, 0.0, -100.0]).unwrap();
        options.add_string("WRITE_LONLAT=YES").unwrap();
    }
    dataset.set_metadata_item("NC_GLOBAL#HorizontalTileNumber", "21", "").unwrap();
    dataset.set_metadata_item("NC_GLOBAL#VerticalTileNumber", "09", "").unwrap();
    let driver = DriverManager::get_driver_by_name("netCDF").unwrap();
    let written = path.with_extension("nc");
    dataset.create_copy(&driver, &written, &options).unwrap().close().unwrap();
    std::fs::rename(written, path).unwrap();
}

fn values(column: usize, row: usize) -> u16 {
    match (column, row) {
        (_, 0) => 65_535,
        (120, 60) => 505,
        (30, 200) => 12,
        _ => 0,
    }
}

fn ingest(test_store: &TestStore, file: &str, change: impl FnOnce(&mut IngestOptions)) -> SceneMetadata {
    let mut options = IngestOptions::new(test_store.path(file));
    options.replace = true;
    change(&mut options);
    test_store.ingest(&options).unwrap()
}

/// The granule's scale, fill value, tile and lights came through.
fn check(test_store: &TestStore, metadata: &SceneMetadata, name: &str) {
    assert_eq!(metadata.report.band, name);
    assert_eq!((metadata.report.lit.count, metadata.report.no_data.count), (2, SIDE as u64));
    assert!((metadata.report.maximum_nw_cm2_sr - 50.5).abs() < 1e-5, "{}", metadata.report.maximum_nw_cm2_sr);
    // Tile h21v09: 30..40° E, 0..10° S.
    assert_eq!(metadata.bounds, [30.0, -10.0, 40.0, 0.0]);
    let scene = test_store.store.open(&metadata.id).unwrap();
    let at = |column: f64, row: f64| place(-(row + 0.5) * 10.0 / 240.0, 30.0 + (column + 0.5) * 10.0 / 240.0);
    assert!((scene.radiance_nw_cm2_sr(at(120.0, 60.0)).unwrap() - 50.5).abs() < 1e-5);
    assert!((scene.radiance_nw_cm2_sr(at(30.0, 200.0)).unwrap() - 1.2).abs() < 1e-5);
    assert_eq!(scene.radiance_nw_cm2_sr(at(5.0, 0.0)), None);
}

/// A daily granule is read with its scale, fill value and tile.
#[test]
fn a_daily_granule_has_scale_fill_and_tile() {
    let test_store = TestStore::new();
    let file = "VNP46A2.A2023001.h21v09.001.2023010.h5";
    write_granule(&test_store.path(file), DAILY, false, Some(0.1), values);
    check(&test_store, &ingest(&test_store, file, |_| {}), DAILY);
}

/// A yearly composite is read from its near-nadir dataset.
#[test]
fn a_yearly_composite_uses_near_nadir_data() {
    let test_store = TestStore::new();
    let file = "VNP46A4.A2023001.h21v09.001.2023010.h5";
    write_granule(&test_store.path(file), COMPOSITE, false, Some(0.1), values);
    check(&test_store, &ingest(&test_store, file, |_| {}), COMPOSITE);
    let other = ingest(&test_store, file, |options| options.band = Some("lon".into()));
    assert_eq!(other.report.band, "lon");
    assert!(other.report.minimum_nw_cm2_sr > 38.0, "{}", other.report.minimum_nw_cm2_sr);
}

/// The tile comes from the attributes when the file's name has none.
#[test]
fn the_tile_may_come_from_the_attributes() {
    let test_store = TestStore::new();
    write_granule(&test_store.path("renamed.h5"), DAILY, false, Some(0.1), values);
    check(&test_store, &ingest(&test_store, "renamed.h5", |_| {}), DAILY);
}

/// A granule without attributes takes the product's scale and fill value.
#[test]
fn a_bare_granule_takes_product_defaults() {
    let test_store = TestStore::new();
    let file = "VNP46A2.A2023001.h21v09.001.2023010.h5";
    write_granule(&test_store.path(file), DAILY, false, None, values);
    check(&test_store, &ingest(&test_store, file, |_| {}), DAILY);
}

#[test]
fn a_file_with_the_radiance_alone_is_read_too() {
    let test_store = TestStore::new();
    let file = "VNP46A2.A2023001.h21v09.001.2023010.h5";
    write_granule(&test_store.path(file), DAILY, true, Some(0.1), values);
    check(&test_store, &ingest(&test_store, file, |_| {}), DAILY);
}

#[test]
fn an_unknown_granule_names_what_it_holds() {
    let test_store = TestStore::new();
    let file = test_store.path("X.h21v09.h5");
    write_granule(&file, "Moon_Phase", false, Some(0.1), values);
    let told = test_store.refusal(&IngestOptions::new(&file));
    assert!(told.contains("--band") && told.contains("Moon_Phase"), "{told}");
    let mut options = IngestOptions::new(&file);
    options.band = Some("Nothing".into());
    assert!(test_store.refusal(&options).contains("no dataset \"Nothing\""));
    // Alone in its file it could pass for anything.
    write_granule(&file, "Moon_Phase", true, Some(0.1), values);
    assert!(test_store.refusal(&IngestOptions::new(&file)).contains("--band 1"));
    let whole = std::fs::read(&file).unwrap();
    std::fs::write(&file, &whole[..whole.len() / 2]).unwrap();
    assert!(test_store.refusal(&IngestOptions::new(&file)).contains("truncated"));
}

#[test]
fn scale_and_offset_of_a_geotiff_are_applied() {
    let test_store = TestStore::new();
    let mut raster = TestRaster::scattered(60, 50);
    raster.scale_offset = Some((0.01, 0.5));
    raster.no_data = Some(0.0);
    raster.values.iter_mut().for_each(|v| *v = (*v * 100.0).round());
    let path = test_store.path("light.tif");
    raster.write(&path, |v| v as u16);
    let metadata = test_store.ingest(&IngestOptions::new(&path)).unwrap();
    let largest = raster.values.iter().copied().fold(0.0, f64::max);
    assert!((metadata.report.maximum_nw_cm2_sr - (0.5 + 0.01 * largest)).abs() < 1e-4);
    let zeros = raster.values.iter().filter(|v| **v == 0.0).count() as u64;
    assert_eq!(metadata.report.no_data.count, zeros);
}
