//! Map tiles of numbers.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{STEP, TestRaster, TestStore, place};
use skyglow_physics::GeoPoint;
use skyglow_scene::{PixelValues, RasterTile, Scene, TileLayer};

/// Tile column and row of a place, with fractions.
fn mercator(at: GeoPoint, z: u8) -> (f64, f64) {
    let world = f64::from(1u32 << z);
    let y = 0.5 - at.latitude_rad().tan().asinh() / std::f64::consts::TAU;
    (world * (at.longitude_deg() / 360.0 + 0.5), world * y)
}

fn tile_at(scene: &Scene, layer: TileLayer, at: GeoPoint, z: u8) -> RasterTile {
    let (x, y) = mercator(at, z);
    scene.tile(layer, z, x as u32, y as u32, 256).unwrap()
}

/// The tile's value at a place, if it is data.
fn value_at(tile: &RasterTile, at: GeoPoint, z: u8) -> Option<f32> {
    let (x, y) = mercator(at, z);
    let index = (y.fract() * 256.0) as usize * 256 + (x.fract() * 256.0) as usize;
    tile.has_data[index].then_some(tile.values[index])
}

/// Zoomed in, a tile shows the raster's own pixels.
#[test]
fn zoomed_in_tiles_show_raster_pixels() {
    let test_store = TestStore::new();
    let mut raster = TestRaster::scattered(300, 300);
    raster.no_data = Some(-9.0);
    raster.values[150 * 300 + 150] = 33.0;
    raster.values[150 * 300 + 151] = -9.0;
    raster.values[150 * 300 + 152] = 0.0;
    let scene = test_store.scene(&raster);
    let at = |column: f64| place(-1.0 - 150.5 * STEP, 37.0 + (column + 0.5) * STEP);
    let z = 13;
    let value = |column| value_at(&tile_at(&scene, TileLayer::Radiance, at(column), z), at(column), z);
    assert_eq!((value(150.0), value(151.0), value(152.0)), (Some(33.0), None, Some(0.0)));
    let outside = tile_at(&scene, TileLayer::Radiance, place(10.0, 10.0), z);
    assert!(outside.has_data.iter().all(|d| !d) && outside.values.iter().all(|v| *v == 0.0));
}

/// Zoomed out, a single light stays visible and the mean is preserved.
#[test]
fn zooming_out_keeps_lone_lights_and_means() {
    let test_store = TestStore::new();
    let raster = TestRaster::new(512, 512, |c, r| if c % 64 == 20 && r % 64 == 30 { 64.0 } else { 0.0 });
    let scene = test_store.scene(&raster);
    for z in 5..9 {
        let tile = tile_at(&scene, TileLayer::Radiance, place(-2.0, 38.0), z);
        let shown: Vec<f32> =
            tile.values.iter().zip(&tile.has_data).filter(|(_, d)| **d).map(|(v, _)| *v).collect();
        let mean = shown.iter().map(|v| f64::from(*v)).sum::<f64>() / shown.len() as f64;
        // 64 nW on one pixel in 4096; blocks on the rim and the tile's cut make it uneven.
        let expected = 64.0 / 4096.0;
        assert!(mean > 0.5 * expected && mean < 2.0 * expected, "zoom {z}: {mean} {expected}");
    }
    let z = 8;
    for (c, r) in [(20.0, 30.0), (84.0, 94.0), (276.0, 222.0)] {
        let lamp = place(-1.0 - (r + 0.5) * STEP, 37.0 + (c + 0.5) * STEP);
        let shown = value_at(&tile_at(&scene, TileLayer::Radiance, lamp, z), lamp, z);
        assert!(shown.unwrap() > 0.0, "{c} {r}");
    }
}

/// Elevation tiles match the terrain at every zoom.
#[test]
fn elevation_tiles_match_the_terrain() {
    let test_store = TestStore::new();
    let path = test_store.path("terrain.tif");
    TestRaster::new(800, 800, |c, r| 500.0 + (c as f64) + 0.5 * (r as f64)).write_f32(&path);
    let scene =
        test_store.scene_with(&TestRaster::scattered(800, 800), |options| options.terrain = vec![path]);
    let at = place(-2.3, 38.7);
    let expected = 500.0 + 1.7 * 240.0 - 0.5 + 0.5 * (1.3 * 240.0 - 0.5);
    for z in 5..=14 {
        let tile = tile_at(&scene, TileLayer::Elevation, at, z);
        let value = value_at(&tile, at, z).unwrap();
        // A map pixel spans this many samples.
        let span = (40_000_000.0 / 256.0 / f64::from(1u32 << z) / 463.0).max(1.0);
        assert!((f64::from(value) - expected).abs() < 2.0 * span, "zoom {z}: {value} {expected}");
    }
    assert!(tile_at(&scene, TileLayer::Elevation, place(5.0, 5.0), 8).has_data.iter().all(|d| !d));
}

#[test]
fn tiles_that_do_not_exist_are_refused() {
    let test_store = TestStore::new();
    let scene = test_store.scene(&TestRaster::scattered(30, 30));
    for (z, x, y, size) in [(25, 0, 0, 256), (3, 8, 0, 256), (3, 0, 8, 256), (3, 0, 0, 0), (3, 0, 0, 4096)] {
        assert!(scene.tile(TileLayer::Radiance, z, x, y, size).is_err(), "{z} {x} {y} {size}");
    }
    assert_eq!(scene.tile(TileLayer::Radiance, 0, 0, 0, 64).unwrap().values.len(), 64 * 64);
}

/// Values of lit pixels are sampled as their radiances are.
#[test]
fn pixel_values_are_sampled_like_radiances() {
    let test_store = TestStore::new();
    let mut raster = TestRaster::scattered(400, 300);
    raster.no_data = Some(-9.0);
    raster.values[..400 * 40].fill(-9.0);
    let scene = test_store.scene(&raster);
    let lit = u32::try_from(scene.metadata().lit_pixels).unwrap();
    let numbers = PixelValues::new((0..lit).map(|number| (number, scene.lit_radiance_nw_cm2_sr(number))));
    let none = PixelValues::new(std::iter::empty());
    let middle = place(-1.6, 37.8);
    for z in [2, 6, 8, 9, 10, 11, 13] {
        let (x, y) = mercator(middle, z);
        let radiance = tile_at(&scene, TileLayer::Radiance, middle, z);
        let tile = scene.pixels_tile(&numbers, z, x as u32, y as u32, 256).unwrap();
        assert_eq!(tile.has_data, radiance.has_data);
        let largest = radiance.values.iter().copied().fold(0f32, f32::max);
        let apart = tile.values.iter().zip(&radiance.values).map(|(a, b)| (a - b).abs()).fold(0f32, f32::max);
        assert!(largest > 0.0 && apart <= 1e-6 * largest, "zoom {z}: {apart}");
        let dark = scene.pixels_tile(&none, z, x as u32, y as u32, 256).unwrap();
        assert!(dark.has_data == radiance.has_data && dark.values.iter().all(|value| *value == 0.0));
    }
    assert!(scene.pixels_tile(&numbers, 3, 8, 0, 256).is_err());
}
