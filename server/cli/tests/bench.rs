//! The bench of the built program, over packs made in seconds.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what cannot be set up fails the test")]

mod common;

use common::{skyglow, text};
use skyglow_physics::Turbidity;
use skyglow_tables::{NoProgress, PrecomputeOptions, precompute};

/// A quick bench prints its tables and leaves rows and plots.
#[test]
fn quick_bench_prints_tables_and_writes_files() {
    let folder = tempfile::tempdir().unwrap();
    let (packs, out) = (folder.path().join("packs"), folder.path().join("out"));
    std::fs::create_dir(&packs).unwrap();
    precompute(&PrecomputeOptions::coarse(Turbidity::new(2.0).unwrap()), &packs, &NoProgress).unwrap();
    let arguments = ["bench", "--quick", "--packs", text(&packs), "--out", text(&out)];
    let finished = skyglow(&arguments).expect_status(0);
    for title in ["baselines", "run times", "roofline", "targets", "notes"] {
        assert!(finished.stdout.lines().any(|line| line.starts_with(title)), "{title}: {}", finished.stdout);
    }
    let rows: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("bench.json")).unwrap()).unwrap();
    assert_eq!(rows["quick"], true);
    assert_eq!(rows["packs"][0]["turbidity"], 2.0);
    assert!(rows["run_times"].as_array().unwrap().iter().any(|row| row["executor"] == "cpu"));
    for plot in ["time-against-lights.svg", "time-against-basis.svg"] {
        assert!(std::fs::read_to_string(out.join(plot)).unwrap().starts_with("<svg"), "{plot}");
    }
    // No reference solution was computed, so there is no plot of errors.
    assert!(!out.join("error-against-basis.svg").exists());
}

#[test]
fn a_bench_without_packs_fails_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let failed = skyglow(&["bench", "--quick", "--packs", text(folder.path())]).expect_status(1);
    assert!(failed.stderr.contains("no table packs"), "{}", failed.stderr);
}
