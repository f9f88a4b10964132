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

/// A scene that one puts is the other's, replaced and removed as well.
#[test]
fn scenes_are_those_of_the_store() {
    let bucket = Arc::new(Bucket::default());
    let [a, b] = [(); 2].map(|()| (TestStore::new(), SharedScenes::new(bucket.clone())));
    let first = scene(&a.0, 1.0);
    let id = first.metadata().id.clone();
    let ids = std::slice::from_ref(&id);
    assert!(refresh(&a.1, &a.0.store).is_empty() && refresh(&b.1, &b.0.store).is_empty());
    a.1.put(&a.0.store, &id, true).unwrap();
    assert_eq!(refresh(&b.1, &b.0.store), ids);
    let copied = b.0.store.open(&id).unwrap();
    assert_eq!(copied.metadata(), first.metadata());
    let here = place(-1.0, 37.0);
    assert_eq!(copied.polar_grid(here, true), first.polar_grid(here, true));
    // Nothing is done twice, nor where it is already.
    assert!(refresh(&b.1, &b.0.store).is_empty() && refresh(&a.1, &a.0.store).is_empty());
    // Another in its place: the files of the one before go.
    let second = scene(&a.0, 2.0);
    let objects = bucket.names().len();
    a.1.put(&a.0.store, &id, true).unwrap();
    assert_eq!(bucket.names().len(), objects);
    assert!(bucket.names().iter().any(|name| name.contains(&second.metadata().version)));
    assert!(!bucket.names().iter().any(|name| name.contains(&first.metadata().version)));
    assert_eq!(refresh(&b.1, &b.0.store), ids);
    assert_eq!(b.0.store.open(&id).unwrap().metadata().version, second.metadata().version);
    // What is removed goes everywhere, and may come again.
    b.1.remove(&b.0.store, &id).unwrap();
    b.1.remove(&b.0.store, &id).unwrap();
    assert_eq!(bucket.names(), [format!("scenes/{id}.gone")]);
    for server in [&a, &b] {
        assert_eq!(refresh(&server.1, &server.0.store), ids);
        assert!(!server.0.store.exists(&id) && refresh(&server.1, &server.0.store).is_empty());
    }
    scene(&a.0, 1.0);
    a.1.put(&a.0.store, &id, true).unwrap();
    assert!(refresh(&a.1, &a.0.store).is_empty() && a.0.store.exists(&id));
    assert_eq!(refresh(&b.1, &b.0.store), ids);
}

/// A server's own scene is neither overwritten nor removed, nor a copy whose store is empty or another.
#[test]
fn own_scenes_stay() {
    let bucket = Arc::new(Bucket::default());
    let [a, b, c] = [(); 3].map(|()| (TestStore::new(), SharedScenes::new(bucket.clone())));
    let [of_a, of_b] = [(&a, 1.0), (&b, 2.0)].map(|(server, factor)| scene(&server.0, factor));
    let id = of_a.metadata().id.clone();
    a.1.put(&a.0.store, &id, false).unwrap();
    let (changed, failed) = b.1.refresh(&b.0.store).unwrap();
    assert!(changed.is_empty() && matches!(failed[..], [SceneError::OwnScene { .. }]), "{failed:?}");
    let version = |store: &TestStore| store.store.open(&id).unwrap().metadata().version.clone();
    assert_eq!(version(&b.0), of_b.metadata().version);
    // It is not tried again at once.
    assert!(refresh(&b.1, &b.0.store).is_empty());
    // Who put it without following it keeps it, and so does who has one of that name that is no copy.
    refresh(&c.1, &c.0.store);
    b.1.remove(&b.0.store, &id).unwrap();
    assert!(bucket.names().len() > 1, "another of that name was removed here");
    c.1.remove(&c.0.store, &id).unwrap();
    for server in [&a, &b] {
        assert!(refresh(&server.1, &server.0.store).is_empty() && server.0.store.exists(&id));
    }
    assert_eq!(refresh(&c.1, &c.0.store), std::slice::from_ref(&id));
    // Another store, or one that lost all, removes nothing.
    a.1.put(&a.0.store, &id, false).unwrap();
    refresh(&c.1, &c.0.store);
    bucket.objects.lock().unwrap().clear();
    assert!(refresh(&SharedScenes::new(bucket), &c.0.store).is_empty() && c.0.store.exists(&id));
}

/// A store that is away takes nothing from a server; a damaged scene there is said, and does not come.
#[test]
fn what_is_here_stays_when_the_store_is_away() {
    let bucket = Arc::new(Bucket::default());
    let (a, b) = (TestStore::new(), TestStore::new());
    let shared = SharedScenes::new(bucket.clone());
    let id = scene(&a, 1.0).metadata().id.clone();
    shared.put(&a.store, &id, true).unwrap();
    let of_b = SharedScenes::new(bucket.clone());
    refresh(&of_b, &b.store);
    bucket.is_away.store(true, Ordering::Relaxed);
    assert!(matches!(of_b.refresh(&b.store), Err(SceneError::StoreAway { .. })));
    assert!(matches!(of_b.remove(&b.store, &id), Err(SceneError::StoreAway { .. })));
    b.store.open(&id).unwrap();
    bucket.is_away.store(false, Ordering::Relaxed);

    let name = bucket.names().into_iter().find(|name| name.ends_with("light.bin")).unwrap();
    *bucket.objects.lock().unwrap().get_mut(&name).unwrap().0.last_mut().unwrap() ^= 1;
    let c = TestStore::new();
    for planted in ["altered", "missing"] {
        let (changed, failed) = SharedScenes::new(bucket.clone()).refresh(&c.store).unwrap();
        assert!(changed.is_empty() && !c.store.exists(&id), "{planted}");
        let error = failed[0].to_string();
        assert!(matches!(failed[0], SceneError::Damaged { .. }) && error.contains("light.bin"), "{error}");
        bucket.objects.lock().unwrap().remove(&name);
    }
    let left = std::fs::read_dir(c.store.scenes_dir()).unwrap().count();
    assert_eq!(left, 0, "nothing half is left");
}
