//! Lights behind ridges: from rasters to the blocking angles of the polar grid.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{STEP, TestRaster, TestStore, place};
use proptest::prelude::*;
use skyglow_physics::blocking::{BLOCKING_ANGLES_DEG, blocking_position};
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::source_pixel::{MAX_SOURCE_DISTANCE_M, SPLIT_WITHIN_M, point_sources};
use skyglow_physics::{BlockedSource, EARTH_RADIUS_M, GeoPoint, PointSource};
use skyglow_scene::{PolarGrid, Scene, SceneMetadata};
use std::sync::OnceLock;

/// Column of a ridge along a meridian, and its height over the ground, metres.
const RIDGE_COLUMN: usize = 300;
const GROUND_M: f64 = 400.0;

/// A town of a few pixels west of a ridge of some height, over terrain on the light's own grid.
fn town_west_of_a_ridge(test_store: &TestStore, height_m: f64) -> Scene {
    let is_town = |c: usize, r: usize| (278..282).contains(&c) && (198..202).contains(&r);
    let light = TestRaster::new(600, 400, |c, r| if is_town(c, r) { 20.0 } else { 0.0 });
    let ground = TestRaster::new(600, 400, |c, _| GROUND_M + if c == RIDGE_COLUMN { height_m } else { 0.0 });
    ground.write_f32(&test_store.path("terrain.tif"));
    test_store.scene_with(&light, |options| options.terrain = vec![test_store.path("terrain.tif")])
}

fn town() -> GeoPoint {
    place(-1.0 - 200.0 * STEP, 37.0 + 280.0 * STEP)
}

/// Flux-weighted mean place on the axis of blocking angles.
fn mean_place(grid: &PolarGrid) -> f64 {
    let flux: f64 = grid.cells.iter().map(|cell| f64::from(cell.flux_dnb_w)).sum();
    grid.cells.iter().map(|cell| f64::from(cell.flux_dnb_w) * f64::from(cell.blocking)).sum::<f64>() / flux
}

fn place_of(degrees: f64) -> f64 {
    let (node, weight) = blocking_position(degrees);
    node as f64 + weight
}

/// Light behind a ridge is at the ridge's blocking angle, light in front of it at none.
#[test]
fn a_ridge_blocks_the_light_behind_it() {
    let test_store = TestStore::new();
    let scene = town_west_of_a_ridge(&test_store, 300.0);
    // The ridge is 20.5 columns of 463 m east of the town.
    let expected_deg = (300.0 / (20.5 * STEP.to_radians() * EARTH_RADIUS_M)).atan().to_degrees();
    let east = town().destination(std::f64::consts::FRAC_PI_2, 64_000.0);
    let behind = mean_place(&scene.polar_grid(east, true));
    assert!((behind - place_of(expected_deg)).abs() < 0.15, "{behind} {expected_deg}");
    let exact = scene.blocking_angle_rad(town(), GROUND_M, 463.0, east).to_degrees();
    assert!((exact / expected_deg - 1.0).abs() < 0.05, "{exact} {expected_deg}");
    // West of the town, and east of it before the ridge, nothing is hidden.
    for (azimuth_deg, distance_m) in
        [(270.0f64, 20_000.0), (270.0, 120_000.0), (90.0, 3_000.0), (90.0, 4_000.0)]
    {
        let observer = town().destination(azimuth_deg.to_radians(), distance_m);
        assert!(mean_place(&scene.polar_grid(observer, true)) < 1e-3, "{azimuth_deg} {distance_m}");
        assert_eq!(scene.blocking_angle_rad(town(), GROUND_M, 463.0, observer), 0.0);
    }
    // The control: without being asked, terrain hides nothing.
    assert!(scene.polar_grid(east, false).cells.iter().all(|cell| cell.blocking == 0));
}

/// The edge of the terrain does not block lights beyond it.
#[test]
fn the_terrain_edge_blocks_no_light_beyond_it() {
    // A plateau at 1 500 m that begins 1 or 17 km east of the town; nothing is known of the ground before it.
    let scene_with_plateau_from = |first_column: usize| {
        let test_store = TestStore::new();
        let is_town = |c: usize, r: usize| (278..282).contains(&c) && (198..202).contains(&r);
        let light = TestRaster::new(600, 400, |c, r| if is_town(c, r) { 20.0 } else { 0.0 });
        let ground = TestRaster::new(600, 400, |c, _| if c < first_column { f64::NAN } else { 1_500.0 });
        ground.write_f32(&test_store.path("terrain.tif"));
        test_store.scene_with(&light, |options| options.terrain = vec![test_store.path("terrain.tif")])
    };
    let east = town().destination(std::f64::consts::FRAC_PI_2, 64_000.0);
    let unknown = scene_with_plateau_from(320);
    assert_eq!(unknown.metadata().report.terrain.as_ref().unwrap().missing.count, 16);
    assert!(
        unknown.polar_grid(east, true).cells.iter().all(|cell| cell.blocking == 0 && cell.altitude_m == 0.0)
    );
    let is_open = |scene: &Scene| scene.blocked_sources(east).iter().all(|light| light.blocking_rad == 0.0);
    assert!(is_open(&unknown));
    // Near the plateau the ground counts as the plateau's, and that is level: no wall either.
    let near = scene_with_plateau_from(284);
    assert!(
        near.polar_grid(east, true).cells.iter().all(|cell| cell.blocking == 0 && cell.altitude_m > 1_400.0)
    );
    assert!(is_open(&near));
}

/// A segment below a ridge is blocked, one above it is free.
#[test]
fn a_ridge_blocks_segments_below_it() {
    let test_store = TestStore::new();
    let scene = town_west_of_a_ridge(&test_store, 300.0);
    let light_m = town().unit_vector() * (EARTH_RADIUS_M + GROUND_M);
    let ridge_m = 20.0 * STEP.to_radians() * EARTH_RADIUS_M;
    for distance_m in [15_000.0f64, 40_000.0, 90_000.0] {
        let over_m = |factor: f64| {
            let drop_m = distance_m * (distance_m - ridge_m) / (2.0 * EARTH_RADIUS_M);
            let altitude_m = GROUND_M + factor * 300.0 * distance_m / ridge_m + drop_m;
            town().destination(std::f64::consts::FRAC_PI_2, distance_m).unit_vector()
                * (EARTH_RADIUS_M + altitude_m)
        };
        assert!(scene.blocks(light_m, over_m(0.95), 463.0), "{distance_m}");
        assert!(!scene.blocks(light_m, over_m(1.05), 463.0), "{distance_m}");
    }
    // Before the ridge, and straight up.
    let near = town().destination(std::f64::consts::FRAC_PI_2, 5_000.0);
    assert!(!scene.blocks(light_m, near.unit_vector() * (EARTH_RADIUS_M + GROUND_M + 10.0), 463.0));
    assert!(!scene.blocks(light_m, 1.001 * light_m, 463.0));
}

#[test]
fn flat_terrain_and_no_terrain_change_no_bit() {
    let test_store = TestStore::new();
    let light = TestRaster::scattered(300, 200);
    let bare = test_store.scene(&light);
    TestRaster::new(300, 200, |_, _| 0.0).write_f32(&test_store.path("terrain.tif"));
    let flat =
        test_store.scene_with(&light, |options| options.terrain = vec![test_store.path("terrain.tif")]);
    for (latitude, longitude) in [(-1.3, 37.5), (-2.0, 36.0), (-1.5, 39.0)] {
        let observer = place(latitude, longitude);
        let expected = bare.polar_grid(observer, false);
        for grid in [
            bare.polar_grid(observer, true),
            flat.polar_grid(observer, true),
            flat.polar_grid(observer, false),
        ] {
            assert_eq!(grid, expected);
        }
        assert!(expected.cells.iter().all(|cell| cell.blocking == 0));
    }
}

/// Hills over scattered lights.
fn hills() -> &'static Scene {
    static HILLS: OnceLock<Scene> = OnceLock::new();
    HILLS.get_or_init(|| {
        let test_store = TestStore::new();
        let height_m = |c: usize, r: usize| {
            let (x, y) = (c as f64 / 17.0, r as f64 / 11.0);
            900.0 + 700.0 * x.sin() * y.cos() + 150.0 * (3.1 * x + y).sin()
        };
        TestRaster::new(500, 400, height_m).write_f32(&test_store.path("terrain.tif"));
        test_store.scene_with(&TestRaster::scattered(500, 400), |options| {
            options.terrain = vec![test_store.path("terrain.tif")];
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

    /// Blocking moves light between blocking angles and loses none.
    #[test]
    fn blocking_conserves_flux(
        latitude in -3.5f64..0.0, longitude in 36.5f64..39.5,
    ) {
        let observer = place(latitude, longitude);
        let (open, hidden) = (hills().polar_grid(observer, false), hills().polar_grid(observer, true));
        let cells_w = |grid: &PolarGrid| grid.cells.iter().map(|cell| f64::from(cell.flux_dnb_w)).sum::<f64>();
        prop_assert_eq!(hidden.flux_dnb_w, open.flux_dnb_w);
        prop_assert!((cells_w(&hidden) / open.flux_dnb_w - 1.0).abs() < 1e-5);
        prop_assert!(hidden.cells.iter().all(|cell| (cell.blocking as usize) < BLOCKING_ANGLES_DEG.len()));
        // By column and ring it is the same light, at the same mean altitude.
        for column in 0..256 {
            let by_ring = |grid: &PolarGrid| {
                let mut rings = vec![(0.0f64, 0.0f64); 192];
                let range = grid.azimuth_start[column] as usize..grid.azimuth_start[column + 1] as usize;
                let cells = &grid.cells[range];
                for cell in cells {
                    rings[cell.ring as usize].0 += f64::from(cell.flux_dnb_w);
                    rings[cell.ring as usize].1 += f64::from(cell.flux_dnb_w) * f64::from(cell.altitude_m);
                }
                let key = |cell: &skyglow_scene::PolarCell| (cell.ring, cell.blocking);
                assert!(cells.windows(2).all(|pair| key(&pair[0]) < key(&pair[1])), "sorted");
                rings
            };
            for (open, hidden) in by_ring(&open).into_iter().zip(by_ring(&hidden)) {
                prop_assert!((open.0 - hidden.0).abs() <= 1e-4 * open.0 && (open.1 - hidden.1).abs() <= 1e-4 * open.1);
            }
        }
    }
}

/// Blocking angles of the polar grid match those of exact lines of sight.
#[test]
fn grid_angles_match_exact_lines_of_sight() {
    let scene = hills();
    for (latitude, longitude) in [(-1.5, 37.9), (-2.4, 38.6), (0.5, 38.0)] {
        let observer = place(latitude, longitude);
        let (mut exact, mut flux) = (0.0, 0.0);
        for pixel in scene.source_pixels_within(observer, 300_000.0).iter().step_by(7) {
            let light = GeoPoint::from_vector(pixel.center());
            let angle_rad =
                scene.blocking_angle_rad(light, pixel.altitude_m, scene.metadata().pixel_size_m, observer);
            exact += pixel.flux_dnb_w * place_of(angle_rad.to_degrees());
            flux += pixel.flux_dnb_w;
        }
        let found = mean_place(&scene.polar_grid(observer, true));
        println!("{latitude} {longitude}: mean place {found:.3}, exact {:.3}", exact / flux);
        assert!((found - exact / flux).abs() < 0.15, "{found} {}", exact / flux);
        assert!(found > 0.5, "there are hills");
        // Blocks stand for their pixels.
        let by_pixels = mean_place(&scene.polar_grid_with_ratio(observer, true, 0.0));
        assert!((found - by_pixels).abs() < 0.05, "{found} {by_pixels}");
        assert!(LocalFrame::at(observer).up.is_normalized());
    }
}

/// The sources of the reference solution are the raster's own, each at its exact blocking angle.
#[test]
fn blocked_sources_have_exact_angles() {
    let scene = hills();
    let observer = place(-1.5, 37.9);
    let lights = scene.blocked_sources(observer);
    let alone: Vec<PointSource> = lights.iter().map(|light| light.source).collect();
    let pixels = scene.source_pixels_within(observer, MAX_SOURCE_DISTANCE_M);
    assert_eq!(alone, point_sources(observer, &pixels));
    // Far lights are their pixels, in the same order.
    let angles = |lights: &[BlockedSource]| -> Vec<f64> {
        let far = lights.iter().filter(|light| light.source.distance_m >= SPLIT_WITHIN_M);
        far.map(|light| light.blocking_rad).collect()
    };
    let frame = LocalFrame::at(observer);
    let exact: Vec<f64> = pixels
        .iter()
        .filter(|pixel| frame.bearing_to(pixel.center()).distance_m >= SPLIT_WITHIN_M)
        .map(|pixel| {
            let light = GeoPoint::from_vector(pixel.center());
            let size_m = scene.metadata().pixel_size_m;
            scene.blocking_angle_rad(light, pixel.altitude_m, size_m, observer)
        })
        .collect();
    let differences = |angles: &[f64]| -> f64 {
        assert_eq!(angles.len(), exact.len());
        angles.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(differences(&angles(&lights)) < 1e-3, "{}", differences(&angles(&lights)));
    // Pieces of near pixels see what is seen from the middle of their pixel: a slope of these hills.
    let near: Vec<&BlockedSource> =
        lights.iter().filter(|light| light.source.distance_m < SPLIT_WITHIN_M).collect();
    let steepest = near.iter().map(|light| light.blocking_rad).fold(0.0, f64::max);
    println!("{} pieces, steepest {steepest}", near.len());
    assert!(near.len() > 50 && (0.01..0.35).contains(&steepest), "{} {steepest}", near.len());
    // The control: under an open sky they would be others.
    assert!(differences(&vec![0.0; exact.len()]) > 0.05);
}

/// A scene of format 1 opens and says that it lacks the skylines of its lights.
#[test]
fn format_1_scenes_lack_light_skylines() {
    let test_store = TestStore::new();
    let scene = town_west_of_a_ridge(&test_store, 300.0);
    let east = town().destination(std::f64::consts::FRAC_PI_2, 64_000.0);
    assert!(scene.metadata().light_skylines && !scene.metadata().lacks_light_skylines());
    let without_terrain = TestStore::new().scene(&TestRaster::scattered(30, 30));
    assert!(!without_terrain.metadata().light_skylines && !without_terrain.metadata().lacks_light_skylines());
    // The same scene as it was stored in form 1: no skylines, not among the files and not in the metadata.
    let id = scene.metadata().id.clone();
    let dir = test_store.store.scenes_dir().join(id.as_str());
    let text = std::fs::read_to_string(dir.join("metadata.json")).unwrap();
    let mut document: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["format"], 2);
    document["format"] = 1.into();
    document["metadata"].as_object_mut().unwrap().remove("light_skylines");
    document["files"].as_array_mut().unwrap().retain(|file| file["name"] != "skylines.bin");
    let mut older = StoredForTest::from(document);
    std::fs::remove_file(dir.join("skylines.bin")).unwrap();
    std::fs::write(dir.join("metadata.json"), older.with_version()).unwrap();
    let opened = test_store.store.open(&id).unwrap();
    assert!(opened.metadata().terrain && opened.metadata().lacks_light_skylines());
    assert_eq!(opened.polar_grid(east, true), opened.polar_grid(east, false));
    assert_ne!(scene.polar_grid(east, true), opened.polar_grid(east, true));
    // Who walks the terrain needs no stored skylines.
    assert_eq!(opened.blocked_sources(east), scene.blocked_sources(east));
    assert!(opened.blocked_sources(east).iter().all(|light| light.blocking_rad > 0.02));
}

/// A stored description whose version is made anew, in the order of fields that the program writes.
struct StoredForTest {
    format: u64,
    metadata: SceneMetadata,
    files: serde_json::Value,
}

impl From<serde_json::Value> for StoredForTest {
    fn from(document: serde_json::Value) -> Self {
        Self {
            format: document["format"].as_u64().unwrap(),
            metadata: serde_json::from_value(document["metadata"].clone()).unwrap(),
            files: document["files"].clone(),
        }
    }
}

impl StoredForTest {
    fn json(&self) -> String {
        let files: Vec<String> = self
            .files
            .as_array()
            .unwrap()
            .iter()
            .map(|file| {
                format!(
                    "{{\"name\":{},\"bytes\":{},\"blake3\":{}}}",
                    file["name"], file["bytes"], file["blake3"]
                )
            })
            .collect();
        let metadata = serde_json::to_string(&self.metadata).unwrap();
        format!("{{\"format\":{},\"metadata\":{metadata},\"files\":[{}]}}", self.format, files.join(","))
    }

    fn with_version(&mut self) -> String {
        self.metadata.version = String::new();
        // Such a scene has no time at which it was ingested.
        self.metadata.ingested_unix_s = None;
        self.metadata.version = blake3::hash(self.json().as_bytes()).to_hex()[..32].to_owned();
        self.json()
    }
}
