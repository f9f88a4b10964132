//! Who keeps what in a store of scenarios and plans: fair shares, owners, lists, and what a restart finds.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

use skyglow_scene::{
    Account, Area, Change, ChangeId, ChangeKind, ChangeLimits, ChangeStore, ChangeStoreError, Cursor, Edit,
    Listed, Outline, Owner, PixelFactors, Posting, Scenario, SceneId, StoredPlan, Viewer,
};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::time::{Duration, Instant};

fn scene() -> SceneId {
    SceneId::parse("here").unwrap()
}

fn scenario(number: usize, base: Option<ChangeId>) -> Scenario {
    let change = Change::Alter { factor: 0.5, lamp: None, emission: None };
    let area = Area::Brush { points: vec![[7.1, 46.3]], radius_m: 250.0 };
    Scenario {
        scene: scene(),
        title: Some(format!("number {number}")),
        base,
        edits: vec![Edit { area, change }],
    }
}

fn plan() -> StoredPlan {
    StoredPlan {
        scene: scene(),
        scene_version: "v1".to_owned(),
        base: None,
        answer: serde_json::json!({"method": "target", "sites": [1, 2], "flux_removed_dnb_w": 3.5, "flux_removed_share": null}),
        factors: PixelFactors { codes: vec![3, 500], factors: vec![0.0, 0.5] },
        effects: vec![0.5, 0.5],
    }
}

fn from(address: &str) -> Posting {
    Posting { account: Account::Address(address.parse().unwrap()), ..Posting::default() }
}

fn by(secret: &str) -> Posting {
    Posting { owner: Some(Owner::by_secret(secret)), ..from("192.0.2.1") }
}

fn put(store: &ChangeStore, number: usize, posting: &Posting) -> ChangeId {
    store.store_scenario_as(&scenario(number, None), posting).unwrap().0
}

/// All pages of the list of scenarios.
fn pages(store: &ChangeStore, viewer: &Viewer, limit: usize) -> Vec<Vec<Listed>> {
    let (mut pages, mut after) = (Vec::new(), None::<Cursor>);
    loop {
        let page = store.page(ChangeKind::Scenario, &scene(), viewer, after.as_ref(), limit).unwrap();
        pages.push(page.entries);
        match page.next {
            Some(next) => after = Cursor::parse(&next.to_string()),
            None => return pages,
        }
    }
}

fn seen(store: &ChangeStore, viewer: &Viewer) -> Vec<ChangeId> {
    pages(store, viewer, 7).concat().into_iter().map(|entry| entry.id).collect()
}

/// The same content posted by many at once is one's: who is told that it is new has the secret that removes it.
#[test]
fn the_same_at_once_has_one_owner() {
    let folder = tempfile::tempdir().unwrap();
    let store = ChangeStore::new(folder.path(), ChangeLimits::default());
    for number in 0..20 {
        let ready = std::sync::Barrier::new(4);
        let store_it = &|secret: &str| {
            ready.wait();
            store.store_scenario_as(&scenario(number, None), &by(secret)).unwrap()
        };
        let stored: Vec<(String, (ChangeId, bool))> = std::thread::scope(|scope| {
            let secrets = (0..4).map(|client| format!("secret {client}"));
            let running: Vec<_> = secrets
                .map(|secret| {
                    scope.spawn(move || {
                        let stored = store_it(&secret);
                        (secret, stored)
                    })
                })
                .collect();
            running.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        let new: Vec<_> = stored.iter().filter(|(_, (_, is_new))| *is_new).collect();
        assert_eq!(new.len(), 1);
        let (secret, (id, _)) = new[0];
        store.remove(id, Some(&Owner::by_secret(secret))).unwrap();
    }
}

/// One household with twenty /64 of a /59 stores far more than there is room for: nobody else loses anything, nor does its
/// neighbour in the /48.
#[test]
fn a_household_evicts_nobody_else() {
    let folder = tempfile::tempdir().unwrap();
    let limits = ChangeLimits { count: 40, ..ChangeLimits::default() };
    let store = ChangeStore::new(folder.path(), limits);
    let others: Vec<ChangeId> = (0..16)
        .map(|number| match number % 4 {
            0 => put(&store, number, &from(&format!("2001:db8:7:{number:x}00::1"))),
            1 => put(&store, number, &from(&format!("2001:db8:{number:x}::1"))),
            2 => put(&store, number, &from(&format!("198.51.100.{number}"))),
            _ => put(&store, number, &Posting::default()),
        })
        .collect();
    // Its own /48 has others' /56 in it.
    let household = |number: usize| from(&format!("2001:db8:7:ff{:02x}::{number:x}", 0x40 + number % 20));
    let mut last = others[0].clone();
    (0..200).for_each(|number| last = put(&store, 100 + number, &household(number)));
    assert!(others.iter().all(|id| store.scenario(id).is_ok()) && store.is_stored(&last));
    let files = std::fs::read_dir(folder.path().join("scenarios")).unwrap();
    let documents = files.filter(|file| file.as_ref().unwrap().path().extension().unwrap() == "json").count();
    assert_eq!((documents, seen(&store, &Viewer::Anyone).len()), (40, 40));
    // The same after a restart.
    let again = ChangeStore::new(folder.path(), limits);
    (0..60).for_each(|number| drop(put(&again, 1_000 + number, &household(number))));
    assert!(others.iter().all(|id| again.is_stored(id)));
}

/// What others are based on stays, whoever is heavy.
#[test]
fn what_others_are_based_on_stays() {
    let folder = tempfile::tempdir().unwrap();
    let store = ChangeStore::new(folder.path(), ChangeLimits { count: 20, ..ChangeLimits::default() });
    let heavy = from("2001:db8:7::1");
    let base = put(&store, 0, &heavy);
    let light = scenario(1, Some(base.clone()));
    let light = store.store_scenario_as(&light, &from("192.0.2.7")).unwrap().0;
    for number in 0..100 {
        put(&store, 100 + number, &heavy);
    }
    assert!(store.steps(&light, &scene(), "v1").is_ok());
    // Without the one that is based on it, it goes like the others.
    store.remove(&light, None).unwrap();
    for number in 0..100 {
        put(&store, 300 + number, &heavy);
    }
    assert!(!store.is_stored(&base));
}

/// An owner removes what is theirs, and nobody else does but the operator.
#[test]
fn owners_remove_what_is_theirs() {
    let folder = tempfile::tempdir().unwrap();
    let store = ChangeStore::new(folder.path(), ChangeLimits::default());
    let (mine, yours) = (Owner::by_secret("mine"), Owner::by_secret("yours"));
    let id = put(&store, 1, &by("mine"));
    // Storing the same again makes nobody else its owner.
    assert_eq!(store.store_scenario_as(&scenario(1, None), &by("yours")).unwrap(), (id.clone(), false));
    let refused = store.remove(&id, Some(&yours));
    assert!(matches!(refused, Err(ChangeStoreError::NotOwner { .. })), "{refused:?}");
    store.remove(&id, Some(&mine)).unwrap();
    assert!(matches!(store.remove(&id, Some(&mine)), Err(ChangeStoreError::Unknown { .. })));
    assert!(matches!(store.scenario(&id), Err(ChangeStoreError::Unknown { .. })));
    assert!(seen(&store, &Viewer::Operator).is_empty());
    // A plan goes with its pixels; what is nobody's goes by the operator alone.
    let of_plan = ChangeStore::plan_id(b"x");
    store.store_plan(&of_plan, &plan()).unwrap();
    assert!(matches!(store.remove(&of_plan, Some(&mine)), Err(ChangeStoreError::NotOwner { .. })));
    store.remove(&of_plan, None).unwrap();
    let names = std::fs::read_dir(folder.path().join("plans")).unwrap();
    assert!(names.map(|name| name.unwrap().file_name()).all(|name| name == "outlines.jsonl"));
}

/// What is not listed has an id that does not follow from its content, and only its owner sees it in lists.
#[test]
fn what_is_not_listed_is_its_owners() {
    let folder = tempfile::tempdir().unwrap();
    let store = ChangeStore::new(folder.path(), ChangeLimits::default());
    let unlisted = |secret| Posting { listed: false, ..by(secret) };
    let listed = put(&store, 1, &by("mine"));
    let (mine, yours) = (put(&store, 1, &unlisted("mine")), put(&store, 1, &unlisted("yours")));
    assert!(listed != mine && mine != yours && listed != yours);
    assert_eq!(put(&store, 1, &unlisted("mine")), mine, "the same is the same");
    let elsewhere = ChangeStore::new(tempfile::tempdir().unwrap().path(), ChangeLimits::default());
    assert_ne!(elsewhere.scenario_id(&scenario(1, None), &unlisted("mine")).unwrap(), mine);
    assert_eq!(elsewhere.scenario_id(&scenario(1, None), &by("mine")).unwrap(), listed);

    let owner = Viewer::Owner(Owner::by_secret("mine"));
    let again = ChangeStore::new(folder.path(), ChangeLimits::default());
    for store in [&store, &again] {
        assert_eq!(seen(store, &Viewer::Anyone), std::slice::from_ref(&listed));
        assert_eq!(seen(store, &owner), [mine.clone(), listed.clone()]);
        assert_eq!(seen(store, &Viewer::Operator), [yours.clone(), mine.clone(), listed.clone()]);
        assert!(store.scenario(&mine).is_ok(), "who knows the id reads it");
    }
}

#[test]
fn pages_follow_each_other_without_gaps() {
    let folder = tempfile::tempdir().unwrap();
    let store = ChangeStore::new(folder.path(), ChangeLimits::default());
    let mut ids: Vec<ChangeId> = (0..23).map(|number| put(&store, number, &by("mine"))).collect();
    let other = Scenario { scene: SceneId::parse("there").unwrap(), ..scenario(0, None) };
    store.store_scenario(&other).unwrap();
    ids.reverse();
    let pages_of_10 = pages(&store, &Viewer::Anyone, 10);
    assert_eq!(pages_of_10.iter().map(Vec::len).collect::<Vec<_>>(), [10, 10, 3]);
    assert_eq!(seen(&store, &Viewer::Anyone), ids);
    assert_eq!(pages(&store, &Viewer::Anyone, 23).len(), 1, "no empty page at the end");
    // One that is removed between two pages leaves no gap.
    let first = store.page(ChangeKind::Scenario, &scene(), &Viewer::Anyone, None, 10).unwrap();
    store.remove(&ids[9], None).unwrap();
    let second =
        store.page(ChangeKind::Scenario, &scene(), &Viewer::Anyone, first.next.as_ref(), 10).unwrap();
    assert_eq!(second.entries[0].id, ids[10]);
    assert_eq!(Cursor::parse("x.s-00000000000000000000"), None);
}

/// What is pinned stays beyond count and age, and takes half of the room at most.
#[test]
fn what_is_pinned_stays() {
    let folder = tempfile::tempdir().unwrap();
    let limits = ChangeLimits { count: 10, ..ChangeLimits::default() };
    let store = ChangeStore::new(folder.path(), limits);
    let pinned = |secret| Posting { pinned: true, ..by(secret) };
    let mut pins: Vec<ChangeId> = (0..4).map(|number| put(&store, number, &pinned("mine"))).collect();
    // Its owner may pin it later; others may not.
    pins.push(put(&store, 4, &by("mine")));
    for secret in ["yours", "mine"] {
        store.store_scenario_as(&scenario(4, None), &pinned(secret)).unwrap();
    }
    let refused = store.store_scenario_as(&scenario(5, None), &pinned("mine"));
    assert!(matches!(refused, Err(ChangeStoreError::PinsFull)), "{refused:?}");
    (10..60).for_each(|number| drop(put(&store, number, &by("mine"))));
    assert!(pins.iter().all(|id| store.scenario(id).is_ok()));
    assert_eq!(seen(&store, &Viewer::Anyone).len(), 10);
    std::thread::sleep(Duration::from_millis(2_100));
    let aged = ChangeStore::new(folder.path(), ChangeLimits { age: Duration::ZERO, ..limits });
    assert!(pins.iter().all(|id| aged.is_stored(id) && aged.scenario(id).is_ok()));
    assert_eq!(seen(&aged, &Viewer::Anyone).len(), 5);
}

/// The file of outlines does not grow without end.
#[test]
fn outlines_are_written_anew() {
    let folder = tempfile::tempdir().unwrap();
    let store = ChangeStore::new(folder.path(), ChangeLimits::default());
    let base = put(&store, 1, &by("mine"));
    let mut longest = 0;
    for _ in 0..2_500 {
        // The same again renews it.
        assert_eq!(put(&store, 1, &by("mine")), base);
        longest = longest.max(std::fs::metadata(outlines(folder.path())).unwrap().len());
    }
    assert!(longest < 1_000_000, "{longest}");
    let again = ChangeStore::new(folder.path(), ChangeLimits::default());
    assert_eq!(seen(&again, &Viewer::Anyone), [base]);
}

fn outlines(folder: &Path) -> std::path::PathBuf {
    folder.join("scenarios/outlines.jsonl")
}

/// A restart finds what is in the files, whatever became of the outlines; damaged documents are left out, and named.
#[test]
fn a_restart_finds_what_the_files_say() {
    let folder = tempfile::tempdir().unwrap();
    let store = ChangeStore::new(folder.path(), ChangeLimits::default());
    let ids: Vec<ChangeId> = (0..9).rev().map(|number| put(&store, number, &by("mine"))).collect();
    let newest_first: Vec<ChangeId> = ids.iter().rev().cloned().collect();
    let lines = std::fs::read(outlines(folder.path())).unwrap();
    let halves = &lines[..lines.len() - 40];
    for known in [None, Some(&lines[..]), Some(halves), Some(b"{}\nnonsense\n\xff")] {
        match known {
            Some(known) => std::fs::write(outlines(folder.path()), known).unwrap(),
            None => std::fs::remove_file(outlines(folder.path())).unwrap(),
        }
        let again = ChangeStore::new(folder.path(), ChangeLimits::default());
        assert_eq!(again.read_index().unwrap(), 9);
        assert_eq!(seen(&again, &Viewer::Anyone), newest_first);
    }
    // Altered after the outlines were written, and before.
    let damage = |id: &ChangeId, from: &str, to: &str| {
        let path = folder.path().join(format!("scenarios/{id}.json"));
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(from));
        std::fs::write(&path, text.replace(from, to)).unwrap();
    };
    damage(&ids[0], "0.5", "0.6");
    damage(&ids[1], "\"unlisted\":false", "\"unlisted\":true");
    let again = ChangeStore::new(folder.path(), ChangeLimits::default());
    assert_eq!(seen(&again, &Viewer::Operator), newest_first[..7]);
    let named: Vec<String> = again.take_damaged().iter().map(ToString::to_string).collect();
    assert!(
        named.len() == 2 && ids[..2].iter().all(|id| named.iter().any(|text| text.contains(id.as_str())))
    );
    assert!(matches!(again.scenario(&ids[1]), Err(ChangeStoreError::Damaged { .. })));
}

/// Documents of older programs, which do not say who had them stored, are listed as before.
#[test]
fn documents_of_older_programs_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let store = ChangeStore::new(folder.path(), ChangeLimits::default());
    let id = put(&store, 1, &by("mine"));
    let path = folder.path().join(format!("scenarios/{id}.json"));
    let text = std::fs::read_to_string(&path).unwrap();
    let (from, to) = (text.find(",\"posted\"").unwrap(), text.find(",\"content\"").unwrap());
    std::fs::write(&path, [&text[..from], &text[to..]].concat()).unwrap();
    let again = ChangeStore::new(folder.path(), ChangeLimits::default());
    assert_eq!(seen(&again, &Viewer::Anyone), std::slice::from_ref(&id));
    assert_eq!(again.scenario(&id).unwrap().0, scenario(1, None));
    let refused = again.remove(&id, Some(&Owner::by_secret("mine")));
    assert!(matches!(refused, Err(ChangeStoreError::NotOwner { .. })));
}

/// What another process stores or removes is seen after a second at most.
#[test]
fn what_another_process_stores_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let (store, other) = (
        ChangeStore::new(folder.path(), ChangeLimits::default()),
        ChangeStore::new(folder.path(), ChangeLimits::none()),
    );
    let first = put(&store, 1, &by("mine"));
    assert_eq!(seen(&store, &Viewer::Anyone), std::slice::from_ref(&first));
    let second = other.store_scenario(&scenario(2, None)).unwrap();
    other.remove(&first, None).unwrap();
    let began = Instant::now();
    while seen(&store, &Viewer::Anyone) != [second.clone()] {
        assert!(began.elapsed() < Duration::from_secs(5));
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// Lists say of plans what their answers say, and files are for the user and the group.
#[test]
fn lists_say_what_plans_say() {
    let folder = tempfile::tempdir().unwrap();
    let store = ChangeStore::new(folder.path(), ChangeLimits::default());
    store.store_plan(&ChangeStore::plan_id(b"x"), &plan()).unwrap();
    let again = ChangeStore::new(folder.path(), ChangeLimits::default());
    for store in [&store, &again] {
        let page = store.page(ChangeKind::Plan, &scene(), &Viewer::Anyone, None, 10).unwrap();
        let outline = Outline::Plan {
            method: "target".to_owned(),
            site_count: 2,
            flux_removed_dnb_w: 3.5,
            flux_removed_share: 0.0,
        };
        assert_eq!(page.entries.iter().map(|entry| &entry.outline).collect::<Vec<_>>(), [&outline]);
    }
    for file in std::fs::read_dir(folder.path().join("plans")).unwrap() {
        let mode = file.as_ref().unwrap().metadata().unwrap().permissions().mode() & 0o777;
        assert_eq!(mode, 0o640, "{file:?}");
    }
    let key = std::fs::metadata(folder.path().join("kept.key")).unwrap();
    assert_eq!(key.permissions().mode() & 0o777, 0o600);
}
