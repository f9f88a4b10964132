//! Scenes on disk: whole, or refused by the name of the file; quick to open.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{Bench, TestRaster, place};
use skyglow_scene::{IngestOptions, SceneError, SceneId, SceneStore};
use std::fs::File;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// A stored scene with light, terrain and places.
fn stored() -> (Bench, SceneId) {
    let bench = Bench::new();
    TestRaster::new(200, 150, |c, r| 900.0 + (c * r) as f64 / 50.0).write_f32(&bench.path("terrain.tif"));
    std::fs::write(
        bench.path("places.csv"),
        "name,latitude,longitude,population\nA,-1.1,37.1,5\nB,-1.2,37.2,9\n",
    )
    .unwrap();
    let scene = bench.scene_with(&TestRaster::scattered(200, 150), |options| {
        options.terrain = vec![options.radiance.with_file_name("terrain.tif")];
        options.places = Some(options.radiance.with_file_name("places.csv"));
        options.title = Some("Plain".into());
        options.date = Some("2023".into());
        options.attribution = Some("Nobody".into());
    });
    let id = scene.metadata().id.clone();
    (bench, id)
}

#[test]
fn a_scene_comes_back_as_it_was_stored() {
    let (bench, id) = stored();
    let scene = bench.store.open(&id).unwrap();
    let metadata = scene.metadata();
    assert_eq!((metadata.title.as_str(), metadata.date.as_deref()), ("Plain", Some("2023")));
    assert_eq!((metadata.attribution.as_deref(), metadata.illustrative), (Some("Nobody"), false));
    assert!(metadata.terrain && metadata.crs == "WGS 84" && metadata.grid.width == 200);
    assert_eq!(metadata.places_count, 2);
    assert_eq!(scene.places()[0].name, "B", "the most populous first");
    let listed = bench.store.list().unwrap().scenes;
    assert_eq!(listed.len(), 1);
    assert_eq!(&listed[0], metadata);
    let text = serde_json::to_string(metadata).unwrap();
    assert_eq!(serde_json::from_str::<skyglow_scene::SceneMetadata>(&text).unwrap(), *metadata);
}

#[test]
fn what_a_killed_ingest_left_is_cleared_at_the_next_and_what_is_in_use_is_not() {
    let (bench, _) = stored();
    let scenes = bench.store.scenes_dir();
    let (dead, running) = (scenes.join(".ingest-dead"), scenes.join(".ingest-running"));
    for folder in [&dead, &running] {
        std::fs::create_dir(folder).unwrap();
        std::fs::write(folder.join("light.bin"), "half of it").unwrap();
    }
    let in_use = File::open(&running).unwrap();
    in_use.lock().unwrap();
    bench.scene(&TestRaster::scattered(30, 30));
    assert!(!dead.exists() && running.exists());
    drop(in_use);
    assert_eq!(bench.store.clear_stale(), 1);
    assert!(!running.exists());
    assert_eq!(bench.store.list().unwrap().scenes.len(), 1);
}

#[test]
fn a_scene_that_was_set_aside_for_a_successor_that_never_came_is_back() {
    let (bench, id) = stored();
    let (home, aside) =
        (bench.store.scenes_dir().join(id.as_str()), bench.store.scenes_dir().join(".ingest-x.old"));
    std::fs::rename(&home, &aside).unwrap();
    assert!(!bench.store.exists(&id));
    assert_eq!(bench.store.clear_stale(), 1);
    assert!(bench.store.open(&id).is_ok());
    // With its successor in place it is only in the way.
    std::fs::create_dir(&aside).unwrap();
    std::fs::copy(home.join("metadata.json"), aside.join("metadata.json")).unwrap();
    assert_eq!(bench.store.clear_stale(), 1);
    assert!(!aside.exists() && bench.store.open(&id).is_ok());
}

#[test]
fn the_same_files_make_the_same_version_and_another_pixel_another() {
    let bench = Bench::new();
    let mut raster = TestRaster::scattered(50, 50);
    let first = bench.scene(&raster).metadata().version.clone();
    assert_eq!(bench.scene(&raster).metadata().version, first);
    raster.values[7] += 1.0;
    assert_ne!(bench.scene(&raster).metadata().version, first);
}

#[test]
fn a_cut_changed_or_missing_file_is_refused_by_its_name() {
    for name in ["metadata.json", "light.bin", "terrain.bin", "skylines.bin", "places.json"] {
        let (bench, id) = stored();
        let path = bench.store.scenes_dir().join(id.as_str()).join(name);
        let whole = std::fs::read(&path).unwrap();
        let refused = |content: &[u8]| {
            std::fs::write(&path, content).unwrap();
            let error = bench.store.open(&id).unwrap_err();
            assert!(matches!(error, SceneError::Damaged { .. }), "{error}");
            assert!(error.to_string().contains(name) && error.to_string().contains(id.as_str()), "{error}");
        };
        for length in [0, 1, whole.len() / 2, whole.len() - 1] {
            refused(&whole[..length]);
        }
        let mut changed = whole.clone();
        let middle = changed.len() / 2;
        // A digit or letter of the JSON, any byte of the others.
        let at = (middle..changed.len()).find(|&i| changed[i].is_ascii_digit()).unwrap_or(middle);
        changed[at] ^= 1;
        refused(&changed);
        std::fs::write(&path, &whole).unwrap();
        assert!(bench.store.open(&id).is_ok());
        std::fs::remove_file(&path).unwrap();
        let error = bench.store.open(&id).unwrap_err();
        let expected = name != "metadata.json";
        assert_eq!(matches!(error, SceneError::Damaged { .. }), expected, "{error}");
    }
}

#[test]
fn a_store_that_is_not_there_is_empty_and_unknown_scenes_are_told() {
    let store = SceneStore::new("/no/such/folder");
    assert!(store.list().unwrap().scenes.is_empty());
    let error = store.open(&SceneId::parse("nothing").unwrap()).unwrap_err();
    assert!(matches!(error, SceneError::UnknownScene { .. }), "{error}");
}

#[test]
fn a_damaged_scene_is_named_and_does_not_hide_the_others() {
    let bench = Bench::new();
    bench.scene(&TestRaster::scattered(50, 50));
    let broken = bench.store.scenes_dir().join("broken");
    std::fs::create_dir(&broken).unwrap();
    std::fs::write(broken.join("metadata.json"), "{").unwrap();
    let list = bench.store.list().unwrap();
    assert_eq!(list.scenes.iter().map(|scene| scene.id.as_str()).collect::<Vec<_>>(), ["light"]);
    assert_eq!(list.damaged.len(), 1);
    assert!(list.damaged[0].to_string().contains("broken"), "{}", list.damaged[0]);
}

#[test]
fn replacing_a_scene_leaves_only_the_new_one() {
    let bench = Bench::new();
    bench.scene(&TestRaster::scattered(50, 50));
    let scene = bench.scene(&TestRaster::scattered(60, 50));
    assert_eq!(scene.metadata().grid.width, 60);
    let left: Vec<_> =
        std::fs::read_dir(bench.store.scenes_dir()).unwrap().flatten().map(|e| e.file_name()).collect();
    assert_eq!(left, ["light"]);
}

#[test]
fn a_scene_that_is_replaced_is_there_all_the_while() {
    let bench = Bench::new();
    let id = bench.scene(&TestRaster::scattered(50, 50)).metadata().id.clone();
    let is_done = AtomicBool::new(false);
    let opened = std::thread::scope(|scope| {
        let reader = scope.spawn(|| {
            let mut opened = 0;
            while !is_done.load(Ordering::Relaxed) {
                let width = bench.store.open(&id).unwrap().metadata().grid.width;
                assert!((50..90).contains(&width));
                opened += 1;
            }
            opened
        });
        for width in 51..90 {
            bench.scene(&TestRaster::scattered(width, 50));
            if reader.is_finished() {
                break;
            }
        }
        is_done.store(true, Ordering::Relaxed);
        reader.join().unwrap()
    });
    assert!(opened > 10, "{opened}");
    // Nothing of the 39 before is left.
    assert_eq!(std::fs::read_dir(bench.store.scenes_dir()).unwrap().count(), 1);
}

#[test]
fn a_million_lit_pixels_open_and_become_a_polar_grid_with_their_flux() {
    let bench = Bench::new();
    let mut raster = TestRaster::new(3000, 2000, |c, r| {
        // Towns: a sixth of the map, in patches, with values that do not repeat.
        let patch = ((c / 60) * 7 + (r / 60) * 13) % 6 == 0;
        if patch { 0.3 + ((c * 7919 + r * 104_729) % 9973) as f64 / 100.0 } else { 0.0 }
    });
    raster.geotransform = [31.0, 1.0 / 240.0, 0.0, 4.0, 0.0, -1.0 / 240.0];
    let path = bench.path("light.tif");
    raster.write_f32(&path);
    let mut options = IngestOptions::new(path);
    options.id = Some(SceneId::parse("million").unwrap());
    let start = Instant::now();
    let metadata = bench.ingest(&options).unwrap();
    println!("{} lit pixels ingested in {:.2} s", metadata.lit_pixels, start.elapsed().as_secs_f64());
    assert!(metadata.lit_pixels > 990_000);
    let best = |work: &mut dyn FnMut()| {
        let mut time = || {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        };
        (0..5).map(|_| time()).fold(f64::INFINITY, f64::min)
    };
    let opened = best(&mut || drop(bench.store.open(&metadata.id).unwrap()));
    let scene = bench.store.open(&metadata.id).unwrap();
    let grid = best(&mut || drop(scene.polar_grid(place(0.0, 37.0), false)));
    println!("opened in {:.0} ms, polar grid in {:.1} ms", 1e3 * opened, 1e3 * grid);
    // How long it takes is printed above and asserted nowhere: it depends on what else the machine does.
    let polar = scene.polar_grid(place(0.0, 37.0), false);
    assert!(polar.cells.len() > 1_000 && polar.cells.len() < 60_000, "{}", polar.cells.len());
    let cells_w: f64 = polar.cells.iter().map(|cell| f64::from(cell.flux_dnb_w)).sum();
    assert!((cells_w / polar.flux_dnb_w - 1.0).abs() < 1e-3, "{cells_w} of {}", polar.flux_dnb_w);
}
