//! Parsers of bytes from outside, with what fuzzers start from, what they found, and seeds cut and altered.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

use proptest::{
    prelude::*,
    test_runner::{RngAlgorithm, TestRng, TestRunner},
};
use skyglow_lab::seeds::{smallest_celestial_table, smallest_pack, smallest_raster};
use skyglow_tests::{
    outside::{self, Rules},
    tree::root,
};
use std::path::PathBuf;

fn folder(target: &str) -> PathBuf {
    root().join("tests/fuzz/seeds").join(target)
}

/// What a fuzzer of this name starts from.
fn seeds(target: &str) -> Vec<Vec<u8>> {
    let mut paths: Vec<_> = std::fs::read_dir(folder(target)).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

fn cut_and_altered(target: &str, rules: Rules, cases: u32) {
    let seeds = seeds(target);
    assert!(seeds.len() >= 2, "{target} has {} seeds", seeds.len());
    for seed in &seeds {
        rules(seed);
        rules(&[]);
    }
    let change = (any::<prop::sample::Index>(), any::<prop::sample::Index>(), any::<u8>(), 0..3u8);
    let altered = (0..seeds.len(), prop::collection::vec(change, 1..6)).prop_map(move |(seed, changes)| {
        let mut bytes = seeds[seed].clone();
        for (at, other, value, how) in changes {
            if bytes.is_empty() {
                break;
            }
            let (at, other) = (at.index(bytes.len()), other.index(bytes.len()));
            match how {
                0 => bytes[at] = value,
                1 => bytes.truncate(at),
                _ => {
                    let part = bytes[at.min(other)..at.max(other)].to_vec();
                    bytes.splice(at..at, part);
                }
            }
        }
        bytes
    });
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    // The same each time: chance is the fuzzers' business.
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let run = TestRunner::new_with_rng(config, rng).run(&altered, |bytes| {
        rules(&bytes);
        Ok(())
    });
    run.unwrap();
}

/// Parameters and bodies are accepted or refused, whatever they are.
#[test]
fn any_parameters_and_bodies_are_judged() {
    cut_and_altered("parameters", outside::parameters, 4000);
    cut_and_altered("body", outside::body, 2000);
    cut_and_altered("boundary", outside::boundary, 2000);
}

/// Packs are accepted or refused, whatever they say of themselves.
#[test]
fn any_packs_are_judged() {
    cut_and_altered("pack", outside::pack, 500);
    cut_and_altered("celestial", outside::celestial, 500);
}

/// Rasters and places are accepted or refused, and nothing is left of what was refused.
#[test]
fn any_rasters_and_places_are_judged() {
    cut_and_altered("raster", outside::raster, 300);
    cut_and_altered("places", outside::places, 200);
}

/// What fuzzers start from is what is accepted today.
#[test]
fn fuzzing_seeds_are_accepted_today() {
    let whole = seeds("pack").into_iter().find(|seed| *seed == smallest_pack());
    let write = "write it again with `cargo run --release -p skyglow-lab -- seeds`";
    assert!(whole.is_some(), "no seed is the smallest pack of this format: {write}");
    assert!(seeds("raster").contains(&smallest_raster()), "{write}");
    let table = smallest_celestial_table();
    assert!(seeds("celestial").contains(&table), "{write}");
    let table = [&table[..], blake3::hash(&table).as_bytes()].concat();
    assert_eq!(skyglow_tables::CelestialTable::from_bytes(&table).unwrap().zenith_angle_rad().len(), 2);
    let body = [smallest_pack(), blake3::hash(&smallest_pack()).as_bytes().to_vec()].concat();
    let pack = skyglow_tables::pack::Pack::from_bytes(&body).unwrap();
    assert_eq!(pack.manifest().basis_count, 1);
}

#[test]
fn every_rule_has_its_fuzzer_and_its_seeds() {
    for (name, _) in outside::ALL {
        let source = root().join("tests/fuzz/fuzz_targets").join(name).with_extension("rs");
        let text = std::fs::read_to_string(source).unwrap();
        assert!(text.contains(&format!("outside::{name}(")), "{name}");
        assert!(folder(name).is_dir());
        let read = |path: &str| std::fs::read_to_string(root().join(path)).unwrap();
        assert!(read("tests/fuzz/Cargo.toml").contains(&format!("name = \"{name}\"")), "{name}");
        let script = read("scripts/fuzz.sh");
        let targets = script.lines().find(|line| line.contains("|| set -- ")).unwrap();
        assert!(targets.split_whitespace().any(|word| word == name), "{name}");
    }
}

/// Packs that lie about their sizes: what is said is looked at before room is made for it.
#[test]
fn a_huge_pack_is_refused_before_allocation() {
    let small = smallest_pack();
    let text = String::from_utf8_lossy(&small).into_owned();
    let start = 16;
    let length = u64::from_le_bytes(small[8..start].try_into().unwrap()) as usize;
    let manifest: serde_json::Value = serde_json::from_slice(&small[start..start + length]).unwrap();
    assert!(text.contains("\"offset_count\":3"));
    let said = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut other = manifest.clone();
        change(&mut other);
        let other = other.to_string();
        let mut content = small[..8].to_vec();
        content.extend((other.len() as u64).to_le_bytes());
        content.extend(other.as_bytes());
        content.extend(&small[start + length..]);
        content.extend(*blake3::hash(&content).as_bytes());
        skyglow_tables::pack::Pack::from_bytes(&content).map(|_| ()).unwrap_err()
    };
    assert!(
        said(&|m| m["axes"]["offset_count"] = 1_000_000_000_000_u64.into()).contains("longer than it can be")
    );
    assert!(said(&|m| m["axes"]["offset_count"] = 0.into()).contains("is empty"));
    assert!(
        said(&|m| {
            m["axes"]["offset_count"] = 4096.into();
            m["axes"]["distance_m"] = (1..=4096).collect::<Vec<u32>>().into();
            m["axes"]["observer_altitude_m"] = vec![0.0, 1.0, 2.0].into();
        })
        .contains("larger than a section can be")
    );
    assert!(said(&|m| m["basis_count"] = 4096.into()).contains("too few for"));
    assert!(said(&|m| m["axes"]["offset_count"] = 4.into()).contains("bytes instead of"));
    assert!(
        said(&|m| m["axes"]["distance_m"] = serde_json::json!([-5.0])).contains("distances that are none")
    );
    assert!(said(&|m| m["axes"]["distance_m"] = serde_json::json!([500.0, 250.0])).contains("does not rise"));
}
