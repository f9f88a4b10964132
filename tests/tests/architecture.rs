//! The layering of the crates, the imports within them, the words that ARCHITECTURE.md forbids, and the names of
//! tests.

use skyglow_tests::{
    cycles,
    forbidden_words::{self, FORBIDDEN_WORDS},
    layering::{self, Dependency},
    test_names,
    tree::{SourceFile, source_files, text},
};

#[test]
fn crates_use_only_what_lies_below_them() {
    assert_eq!(layering::violations(&layering::workspace_dependencies()), Vec::<String>::new());
}

#[test]
fn a_dependency_upwards_is_seen() {
    let real = layering::workspace_dependencies();
    for (package, dependency, words) in [
        ("skyglow-tables", "skyglow-scene", "skyglow-tables must not use skyglow-scene"),
        ("skyglow-scene", "skyglow-tables", "skyglow-scene must not use skyglow-tables"),
        ("skyglow-physics", "skyglow-render", "skyglow-physics must not use skyglow-render"),
        ("skyglow-render", "skyglow-http", "skyglow-render must not use skyglow-http"),
        ("skyglow-display", "skyglow-render", "skyglow-display must not use skyglow-render"),
        ("skyglow-celestial", "skyglow-tables", "skyglow-celestial must not use skyglow-tables"),
        ("skyglow-render", "skyglow-celestial", "skyglow-render must not use skyglow-celestial"),
        ("skyglow-bench", "skyglow-http", "skyglow-bench must not use skyglow-http"),
        ("skyglow-render", "skyglow-bench", "skyglow-render must not use skyglow-bench"),
        ("skyglow", "skyglow-lab", "skyglow must not use skyglow-lab"),
        ("skyglow-display", "wgpu", "wgpu belongs to skyglow-render alone, not to skyglow-display"),
        ("skyglow", "axum", "axum belongs to skyglow-http alone, not to skyglow"),
        ("skyglow-scene", "object_store", "object_store belongs to skyglow-http alone, not to skyglow-scene"),
        ("skyglow-tests", "gdal", "gdal belongs to skyglow-scene alone, not to skyglow-tests"),
    ] {
        let mut broken = real.clone();
        broken.entry(package.to_owned()).or_default().push(Dependency::shipped(dependency));
        assert!(layering::violations(&broken).contains(&words.to_owned()), "{package} -> {dependency}");
    }
}

/// A crate without a place in the layering, or gone from the workspace, is seen.
#[test]
fn an_unlisted_or_missing_crate_is_seen() {
    let mut broken = layering::workspace_dependencies();
    broken.insert("skyglow-helpers".to_owned(), Vec::new());
    broken.remove("skyglow-display");
    assert_eq!(
        layering::violations(&broken),
        ["skyglow-helpers has no place in the layering", "skyglow-display is missing from the workspace"]
    );
}

#[test]
fn forbidden_words_do_not_occur() {
    let mut files = source_files("server", &[".rs"]);
    files.extend(source_files("shaders", &[".wgsl"]));
    assert_eq!(forbidden_words::violations(&files, FORBIDDEN_WORDS), Vec::<String>::new());
}

#[test]
fn each_forbidden_word_is_seen() {
    for forbidden in FORBIDDEN_WORDS {
        for within in forbidden.within {
            let folder = if *within == "server/" { "server/cli/src/" } else { within };
            let intruder = SourceFile {
                path: format!("{folder}intruder.rs"),
                text: format!("fine\n    let x = \"{}\";\n", forbidden.word),
            };
            let found = forbidden_words::violations(&[intruder], FORBIDDEN_WORDS);
            assert!(
                found.iter().any(|line| line.starts_with(&format!("{folder}intruder.rs:2:"))),
                "{forbidden:?}: {found:?}"
            );
        }
    }
}

#[test]
fn a_word_in_its_own_home_is_no_violation() {
    for forbidden in FORBIDDEN_WORDS {
        for home in forbidden.except {
            let resident =
                SourceFile { path: format!("{home}/resident.rs"), text: forbidden.word.to_owned() };
            assert_eq!(forbidden_words::violations(&[resident], &[*forbidden]), Vec::<String>::new());
        }
    }
}

/// Crates whose files may still import each other in cycles, by folder, with the number of groups. It only shrinks.
const CYCLES_LEFT: &[(&str, usize)] = &[];

/// The files of a crate import each other without cycles, but for the groups that are left.
#[test]
fn files_have_no_import_cycles() {
    let mut files = source_files("server", &[".rs"]);
    files.extend(source_files("tests", &[".rs"]));
    for (folder, groups) in cycles::cycles(&files) {
        println!("{folder}: {} cycles {groups:#?}", groups.len());
    }
    assert_eq!(cycles::violations(&files, CYCLES_LEFT), Vec::<String>::new());
}

/// The cycles of a crate made of these files.
fn cycles_of(files: &[(&str, &str)]) -> Vec<Vec<String>> {
    let file =
        |(path, text): &(&str, &str)| SourceFile { path: format!("x/{path}"), text: (*text).to_owned() };
    let files: Vec<SourceFile> = files.iter().map(file).collect();
    cycles::cycles(&files).remove("x").unwrap_or_default()
}

/// Nested braces, `super::`, inline paths, macros and names re-exported at the root all close a cycle.
#[test]
fn an_import_cycle_is_seen() {
    let root = ("lib.rs", "mod a; mod b; mod c; pub use a::A; pub fn own() {}");
    let (a, b) = (("a.rs", "use crate::b::{self, B};"), ("b/mod.rs", "use super::{c::{C, D}, own};"));
    let all = vec![vec!["x/a.rs".to_owned(), "x/b/mod.rs".to_owned(), "x/c.rs".to_owned()]];
    for c in ["fn f() { crate::a::g::<u8>() }", "use crate::A;", "fn f() { g!(1, super::a::X as u8) }"] {
        assert_eq!(cycles_of(&[root, a, b, ("c.rs", c)]), all, "{c}");
    }
    assert_eq!(
        cycles_of(&[root, a, b, ("c.rs", "use crate::own; use other::a::A;")]),
        Vec::<Vec<String>>::new()
    );
    let child = ("p/q.rs", "use super::P;");
    let parent = "mod q; pub use q::Q; pub struct P; fn f() -> Q {}";
    assert_eq!(cycles_of(&[("lib.rs", "mod p;"), ("p.rs", parent), child]), [["x/p.rs", "x/p/q.rs"]]);
}

/// Declared and re-exported children, tests and their files close none.
#[test]
fn what_is_no_import_cycle_is_none() {
    let root = ("lib.rs", "pub mod a; pub mod b; pub use a::A;");
    let tests = "#[cfg(test)] use crate::a::A; #[cfg(test)] mod tests; \
        #[cfg(test)] #[path = \"b_tests.rs\"] mod more; #[cfg(test)] mod inner { use crate::a::{A, X}; }";
    let (a, b) = (("a.rs", "use crate::b::B; pub struct A;"), ("b.rs", tests));
    let files =
        [root, a, b, ("b/tests.rs", "use super::B; use crate::a::A;"), ("b_tests.rs", "use crate::a::A;")];
    assert_eq!(cycles_of(&files), Vec::<Vec<String>>::new());
    let parent = ("p/mod.rs", "mod q; pub use q::Q; pub struct P;");
    assert_eq!(
        cycles_of(&[("lib.rs", "mod p;"), parent, ("p/q.rs", "use super::P;")]),
        Vec::<Vec<String>>::new()
    );
}

/// A name says what is tested; the sentence is the doc comment.
#[test]
fn names_of_tests_are_short() {
    let mut files = source_files("server", &[".rs"]);
    files.extend(source_files("tests", &[".rs"]));
    assert_eq!(test_names::violations(&files), Vec::<String>::new());
}

/// Of plain, asynchronous and generated tests; other functions may be called what they like.
#[test]
fn a_long_name_of_a_test_is_seen() {
    let long = "x".repeat(46);
    let other = format!("fn {long}() {{}}\n#[test]\nfn short() {{ fn {long}() {{}} }}\n");
    for (attribute, head) in [
        ("#[test]\n", "fn "),
        ("#[tokio::test(flavor = \"multi_thread\")]\n", "async fn "),
        ("#[test]\n#[ignore = \"fn of it\"]\n", "fn "),
        ("#[test] ", "fn "),
    ] {
        let text = format!("{other}{attribute}    {head}{long}(x in 0..3) {{}}\n");
        assert_eq!(test_names::test_names(&text), ["short", &long], "{text}");
        let file = SourceFile { path: "a/b.rs".to_owned(), text };
        assert_eq!(test_names::violations(&[file]), [format!("a/b.rs: {long}: 46 characters")]);
    }
}

/// A test that is ignored is one that `make test` runs in a part of its own.
#[test]
fn no_test_is_left_out_of_make_test() {
    let mut files = source_files("server", &[".rs"]);
    files.extend(source_files("tests", &[".rs"]));
    assert_eq!(test_names::ignored_elsewhere(&files), Vec::<String>::new());
    let script = text("scripts/test.sh");
    assert!(script.contains("--lib --bins -- --include-ignored"));
    assert!(script.contains("--test real_rasters -- --ignored"));
}

/// Without a reason, for another one, and elsewhere.
#[test]
fn a_test_left_out_of_make_test_is_seen() {
    let slow = "#[ignore = \"slow: `make check` leaves it to `make test`\"]";
    for (path, line, count) in [
        ("a/src/b.rs", slow, 0),
        ("a/tests/b.rs", slow, 1),
        ("a/src/b.rs", "#[ignore]", 1),
        ("a/src/b.rs", "#[ignore = \"flaky\"]", 1),
        ("a/src/b.rs", "#[cfg_attr(windows, ignore)]", 1),
    ] {
        let file = SourceFile { path: path.to_owned(), text: format!("#[test]\n    {line}\nfn f() {{}}") };
        assert_eq!(test_names::ignored_elsewhere(&[file]).len(), count, "{path} {line}");
    }
}
