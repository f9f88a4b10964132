//! The arrows between the crates and the absences that ARCHITECTURE.md states.

use skyglow_tests::{
    absences::{self, ABSENCES},
    arrows::{self, Dependency},
    tree::{SourceFile, source_files},
};

#[test]
fn crates_use_only_what_lies_below_them() {
    assert_eq!(arrows::violations(&arrows::workspace_dependencies()), Vec::<String>::new());
}

#[test]
fn an_arrow_that_points_the_wrong_way_is_seen() {
    let real = arrows::workspace_dependencies();
    for (package, dependency, words) in [
        ("skyglow-tables", "skyglow-scene", "skyglow-tables must not use skyglow-scene"),
        ("skyglow-scene", "skyglow-tables", "skyglow-scene must not use skyglow-tables"),
        ("skyglow-physics", "skyglow-engine", "skyglow-physics must not use skyglow-engine"),
        ("skyglow-engine", "skyglow-http", "skyglow-engine must not use skyglow-http"),
        ("skyglow-display", "skyglow-engine", "skyglow-display must not use skyglow-engine"),
        ("skyglow-bench", "skyglow-http", "skyglow-bench must not use skyglow-http"),
        ("skyglow-engine", "skyglow-bench", "skyglow-engine must not use skyglow-bench"),
        ("skyglow-display", "wgpu", "wgpu belongs to skyglow-engine alone, not to skyglow-display"),
        ("skyglow", "axum", "axum belongs to skyglow-http alone, not to skyglow"),
        ("skyglow-tests", "gdal", "gdal belongs to skyglow-scene alone, not to skyglow-tests"),
    ] {
        let mut broken = real.clone();
        broken.entry(package.to_owned()).or_default().push(Dependency::shipped(dependency));
        assert!(arrows::violations(&broken).contains(&words.to_owned()), "{package} -> {dependency}");
    }
}

#[test]
fn a_crate_without_a_place_or_gone_from_the_workspace_is_seen() {
    let mut broken = arrows::workspace_dependencies();
    broken.insert("skyglow-helpers".to_owned(), Vec::new());
    broken.remove("skyglow-display");
    assert_eq!(
        arrows::violations(&broken),
        ["skyglow-helpers has no place in the arrows", "skyglow-display is missing from the workspace"]
    );
}

#[test]
fn words_that_must_be_absent_are_absent() {
    let mut files = source_files("server", &[".rs"]);
    files.extend(source_files("shaders", &[".wgsl"]));
    assert_eq!(absences::violations(&files, ABSENCES), Vec::<String>::new());
}

#[test]
fn each_absence_is_seen_when_it_is_broken() {
    for absence in ABSENCES {
        for within in absence.within {
            let folder = if *within == "server/" { "server/cli/src/" } else { within };
            let intruder = SourceFile {
                path: format!("{folder}intruder.rs"),
                text: format!("fine\n    let x = \"{}\";\n", absence.word),
            };
            let found = absences::violations(&[intruder], ABSENCES);
            assert!(
                found.iter().any(|line| line.starts_with(&format!("{folder}intruder.rs:2:"))),
                "{absence:?}: {found:?}"
            );
        }
    }
}

#[test]
fn a_word_in_its_own_home_is_no_violation() {
    for absence in ABSENCES {
        for home in absence.except {
            let resident = SourceFile { path: format!("{home}/resident.rs"), text: absence.word.to_owned() };
            assert_eq!(absences::violations(&[resident], &[*absence]), Vec::<String>::new());
        }
    }
}
