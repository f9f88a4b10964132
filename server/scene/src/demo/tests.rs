use super::*;
use skyglow_physics::GeoPoint;

/// The demo is marked as illustrative and comes out the same twice.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn the_demo_is_illustrative_and_deterministic() {
    let dir = tempfile::tempdir().unwrap();
    let store = SceneStore::new(dir.path());
    assert!(demo_is_wanted(&store));
    let first = create_demo(&store, &mut |_| {}).unwrap();
    assert!(!demo_is_wanted(&store));
    // A demo of an older format is outdated; a measured scene never is.
    let older = SceneMetadata { light_skylines: false, ..first.clone() };
    assert!(is_outdated(&older) && !is_outdated(&first));
    assert!(!is_outdated(&SceneMetadata { illustrative: false, ..older }));
    assert!(first.illustrative && first.title.contains("illustrative"));
    assert!(first.attribution.as_ref().unwrap().contains("Illustrative"));
    let bytes = std::fs::read(dir.path().join("scenes/demo/light.bin")).unwrap();
    assert_eq!(create_demo(&store, &mut |_| {}).unwrap(), first);
    assert_eq!(std::fs::read(dir.path().join("scenes/demo/light.bin")).unwrap(), bytes);
    assert_eq!(std::fs::read_dir(store.scenes_dir()).unwrap().count(), 1, "nothing else is left");

    let scene = store.open(&SceneId::parse(DEMO_ID).unwrap()).unwrap();
    let at = |lat, lon| GeoPoint::from_deg(lat, lon).unwrap();
    assert_eq!(scene.places()[0].name, "Milano");
    assert!(scene.radiance_nw_cm2_sr(at(45.464, 9.190)).unwrap() > 40.0);
    assert_eq!(scene.radiance_nw_cm2_sr(at(43.2, 8.5)), Some(0.0), "the sea is dark");
    assert_eq!(scene.terrain_altitude_m(at(43.2, 8.5)), Some(0.0), "the sea is level");
    let altitude = |lat, lon| scene.terrain_altitude_m(at(lat, lon)).unwrap();
    assert!((altitude(45.464, 9.190) - 120.0).abs() < 60.0, "{}", altitude(45.464, 9.190));
    assert!((altitude(46.43, 6.55) - 372.0).abs() < 5.0, "Lake Geneva: {}", altitude(46.43, 6.55));
    assert!(first.report.terrain.as_ref().unwrap().maximum_m > 3_000.0);
    assert!(scene.coverage(at(45.8, 9.5)) > 0.99);
    let people: f64 = towns::TOWNS.iter().map(|t| f64::from(t.population)).sum();
    let watts_a_head = first.report.flux_dnb_w / people;
    assert!((0.2..0.8).contains(&watts_a_head), "{watts_a_head}");
}
