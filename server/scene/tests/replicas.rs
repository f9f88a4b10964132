//! Stores of scenarios and plans beside each other over one object store, as servers of one service have them.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

#[path = "common/bucket.rs"]
mod bucket;

use bucket::Bucket;
use skyglow_scene::{
    Account, Area, Change, ChangeId, ChangeKind, ChangeLimits, ChangeStore, ChangeStoreError, DraftShelf,
    Edit, Owner, PixelFactors, Posting, Scenario, SceneId, StoredPlan, Viewer,
};
use std::collections::BTreeMap;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};
use tempfile::TempDir;

/// A server's store, with a data folder of its own.
fn replica(bucket: &Arc<Bucket>, limits: ChangeLimits) -> (TempDir, ChangeStore) {
    let folder = tempfile::tempdir().unwrap();
    let store = ChangeStore::in_store(folder.path(), limits, bucket.clone()).unwrap();
    (folder, store)
}

fn two() -> (Arc<Bucket>, [(TempDir, ChangeStore); 2]) {
    let bucket = Arc::new(Bucket::default());
    let replicas = [(); 2].map(|()| replica(&bucket, ChangeLimits::default()));
    (bucket, replicas)
}

fn scene() -> SceneId {
    SceneId::parse("here").unwrap()
}

fn scenario(number: usize) -> Scenario {
    let change = Change::Alter { factor: 0.5, lamp: None, emission: None };
    let area = Area::Brush { points: vec![[7.1, 46.3]], radius_m: 250.0 };
    let title = Some(format!("number {number}"));
    Scenario { scene: scene(), title, base: None, edits: vec![Edit { area, change }] }
}

fn plan(effect: f32) -> StoredPlan {
    StoredPlan {
        scene: scene(),
        scene_version: "v1".to_owned(),
        base: None,
        answer: serde_json::json!({"method": "target", "sites": []}),
        factors: PixelFactors { codes: vec![3, 500], factors: vec![0.0, 0.5] },
        effects: vec![effect, 0.5],
    }
}

fn of(secret: &str) -> Posting {
    Posting { owner: Some(Owner::by_secret(secret)), ..Posting::default() }
}

fn listed(store: &ChangeStore, kind: ChangeKind) -> Vec<ChangeId> {
    let page = store.page(kind, &scene(), &Viewer::Anyone, None, 1000).unwrap();
    page.entries.into_iter().map(|entry| entry.id).collect()
}

fn is_unknown<T>(result: Result<T, ChangeStoreError>) -> bool {
    matches!(result, Err(ChangeStoreError::Unknown { .. }))
}

/// What one keeps, the other reads at once by its id and has in its next list; so has one that starts later.
#[test]
fn what_one_keeps_the_other_reads() {
    let (bucket, [(_a, a), (_b, b)]) = two();
    let painted = a.store_scenario(&scenario(1)).unwrap();
    assert_eq!(b.scenario(&painted).unwrap(), a.scenario(&painted).unwrap());
    let found = ChangeStore::plan_id(b"found");
    a.store_plan(&found, &plan(0.5)).unwrap();
    assert_eq!(b.plan(&found).unwrap().0, plan(0.5));
    let another = a.store_scenario(&scenario(2)).unwrap();
    std::thread::sleep(Duration::from_millis(1100));
    assert_eq!(listed(&b, ChangeKind::Scenario), [another.clone(), painted.clone()]);
    let (_c, c) = replica(&bucket, ChangeLimits::default());
    assert_eq!(c.read_index().unwrap(), 3);
    assert_eq!(listed(&c, ChangeKind::Plan), [found]);
    assert!(is_unknown(c.scenario(&ChangeId::parse("s-0123456789abcdef0123").unwrap())));
}

/// What one removes is gone from the store at once, and from the other when that looks; the owner is known to both.
#[test]
fn what_one_removes_is_gone_at_the_other() {
    let (bucket, [(_a, a), (_b, b)]) = two();
    let found = ChangeStore::plan_id(b"found");
    a.store_plan_as(&found, &plan(0.5), &of("secret")).unwrap();
    let stranger = Owner::by_secret("other");
    assert!(matches!(b.remove(&found, Some(&stranger)), Err(ChangeStoreError::NotOwner { .. })));
    b.remove(&found, Some(&Owner::by_secret("secret"))).unwrap();
    assert_eq!(bucket.names(), ["kept.key"]);
    assert!(a.plan(&found).is_ok(), "the copy");
    assert!(!a.is_kept(&found).unwrap() && is_unknown(a.plan(&found)));
    // Kept anew where the copy is there still, it is new.
    a.store_plan(&found, &plan(0.5)).unwrap();
    b.refresh().unwrap();
    a.remove(&found, None).unwrap();
    assert!(b.store_plan_as(&found, &plan(0.5), &of("third")).unwrap());
    a.refresh().unwrap();
    assert!(a.plan(&found).is_ok());
    b.remove(&found, None).unwrap();
    a.refresh().unwrap();
    assert!(is_unknown(a.plan(&found)) && listed(&a, ChangeKind::Plan).is_empty());
}

/// The same kept at two servers at once has one owner, who is told so, and pixels that fit.
#[test]
fn the_same_at_two_servers_has_one_owner() {
    let (_bucket, [(_a, a), (_b, b)]) = two();
    for round in 0..20_u32 {
        let id = ChangeStore::plan_id(&round.to_le_bytes());
        let put = |store: &ChangeStore, secret: &str, effect| {
            store.store_plan_as(&id, &plan(effect), &of(secret)).unwrap()
        };
        let (first, second) = std::thread::scope(|scope| {
            let first = scope.spawn(|| put(&a, "a", 0.25));
            let second = put(&b, "b", 0.75);
            (first.join().unwrap(), second)
        });
        assert!(first != second, "one of them is told that it is new");
        let kept = if first { plan(0.25) } else { plan(0.75) };
        assert!(a.plan(&id).unwrap().0 == kept && b.plan(&id).unwrap().0 == kept);
        let owner = Owner::by_secret(if first { "a" } else { "b" });
        b.remove(&id, Some(&owner)).unwrap();
        a.refresh().unwrap();
    }
}

/// A store that is away is an error of its own, never "unknown"; what has a copy is read, and all goes on when it is back.
#[test]
fn a_store_that_is_away_says_so() {
    let (bucket, [(_a, a), (_b, b)]) = two();
    let [here, elsewhere] = [1, 2].map(|number| a.store_scenario(&scenario(number)).unwrap());
    b.scenario(&here).unwrap();
    bucket.is_away.store(true, Ordering::Relaxed);
    let is_away = |error: ChangeStoreError| matches!(error, ChangeStoreError::Away(_));
    assert!(b.scenario(&here).is_ok());
    assert!(is_away(b.scenario(&elsewhere).unwrap_err()));
    assert!(is_away(b.store_scenario(&scenario(3)).unwrap_err()));
    assert!(is_away(b.remove(&here, None).unwrap_err()) && b.scenario(&here).is_ok());
    assert!(is_away(b.list(ChangeKind::Scenario).unwrap_err()));
    let folder = tempfile::tempdir().unwrap();
    let refused = ChangeStore::in_store(folder.path(), ChangeLimits::default(), bucket.clone());
    assert!(is_away(refused.unwrap_err()));
    bucket.is_away.store(false, Ordering::Relaxed);
    b.store_scenario(&scenario(3)).unwrap();
    assert_eq!(b.list(ChangeKind::Scenario).unwrap().len(), 3);
}

/// What is too much goes from the store, and so from all; what is not listed has the same id at both.
#[test]
fn limits_and_keys_hold_for_all() {
    let bucket = Arc::new(Bucket::default());
    let limits = ChangeLimits { count: 4, ..ChangeLimits::default() };
    let [(_a, a), (_b, b)] = [(); 2].map(|()| replica(&bucket, limits));
    for number in 0..8 {
        let store = if number % 2 == 0 { &a } else { &b };
        store.refresh().unwrap();
        store.store_scenario(&scenario(number)).unwrap();
    }
    a.refresh().unwrap();
    b.refresh().unwrap();
    assert_eq!(listed(&a, ChangeKind::Scenario), listed(&b, ChangeKind::Scenario));
    assert_eq!(bucket.names().iter().filter(|name| name.ends_with(".json")).count(), 4);
    let hidden = Posting { listed: false, ..of("secret") };
    assert_eq!(a.scenario_id(&scenario(9), &hidden).unwrap(), b.scenario_id(&scenario(9), &hidden).unwrap());
}

/// Drafts for several servers, in memory.
#[derive(Debug, Default)]
struct Shelf(Mutex<BTreeMap<String, Vec<u8>>>);

impl DraftShelf for Shelf {
    fn put(&self, id: &str, bytes: &[u8]) {
        self.0.lock().unwrap().insert(id.to_owned(), bytes.to_vec());
    }

    fn get(&self, id: &str) -> Option<Vec<u8>> {
        self.0.lock().unwrap().get(id).cloned()
    }
}

/// A draft of one server is read at another, and stays no base; one that is not whole is none.
#[test]
fn drafts_are_found_at_the_other() {
    let (bucket, [(_a, a), (_b, b)]) = two();
    let shelf = Arc::new(Shelf::default());
    let [a, b] = [a, b].map(|store| store.with_shelf(shelf.clone()));
    let [one, two, unknown] = [b"1", b"2", b"3"].map(|content| ChangeStore::plan_id(content));
    let account = Account::Address("192.0.2.1".parse().unwrap());
    [&one, &two].iter().for_each(|id| a.hold_plan(id, plan(0.5), &account));
    assert_eq!(b.plan(&one).unwrap(), a.plan(&one).unwrap());
    assert!(matches!(b.check_base(Some(&one)), Err(ChangeStoreError::Draft { .. })));
    shelf.0.lock().unwrap().get_mut(two.as_str()).unwrap()[300] ^= 1;
    assert!(is_unknown(b.plan(&two)) && is_unknown(b.plan(&unknown)) && a.plan(&two).is_ok());
    shelf.0.lock().unwrap().clear();
    assert!(b.plan(&one).is_ok(), "taken over");
    assert_eq!(bucket.names(), ["kept.key"]);
}

/// A document that is kept again is as young at the other server, and one that is pinned there stays here.
#[test]
fn ages_and_pins_are_those_of_all() {
    let (bucket, [(_a, a), (_b, b)]) = two();
    let id = a.store_scenario_as(&scenario(1), &of("secret")).unwrap().0;
    let day = Duration::from_secs(86_400);
    let age = |name: &str, by: Duration| {
        let mut objects = bucket.objects.lock().unwrap();
        let object = objects.iter_mut().find(|(other, _)| other.ends_with(name)).unwrap();
        object.1.1 = SystemTime::now() - by;
    };
    age(".json", 100 * day);
    assert!(is_unknown(b.scenario(&id)), "past its age");
    a.store_scenario(&scenario(1)).unwrap();
    a.refresh().unwrap();
    age(".renewed", day);
    b.refresh().unwrap();
    assert!(b.scenario(&id).is_ok());
    let pinned = Posting { pinned: true, ..of("secret") };
    a.store_scenario_as(&scenario(1), &pinned).unwrap();
    age(".json", 95 * day);
    bucket.objects.lock().unwrap().retain(|name, _| !name.ends_with(".renewed"));
    let (_c, c) = replica(&bucket, ChangeLimits::default());
    assert!(c.scenario(&id).is_ok(), "pinned, whatever its age");
}
