//! Invalid input is refused in one sentence, and nothing is left behind.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{TestRaster, TestStore, place};
use gdal::DriverManager;
use gdal::raster::{ColorInterpretation, RasterCreationOptions};
use skyglow_scene::{IngestOptions, RadianceUnit, SceneId};

fn refusal_of(change: impl FnOnce(&mut TestRaster)) -> String {
    let test_store = TestStore::new();
    let mut raster = TestRaster::scattered(40, 30);
    change(&mut raster);
    let path = test_store.path("light.tif");
    raster.write_f32(&path);
    test_store.refusal(&IngestOptions::new(path))
}

#[test]
fn a_raster_without_a_crs_is_refused() {
    let told = refusal_of(|raster| raster.epsg = None);
    assert!(told.contains("no coordinate reference system"), "{told}");
}

#[test]
fn metres_called_degrees_are_refused() {
    let told = refusal_of(|raster| raster.geotransform = [257_000.0, 500.0, 0.0, 9_858_000.0, 0.0, -500.0]);
    assert!(told.contains("no longitude and latitude") && told.contains("257000"), "{told}");
}

/// Longitudes a whole turn away are refused, those across an edge are not.
#[test]
fn longitudes_a_turn_away_are_refused() {
    let told = refusal_of(|raster| raster.geotransform[0] = 500.0);
    assert!(told.contains("no longitude and latitude") && told.contains("500"), "{told}");
    let told = refusal_of(|raster| raster.geotransform[0] = -500.0);
    assert!(told.contains("-500"), "{told}");
    for west in [359.9, 179.9, -180.1] {
        let mut raster = TestRaster::scattered(120, 30);
        raster.geotransform[0] = west;
        let bounds = TestStore::new().scene(&raster).metadata().bounds;
        assert!(bounds[0].abs() <= 180.0 && bounds[2].abs() <= 180.0, "{west}: {bounds:?}");
    }
}

#[test]
fn degrees_called_metres_are_refused() {
    let told = refusal_of(|raster| raster.epsg = Some(32737));
    assert!(told.contains("cannot be meant"), "{told}");
}

/// Projected coordinates beyond the world are refused.
#[test]
fn projected_coordinates_off_world_are_refused() {
    for epsg in [3857, 32737, 3035] {
        let told = refusal_of(|raster| {
            raster.epsg = Some(epsg);
            raster.geotransform = [9e8, 500.0, 0.0, 9e8, 0.0, -500.0];
        });
        assert!(told.contains("off the world") || told.contains("no place on Earth"), "{told}");
    }
}

#[test]
fn a_raster_without_a_measurement_is_refused() {
    let told = refusal_of(|raster| {
        raster.no_data = Some(-999.0);
        raster.values.fill(-999.0);
    });
    assert!(told.contains("no measurement"), "{told}");
    let told = refusal_of(|raster| raster.values.fill(f64::NAN));
    assert!(told.contains("no measurement"), "{told}");
}

#[test]
fn a_raster_without_light_is_refused() {
    let told = refusal_of(|raster| raster.values.fill(0.0));
    assert!(told.contains("no light"), "{told}");
    let told = refusal_of(|raster| raster.values.fill(-0.25));
    assert!(told.contains("no light") && told.contains("-0.25"), "{told}");
}

#[test]
fn pictures_are_refused() {
    let test_store = TestStore::new();
    let path = test_store.path("picture.tif");
    TestRaster::scattered(40, 30).write(&path, |v| v as u8);
    let told = test_store.refusal(&IngestOptions::new(&path));
    assert!(told.contains("8-bit"), "{told}");

    let driver = DriverManager::get_driver_by_name("GTiff").unwrap();
    let options = RasterCreationOptions::from_iter(["PHOTOMETRIC=RGB"]);
    let path = test_store.path("rgb.tif");
    let dataset = driver.create_with_band_type_with_options::<u8, _>(&path, 8, 8, 3, &options).unwrap();
    dataset.rasterband(1).unwrap().set_color_interpretation(ColorInterpretation::RedBand).unwrap();
    dataset.close().unwrap();
    let told = test_store.refusal(&IngestOptions::new(&path));
    assert!(told.contains("colour picture"), "{told}");
}

/// Of several bands one must be chosen; an alpha band is a mask.
#[test]
fn bands_must_be_chosen_and_alpha_is_a_mask() {
    let test_store = TestStore::new();
    let path = test_store.path("bands.tif");
    let driver = DriverManager::get_driver_by_name("GTiff").unwrap();
    let options = RasterCreationOptions::default();
    let mut dataset = driver.create_with_band_type_with_options::<f32, _>(&path, 8, 8, 2, &options).unwrap();
    let raster = TestRaster::scattered(8, 8);
    let write = |dataset: &mut gdal::Dataset| {
        dataset.set_geo_transform(&raster.geotransform).unwrap();
        dataset.set_spatial_ref(&gdal::spatial_ref::SpatialRef::from_epsg(4326).unwrap()).unwrap();
        for (number, value) in [(1, 5.0f32), (2, 255.0)] {
            let mut data = gdal::raster::Buffer::new((8, 8), vec![value; 64]);
            if number == 2 {
                data.data_mut()[..32].fill(0.0);
            }
            dataset.rasterband(number).unwrap().write((0, 0), (8, 8), &mut data).unwrap();
        }
    };
    write(&mut dataset);
    dataset.close().unwrap();
    let told = test_store.refusal(&IngestOptions::new(&path));
    assert!(told.contains("--band: 1, 2"), "{told}");
    let mut options = IngestOptions::new(&path);
    options.band = Some("1".into());
    assert_eq!(test_store.ingest(&options).unwrap().lit_pixels, 64);

    let creation = RasterCreationOptions::from_iter(["ALPHA=YES"]);
    let mut dataset = driver.create_with_band_type_with_options::<f32, _>(&path, 8, 8, 2, &creation).unwrap();
    write(&mut dataset);
    dataset.close().unwrap();
    options.band = None;
    options.replace = true;
    let metadata = test_store.ingest(&options).unwrap();
    assert_eq!((metadata.lit_pixels, metadata.report.no_data.count), (32, 32));
}

#[test]
fn eight_bit_radiances_pass_with_their_scale() {
    let test_store = TestStore::new();
    let path = test_store.path("light.tif");
    TestRaster::scattered(40, 30).write(&path, |v| v as u8);
    let mut options = IngestOptions::new(&path);
    options.scale = Some(0.5);
    let metadata = test_store.ingest(&options).unwrap();
    assert!(metadata.report.maximum_nw_cm2_sr < 21.0);
}

/// A truncated raster is refused, and so is a file that is no raster.
#[test]
fn truncated_files_and_other_files_are_refused() {
    let test_store = TestStore::new();
    let path = test_store.path("light.tif");
    let mut raster = TestRaster::scattered(700, 700);
    raster.values.iter_mut().enumerate().for_each(|(i, v)| *v += (i as f64 * 0.618).fract());
    raster.write_f32(&path);
    let whole = std::fs::read(&path).unwrap();
    let mut refused = 0;
    for part in [0.0, 0.001, 0.3, 0.6, 0.95] {
        std::fs::write(&path, &whole[..(whole.len() as f64 * part) as usize]).unwrap();
        let told = test_store.refusal(&IngestOptions::new(&path));
        assert!(told.contains("cannot be read as a raster"), "{told}");
        refused += 1;
    }
    assert_eq!(refused, 5);
    std::fs::write(&path, "hello, this is a letter and not a raster").unwrap();
    let told = test_store.refusal(&IngestOptions::new(&path));
    assert!(told.contains("cannot be read as a raster"), "{told}");
}

/// A file with its directory at the front (COG) is refused when its end is cut.
#[test]
fn a_truncated_cog_is_refused() {
    // A COG has all its headers first, so it opens although pixels are missing.
    let test_store = TestStore::new();
    let (plain, cog) = (test_store.path("plain.tif"), test_store.path("cog.tif"));
    let mut raster = TestRaster::scattered(1100, 900);
    raster.values.iter_mut().enumerate().for_each(|(i, v)| *v += (i as f64 * 0.618).fract());
    raster.write_f32(&plain);
    let source = gdal::Dataset::open(&plain).unwrap();
    let driver = DriverManager::get_driver_by_name("COG").unwrap();
    source.create_copy(&driver, &cog, &RasterCreationOptions::default()).unwrap().close().unwrap();
    let same = |path| {
        let mut options = IngestOptions::new(path);
        options.id = Some(SceneId::parse("same").unwrap());
        options.replace = true;
        test_store.ingest(&options).unwrap()
    };
    assert_eq!(same(plain.clone()).report.lit, same(cog.clone()).report.lit);
    let whole = std::fs::read(&cog).unwrap();
    std::fs::write(&cog, &whole[..whole.len() * 3 / 4]).unwrap();
    let store_for_cut = TestStore::new();
    let told = store_for_cut.refusal(&IngestOptions::new(&cog));
    assert!(told.contains("truncated"), "{told}");
}

#[test]
fn virtual_and_missing_files_are_refused() {
    let test_store = TestStore::new();
    for path in ["/vsicurl/http://localhost/x.tif", "/vsimem/x.tif", "/no/such/file.tif", "HDF5:x.h5://a"] {
        let told = test_store.refusal(&IngestOptions::new(path));
        assert!(told.contains(path), "{told}");
    }
    let vrt = test_store.path("light.vrt");
    std::fs::write(&vrt, "<VRTDataset rasterXSize=\"1\" rasterYSize=\"1\"></VRTDataset>").unwrap();
    // Of whoever is trusted a virtual raster stands for its files, and this one has none; of others it is no raster.
    assert!(test_store.refusal(&IngestOptions::new(&vrt)).contains("gdal_translate"));
    let mut untrusted = IngestOptions::new(vrt);
    untrusted.max_pixels = Some(1 << 20);
    assert!(test_store.refusal(&untrusted).contains("cannot be read as a raster"));
}

#[test]
fn wrong_numbers_are_refused_by_their_option() {
    let test_store = TestStore::new();
    let path = test_store.path("light.tif");
    TestRaster::scattered(40, 30).write_f32(&path);
    let mut options = IngestOptions::new(&path);
    options.calibration = -1.0;
    assert!(test_store.refusal(&options).starts_with("--calibration: -1"));
    options.calibration = 1.0;
    options.scale = Some(f64::NAN);
    assert!(test_store.refusal(&options).starts_with("--scale: NaN"));
    options.scale = None;
    options.band = Some("7".into());
    assert!(test_store.refusal(&options).contains("no band \"7\""));
    assert!(RadianceUnit::parse("lux").unwrap_err().to_string().contains("nw-cm2-sr"));
}

/// Bad terrain and bad places are refused before anything is stored.
#[test]
fn bad_terrain_and_places_are_refused() {
    let test_store = TestStore::new();
    let path = test_store.path("light.tif");
    TestRaster::scattered(40, 30).write_f32(&path);
    let mut options = IngestOptions::new(&path);
    let terrain = test_store.path("terrain.tif");
    options.terrain = vec![terrain.clone()];
    assert!(test_store.refusal(&options).contains("terrain.tif"));
    let mut raster = TestRaster::new(20, 20, |_, _| f64::NAN);
    raster.write_f32(&terrain);
    assert!(test_store.refusal(&options).contains("every sample is void"));
    raster.values.fill(100.0);
    raster.epsg = None;
    raster.write_f32(&terrain);
    assert!(test_store.refusal(&options).contains("no coordinate reference system"));
    options.terrain.clear();
    options.places = Some(test_store.path("light.tif"));
    assert!(test_store.refusal(&options).contains("neither GeoJSON nor a table"));
    let places = test_store.path("places.csv");
    for off in ["500", "-181", "360.5", "nan", "inf"] {
        std::fs::write(&places, format!("name,latitude,longitude\nB,-1,{off}\n")).unwrap();
        options.places = Some(places.clone());
        let told = test_store.refusal(&options);
        assert!(
            told.contains("no places") && told.contains("line 2") && told.contains("off the world"),
            "{told}"
        );
    }
    options.places = None;
    options.date = Some("a dark night".into());
    assert!(test_store.refusal(&options).contains("--date: \"a dark night\" is no date"));
}

/// An id that is taken is refused, and the existing scene stays.
#[test]
fn a_taken_id_is_refused() {
    let test_store = TestStore::new();
    let raster = TestRaster::scattered(40, 30);
    let first = test_store.scene(&raster);
    let mut options = IngestOptions::new(test_store.path("light.tif"));
    let told = test_store.ingest(&options).unwrap_err().to_string();
    assert!(told.contains("exists already") && told.contains("--replace"), "{told}");
    // A replacement that fails leaves the old scene too.
    options.replace = true;
    std::fs::write(test_store.path("light.tif"), "broken").unwrap();
    assert!(test_store.ingest(&options).is_err());
    let still = test_store.store.open(&first.metadata().id).unwrap();
    assert_eq!(still.metadata(), first.metadata());
    assert_eq!(test_store.store.list().unwrap().scenes.len(), 1);
}

/// Negative, infinite and other odd pixels are counted, listed, and give no light.
#[test]
fn odd_pixels_are_counted_and_dark() {
    let test_store = TestStore::new();
    let mut raster = TestRaster::scattered(60, 50);
    raster.no_data = Some(-999.0);
    raster.values.iter_mut().for_each(|v| *v = v.min(30.0));
    for (index, odd) in [(0, -999.0), (1, f64::NAN), (2, f64::INFINITY), (3, -0.5), (4, -2.0)] {
        raster.values[index] = odd;
    }
    for index in 100..112 {
        raster.values[index] = 30.0;
    }
    let scene = test_store.scene(&raster);
    let report = &scene.metadata().report;
    assert_eq!((report.no_data.count, report.nan.count, report.negative.count), (1, 1, 2));
    assert_eq!(report.infinite.count, 1);
    assert!(report.capped.count >= 12 && report.maximum_nw_cm2_sr == 30.0);
    assert!(report.warnings.iter().any(|w| w.contains("capped")), "{:?}", report.warnings);
    let total = report.lit.count
        + report.zero.count
        + report.negative.count
        + report.nan.count
        + report.infinite.count
        + report.no_data.count;
    assert_eq!(total, report.pixels);
    let example = report.nan.examples[0];
    assert!((example.longitude_deg - 37.00625).abs() < 2e-5 && (example.latitude_deg + 1.00208).abs() < 2e-5);
    let at = |column: f64| place(-1.0 - 0.5 / 240.0, 37.0 + (column + 0.5) / 240.0);
    assert_eq!(scene.radiance_nw_cm2_sr(at(0.0)), None, "no-data");
    assert_eq!(scene.radiance_nw_cm2_sr(at(1.0)), None, "NaN");
    assert_eq!(scene.radiance_nw_cm2_sr(at(3.0)), Some(0.0), "negative");
    assert_eq!(scene.radiance_nw_cm2_sr(place(10.0, 37.1)), None, "outside");
    assert!(!scene.contains(place(10.0, 37.1)) && scene.contains(at(0.0)));
}

#[test]
fn light_that_nothing_on_earth_sends_is_refused() {
    let test_store = TestStore::new();
    let path = test_store.path("light.tif");
    TestRaster::scattered(60, 50).write_f32(&path);
    let mut options = IngestOptions::new(path);
    options.scale = Some(1e30);
    let told = test_store.refusal(&options);
    assert!(told.contains("scale is not the right one"), "{told}");
    options.scale = Some(1.0);
    assert!(test_store.ingest(&options).is_ok());
}

/// Suspicious units are reported, and the units option corrects them.
#[test]
fn units_are_judged_by_the_mean_of_the_lit() {
    let test_store = TestStore::new();
    let plain = TestRaster::scattered(60, 50);
    let right = test_store.scene(&plain).metadata().report.flux_dnb_w;
    for (factor, unit) in [
        (1e-5, RadianceUnit::WattPerSquareMetreSteradian),
        (1e-9, RadianceUnit::WattPerSquareCentimetreSteradian),
    ] {
        let mut raster = plain.clone();
        raster.values.iter_mut().for_each(|v| *v *= factor);
        // One bright town does not make the unit another one.
        raster.values[0] = 4_000.0 * factor;
        let path = test_store.path("other_unit.tif");
        raster.write_f32(&path);
        let told = test_store.ingest(&IngestOptions::new(&path)).unwrap_err().to_string();
        // The first that is advised is the right one.
        let first = told.split("it would be ").nth(1).and_then(|advice| advice.split(',').next());
        assert!(first.is_some_and(|first| first.ends_with(unit.name())), "{told}");
        // The advice leads to the right number.
        raster.values[0] = plain.values[0] * factor;
        let mended = test_store.scene_with(&raster, |options| options.units = Some(unit));
        assert!(mended.metadata().report.warnings.iter().all(|w| !w.contains("unit")));
        assert!((mended.metadata().report.flux_dnb_w / right - 1.0).abs() < 1e-5);
    }
    let mut raster = plain;
    raster.values.iter_mut().for_each(|v| *v = v.round());
    let picture = test_store.scene(&raster);
    assert!(picture.metadata().report.warnings.iter().any(|w| w.contains("picture")));
}

/// Light that does not fit into memory is refused before work begins, with what it needs and what would help; the few lights of a
/// raster whose pixels could all be lit are counted first.
#[test]
fn light_beyond_the_memory_is_refused() {
    let test_store = TestStore::new();
    let (full, few) = (test_store.path("full.tif"), test_store.path("few.tif"));
    TestRaster::new(1000, 1000, |_, _| 5.0).write_f32(&full);
    TestRaster::new(1000, 1000, |c, r| if c % 100 == 0 && r % 100 == 0 { 5.0 } else { 0.0 }).write_f32(&few);
    let options = |path: &std::path::Path| {
        let mut options = IngestOptions::new(path);
        options.memory_bytes = Some(280 << 20);
        options
    };
    let told = test_store.refusal(&options(&full));
    assert!(
        told.contains("reading its 1000000 lit pixels needs 0.3 GB") && told.contains("--floor"),
        "{told}"
    );
    let mut small = IngestOptions::new(&full);
    small.max_scene_bytes = Some(10_000_000);
    let told = test_store.refusal(&small);
    assert!(told.contains("as a scene its 1000000 lit pixels need 0.0 GB"), "{told}");
    let mut few = options(&few);
    few.max_scene_bytes = Some(100_000);
    assert_eq!(test_store.ingest(&few).unwrap().lit_pixels, 100);
    let bytes = test_store.store.open(&SceneId::parse("few").unwrap()).unwrap().byte_count();
    assert!(bytes <= 100_000, "{bytes}");
    few.max_scene_bytes = Some(10_000);
    few.replace = true;
    assert!(test_store.ingest(&few).unwrap_err().to_string().contains("100 lit pixels"));
}
