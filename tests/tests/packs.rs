//! Nothing lies in precomputed/ without a manifest that rebuilds it.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what cannot be set up fails the test")]

use skyglow_tests::{
    packs::{Entry, MAX_TOTAL_BYTES, listed_turbidities, violations},
    tree,
};
use std::collections::BTreeMap;

/// Packs of other kinds, which whoever runs the program made for himself; git does not keep them either.
fn is_own(name: &str) -> bool {
    let is_shipped = name.starts_with("turbidity-2.50-multiple-clouds-1500.");
    name.contains("-single.") || name.contains("-clouds-") && !is_shipped || name.ends_with(".partial")
}

fn entries() -> BTreeMap<String, Entry> {
    let folder = tree::root().join("precomputed");
    std::fs::read_dir(&folder)
        .unwrap()
        .map(Result::unwrap)
        .map(|entry| (entry.file_name().into_string().unwrap(), entry))
        .filter(|(name, _)| !is_own(name))
        .map(|(name, entry)| {
            let text = name.ends_with(".json").then(|| std::fs::read_to_string(entry.path()).unwrap());
            (name, Entry { bytes: entry.metadata().unwrap().len(), text })
        })
        .collect()
}

fn listed() -> Vec<f64> {
    listed_turbidities(&tree::text("precomputed/turbidities.txt")).unwrap()
}

/// Every precomputed file has a manifest, and all stay within 150 megabytes.
#[test]
fn precomputed_files_are_listed_and_small() {
    assert_eq!(violations(&entries(), &listed()), Vec::<String>::new());
}

/// Packs of other kinds may lie beside those that come with the project, and git does not keep them.
#[test]
fn git_ignores_packs_of_other_kinds() {
    let kept = tree::text(".gitignore");
    for (name, own) in [
        ("turbidity-2.50-single.skyglow", true),
        ("turbidity-2.50-multiple-clouds-1400.json", true),
        ("turbidity-2.50-multiple-clouds-1500.json", false),
        ("turbidity-2.50-multiple.skyglow", false),
        ("turbidity-2.20-multiple.skyglow", false),
    ] {
        assert_eq!(is_own(name), own, "{name}");
    }
    for pattern in [
        "/precomputed/*-single.*",
        "/precomputed/*-clouds-*",
        "!/precomputed/turbidity-2.50-multiple-clouds-1500.*",
        "/precomputed/.*.partial/",
    ] {
        assert!(kept.lines().any(|line| line == pattern), "{pattern}");
    }
}

/// The listed turbidities cover one and a half to six.
#[test]
fn listed_turbidities_cover_1_5_to_6() {
    let listed = listed();
    assert!(listed.contains(&1.5) && listed.contains(&6.0), "{listed:?}");
    assert!(listed.is_sorted(), "{listed:?}");
    assert_eq!(listed_turbidities("2\nclear\n"), Err("clear".to_owned()));
}

#[test]
fn strays_orphans_and_heavyweights_are_seen() {
    let manifest = |text: &str| Entry { bytes: 100, text: Some(text.to_owned()) };
    let file = |bytes| Entry { bytes, text: None };
    let broken: BTreeMap<String, Entry> = [
        ("README.md".to_owned(), file(1)),
        ("stray.pack".to_owned(), file(MAX_TOTAL_BYTES)),
        ("good.pack".to_owned(), file(1)),
        ("good.json".to_owned(), manifest(r#"{"turbidity": 2.0, "checksum": "aa"}"#)),
        ("odd.pack".to_owned(), file(1)),
        ("odd.json".to_owned(), manifest(r#"{"turbidity": 2.2}"#)),
        ("orphan.json".to_owned(), manifest("not JSON")),
    ]
    .into();
    assert_eq!(
        violations(&broken, &[2.0]),
        [
            format!(
                "{} bytes in all; at most {MAX_TOTAL_BYTES} come with the project",
                MAX_TOTAL_BYTES + 303
            ),
            "odd.json has no checksum".to_owned(),
            "odd.json: turbidity 2.2 is not in turbidities.txt".to_owned(),
            "orphan.json describes a pack that is not there".to_owned(),
            "orphan.json is not JSON".to_owned(),
            "stray.pack has no manifest that rebuilds it".to_owned(),
        ]
    );
}
