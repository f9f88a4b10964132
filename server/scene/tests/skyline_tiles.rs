//! Skylines made by tile when they are needed: the same as those that were found at ingest.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{STEP, TestRaster, TestStore, place};
use skyglow_physics::GeoPoint;
use skyglow_physics::blocking::BLOCKING_COUNT;
use skyglow_scene::{
    Area, Change, ChangeStep, Edit, Observers, PatchStore, PlaceKernel, PlaceWindow, Prepared, RING_COUNT,
    Scene, SceneError, SkylineTime, SumWay, UniformAxis, ring_distance_m,
};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

const SIZE: usize = 420;

/// Scattered lights among ridges.
fn lights() -> TestRaster {
    TestRaster::scattered(SIZE, SIZE)
}

fn ridges() -> TestRaster {
    TestRaster::new(SIZE, SIZE, |c, r| {
        let wave = |at: usize, length: f64| (at as f64 * std::f64::consts::TAU / length).sin();
        // Level ground in the east, where lights have an open sky.
        if c > 300 {
            100.0
        } else {
            600.0 + 300.0 * wave(c, 37.0) * wave(r, 53.0) + 200.0 * wave(c + r, 11.0)
        }
    })
}

fn scene(store: &TestStore, when: SkylineTime) -> Scene {
    ridges().write_f32(&store.path("terrain.tif"));
    store.scene_with(&lights(), |options| {
        options.terrain = vec![store.path("terrain.tif")];
        options.skylines = Some(when);
    })
}

fn at(column: f64, row: f64) -> GeoPoint {
    place(-1.0 - STEP * row, 37.0 + STEP * column)
}

/// Places in the scene, at its edge, and off it.
fn places() -> Vec<GeoPoint> {
    let places =
        [(10.0, 10.0), (200.5, 180.2), (310.0, 77.7), (415.0, 400.0), (-200.0, 210.0), (210.0, 900.0)];
    places.map(|(column, row)| at(column, row)).to_vec()
}

fn tile_files(store: &TestStore, scene: &Scene) -> Vec<PathBuf> {
    let folder = store.store.scenes_dir().join(scene.metadata().id.as_str()).join("skylines");
    let files = std::fs::read_dir(folder).map(|found| found.flatten().map(|file| file.path()).collect());
    files.unwrap_or_default()
}

fn kernel() -> PlaceKernel {
    let axes =
        (UniformAxis::between(0.0, 4000.0, 500.0, 99), UniformAxis::between(-4000.0, 4000.0, 500.0, 99));
    let mut values = Vec::new();
    for _ in 0..axes.0.count {
        for ring in 0..RING_COUNT {
            for offset in 0..axes.1.count {
                let one = |blocking: usize| {
                    let near = 1e3 / ring_distance_m(ring) * (1.0 + 0.01 * offset as f64);
                    (near * (1.0 - 0.11 * blocking as f64)) as f32
                };
                values.extend((0..BLOCKING_COUNT).map(one));
            }
        }
    }
    PlaceKernel::new(axes.0, axes.1, BLOCKING_COUNT, values).unwrap()
}

/// Wants only places of the raster's north-western corner.
struct Corner;

impl PatchStore for Corner {
    fn load(&self, _: u64, _: usize) -> Option<Vec<f32>> {
        None
    }

    fn store(&self, _: u64, _: &[f32], _: f64) -> bool {
        true
    }

    fn wants(&self, window: &PlaceWindow) -> bool {
        window.columns.start < 8 && window.rows.start < 8
    }
}

/// Polar grids, shares of lights and changed scenes are the same bit for bit.
#[test]
fn tiles_hold_what_ingest_finds() {
    let (whole_store, store) = (TestStore::new(), TestStore::new());
    let (whole, tiled) = (scene(&whole_store, SkylineTime::Ingest), scene(&store, SkylineTime::Need));
    assert!(tiled.metadata().light_skylines && !tiled.metadata().lacks_light_skylines());
    assert!(tile_files(&store, &tiled).is_empty());
    for place in places() {
        for ratio in [0.0, 0.006, 0.1] {
            let (a, b) = (
                whole.polar_grid_with_ratio(place, true, ratio),
                tiled.polar_grid_with_ratio(place, true, ratio),
            );
            assert!(a.cells.iter().any(|cell| cell.blocking > 0));
            assert_eq!(a, b);
        }
        assert_eq!(whole.polar_grid(place, false), tiled.polar_grid(place, false));
        let alone = |scene: &Scene| {
            let shares = scene.light_shares(place, true).remove(0).1;
            (0..shares.len()).step_by(997).map(|position| shares.alone(position)).collect::<Vec<_>>()
        };
        assert_eq!(alone(&whole), alone(&tiled));
    }
    // Another lamp for some lights, and new ones.
    let rectangle = |[west, east]: [f64; 2], [north, south]: [f64; 2]| {
        let (a, b) = (at(west, north), at(east, south));
        let corner = |x: GeoPoint, y: GeoPoint| [x.longitude_deg(), y.latitude_deg()];
        Area::Polygons(vec![vec![vec![corner(a, a), corner(a, b), corner(b, b), corner(b, a), corner(a, a)]]])
    };
    let edits = vec![
        Edit {
            area: rectangle([100.0, 150.0], [100.0, 160.0]),
            change: Change::Alter { factor: 0.5, lamp: None, emission: None },
        },
        Edit {
            area: rectangle([40.0, 44.0], [40.0, 44.0]),
            change: Change::Add { radiance_nw_cm2_sr: 30.0, lamp: None, emission: None },
        },
    ];
    let changed = |scene: &Scene| scene.changed(&[ChangeStep::Painted(edits.clone())], "test").unwrap().0;
    let (a, b) = (changed(&whole), changed(&tiled));
    for place in places() {
        assert_eq!(a.polar_grids(place, true), b.polar_grids(place, true));
    }
}

/// Maps of all places and of a part are the same bit for bit.
#[test]
fn tiles_serve_sums_at_places() {
    let (whole_store, store) = (TestStore::new(), TestStore::new());
    let (whole, tiled) = (scene(&whole_store, SkylineTime::Ingest), scene(&store, SkylineTime::Need));
    let lattice = whole.place_lattice(20_000);
    let observers = Observers::everywhere(lattice, whole.ground_altitudes_m(lattice));
    let bits = |scene: &Scene, way: SumWay, store: &dyn PatchStore| -> Vec<u32> {
        let sums = scene.sum_at_places(&observers, &[kernel()], true, way, store).unwrap();
        sums.into_iter().map(f32::to_bits).collect()
    };
    for way in [SumWay::DualTree, SumWay::Convolution] {
        assert_eq!(bits(&whole, way, &Corner), bits(&tiled, way, &Corner));
        assert_eq!(bits(&whole, way, &|_: f64| true), bits(&tiled, way, &|_: f64| true));
    }
}

/// Tiles are stored, found again by the next process, and made anew where their file is damaged or of another scene.
#[test]
fn tiles_are_kept_beside_the_scene() {
    let store = TestStore::new();
    let first = scene(&store, SkylineTime::Need);
    let id = first.metadata().id.clone();
    first.prepare_skylines(None, &mut |_, _| {}).unwrap();
    let expected = first.polar_grid(places()[1], true);
    let files = tile_files(&store, &first);
    assert!(files.len() > 4, "{files:?}");
    let bytes: Vec<Vec<u8>> = files.iter().map(|file| std::fs::read(file).unwrap()).collect();
    // As they are; one altered, one cut, one of another place, one of none.
    let mut altered = bytes[0].clone();
    *altered.last_mut().unwrap() ^= 1;
    std::fs::write(&files[0], altered).unwrap();
    std::fs::write(&files[1], &bytes[1][..20]).unwrap();
    std::fs::write(&files[2], &bytes[3]).unwrap();
    std::fs::remove_file(&files[3]).unwrap();
    let second = store.store.open(&id).unwrap();
    assert_eq!(second.polar_grid(places()[1], true), expected);
    second.prepare_skylines(None, &mut |_, _| {}).unwrap();
    let again: Vec<Vec<u8>> = files.iter().map(|file| std::fs::read(file).unwrap()).collect();
    assert_eq!(again, bytes);
    // Nothing is left to make, and the scene is sound.
    let prepared = second.prepare_skylines(None, &mut |_, _| {}).unwrap();
    assert_eq!((prepared.tiles, prepared.made), (files.len() as u64, 0));
    assert_eq!(prepared.lights, second.metadata().lit_pixels);
    store.store.verify(&id).unwrap();
    // Those of a scene before are not those of the next.
    let folder = files[0].parent().unwrap().to_owned();
    let lit = TestRaster { values: lights().values.iter().map(|value| 2.0 * value).collect(), ..lights() };
    ridges().write_f32(&store.path("terrain.tif"));
    let next = store.scene_with(&lit, |options| {
        options.terrain = vec![store.path("terrain.tif")];
        options.skylines = Some(SkylineTime::Need);
    });
    assert!(!folder.exists());
    std::fs::create_dir(&folder).unwrap();
    files.iter().zip(&bytes).for_each(|(file, bytes)| std::fs::write(file, bytes).unwrap());
    let prepared = next.prepare_skylines(None, &mut |_, _| {}).unwrap();
    assert_eq!(prepared.made, prepared.tiles);
}

/// One place needs a part of the skylines, which is not stored; where many places did, all of them are found and stored.
#[test]
fn many_places_need_the_whole() {
    let store = TestStore::new();
    let (whole, tiled) = (scene(&TestStore::new(), SkylineTime::Ingest), scene(&store, SkylineTime::Need));
    let mut stored = Vec::new();
    for number in 0..14 {
        let place = at(150.3 + 2.0 * f64::from(number), 120.6);
        assert_eq!(whole.polar_grid(place, true), tiled.polar_grid(place, true), "{number}");
        // Asked again, it takes what it has.
        assert_eq!(whole.light_shares(place, true).len(), tiled.light_shares(place, true).len());
        stored.push(tile_files(&store, &tiled).len());
    }
    assert!(stored[..12].iter().all(|count| *count == 0) && stored[12] > 4, "{stored:?}");
    let prepared = tiled.prepare_skylines(None, &mut |_, _| {}).unwrap();
    assert_eq!(prepared.tiles - prepared.made, stored[13] as u64);
}

/// Bounds limit what is prepared to what reaches them; a scene that has all has nothing to prepare.
#[test]
fn what_is_prepared_is_what_reaches() {
    let store = TestStore::new();
    let tiled = scene(&store, SkylineTime::Need);
    let prepare = |bounds: [f64; 4]| tiled.prepare_skylines(Some(bounds), &mut |_, _| {}).unwrap();
    // 33° is more than 300 km west of all lights.
    assert_eq!(prepare([32.0, -2.0, 33.0, -1.0]), Prepared::default());
    let some = prepare([33.5, -2.0, 34.5, -1.5]);
    assert!(some.tiles > 0 && some.tiles == some.made, "{some:?}");
    let near = prepare([33.9, -2.0, 35.2, -1.5]);
    assert!(near.tiles > some.tiles && near.made == near.tiles - some.tiles, "{near:?} {some:?}");
    let whole = scene(&TestStore::new(), SkylineTime::Ingest);
    assert_eq!(whole.prepare_skylines(None, &mut |_, _| {}).unwrap(), Prepared::default());
}

/// Who does not wait is told how far it is, and in the end finds what who waits finds. Where nothing can be stored everybody waits.
#[test]
fn skylines_are_found_while_nobody_waits() {
    let store = TestStore::new();
    let tiled = Arc::new(scene(&store, SkylineTime::Need));
    let here = places()[1];
    let beginning = Instant::now();
    let mut last = 0.0;
    while let Err(error) = tiled.find_skylines_around(here, 100) {
        let SceneError::SkylinesBeingFound { progress, left_s } = error else { panic!("{error}") };
        assert!((last..1.0).contains(&progress) && left_s > 0.0, "{last} {progress} {left_s}");
        last = progress;
        assert!(beginning.elapsed() < Duration::from_secs(60), "{progress}");
        std::thread::sleep(Duration::from_millis(1));
    }
    let whole = scene(&TestStore::new(), SkylineTime::Ingest);
    assert_eq!(tiled.polar_grid(here, true), whole.polar_grid(here, true));
    // What has all at ingest has nothing to find, and so has what is far from all lights.
    Arc::new(whole).find_skylines_around(here, 0).unwrap();
    tiled.find_skylines_around(place(50.0, 0.0), 0).unwrap();

    let store = TestStore::new();
    let tiled = Arc::new(scene(&store, SkylineTime::Need));
    // A file where the folder would be.
    let folder = store.store.scenes_dir().join(tiled.metadata().id.as_str()).join("skylines");
    std::fs::write(folder, "").unwrap();
    let beginning = Instant::now();
    while tiled.find_skylines_around(here, 100).is_err() {
        assert!(beginning.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(
        tiled.polar_grid(here, true),
        scene(&TestStore::new(), SkylineTime::Ingest).polar_grid(here, true)
    );
}
