//! Lights of large scenes that stay in a file: the same as those in memory.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{STEP, TestRaster, TestStore, place};
use skyglow_physics::GeoPoint;
use skyglow_scene::{Area, Change, ChangeStep, Edit, Scene, SceneStore, SkylineTime};
use std::path::PathBuf;

const SIZE: usize = 200;

fn scene(store: &TestStore, value: impl Fn(f64) -> f64, has_terrain: bool) -> Scene {
    let lights = TestRaster::scattered(SIZE, SIZE);
    let values = lights.values.iter().map(|light| value(*light)).collect();
    let hill = |c: usize, r: usize| 50.0 + 400.0 * f64::from(u8::from((c / 9 + r / 7).is_multiple_of(3)));
    TestRaster::new(SIZE, SIZE, hill).write_f32(&store.path("terrain.tif"));
    store.scene_with(&TestRaster { values, ..lights }, |options| {
        options.terrain = if has_terrain { vec![store.path("terrain.tif")] } else { Vec::new() };
        options.skylines = Some(SkylineTime::Need);
    })
}

/// The same scenes, whose lights stay in a file however few they are.
fn in_file(store: &TestStore) -> SceneStore {
    SceneStore::new(store.store.scenes_dir().parent().unwrap()).with_lights_in_file(1)
}

fn file(store: &TestStore, scene: &Scene) -> PathBuf {
    store.store.scenes_dir().join(scene.metadata().id.as_str()).join("pyramid.bin")
}

fn at(column: f64, row: f64) -> GeoPoint {
    place(-1.0 - STEP * row, 37.0 + STEP * column)
}

fn places() -> [GeoPoint; 4] {
    [(10.0, 10.0), (100.5, 90.2), (195.0, 30.7), (-200.0, 210.0)].map(|(column, row)| at(column, row))
}

/// That a scene answers as another does, bit for bit.
fn assert_same(a: &Scene, b: &Scene) {
    for place in places() {
        for ratio in [0.0, 0.006, 0.1] {
            let of = |scene: &Scene| scene.polar_grid_with_ratio(place, true, ratio);
            assert!(!of(a).cells.is_empty());
            assert_eq!(of(a), of(b));
        }
        let alone = |scene: &Scene| {
            let shares = scene.light_shares(place, true).remove(0).1;
            (0..shares.len()).step_by(97).map(|position| shares.alone(position)).collect::<Vec<_>>()
        };
        assert_eq!(alone(a), alone(b));
        assert_eq!(a.radiance_nw_cm2_sr(place), b.radiance_nw_cm2_sr(place));
        assert_eq!(a.coverage(place), b.coverage(place));
    }
    assert_eq!(a.light_altitude_range_m(), b.light_altitude_range_m());
}

#[test]
fn lights_in_a_file_are_those_in_memory() {
    for has_terrain in [false, true] {
        let store = TestStore::new();
        let ingested = scene(&store, |light| light, has_terrain);
        let (id, path) = (ingested.metadata().id.clone(), file(&store, &ingested));
        let in_memory = store.store.open(&id).unwrap();
        store.store.store_lights(&id).unwrap();
        assert!(!path.exists(), "few lights stay in memory");
        let kept = in_file(&store);
        kept.store_lights(&id).unwrap();
        let made = path.metadata().unwrap().modified().unwrap();
        kept.store_lights(&id).unwrap();
        assert_eq!(path.metadata().unwrap().modified().unwrap(), made, "what is there is not made again");
        let first = kept.open(&id).unwrap();
        let written = std::fs::metadata(&path).unwrap().modified().unwrap();
        let second = kept.open(&id).unwrap();
        assert_eq!(std::fs::metadata(&path).unwrap().modified().unwrap(), written, "it is made once");
        for scene in [&ingested, &first, &second] {
            assert_same(&in_memory, scene);
        }
        // They are the system's to have back.
        assert!(second.byte_count() < in_memory.byte_count(), "{has_terrain}");
        assert!(kept.verify_lights(&id));
    }
}

/// A scenario of a scene in a file is that of one in memory; the file is not changed.
#[test]
fn scenarios_change_lights_in_a_file() {
    let store = TestStore::new();
    let ingested = scene(&store, |light| light, true);
    let (id, path) = (ingested.metadata().id.clone(), file(&store, &ingested));
    let opened = in_file(&store).open(&id).unwrap();
    let before = std::fs::read(&path).unwrap();
    let corner = |column: f64, row: f64| {
        let corner = at(column, row);
        [corner.longitude_deg(), corner.latitude_deg()]
    };
    let ring = [(20.0, 20.0), (120.0, 20.0), (120.0, 120.0), (20.0, 120.0), (20.0, 20.0)];
    let area = Area::Polygons(vec![vec![ring.map(|(column, row)| corner(column, row)).to_vec()]]);
    let edit = Edit { area, change: Change::Alter { factor: 0.25, lamp: None, emission: None } };
    let steps = [ChangeStep::Painted(vec![edit])];
    let of = |scene: &Scene| scene.changed(&steps, "mark").unwrap();
    let ((a, summary), (b, same)) = (of(&store.store.open(&id).unwrap()), of(&opened));
    assert!(summary.changed_pixels > 100 && summary == same);
    assert_same(&a, &b);
    assert!(std::fs::read(&path).unwrap() == before);
}

/// A file of another version, a shortened one and one that cannot be written are done without.
#[test]
fn a_file_that_does_not_fit_is_made_again() {
    let store = TestStore::new();
    let first = scene(&store, |light| light, true);
    let (id, path) = (first.metadata().id.clone(), file(&store, &first));
    let kept = in_file(&store);
    kept.open(&id).unwrap();
    let of_first = std::fs::read(&path).unwrap();
    let second = scene(&store, |light| 2.0 * light, true);
    assert!(!path.exists(), "a new scene begins without");
    std::fs::write(&path, &of_first).unwrap();
    assert_same(&second, &kept.open(&id).unwrap());
    let of_second = std::fs::read(&path).unwrap();
    assert!(of_second != of_first);
    std::fs::write(&path, &of_second[..of_second.len() - 1]).unwrap();
    assert_same(&second, &kept.open(&id).unwrap());
    assert!(std::fs::read(&path).unwrap() == of_second);
    // A folder in its place: lights stay in memory.
    std::fs::remove_file(&path).unwrap();
    std::fs::create_dir(&path).unwrap();
    assert_same(&second, &kept.open(&id).unwrap());
}

/// Whoever opens a damaged file makes it again, and so does a server when it has read it through.
#[test]
fn damage_to_the_file_is_found() {
    let store = TestStore::new();
    let ingested = scene(&store, |light| light, true);
    let (id, path) = (ingested.metadata().id.clone(), file(&store, &ingested));
    let kept = in_file(&store);
    kept.open(&id).unwrap();
    let whole = std::fs::read(&path).unwrap();
    // From the header to the end. Padding between arrays, less than 64 bytes of each, is nobody's.
    let mut found = 0;
    let places = (0..whole.len()).step_by(whole.len() / 40);
    for at in places.clone() {
        let mut bytes = whole.clone();
        bytes[at] ^= 1;
        std::fs::write(&path, &bytes).unwrap();
        assert_same(&ingested, &kept.open(&id).unwrap());
        found += usize::from(std::fs::read(&path).unwrap() == whole);
    }
    assert!(found + 2 >= places.count(), "{found}");
    let mut bytes = whole.clone();
    bytes[whole.len() - 9] ^= 1;
    std::fs::write(&path, bytes).unwrap();
    kept.open_unchecked(&id, u64::MAX).unwrap();
    assert!(std::fs::read(&path).unwrap() != whole, "it is not read");
    kept.verify(&id).unwrap();
    assert!(!kept.verify_lights(&id));
    assert!(kept.verify_lights(&id), "it is gone");
    assert_same(&ingested, &kept.open_unchecked(&id, u64::MAX).unwrap());
    assert!(std::fs::read(&path).unwrap() == whole);
    // The scene's own file is there all the same.
    let light = path.with_file_name("light.bin");
    std::fs::write(&light, [0]).unwrap();
    assert!(kept.open(&id).unwrap_err().to_string().contains("light.bin"));
    std::fs::remove_file(&light).unwrap();
    assert!(kept.open(&id).unwrap_err().to_string().contains("is missing"));
}
