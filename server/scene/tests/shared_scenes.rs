//! Scenes of a store that servers share, copied into the folders of two.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

#[path = "common/bucket.rs"]
mod bucket;
mod common;

use bucket::Bucket;
use common::{TestRaster, TestStore, place};
use skyglow_scene::{Scene, SceneError, SceneId, SceneStore, SharedScenes, SkylineTime};
use std::sync::{Arc, atomic::Ordering};

const SIZE: usize = 60;

/// A scene with every kind of file.
fn scene(store: &TestStore, factor: f64) -> Scene {
    TestRaster::new(SIZE, SIZE, |c, r| 300.0 + 40.0 * (c % 9) as f64 + r as f64)
        .write_f32(&store.path("terrain.tif"));
    let lights = TestRaster::scattered(SIZE, SIZE);
    let lit = TestRaster { values: lights.values.iter().map(|value| factor * value).collect(), ..lights };
    store.scene_with(&lit, |options| {
        options.terrain = vec![store.path("terrain.tif")];
        options.skylines = Some(SkylineTime::Ingest);
    })
}

fn refresh(shared: &SharedScenes, store: &SceneStore) -> Vec<SceneId> {
    let (changed, failed) = shared.refresh(store).unwrap();
    assert!(failed.is_empty(), "{failed:?}");
    changed
}

/// A scene that one puts is the other's, replaced and removed as well; scenes of its own stay, also of the same name.
#[test]
fn scenes_are_those_of_the_store() {
    let bucket = Arc::new(Bucket::default());
    let [a, b] = [(); 2].map(|()| (TestStore::new(), SharedScenes::new(bucket.clone())));
    let first = scene(&a.0, 1.0);
    let id = first.metadata().id.clone();
    assert!(refresh(&a.1, &a.0.store).is_empty() && refresh(&b.1, &b.0.store).is_empty());
    a.1.put(&a.0.store, &id).unwrap();
    assert_eq!(refresh(&b.1, &b.0.store), std::slice::from_ref(&id));
    let copied = b.0.store.open(&id).unwrap();
    assert_eq!(copied.metadata(), first.metadata());
    let here = place(-1.0, 37.0);
    assert_eq!(copied.polar_grid(here, true), first.polar_grid(here, true));
    // Nothing is done twice, nor where it is already.
    assert!(refresh(&b.1, &b.0.store).is_empty() && refresh(&a.1, &a.0.store).is_empty());
    // Another in its place: the files of the one before go.
    let second = scene(&a.0, 2.0);
    let objects = bucket.names().len();
    a.1.put(&a.0.store, &id).unwrap();
    assert_eq!(bucket.names().len(), objects);
    assert!(bucket.names().iter().any(|name| name.contains(&second.metadata().version)));
    assert!(!bucket.names().iter().any(|name| name.contains(&first.metadata().version)));
    // Times of files may be as coarse as the clock.
    std::thread::sleep(std::time::Duration::from_millis(10));
    assert_eq!(refresh(&b.1, &b.0.store), std::slice::from_ref(&id));
    assert_eq!(b.0.store.open(&id).unwrap().metadata().version, second.metadata().version);
    // What one puts and another removes at once is gone.
    let (c, of_c) = (TestStore::new(), SharedScenes::new(bucket.clone()));
    scene(&c, 4.0);
    of_c.put(&c.store, &id).unwrap();
    b.1.remove(&id).unwrap();
    assert_eq!(refresh(&of_c, &c.store), std::slice::from_ref(&id));
    assert!(!c.store.exists(&id));
    a.1.put(&a.0.store, &id).unwrap();
    // What is removed goes everywhere, but for what somebody put in its place.
    scene(&a.0, 3.0);
    b.1.remove(&id).unwrap();
    b.1.remove(&id).unwrap();
    assert!(bucket.names().is_empty(), "{:?}", bucket.names());
    assert_eq!(refresh(&b.1, &b.0.store), std::slice::from_ref(&id));
    assert!(!b.0.store.exists(&id));
    assert!(refresh(&a.1, &a.0.store).is_empty() && a.0.store.exists(&id));
}

/// A store that is away takes nothing from a server; a damaged scene there is said, and does not come.
#[test]
fn what_is_here_stays_when_the_store_is_away() {
    let bucket = Arc::new(Bucket::default());
    let (a, b) = (TestStore::new(), TestStore::new());
    let shared = SharedScenes::new(bucket.clone());
    let id = scene(&a, 1.0).metadata().id.clone();
    shared.put(&a.store, &id).unwrap();
    let of_b = SharedScenes::new(bucket.clone());
    refresh(&of_b, &b.store);
    bucket.is_away.store(true, Ordering::Relaxed);
    assert!(matches!(of_b.refresh(&b.store), Err(SceneError::StoreAway { .. })));
    assert!(matches!(of_b.remove(&id), Err(SceneError::StoreAway { .. })));
    b.store.open(&id).unwrap();
    bucket.is_away.store(false, Ordering::Relaxed);

    let name = bucket.names().into_iter().find(|name| name.ends_with("light.bin")).unwrap();
    *bucket.objects.lock().unwrap().get_mut(&name).unwrap().0.last_mut().unwrap() ^= 1;
    let c = TestStore::new();
    let of_c = SharedScenes::new(bucket.clone());
    for planted in ["altered", "missing"] {
        let (changed, failed) = of_c.refresh(&c.store).unwrap();
        assert!(changed.is_empty() && !c.store.exists(&id), "{planted}");
        let error = failed[0].to_string();
        assert!(matches!(failed[0], SceneError::Damaged { .. }) && error.contains("light.bin"), "{error}");
        bucket.objects.lock().unwrap().remove(&name);
    }
    let left = std::fs::read_dir(c.store.scenes_dir()).unwrap().count();
    assert_eq!(left, 0, "nothing half is left");
}
