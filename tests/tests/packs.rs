//! Nothing lies in precomputed/ without a manifest that rebuilds it.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what cannot be set up fails the test")]

use serde_json::Value;
use skyglow_tests::{
    packs::{Entry, MAX_TOTAL_BYTES, listed_turbidities, violations},
    tree,
};
use std::collections::BTreeMap;

/// Bases of the overcast skies that come with the project, metres.
const CLOUD_BASES_M: [u32; 3] = [800, 1_500, 3_000];

/// Packs of other kinds, which whoever runs the program made for himself; git does not keep them either.
fn is_own(name: &str) -> bool {
    let of_base = |base_m: u32| name.starts_with(&format!("turbidity-2.50-multiple-clouds-{base_m}."));
    let is_shipped = CLOUD_BASES_M.into_iter().any(of_base);
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
        ("turbidity-2.50-multiple-clouds-300.json", true),
        ("turbidity-2.50-multiple-clouds-3000.skyglow", false),
        ("turbidity-2.50-multiple.skyglow", false),
        ("turbidity-2.20-multiple.skyglow", false),
    ] {
        assert_eq!(is_own(name), own, "{name}");
    }
    let overcast =
        CLOUD_BASES_M.map(|base_m| format!("!/precomputed/turbidity-2.50-multiple-clouds-{base_m}.*"));
    let others = ["/precomputed/*-single.*", "/precomputed/*-clouds-*", "/precomputed/.*.partial/"];
    for pattern in overcast.iter().map(String::as_str).chain(others) {
        assert!(kept.lines().any(|line| line == pattern), "{pattern}");
    }
}

/// Overcast skies of every base come with the project, with axes alike.
#[test]
fn overcast_skies_of_three_bases_come_along() {
    let entries = entries();
    let manifest = |base_m: u32| -> Value {
        let name = format!("turbidity-2.50-multiple-clouds-{base_m}.json");
        serde_json::from_str(entries[&name].text.as_ref().unwrap()).unwrap()
    };
    let first = manifest(CLOUD_BASES_M[0]);
    for base_m in CLOUD_BASES_M {
        let manifest = manifest(base_m);
        assert_eq!(manifest["clouds"]["base_m"], base_m);
        for alike in ["basis_count", "ground_albedo", "scattering"] {
            assert_eq!(manifest[alike], first[alike], "{base_m} {alike}");
        }
        assert_eq!(manifest["axes"]["distance_m"], first["axes"]["distance_m"], "{base_m}");
    }
    let bases_m = CLOUD_BASES_M.map(|base_m| base_m.to_string()).join(" ");
    let made = tree::text("scripts/make_packs.sh");
    assert!(made.contains(&format!("for base_m in {bases_m}; do")), "{made}");
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
