//! Stored scenarios and plans are read back exactly, or refused.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

use skyglow_physics::{EmissionMix, LampChange, LampPreset, PreservedFlux};
use skyglow_scene::{
    Account, Area, Change, ChangeId, ChangeKind, ChangeLimits, ChangeStep, ChangeStore, ChangeStoreError,
    Edit, PixelFactors, Scenario, SceneId, StoredPlan,
};
use std::time::Duration;
use tempfile::TempDir;

fn scene() -> SceneId {
    SceneId::parse("here").unwrap()
}

fn scenario(factor: f64, base: Option<ChangeId>) -> Scenario {
    let lamp = LampChange {
        from: Some(LampPreset::Hps),
        to: LampPreset::Led3000k.lamp(),
        preserved: PreservedFlux::LuminousFlux,
    };
    let change = Change::Alter { factor, lamp: Some(lamp), emission: Some(EmissionMix::garstang()) };
    let area = Area::Brush { points: vec![[7.1, 46.3], [0.1 + 0.2, 1.0 / 3.0]], radius_m: 250.0 };
    Scenario { scene: scene(), title: Some("new lamps".to_owned()), base, edits: vec![Edit { area, change }] }
}

fn plan(base: Option<ChangeId>) -> StoredPlan {
    StoredPlan {
        scene: scene(),
        scene_version: "v1".to_owned(),
        base,
        answer: serde_json::json!({"removed": 0.1}),
        factors: PixelFactors { codes: vec![3, 500, 70_000], factors: vec![0.0, 0.5, 0.9] },
        effects: vec![0.5, 0.3, 0.2],
    }
}

fn store(limits: ChangeLimits) -> (TempDir, ChangeStore) {
    let folder = tempfile::tempdir().unwrap();
    let store = ChangeStore::new(folder.path(), limits);
    (folder, store)
}

/// A draft plan is not on disk, and nothing stored can be based on it.
#[test]
fn drafts_stay_in_memory_and_are_no_base() {
    let (folder, store) = store(ChangeLimits::default());
    let draft = ChangeStore::plan_id(b"a slider on its way");
    store.hold_plan(&draft, plan(None), &Account::Nobody);
    assert_eq!(store.plan(&draft).unwrap().0, plan(None));
    assert!(store.is_there(&draft) && !store.is_stored(&draft));
    assert_eq!(store.steps(&draft, &scene(), "v1").unwrap(), [ChangeStep::Dimmed(plan(None).factors)]);
    assert!(store.list(ChangeKind::Plan).unwrap().is_empty());
    let refused = store.store_scenario(&scenario(0.5, Some(draft.clone())));
    assert!(matches!(refused, Err(ChangeStoreError::Draft { .. })));
    let refused = store.store_plan(&ChangeStore::plan_id(b"upon it"), &plan(Some(draft.clone())));
    assert!(matches!(refused, Err(ChangeStoreError::Draft { .. })));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);

    let again = ChangeStore::new(folder.path(), ChangeLimits::default());
    assert!(
        matches!(again.plan(&draft), Err(ChangeStoreError::Unknown { .. })),
        "another process has none of it"
    );
    store.store_plan(&draft, &plan(None)).unwrap();
    assert!(store.is_stored(&draft) && again.is_there(&draft));
    store.store_scenario(&scenario(0.5, Some(draft))).unwrap();
}

/// Scenarios and plans survive a restart and can be based on each other.
#[test]
fn scenarios_and_plans_survive_and_chain() {
    let (folder, store) = store(ChangeLimits::default());
    let first = store.store_scenario(&scenario(0.5, None)).unwrap();
    assert_eq!(store.store_scenario(&scenario(0.5, None)).unwrap(), first, "the same is the same");
    let of_plan = ChangeStore::plan_id(b"what decides it");
    store.store_plan(&of_plan, &plan(Some(first.clone()))).unwrap();
    let last = store.store_scenario(&scenario(0.25, Some(of_plan.clone()))).unwrap();
    assert_ne!(last, first);

    // As another process finds it.
    let again = ChangeStore::new(folder.path(), ChangeLimits::default());
    assert_eq!(again.scenario(&first).unwrap().0, scenario(0.5, None));
    assert_eq!(again.plan(&of_plan).unwrap().0, plan(Some(first.clone())));
    assert_eq!(again.plan_answer(&of_plan).unwrap().1, serde_json::json!({"removed": 0.1}));
    let steps = again.steps(&last, &scene(), "v1").unwrap();
    let wanted = [
        ChangeStep::Painted(scenario(0.5, None).edits),
        ChangeStep::Dimmed(plan(None).factors),
        ChangeStep::Painted(scenario(0.25, None).edits),
    ];
    assert_eq!(steps, wanted);
    let ids = |kind| -> Vec<ChangeId> { again.list(kind).unwrap().into_iter().map(|(id, _)| id).collect() };
    let mut scenarios = vec![first, last.clone()];
    scenarios.sort();
    let mut listed = ids(ChangeKind::Scenario);
    listed.sort();
    assert_eq!((listed, ids(ChangeKind::Plan)), (scenarios, vec![of_plan]));

    let other = SceneId::parse("there").unwrap();
    assert!(matches!(again.steps(&last, &other, "v1"), Err(ChangeStoreError::OtherScene { .. })));
    assert!(matches!(again.steps(&last, &scene(), "v2"), Err(ChangeStoreError::Stale { .. })));
    let unknown = ChangeStore::plan_id(b"another");
    assert!(matches!(again.steps(&unknown, &scene(), "v1"), Err(ChangeStoreError::Unknown { .. })));
}

/// Emission weights whose sum differs from one in the last bit are read back exactly.
#[test]
fn emission_weights_round_trip_exactly() {
    let (_folder, store) = store(ChangeLimits::default());
    for step in 1..200u32 {
        let weights = [f64::from(step % 7), f64::from(step % 11), 1.0 / f64::from(step)];
        let emission = Some(EmissionMix::new(weights).unwrap());
        let mut scenario = scenario(0.5, None);
        scenario.edits[0].change = Change::Alter { factor: 1.0 / f64::from(step), lamp: None, emission };
        let id = store.store_scenario(&scenario).unwrap();
        assert_eq!(store.scenario(&id).unwrap().0, scenario, "{weights:?}");
    }
}

#[test]
fn changes_upon_changes_end_somewhere() {
    let (_folder, store) = store(ChangeLimits::default());
    let mut base = None;
    for step in 0..17 {
        base = Some(store.store_scenario(&scenario(f64::from(step), base)).unwrap());
    }
    let steps = store.steps(&base.unwrap(), &scene(), "v1");
    assert!(matches!(steps, Err(ChangeStoreError::TooDeep { .. })), "{steps:?}");
}

#[test]
fn old_ones_make_room() {
    let limits = ChangeLimits { count: 3, ..ChangeLimits::default() };
    let (folder, store) = store(limits);
    let mut ids = Vec::new();
    for step in 0..5 {
        ids.push(store.store_scenario(&scenario(f64::from(step), None)).unwrap());
        // Files are told apart by the second.
        let path = folder.path().join("scenarios").join(format!("{}.json", ids[step as usize]));
        let then = std::time::SystemTime::now() - Duration::from_secs(100 - 10 * step as u64);
        std::fs::File::options().write(true).open(path).unwrap().set_modified(then).unwrap();
    }
    let kept: Vec<ChangeId> =
        store.list(ChangeKind::Scenario).unwrap().into_iter().map(|(id, _)| id).collect();
    assert_eq!(kept, [ids[4].clone(), ids[3].clone(), ids[2].clone()]);
    assert!(matches!(store.scenario(&ids[0]), Err(ChangeStoreError::Unknown { .. })));
    // What stands on an old one keeps it.
    let child = store.store_scenario(&scenario(7.0, Some(ids[2].clone()))).unwrap();
    assert!(store.scenario(&ids[2]).is_ok() && store.scenario(&ids[3]).is_err());
    assert!(store.steps(&child, &scene(), "v1").is_ok());
    // The newest is kept whatever it takes.
    let narrow = ChangeStore::new(folder.path(), ChangeLimits { bytes: 1, ..limits });
    let last = narrow.store_scenario(&scenario(9.0, None)).unwrap();
    assert_eq!(narrow.list(ChangeKind::Scenario).unwrap().len(), 1);
    assert!(narrow.scenario(&last).is_ok());
    // What is past its age is gone, be it still on disk.
    let aged = ChangeStore::new(folder.path(), ChangeLimits { age: Duration::ZERO, ..limits });
    std::thread::sleep(Duration::from_millis(2_100));
    assert!(matches!(aged.scenario(&last), Err(ChangeStoreError::Unknown { .. })));
    assert!(aged.list(ChangeKind::Scenario).unwrap().is_empty());
    assert!(!aged.is_stored(&last) && narrow.is_stored(&last));
}

#[test]
fn damaged_files_are_named_and_not_believed() {
    let (folder, store) = store(ChangeLimits::default());
    let id = store.store_scenario(&scenario(0.5, None)).unwrap();
    let path = folder.path().join("scenarios").join(format!("{id}.json"));
    let text = std::fs::read_to_string(&path).unwrap();
    for broken in [
        text.replace("0.5", "0.6"),
        text[..text.len() / 2].to_owned(),
        String::new(),
        text.replace("\"format\":1", "\"format\":9"),
    ] {
        assert_ne!(broken, text);
        std::fs::write(&path, broken).unwrap();
        assert!(matches!(store.scenario(&id), Err(ChangeStoreError::Damaged { .. })));
    }
    let of_plan = ChangeStore::plan_id(b"x");
    store.store_plan(&of_plan, &plan(None)).unwrap();
    let pixels = folder.path().join("plans").join(format!("{of_plan}.bin"));
    let mut bytes = std::fs::read(&pixels).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    std::fs::write(&pixels, bytes).unwrap();
    assert!(matches!(store.plan(&of_plan), Err(ChangeStoreError::Damaged { .. })));
}
