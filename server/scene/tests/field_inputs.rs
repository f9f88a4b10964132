//! Files of the kinds that people have: what is recognised, what is refused, and that nothing is wrong in silence.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{STEP, TestRaster, TestStore, place};
use gdal::{Dataset, DriverManager};
use skyglow_scene::{IngestOptions, NoisePolicy, OverlapRule, SceneMetadata};
use std::{io::Write, path::Path};

/// Ingests a raster file under changed options.
fn ingested(test_store: &TestStore, path: &Path, change: impl FnOnce(&mut IngestOptions)) -> SceneMetadata {
    let mut options = IngestOptions::new(path);
    options.replace = true;
    change(&mut options);
    test_store.ingest(&options).unwrap()
}

fn warns(metadata: &SceneMetadata, words: &str) -> bool {
    metadata.report.warnings.iter().any(|warning| warning.contains(words))
}

/// Sets the unit of a raster's band.
fn set_unit(path: &Path, unit: &str) {
    let text = std::ffi::CString::new(unit).unwrap();
    let dataset = Dataset::open_ex(
        path,
        gdal::DatasetOptions { open_flags: gdal::GdalOpenFlags::GDAL_OF_UPDATE, ..Default::default() },
    )
    .unwrap();
    let band = dataset.rasterband(1).unwrap();
    #[expect(unsafe_code, reason = "the crate has no call for it")]
    // SAFETY: the band and the text outlive the call.
    let code = unsafe { gdal_sys::GDALSetRasterUnitType(band.c_rasterband(), text.as_ptr()) };
    assert_eq!(code, gdal_sys::CPLErr::CE_None);
    dataset.close().unwrap();
}

/// Integers without a scale are refused with what to do, and the advice leads to the right number.
#[test]
fn integers_without_a_scale_are_refused() {
    let test_store = TestStore::new();
    let plain = TestRaster::scattered(60, 50);
    let path = test_store.path("light.tif");
    plain.write_f32(&path);
    let right = ingested(&test_store, &path, |_| {});
    let tenths = |v: f64| (v * 10.0).round();
    let path = test_store.path("tenths.tif");
    let with_fill = |raster: &TestRaster| {
        let mut raster = raster.clone();
        raster.values[..120].fill(6_553.5);
        raster
    };
    with_fill(&plain).write(&path, |v| tenths(v) as u16);
    let told = test_store.ingest(&IngestOptions::new(&path)).unwrap_err().to_string();
    assert!(told.contains("--scale 0.1 --nodata 65535"), "{told}");
    // Followed, or followed in half: the largest number of the type is never light.
    for no_data in [vec![65_535.0], vec![]] {
        let said = !no_data.is_empty();
        let metadata = ingested(&test_store, &path, |options| {
            options.scale = Some(0.1);
            options.no_data = no_data;
        });
        let report = &metadata.report;
        assert_eq!(report.no_data.count + report.fill.count, 120);
        assert_eq!(warns(&metadata, "65535"), !said);
        assert!((report.maximum_nw_cm2_sr - right.report.maximum_nw_cm2_sr).abs() < 0.06);
    }
    // The same numbers as floats.
    let path = test_store.path("floats.tif");
    let mut counts = plain.clone();
    counts.values.iter_mut().for_each(|v| *v = tenths(*v));
    counts.write_f32(&path);
    let told = test_store.ingest(&IngestOptions::new(&path)).unwrap_err().to_string();
    assert!(told.contains("--scale 0.1"), "{told}");
}

/// Values that fill gaps are no data, declared or not, and those that are not declared are named.
#[test]
fn gaps_are_no_data_and_named() {
    let test_store = TestStore::new();
    let path = test_store.path("light.tif");
    for (fill, declared) in [
        (-999.9, Some(-999.9)),
        (-9999.0, None),
        (-999.3, None),
        (-3.4028234663852886e38, Some(-3.4e38)),
        (-3.4028234663852886e38, None),
        (-1.0, None),
        (6_553.5, None),
    ] {
        let mut raster = TestRaster::scattered(60, 50);
        raster.values[..600].fill(fill);
        raster.no_data = declared;
        raster.write_f32(&path);
        let metadata = ingested(&test_store, &path, |_| {});
        let report = &metadata.report;
        let counts = (report.no_data.count, report.fill.count, report.negative.count);
        let expected = if declared.is_some() { (600, 0, 0) } else { (0, 600, 0) };
        assert_eq!(counts, expected, "{fill} {declared:?} {:?}", report.warnings);
        assert_eq!(warns(&metadata, "count as no data"), declared.is_none());
        assert!(report.maximum_nw_cm2_sr < 50.0 && report.minimum_nw_cm2_sr >= 0.0);
    }
}

/// A no-data value of 0 is said, and taken for dark where that is asked for or the product is known.
#[test]
fn zero_as_no_data_is_said() {
    let test_store = TestStore::new();
    let mut raster = TestRaster::scattered(60, 50);
    raster.no_data = Some(0.0);
    let path = test_store.path("light.tif");
    raster.write_f32(&path);
    let missing = ingested(&test_store, &path, |_| {});
    assert!(warns(&missing, "--zero-is-dark") && missing.report.zero.count == 0);
    let dark = ingested(&test_store, &path, |options| options.zero_is_dark = true);
    assert!(!warns(&dark, "--zero-is-dark") && dark.report.no_data.count == 0);
    let known = test_store.path("VNL_v2_npp_2020_global_vcmslcfg.average_masked.tif");
    std::fs::copy(&path, &known).unwrap();
    let known = ingested(&test_store, &known, |_| {});
    assert_eq!((known.report.no_data.count, known.date.as_deref()), (0, Some("2020")));
    assert_eq!(known.report.lit.count, dark.report.lit.count);
}

/// The unit that a file says is read.
#[test]
fn units_of_files_are_read() {
    let test_store = TestStore::new();
    let plain = TestRaster::scattered(60, 50);
    let right = test_store.scene(&plain).metadata().report.flux_dnb_w;
    let path = test_store.path("light.tif");
    for (factor, unit) in [(1e-5, "W m-2 sr-1"), (1e-9, "Watts/(cm^2 sr)"), (1.0, "nW/cm2/sr")] {
        let mut raster = plain.clone();
        raster.values.iter_mut().for_each(|v| *v *= factor);
        raster.write_f32(&path);
        set_unit(&path, unit);
        let metadata = ingested(&test_store, &path, |_| {});
        assert!((metadata.report.flux_dnb_w / right - 1.0).abs() < 1e-5, "{unit}");
        assert!(metadata.report.recognised.iter().any(|entry| entry.value.contains(unit)));
    }
    plain.write_f32(&path);
    set_unit(&path, "DN");
    assert!(test_store.ingest(&IngestOptions::new(&path)).is_err());
}

/// Terrain in feet is read as such, and heights that no peak has are refused.
#[test]
fn terrain_in_feet_is_put_in_metres() {
    let test_store = TestStore::new();
    let (light, dem) = (test_store.path("light.tif"), test_store.path("dem.tif"));
    TestRaster::scattered(60, 50).write_f32(&light);
    let terrain = TestRaster::new(60, 50, |c, r| 1_000.0 + 20.0 * (c + r) as f64);
    let highest = |change: &dyn Fn(&mut IngestOptions)| {
        let metadata = ingested(&test_store, &light, |options| {
            options.terrain = vec![dem.clone()];
            change(options);
        });
        metadata.report.terrain.unwrap().maximum_m
    };
    terrain.write_f32(&dem);
    let in_metres = highest(&|_| {});
    let mut feet = terrain.clone();
    feet.values.iter_mut().for_each(|v| *v /= 0.3048);
    feet.write_f32(&dem);
    set_unit(&dem, "ft");
    assert!((highest(&|_| {}) - in_metres).abs() < 1e-2);
    feet.write_f32(&dem);
    assert!((highest(&|options| options.terrain_units = Some("ft".into())) - in_metres).abs() < 1e-2);
    // Nothing says the unit, and half of it lies higher than any peak.
    feet.values.iter_mut().for_each(|v| *v *= 3.0);
    feet.write_f32(&dem);
    let mut options = IngestOptions::new(&light);
    (options.terrain, options.replace) = (vec![dem.clone()], true);
    let told = test_store.ingest(&options).unwrap_err().to_string();
    assert!(told.contains("--terrain-units"), "{told}");
    // Voids that no tag names.
    let mut void = terrain;
    void.values[..1_000].fill(-9_999.0);
    void.write_f32(&dem);
    let metadata = ingested(&test_store, &light, |options| options.terrain = vec![dem.clone()]);
    let report = metadata.report.terrain.unwrap();
    assert!(report.void_samples == 1_000 && report.minimum_m >= 1_000.0, "{report:?}");
}

/// Granules of one grid are one scene, the same as of one file, whatever their order; others are refused by name.
#[test]
fn granules_side_by_side_are_one_scene() {
    let test_store = TestStore::new();
    let whole = TestRaster::scattered(80, 40);
    let path = test_store.path("light.tif");
    whole.write_f32(&path);
    let one = ingested(&test_store, &path, |_| {});
    let part = |name: &str, columns: std::ops::Range<usize>| {
        let mut raster = whole.clone();
        raster.size = (columns.len(), 40);
        raster.geotransform[0] += columns.start as f64 * STEP;
        raster.values = (0..40).flat_map(|row| whole.values[row * 80..][columns.clone()].to_vec()).collect();
        let path = test_store.path(name);
        raster.write_f32(&path);
        path
    };
    // They overlap by eight columns.
    let (west, east) = (part("west.tif", 0..48), part("east.tif", 40..80));
    for files in [vec![west.clone(), east.clone()], vec![east.clone(), west.clone()]] {
        let mut options = IngestOptions::new(&files[0]);
        options.radiance = files;
        options.replace = true;
        let both = test_store.ingest(&options).unwrap();
        assert_eq!((both.lit_pixels, both.bounds, both.report.files.len()), (one.lit_pixels, one.bounds, 2));
        assert_eq!(both.report.flux_dnb_w, one.report.flux_dnb_w);
    }
    assert!(one.report.warnings.iter().all(|warning| !warning.contains("overlap")));
    let list = test_store.path("files.txt");
    std::fs::write(&list, "west.tif\neast.tif\n").unwrap();
    assert_eq!(ingested(&test_store, &list, |_| {}).lit_pixels, one.lit_pixels);
    let vrt = test_store.path("all.vrt");
    let source = |name: &str, at: usize, width: usize| {
        format!(
            "<SimpleSource><SourceFilename relativeToVRT=\"1\">{name}</SourceFilename><SourceBand>1</SourceBand>\
             <SrcRect xOff=\"0\" yOff=\"0\" xSize=\"{width}\" ySize=\"40\" />\
             <DstRect xOff=\"{at}\" yOff=\"0\" xSize=\"{width}\" ySize=\"40\" /></SimpleSource>"
        )
    };
    let sources = source("west.tif", 0, 48) + &source("east.tif", 40, 40);
    std::fs::write(
        &vrt,
        format!("<VRTDataset><VRTRasterBand band=\"1\">{sources}</VRTRasterBand></VRTDataset>"),
    )
    .unwrap();
    assert_eq!(ingested(&test_store, &vrt, |_| {}).lit_pixels, one.lit_pixels);
    let mut shifted = whole.clone();
    shifted.geotransform[0] += 80.4 * STEP;
    shifted.write_f32(&test_store.path("shifted.tif"));
    let mut options = IngestOptions::new(&west);
    options.radiance.push(test_store.path("shifted.tif"));
    options.replace = true;
    let told = test_store.ingest(&options).unwrap_err().to_string();
    assert!(told.contains("shifted.tif") && told.contains("grid"), "{told}");
}

/// Where rasters have measured the same pixels the rule says what counts, a hole in one is filled by the other, and a code of missing
/// data is in no mean.
#[test]
fn overlaps_count_by_a_rule() {
    let test_store = TestStore::new();
    let write = |name: &str, at: [f64; 4]| {
        let mut raster = TestRaster::scattered(80, 40);
        raster.values[..4].copy_from_slice(&at);
        let path = test_store.path(name);
        raster.write_f32(&path);
        path
    };
    let older = write("VNL_v2_npp_2019_global_vcmslcfg.tif", [10.0, 30.0, f64::NAN, 6.0]);
    let newer = write("VNL_v2_npp_2022_global_vcmslcfg.tif", [20.0, 5.0, 7.0, -999.0]);
    let radiances = |text: &str| {
        let mut options = IngestOptions::new(&older);
        options.radiance.push(newer.clone());
        (options.overlap, options.replace) = (OverlapRule::parse(text).unwrap(), true);
        options.no_data.push(-999.0);
        let scene = test_store.ingest(&options).unwrap();
        let said = format!("the {}", if text == "max" { "largest" } else { text });
        assert!(
            scene.report.warnings.iter().any(|warning| warning.contains(&said)),
            "{:?}",
            scene.report.warnings
        );
        let opened = test_store.store.open(&scene.id).unwrap();
        let of = |column: u8| {
            let at = place(-1.0 - 0.5 * STEP, 37.0 + (f64::from(column) + 0.5) * STEP);
            opened.radiance_nw_cm2_sr(at).unwrap()
        };
        [0, 1, 2, 3].map(of)
    };
    assert_eq!(radiances("first"), [10.0, 30.0, 7.0, 6.0]);
    assert_eq!(radiances("mean"), [15.0, 17.5, 7.0, 6.0]);
    assert_eq!(radiances("max"), [20.0, 30.0, 7.0, 6.0]);
    assert_eq!(radiances("newest"), [20.0, 5.0, 7.0, 6.0]);
    let undated = write("undated.tif", [1.0; 4]);
    let mut options = IngestOptions::new(&older);
    options.radiance.push(undated);
    (options.overlap, options.replace) = (OverlapRule::Newest, true);
    let told = test_store.ingest(&options).unwrap_err().to_string();
    assert!(told.contains("undated.tif") && told.contains("--overlap"), "{told}");
}

/// Granules on both sides of the antimeridian lie side by side.
#[test]
fn granules_meet_at_the_antimeridian() {
    let test_store = TestStore::new();
    let at = |name: &str, longitude: f64| {
        let mut raster = TestRaster::scattered(48, 40);
        raster.geotransform[0] = longitude;
        let path = test_store.path(name);
        raster.write_f32(&path);
        path
    };
    let (east, west) = (at("east.tif", 180.0 - 48.0 * STEP), at("west.tif", -180.0));
    let mut options = IngestOptions::new(&west);
    options.radiance.push(east);
    let metadata = test_store.ingest(&options).unwrap();
    assert_eq!(metadata.grid.width, 96);
    let [west_deg, _, east_deg, _] = metadata.bounds;
    assert!((west_deg - 179.8).abs() < 1e-6 && (east_deg + 179.8).abs() < 1e-6, "{:?}", metadata.bounds);
}

/// Packed files are read; what is no raster is named with what to do.
#[test]
fn packed_files_are_read_and_others_named() {
    let test_store = TestStore::new();
    let path = test_store.path("light.tif");
    TestRaster::scattered(60, 50).write_f32(&path);
    let plain = ingested(&test_store, &path, |_| {});
    let bytes = std::fs::read(&path).unwrap();
    let packed = test_store.path("light.average.tif.gz");
    let mut encoder =
        flate2::write::GzEncoder::new(std::fs::File::create(&packed).unwrap(), flate2::Compression::fast());
    encoder.write_all(&bytes).unwrap();
    encoder.finish().unwrap();
    assert_eq!(ingested(&test_store, &packed, |_| {}).lit_pixels, plain.lit_pixels);
    let archive = test_store.path("light.zip");
    let mut writer = zip::ZipWriter::new(std::fs::File::create(&archive).unwrap());
    writer.start_file("readme.txt", zip::write::SimpleFileOptions::default()).unwrap();
    writer.start_file("../deep/light.tif", zip::write::SimpleFileOptions::default()).unwrap();
    writer.write_all(&bytes).unwrap();
    writer.start_file("folder/light.tif", zip::write::SimpleFileOptions::default()).unwrap();
    writer.write_all(&bytes).unwrap();
    writer.finish().unwrap();
    assert_eq!(ingested(&test_store, &archive, |_| {}).lit_pixels, plain.lit_pixels);
    for (name, head, advice) in [
        ("login.h5", &b"<!DOCTYPE html><html><body>Log in"[..], "login"),
        ("light.nc", b"CDF\x01....", "NETCDF:"),
        ("light.img", b"EHFA_HEADER_TAG....", "gdal_translate"),
        ("light.asc", b"ncols 4\nnrows 4\n", "-a_srs"),
        ("light.tar.gz.tif", b"BZh91AY", "unpack"),
        ("light.png", b"\x89PNG\r\n\x1a\n", "picture"),
    ] {
        let path = test_store.path(name);
        std::fs::write(&path, head).unwrap();
        let mut options = IngestOptions::new(&path);
        options.replace = true;
        let told = test_store.ingest(&options).unwrap_err().to_string();
        assert!(told.contains(advice), "{told}");
    }
    // Of somebody who is not trusted a small file does not fill the disk.
    let bomb = test_store.path("bomb.tif.gz");
    let mut encoder =
        flate2::write::GzEncoder::new(std::fs::File::create(&bomb).unwrap(), flate2::Compression::fast());
    let zeros = vec![0u8; 1 << 20];
    (0..80).for_each(|_| encoder.write_all(&zeros).unwrap());
    encoder.finish().unwrap();
    let mut options = IngestOptions::new(&bomb);
    options.max_pixels = Some(1000);
    assert!(test_store.ingest(&options).unwrap_err().to_string().contains("unpacks to more"));
}

/// Noise around zero does not become light, light does not become less, and the bias is said.
#[test]
fn noise_around_zero_is_balanced() {
    let test_store = TestStore::new();
    let mut state = 1u64;
    let mut normal = move || {
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| unit()).sum::<f64>() - 6.0
    };
    let plain = TestRaster::new(240, 240, |c, r| {
        if (100..104).contains(&c) && (100..104).contains(&r) { 12.5 } else { 0.0 }
    });
    let right = test_store.scene(&plain).metadata().report.flux_dnb_w;
    let mut noisy = plain.clone();
    noisy.values.iter_mut().for_each(|v| *v += 0.15 * normal());
    let balanced = test_store.scene(&noisy);
    let report = &balanced.metadata().report;
    let noise = report.noise.unwrap();
    assert!(
        (0.13..0.17).contains(&noise.deviation_nw_cm2_sr) && noise.balanced && noise.bias > 5.0,
        "{noise:?}"
    );
    assert!((report.flux_dnb_w / right - 1.0).abs() < 0.2, "{}", report.flux_dnb_w / right);
    assert!(warns(balanced.metadata(), "noise around zero"));
    let cut = test_store.scene_with(&noisy, |options| options.noise = NoisePolicy::Cut);
    assert!(cut.metadata().report.flux_dnb_w > 10.0 * right);
    let floor = test_store.scene_with(&noisy, |options| {
        (options.noise, options.floor_nw_cm2_sr) = (NoisePolicy::Cut, Some(1.0));
    });
    assert!((floor.metadata().report.flux_dnb_w / right - 1.0).abs() < 0.05);
    assert_eq!(floor.metadata().lit_pixels, 16);
    let cap = test_store.scene_with(&plain, |options| options.cap_nw_cm2_sr = Some(10.0));
    assert!((cap.metadata().report.flux_dnb_w / right - 0.8).abs() < 1e-6);
}

/// Masks, quality and observations are read from layers on the radiances' grid, and refused where they are not.
#[test]
fn layers_beside_the_radiances_count() {
    let test_store = TestStore::new();
    let plain = TestRaster::new(40, 30, |_, _| 5.5);
    let path = test_store.path("light.tif");
    plain.write_f32(&path);
    let half = test_store.path("half.tif");
    TestRaster::new(40, 30, |c, _| if c < 20 { 0.0 } else { 3.0 }).write(&half, |v| v as u8);
    let masked = ingested(&test_store, &path, |options| options.masks = vec![half.clone()]);
    assert_eq!((masked.lit_pixels, masked.report.zero.count), (600, 600));
    let good = ingested(&test_store, &path, |options| {
        (options.quality, options.quality_files) = (Some(vec![0, 1]), vec![half.clone()]);
    });
    assert_eq!((good.lit_pixels, good.report.rejected.count), (600, 600));
    let seen = ingested(&test_store, &path, |options| {
        (options.min_observations, options.observation_files) = (Some(2), vec![half.clone()]);
    });
    assert_eq!((seen.lit_pixels, seen.report.rejected.count), (600, 600));
    let mut options = IngestOptions::new(&path);
    (options.quality, options.replace) = (Some(vec![0]), true);
    assert!(test_store.ingest(&options).unwrap_err().to_string().contains("--quality-file"));
    let other = test_store.path("other.tif");
    TestRaster::new(20, 30, |_, _| 1.0).write_f32(&other);
    options.quality_files = vec![other];
    assert!(test_store.ingest(&options).unwrap_err().to_string().contains("on the grid"));
}

/// A driver that the program never reads by: its files are named, not opened.
#[test]
fn other_formats_are_not_opened() {
    let test_store = TestStore::new();
    let path = test_store.path("light.flt");
    let driver = DriverManager::get_driver_by_name("EHdr").unwrap();
    driver.create_with_band_type::<f32, _>(&path, 4, 4, 1).unwrap().close().unwrap();
    let told = test_store.ingest(&IngestOptions::new(&path)).unwrap_err().to_string();
    assert!(told.contains("gdal_translate"), "{told}");
}
