//! Exit status, streams and help of the built program.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what cannot be set up fails the test")]

mod common;

use common::{command, skyglow, text};
use std::process::Stdio;

#[test]
fn help_and_version_succeed_on_standard_output() {
    let help = skyglow(&["--help"]).expect_status(0);
    for name in [
        "serve",
        "ingest",
        "scenes",
        "precompute",
        "packs",
        "panorama",
        "sky",
        "night",
        "influence",
        "plan",
        "scenario",
        "atlas",
        "reference",
        "bench",
        "config",
    ] {
        assert!(
            help.stdout.lines().any(|line| line.trim_start().starts_with(name)),
            "{name}: {}",
            help.stdout
        );
        let own = skyglow(&[name, "--help"]).expect_status(0);
        assert!(own.stdout.contains("Example"), "{name}");
        assert_eq!(own.stderr, "");
    }
    let long = skyglow(&["--version"]).expect_status(0).stdout;
    assert!(
        long.starts_with("skyglow ") && long.contains("packs: format ") && long.contains("model "),
        "{long}"
    );
    assert_eq!(skyglow(&["-V"]).expect_status(0).stdout.lines().count(), 1);
}

/// A night is found without scenes and packs; a date that is none is wrong usage.
#[test]
fn a_night_needs_no_scene() {
    let at = |date: &'static str| ["night", "--lat", "46.17", "--lon", "8.79", "--date", date];
    let night = skyglow(&[&at("2026-08-12")[..], &["--json"]].concat()).expect_status(0).json();
    assert!(night["dark_hours"].as_f64().unwrap() > 4.0, "{night}");
    let said = skyglow(&at("2026-08-12")).expect_status(0).stdout;
    assert!(said.contains("astronomical twilight") && said.contains("Moon rises"), "{said}");
    assert!(skyglow(&at("today")).expect_status(2).stderr.contains("date"));
}

/// Wrong usage is status 2, and standard error says why.
#[test]
fn wrong_usage_is_status_2() {
    let wrong: &[&[&str]] = &[
        &[],
        &["fly"],
        &["serve", "--lisen", "127.0.0.1:1"],
        &["serve", "--listen", "here"],
        &["serve", "--device", "tpu"],
        &["ingest"],
        &["precompute"],
        &["precompute", "--turbidity", "clear"],
        &["precompute", "--turbidity", "2", "--scattering", "double"],
        &["precompute", "--turbidity", "2", "--ground-albedo", "1.5"],
        &["precompute", "--turbidity", "2", "--scattering", "single", "--ground-albedo", "0.3"],
        &["sky", "--scene", "demo", "--lat", "46", "--lon", "8", "--scattering", "double"],
        &["reference", "--scene", "demo", "--lat", "46", "--lon", "8", "--ground-albedo", "1.5"],
        &[
            "reference",
            "--scene",
            "demo",
            "--lat",
            "46",
            "--lon",
            "8",
            "--scattering",
            "single",
            "--ground-albedo",
            "0.3",
        ],
        &["sky", "--scene", "demo", "--lat", "46"],
        &["sky", "--scene", "demo", "--lat", "146", "--lon", "8"],
        &["sky", "--scene", "Demo!", "--lat", "46", "--lon", "8"],
        &["sky", "--scene", "demo", "--lat", "46", "--lon", "8", "--turbidity", "0"],
        &["sky", "--scene", "demo", "--lat", "46", "--lon", "8", "--lamp", "candle"],
        &["sky", "--scene", "demo", "--lat", "46", "--lon", "8", "--emission", "upwards"],
        &["sky", "--scene", "demo", "--lat", "46", "--lon", "8", "--height", "2", "--altitude", "900"],
        &["reference", "--scene", "demo", "--lat", "46", "--lon", "8", "--basis", "16"],
        &["panorama", "--scene", "demo", "--lat", "46", "--lon", "8"],
        &["panorama", "--scene", "demo", "--lat", "46", "--lon", "8", "-o", "sky.gif"],
        &[
            "panorama",
            "--scene",
            "demo",
            "--lat",
            "46",
            "--lon",
            "8",
            "-o",
            "sky.exr",
            "--style",
            "realistic",
        ],
    ];
    for arguments in wrong {
        let finished = skyglow(arguments).expect_status(2);
        assert_eq!(finished.stdout, "", "{arguments:?}");
        assert!(!finished.stderr.is_empty(), "{arguments:?}");
    }
}

/// A refused turbidity or basis names what the packs serve.
#[test]
fn refusals_name_what_the_packs_serve() {
    for (flag, value, allowed) in [
        ("--turbidity", "10", "1.5 to 6"),
        ("--turbidity", "1", "1.5 to 6"),
        ("--basis", "500", "from 1 to 112"),
    ] {
        let asked = ["sky", "--scene", "demo", "--lat", "46", "--lon", "8", flag, value];
        let refused = skyglow(&asked).expect_status(2);
        assert!(refused.stderr.contains(allowed), "{flag} {value}: {}", refused.stderr);
    }
}

/// Failed work is status 1, with one line that says why.
#[test]
fn failed_work_is_status_1() {
    let folder = tempfile::tempdir().unwrap();
    let data = text(folder.path());
    let nowhere = text(&folder.path().join("nowhere")).to_owned();
    let failing: &[(&[&str], &str)] = &[
        (&["ingest", &nowhere, "--data", data], "nowhere"),
        (&["packs", "--packs", &nowhere], "nowhere"),
        (&["config", "check", "--config", &nowhere], "nowhere"),
    ];
    for (arguments, reason) in failing {
        let finished = skyglow(arguments).expect_status(1);
        assert_eq!(finished.stdout, "", "{arguments:?}");
        let said: Vec<&str> = finished.stderr.lines().filter(|line| line.starts_with("skyglow: ")).collect();
        assert_eq!(said.len(), 1, "{arguments:?}: {}", finished.stderr);
        assert!(said[0].contains(reason), "{arguments:?}: {}", said[0]);
    }
}

/// A pack that was cut is listed as damaged by its name, with status 1.
#[test]
fn a_cut_pack_is_listed_as_damaged() {
    let precomputed = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../precomputed"));
    let folder = tempfile::tempdir().unwrap();
    // Whichever kind of packs comes with the program.
    let shipped = skyglow_tables::packs_in(precomputed).unwrap();
    let [whole, damaged] = [&shipped[0], &shipped[1]].map(|pack| pack.file_stem().unwrap().to_str().unwrap());
    for name in [whole, damaged] {
        for extension in ["skyglow", "json"] {
            let file = format!("{name}.{extension}");
            std::fs::copy(precomputed.join(&file), folder.path().join(&file)).unwrap();
        }
    }
    let packs = text(folder.path());
    let listed = skyglow(&["packs", "--packs", packs, "--json"]).expect_status(0).json();
    let table = skyglow(&["packs", "--packs", packs]).expect_status(0).stdout;
    for pack in listed.as_array().unwrap() {
        let scattering = pack["scattering"].as_str().unwrap();
        assert!(
            table.lines().skip(1).any(|line| line.split_whitespace().any(|w| w == scattering)),
            "{table}"
        );
    }
    let cut = folder.path().join(format!("{damaged}.skyglow"));
    let bytes = std::fs::read(&cut).unwrap();
    std::fs::write(&cut, &bytes[..bytes.len() - 1000]).unwrap();
    for command in [&["packs"][..], &["packs", "verify"]] {
        let listed = skyglow(&[command, &["--packs", packs]].concat()).expect_status(1);
        let line = |name: &str| listed.stdout.lines().find(|line| line.starts_with(name)).unwrap_or_default();
        assert!(line(damaged).contains("damaged"), "{}", listed.stdout);
        assert!(line(whole).contains("1.5"), "{}", listed.stdout);
        assert!(listed.stderr.contains(&format!("{damaged}.skyglow")), "{}", listed.stderr);
    }
}

#[test]
fn an_empty_data_folder_has_no_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let finished = skyglow(&["scenes", "--json", "--data", text(folder.path())]).expect_status(0);
    assert_eq!(finished.json(), serde_json::json!([]));
}

/// File, environment and flags are layered in that order.
#[test]
fn flags_override_environment_overrides_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("skyglow.toml");
    std::fs::write(&file, "listen = \"127.0.0.1:9001\"\ndevice = \"gpu\"\ndata = \"/from/file\"\n").unwrap();
    let output = command()
        .args(["config", "print", "--json", "--config", text(&file), "--data", "/from/flag"])
        .env("SKYGLOW_DEVICE", "cpu")
        .env("SKYGLOW_DATA", "/from/environment")
        .stderr(Stdio::inherit())
        .output()
        .unwrap();
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(printed["listen"], "127.0.0.1:9001");
    assert_eq!(printed["device"], "cpu");
    assert_eq!(printed["data"], "/from/flag");
}

/// Config check names the line and schema is json.
#[test]
fn config_check_names_line_and_schema_is_json() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("skyglow.toml");
    std::fs::write(&file, "device = \"cpu\"\nlisen = \"127.0.0.1:1\"\n").unwrap();
    let refused = skyglow(&["config", "check", "--config", text(&file)]).expect_status(1);
    assert!(refused.stderr.contains("skyglow.toml:2: unknown field `lisen`"), "{}", refused.stderr);
    std::fs::write(&file, "device = \"cpu\"\n").unwrap();
    skyglow(&["config", "check", "--config", text(&file)]).expect_status(0);
    assert_eq!(skyglow(&["config", "schema"]).expect_status(0).json()["type"], "object");
}
