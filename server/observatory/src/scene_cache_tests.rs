//! Scenes that are opened, let go and kept within memory.

use super::*;
use skyglow_scene::{ChangeLimits, IngestOptions, ingest};
use std::path::Path;

/// A scene that is damaged is found without being asked for, left out, and back when it is whole.
#[test]
fn a_damaged_scene_is_left_out_until_whole() {
    let data = tempfile::tempdir().unwrap();
    let (store, id) = store_lights(data.path());
    let cache = SceneCache::new(
        store,
        ChangeStore::new(data.path(), ChangeLimits::none()),
        4,
        &CacheSizes::most(1 << 30),
    );
    cache.check_all().unwrap();
    assert_eq!(cache.damaged(), (vec![], 1));
    let light = cache.store().scenes_dir().join(id.as_str()).join("light.bin");
    let whole = std::fs::read(&light).unwrap();
    let mut altered = whole.clone();
    altered[whole.len() / 2] ^= 1;
    std::fs::write(&light, &altered).unwrap();
    // What was sound stays so until it is opened: another cache sees it at its first look.
    let error = cache.scene(&id).unwrap_err().to_string();
    assert!(error.contains("light.bin"), "{error}");
    let later = SceneCache::new(
        cache.store().clone(),
        ChangeStore::new(data.path(), ChangeLimits::none()),
        4,
        &CacheSizes::most(1 << 30),
    );
    later.check_all().unwrap();
    for cache in [&cache, &later] {
        assert_eq!(cache.damaged(), (vec![id.clone()], 0));
        let opened = cache.opened.load(Ordering::Relaxed);
        assert!(cache.scene(&id).is_err());
        assert_eq!(cache.opened.load(Ordering::Relaxed), opened, "a damaged scene is not read again");
    }
    std::fs::write(&light, &whole).unwrap();
    later.check_all().unwrap();
    assert!(later.scene(&id).is_ok());
    assert_eq!(later.damaged(), (vec![], 1));
    // What is sound is opened before somebody asks, where there is room for twice as much.
    for (count, expected) in [(4, 1), (1, 0)] {
        let changes = ChangeStore::new(data.path(), ChangeLimits::none());
        let cache = SceneCache::new(later.store().clone(), changes, count, &CacheSizes::most(1 << 30));
        let sound = cache.check_all().unwrap();
        assert_eq!(sound, std::slice::from_ref(&id));
        cache.open_ahead(&sound);
        assert_eq!(cache.opened.load(Ordering::Relaxed), expected, "{count}");
        assert!(cache.check_all().unwrap().is_empty(), "it is known already");
    }
}

/// Stores a scene of two lights.
fn store_lights(data: &Path) -> (SceneStore, SceneId) {
    let raster = data.join("light.tif");
    std::fs::write(&raster, include_bytes!("../../../tests/fuzz/seeds/raster/smallest")).unwrap();
    let store = SceneStore::new(data);
    let id = ingest(&store, &IngestOptions::new(raster), &mut |_| {}).unwrap().id;
    (store, id)
}

/// A scene that is removed or replaced is let go at once with what was changed in it, and larger ones than there is memory for
/// are not opened.
#[test]
fn scenes_are_let_go_and_bounded() {
    let data = tempfile::tempdir().unwrap();
    let (store, id) = store_lights(data.path());
    let changes = || ChangeStore::new(data.path(), ChangeLimits::none());
    let cache = SceneCache::new(store.clone(), changes(), 4, &CacheSizes::most(1 << 30));
    let scene = Arc::downgrade(&cache.scene(&id).unwrap());
    assert!(scene.upgrade().is_some() && cache.len() == 1);
    cache.forget(&id);
    assert!(scene.upgrade().is_none() && cache.len() == 0);
    let small = SceneCache::new(store, changes(), 4, &CacheSizes::most(64));
    let error = small.scene(&id).unwrap_err();
    assert!(
        matches!(error, ObservatoryError::Scene(SceneError::TooLarge { limit_bytes: 64, .. })),
        "{error}"
    );
}

/// A server that opened a scene before it checked the file of its lights finds damage all the same, once, and has right numbers from then on.
#[test]
fn damaged_lights_are_found_after_opening() {
    let data = tempfile::tempdir().unwrap();
    let (store, id) = store_lights(data.path());
    let store = store.with_lights_in_file(1);
    let whole = store.open(&id).unwrap();
    let path = store.scenes_dir().join(id.as_str()).join("pyramid.bin");
    let good = std::fs::read(&path).unwrap();
    let mut bad = good.clone();
    // The highest byte of the last number, of a block's altitude or flux.
    *bad.last_mut().unwrap() ^= 0x40;
    std::fs::write(&path, &bad).unwrap();
    let changes = || ChangeStore::new(data.path(), ChangeLimits::none());
    let [west, south, ..] = whole.metadata().bounds;
    let place = skyglow_physics::GeoPoint::from_deg(south, west).unwrap();
    let of = |scene: &Scene| scene.polar_grid_with_ratio(place, false, 0.1);
    let server =
        SceneCache::new(store.clone(), changes(), 4, &CacheSizes::most(1 << 30)).with_lights_checked_later();
    server.scene(&id).unwrap();
    assert!(std::fs::read(&path).unwrap() == bad, "it is not read when it is opened");
    assert!(server.check_all().unwrap().is_empty(), "who asked for it has seen that it opens");
    server.check_lights().unwrap();
    assert!(!path.exists() && server.len() == 0);
    assert_eq!(of(&server.scene(&id).unwrap()), of(&whole));
    assert!(std::fs::read(&path).unwrap() == good);
    // Damaged anew, it is checked when it is opened.
    std::fs::write(&path, &bad).unwrap();
    server.forget(&id);
    server.scene(&id).unwrap();
    assert!(std::fs::read(&path).unwrap() == good);
    // A command checks at once.
    std::fs::write(&path, &bad).unwrap();
    SceneCache::new(store, changes(), 4, &CacheSizes::most(1 << 30)).scene(&id).unwrap();
    assert!(std::fs::read(&path).unwrap() == good);
}

/// Scenes that together take more than they may leave one another no room.
#[test]
fn open_scenes_keep_to_their_memory() {
    let data = tempfile::tempdir().unwrap();
    let (store, id) = store_lights(data.path());
    let bytes = store.scene_bytes(&id).unwrap().max(store.open(&id).unwrap().byte_count());
    let mut options = IngestOptions::new(data.path().join("light.tif"));
    let ids = ["one", "two", "three"].map(|name| SceneId::parse(name).unwrap());
    for id in &ids {
        options.id = Some(id.clone());
        ingest(&store, &options, &mut |_| {}).unwrap();
    }
    let open = |most_bytes: u64| {
        let changes = ChangeStore::new(data.path(), ChangeLimits::none());
        let cache = SceneCache::new(store.clone(), changes, 4, &CacheSizes::most(most_bytes));
        ids.iter().for_each(|id| drop(cache.scene(id).unwrap()));
        cache.len()
    };
    assert!((1..=2).contains(&open(5 * bytes / 2)));
    assert_eq!(open(1 << 30), 3);
}

#[test]
fn a_scene_asked_for_at_once_is_opened_once() {
    let data = tempfile::tempdir().unwrap();
    let (store, id) = store_lights(data.path());
    let cache = SceneCache::new(
        store,
        ChangeStore::new(data.path(), ChangeLimits::none()),
        4,
        &CacheSizes::most(1 << 30),
    );
    let start = std::sync::Barrier::new(8);
    let scenes: Vec<Arc<Scene>> = std::thread::scope(|scope| {
        let ask = || {
            start.wait();
            cache.scene(&id).unwrap()
        };
        let asking: Vec<_> = (0..8).map(|_| scope.spawn(ask)).collect();
        asking.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    assert_eq!(cache.opened.load(Ordering::Relaxed), 1);
    assert!(scenes.iter().all(|scene| Arc::ptr_eq(scene, &scenes[0])));
    // What changed on disk is opened again, once.
    let metadata = cache.store().scenes_dir().join(id.as_str()).join("metadata.json");
    let later = std::fs::metadata(&metadata).unwrap().modified().unwrap() + Duration::from_secs(5);
    std::fs::File::options().write(true).open(&metadata).unwrap().set_modified(later).unwrap();
    assert!(!Arc::ptr_eq(&cache.scene(&id).unwrap(), &scenes[0]));
    assert!(cache.scene(&id).is_ok());
    assert_eq!(cache.opened.load(Ordering::Relaxed), 2);
}
