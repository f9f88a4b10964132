//! Terrain: another grid than the lights', several files, voids, .hgt.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{TestRaster, TestStore, place};
use skyglow_scene::{Ground, IngestOptions, Scene};
use std::io::Write;

/// A plane in longitude and latitude, metres.
fn plane_m(latitude_deg: f64, longitude_deg: f64) -> f64 {
    1500.0 + 300.0 * (longitude_deg - 37.0) - 200.0 * (latitude_deg + 1.0)
}

/// A raster of the plane with its own step, from its west and north edge.
fn plane(west: f64, north: f64, step: f64, width: usize, height: usize) -> TestRaster {
    let mut raster = TestRaster::new(width, height, |c, r| {
        plane_m(north - (r as f64 + 0.5) * step, west + (c as f64 + 0.5) * step)
    });
    raster.geotransform = [west, step, 0.0, north, 0.0, -step];
    raster
}

fn scene_over(test_store: &TestStore, files: &[TestRaster]) -> Scene {
    let mut paths = Vec::new();
    for (index, raster) in files.iter().enumerate() {
        paths.push(test_store.path(&format!("terrain{index}.tif")));
        raster.write_f32(&paths[index]);
    }
    test_store.scene_with(&TestRaster::scattered(240, 240), |options| options.terrain = paths)
}

/// Elevation is bilinear and therefore exact on a plane at any resolution.
#[test]
fn elevation_is_exact_on_a_plane() {
    let test_store = TestStore::new();
    for step in [0.001, 1.0 / 120.0, 0.031] {
        let size = (1.2 / step) as usize + 2;
        let scene = scene_over(&test_store, &[plane(36.9, -0.9, step, size, size)]);
        for i in 0..200 {
            let (lat, lon) = (-1.01 - 0.0049 * f64::from(i), 37.01 + 0.0048 * f64::from((i * 77) % 200));
            let found = scene.terrain_altitude_m(place(lat, lon)).unwrap();
            assert!((found - plane_m(lat, lon)).abs() < 0.11, "{step}: {found} {}", plane_m(lat, lon));
        }
        for pixel in scene.source_pixels_within(place(-1.5, 37.5), 1e5) {
            let center = skyglow_physics::GeoPoint::from_vector(pixel.center());
            assert!((pixel.altitude_m - plane_m(center.latitude_deg(), center.longitude_deg())).abs() < 0.11);
        }
        let report = scene.metadata().report.terrain.clone().unwrap();
        assert_eq!((report.missing.count, report.nearest.count), (0, 0));
        assert_eq!(report.covered, scene.metadata().lit_pixels);
    }
}

/// Adjoining files make one terrain without a seam.
#[test]
fn adjoining_terrain_files_have_no_seam() {
    let test_store = TestStore::new();
    let step = 0.01;
    let scene =
        scene_over(&test_store, &[plane(36.9, -0.9, step, 60, 130), plane(37.5, -0.9, step, 60, 130)]);
    for i in 0..100 {
        let lon = 37.45 + 0.001 * f64::from(i);
        let found = scene.terrain_altitude_m(place(-1.5, lon)).unwrap();
        // Half a sample at the seam takes its own file's edge.
        assert!((found - plane_m(-1.5, lon)).abs() < 300.0 * 0.5 * step + 0.1, "{lon} {found}");
    }
    assert_eq!(scene.metadata().report.terrain.as_ref().unwrap().files, 2);
}

#[test]
fn the_first_file_with_a_value_counts() {
    let test_store = TestStore::new();
    let mut first = plane(36.9, -0.9, 0.01, 130, 130);
    first.values.iter_mut().enumerate().for_each(|(i, v)| *v = if i % 130 < 65 { 10.0 } else { f64::NAN });
    let scene = scene_over(&test_store, &[first, plane(36.9, -0.9, 0.01, 130, 130)]);
    assert_eq!(scene.terrain_altitude_m(place(-1.5, 37.2)), Some(10.0));
    let behind = scene.terrain_altitude_m(place(-1.5, 37.8)).unwrap();
    assert!((behind - plane_m(-1.5, 37.8)).abs() < 0.2);
}

/// Lights off the terrain take the nearest elevation within 5 km, else sea level.
#[test]
fn lights_off_terrain_take_nearest_within_5_km() {
    let test_store = TestStore::new();
    // Terrain ends in the middle of the lights: 0.5 degrees are 55 km.
    let scene = scene_over(&test_store, &[plane(36.9, -0.9, 0.004, 150, 300)]);
    let edge_deg = 36.9 + 150.0 * 0.004;
    let report = scene.metadata().report.terrain.clone().unwrap();
    assert_eq!(report.covered + report.nearest.count + report.missing.count, scene.metadata().lit_pixels);
    assert!(report.nearest.count > 0 && report.missing.count > 0 && !report.missing.examples.is_empty());
    for pixel in scene.source_pixels_within(place(-1.5, 37.5), 1e5) {
        let center = skyglow_physics::GeoPoint::from_vector(pixel.center());
        let beyond_m = (center.longitude_deg() - edge_deg) * 111_194.9 * center.latitude_rad().cos();
        let at_edge = plane_m(center.latitude_deg(), edge_deg);
        if beyond_m > 5_100.0 {
            assert_eq!(pixel.altitude_m, 0.0);
        } else if (300.0..4_500.0).contains(&beyond_m) {
            assert!((pixel.altitude_m - at_edge).abs() < 3.0, "{beyond_m}: {} {at_edge}", pixel.altitude_m);
        }
    }
    assert_eq!(scene.terrain_altitude_m(place(-1.5, 37.9)), None);
    // An observer's ground follows the same rule as the lights'.
    let beside = place(-1.5, edge_deg + 0.03);
    assert_eq!(scene.terrain_altitude_m(beside), None);
    let Ground::Nearest { elevation_m, distance_m } = scene.ground(beside) else {
        panic!("{:?}", scene.ground(beside))
    };
    assert!((elevation_m - plane_m(-1.5, edge_deg)).abs() < 3.0, "{elevation_m}");
    assert!((distance_m - 3_335.0).abs() < 300.0, "{distance_m}");
    assert_eq!(scene.ground(place(-1.5, edge_deg + 0.05)), Ground::Unknown);
    assert!(matches!(scene.ground(place(-1.5, 37.2)), Ground::Here { .. }));
    let warnings = &scene.metadata().report.warnings;
    assert!(warnings.len() == 1 && warnings[0].contains("have no terrain within 5 km"), "{warnings:?}");
}

/// Terrain of another region is refused: its scene would lie at sea level without a word.
#[test]
fn terrain_that_lies_elsewhere_is_refused() {
    let test_store = TestStore::new();
    let (light, ground) = (test_store.path("light.tif"), test_store.path("ground.tif"));
    TestRaster::scattered(240, 240).write_f32(&light);
    let mut elsewhere = plane(10.0, 40.0, 0.01, 130, 130);
    elsewhere.values.fill(500.0);
    elsewhere.write_f32(&ground);
    let mut options = IngestOptions::new(light);
    options.terrain = vec![ground];
    let refused = test_store.refusal(&options);
    assert!(refused.contains("lies elsewhere") && refused.contains("none"), "{refused}");
}

#[test]
fn below_sea_level_counts_as_sea_level() {
    let test_store = TestStore::new();
    let mut low = plane(36.9, -0.9, 0.01, 130, 130);
    low.values.fill(-30.0);
    let scene = scene_over(&test_store, &[low]);
    assert_eq!(scene.terrain_altitude_m(place(-1.5, 37.5)), Some(0.0));
    assert!(scene.source_pixels_within(place(-1.5, 37.5), 1e5).iter().all(|p| p.altitude_m == 0.0));
    assert_eq!(
        scene.metadata().report.terrain.as_ref().unwrap().below_sea_level,
        scene.metadata().lit_pixels
    );
}

#[test]
fn without_terrain_all_is_at_sea_level_and_said() {
    let test_store = TestStore::new();
    let scene = test_store.scene(&TestRaster::scattered(100, 100));
    assert!(!scene.metadata().terrain && scene.metadata().report.terrain.is_none());
    assert_eq!(scene.terrain_altitude_m(place(-1.2, 37.2)), None);
    assert!(scene.metadata().report.warnings.iter().any(|w| w.contains("no terrain")));
}

#[test]
fn terrain_in_a_projection_is_read_in_its_place() {
    let test_store = TestStore::new();
    let path = test_store.path("utm.tif");
    // UTM 37S around 37.5° E 1.5° S: easting 333 km, northing 9 834 km; heights rise 10 m a kilometre eastwards.
    let mut raster = TestRaster::new(200, 200, |c, _| 1000.0 + 10.0 * (c as f64 + 0.5));
    raster.geotransform = [250_000.0, 1000.0, 0.0, 9_930_000.0, 0.0, -1000.0];
    raster.epsg = Some(32737);
    raster.write_f32(&path);
    let scene =
        test_store.scene_with(&TestRaster::scattered(240, 240), |options| options.terrain = vec![path]);
    // 37.5° E, 1.5° S is easting 333 137.9 by the transverse Mercator series.
    let found = scene.terrain_altitude_m(place(-1.5, 37.5)).unwrap();
    assert!((found - (1000.0 + 10.0 * 83.138)).abs() < 1.0, "{found}");
    assert_eq!(scene.metadata().report.terrain.as_ref().unwrap().missing.count, 0);
}

#[test]
fn an_hgt_file_lies_where_its_name_says() {
    let test_store = TestStore::new();
    let path = test_store.path("S02E037.hgt");
    let mut file = std::io::BufWriter::new(std::fs::File::create(&path).unwrap());
    for row in 0..1201 {
        for column in 0..1201 {
            let (lat, lon) = (-1.0 - f64::from(row) / 1200.0, 37.0 + f64::from(column) / 1200.0);
            let is_void = (600..620).contains(&row) && (600..620).contains(&column);
            let height = if is_void { -32_768 } else { plane_m(lat, lon).round() as i16 };
            file.write_all(&height.to_be_bytes()).unwrap();
        }
    }
    file.into_inner().unwrap().sync_all().unwrap();
    let scene =
        test_store.scene_with(&TestRaster::scattered(240, 240), |options| options.terrain = vec![path]);
    for (lat, lon) in [(-1.001, 37.002), (-1.25, 37.75), (-1.99, 37.1)] {
        let found = scene.terrain_altitude_m(place(lat, lon)).unwrap();
        assert!((found - plane_m(lat, lon)).abs() < 1.0, "{lat} {lon}: {found}");
    }
    assert_eq!(scene.terrain_altitude_m(place(-1.508, 37.508)), None, "a void");
    let report = scene.metadata().report.terrain.clone().unwrap();
    assert_eq!((report.void_samples, report.missing.count), (400, 0));
    // About two rows of the 1/240° pixels lie in the void of 1/60°.
    assert!(report.nearest.count <= 25, "{report:?}");
    // The lights start exactly at the terrain's north-west corner.
    assert_eq!(report.covered + report.nearest.count, scene.metadata().lit_pixels);
}

#[test]
fn a_picture_is_no_terrain() {
    let test_store = TestStore::new();
    let (light, picture) = (test_store.path("light.tif"), test_store.path("picture.tif"));
    TestRaster::scattered(40, 30).write_f32(&light);
    TestRaster::scattered(40, 30).write(&picture, |v| v as u8);
    let mut options = IngestOptions::new(light);
    options.terrain = vec![picture];
    assert!(test_store.refusal(&options).contains("8-bit"));
}
