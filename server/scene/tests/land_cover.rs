//! Land cover: classes of products, voids, coarse and fine rasters, and what is refused.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;

use common::{STEP, TestRaster, TestStore, place};
use skyglow_scene::{IngestOptions, Land, LandClasses, SNOW_ALBEDO, Scene};
use std::path::PathBuf;

/// A raster of classes over the lights' ground: forest in the west, water in the east, nothing in the last ten rows.
fn classes(test_store: &TestStore, name: &str, [west, east, void]: [u8; 3]) -> PathBuf {
    let raster = TestRaster::new(80, 40, |column, row| {
        f64::from(if row >= 30 { void } else { [west, east][usize::from(column >= 40)] })
    });
    let path = test_store.path(name);
    raster.write::<u8>(&path, |value| value as u8);
    path
}

fn scene(test_store: &TestStore, change: impl FnOnce(&mut IngestOptions)) -> Scene {
    test_store.scene_with(&TestRaster::scattered(80, 40), change)
}

fn land(scene: &Scene, column: f64, row: f64) -> Option<Land> {
    scene.land(place(-1.0 - row * STEP, 37.0 + column * STEP), 0.0)
}

#[test]
fn classes_become_albedo_water_and_forest() {
    let test_store = TestStore::new();
    let cover = classes(&test_store, "cover.tif", [10, 80, 0]);
    let with_cover = scene(&test_store, |options| options.land_cover.push(cover));
    let close = |found: Option<Land>, albedo: f64, water: f64, forest: f64| {
        let found = found.unwrap();
        let errors = [found.albedo - albedo, found.water - water, found.forest - forest];
        assert!(errors.iter().all(|error| error.abs() < 2e-4), "{found:?}");
    };
    close(land(&with_cover, 12.0, 12.0), 0.06, 0.0, 1.0);
    close(land(&with_cover, 60.0, 12.0), 0.07, 1.0, 0.0);
    // Between the two it is half of each.
    close(land(&with_cover, 40.0, 12.0), 0.065, 0.5, 0.5);
    assert_eq!((land(&with_cover, 12.0, 35.0), land(&with_cover, -9.0, 12.0)), (None, None));
    // From afar it is the mean of much.
    let far = with_cover.land(place(-1.0 - 15.0 * STEP, 37.0 + 40.0 * STEP), 32.0 * 463.0).unwrap();
    assert!((0.3..0.7).contains(&far.water), "{far:?}");
    let said = format!("{:?}", with_cover.metadata().report.recognised);
    assert!(
        with_cover.metadata().land_cover && said.contains("ESA WorldCover") && said.contains("Assumed"),
        "{said}"
    );
    let again = test_store.store.open(&with_cover.metadata().id).unwrap();
    assert_eq!(land(&again, 40.0, 12.0), land(&with_cover, 40.0, 12.0));
    let without = scene(&test_store, |_| {});
    assert!(!without.metadata().land_cover && land(&without, 12.0, 12.0).is_none());
}

/// Under snow open ground is snow, forest is darker, and water stays water.
#[test]
fn forest_is_darker_than_snow() {
    let of = |albedo: f64, water: f64, forest: f64| Land { albedo, water, forest }.albedo_in_snow();
    assert_eq!(of(0.1, 0.0, 0.0), SNOW_ALBEDO);
    assert!((0.1..0.4).contains(&of(0.06, 0.0, 1.0)) && of(0.07, 1.0, 0.0) < 0.1);
    // Ice is no darker for it.
    assert_eq!(of(0.8, 0.0, 0.0), 0.8);
}

/// Fine rasters are put together to samples of 25 m or more; other products are read by their names.
#[test]
fn fine_rasters_are_put_together() {
    let test_store = TestStore::new();
    let mut fine =
        TestRaster::new(2_000, 900, |column, row| if (column / 7 + row / 7) % 2 == 0 { 17.0 } else { 1.0 });
    // 4 m.
    (fine.geotransform[1], fine.geotransform[5]) = (STEP / 116.0, -STEP / 116.0);
    let path = test_store.path("igbp.tif");
    fine.write::<u8>(&path, |value| value as u8);
    let scene = scene(&test_store, |options| {
        options.land_cover.push(path);
        options.land_cover_classes = Some(LandClasses::Igbp);
    });
    let found = land(&scene, 8.0, 4.0).unwrap();
    assert!(
        (0.2..0.8).contains(&found.water) && (found.water + found.forest - 1.0).abs() < 1e-3,
        "{found:?}"
    );
    let said = format!("{:?}", scene.metadata().report.recognised);
    assert!(said.contains("IGBP, means over 28 m") && said.contains("Certain"), "{said}");
}

#[test]
fn other_classes_and_rasters_are_refused() {
    let test_store = TestStore::new();
    TestRaster::scattered(80, 40).write_f32(&test_store.path("light.tif"));
    let refusal = |cover: PathBuf| {
        let mut options = IngestOptions::new(test_store.path("light.tif"));
        options.land_cover.push(cover);
        test_store.refusal(&options)
    };
    let unknown = refusal(classes(&test_store, "unknown.tif", [10, 17, 0]));
    assert!(unknown.contains("class 17") && unknown.contains("--land-cover-classes"), "{unknown}");
    let void = refusal(classes(&test_store, "void.tif", [0, 0, 0]));
    assert!(void.contains("know nothing of the ground"), "{void}");
    let mut elsewhere = TestRaster::new(80, 40, |_, _| 10.0);
    elsewhere.geotransform[0] = 50.0;
    elsewhere.write::<u8>(&test_store.path("elsewhere.tif"), |value| value as u8);
    assert!(refusal(test_store.path("elsewhere.tif")).contains("know nothing of the ground"));
    TestRaster::scattered(80, 40).write_f32(&test_store.path("numbers.tif"));
    let numbers = refusal(test_store.path("numbers.tif"));
    assert!(numbers.contains("not classes of 8 or 16 bits"), "{numbers}");
}

/// A scene whose land cover is gone or altered is not opened.
#[test]
fn damaged_land_cover_is_refused() {
    let test_store = TestStore::new();
    let cover = classes(&test_store, "cover.tif", [10, 80, 0]);
    let id = scene(&test_store, |options| options.land_cover.push(cover)).metadata().id.clone();
    let file = test_store.store.scenes_dir().join(id.as_str()).join("land_cover.bin");
    let whole = std::fs::read(&file).unwrap();
    let mut altered = whole.clone();
    altered[whole.len() / 2] ^= 1;
    std::fs::write(&file, altered).unwrap();
    assert!(test_store.store.open(&id).unwrap_err().to_string().contains("land_cover.bin"));
    std::fs::remove_file(&file).unwrap();
    assert!(test_store.store.open(&id).unwrap_err().to_string().contains("land_cover.bin"));
}
