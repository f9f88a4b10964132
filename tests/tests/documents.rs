//! README.md and ARCHITECTURE.md name commands, files and tests that exist.

use skyglow_tests::{
    documents::{make_targets, missing_paths, missing_targets, missing_tests},
    tree::{root, source_files, text},
};

const DOCUMENTS: [&str; 3] = ["README.md", "ARCHITECTURE.md", "precomputed/README.md"];

#[test]
fn make_commands_of_the_documents_are_in_the_makefile() {
    let makefile = text("Makefile");
    for document in DOCUMENTS {
        assert_eq!(missing_targets(&text(document), &makefile), Vec::<&str>::new(), "{document}");
    }
    let readme = text("README.md");
    assert!(make_targets(&readme).starts_with(&["serve", "test"]), "{:?}", make_targets(&readme));
    assert!(text(".ci/run").contains("make test"));
}

#[test]
fn a_command_that_the_makefile_lacks_is_seen() {
    let document =
        "Run `make serve`, then\n```\nmake tea   # hot\nmake serve\n```\nthen make packs\nof it.\n";
    assert_eq!(make_targets(document), ["serve", "tea"]);
    assert_eq!(missing_targets(document, "serve: build\n\tskyglow serve\n"), ["tea"]);
}

#[test]
fn files_named_in_the_documents_exist() {
    for document in DOCUMENTS {
        assert_eq!(missing_paths(&text(document), &root()), Vec::<&str>::new(), "{document}");
    }
}

#[test]
fn a_file_that_is_gone_is_seen() {
    let document = "Look into `server/physics/src/lib.rs`, `tests/src/*` and `server/gone/src/lib.rs`.";
    assert_eq!(missing_paths(document, &root()), ["server/gone/src/lib.rs"]);
}

#[test]
fn tests_named_in_the_documents_exist() {
    let mut files = source_files("server", &[".rs"]);
    files.extend(source_files("tests", &[".rs"]));
    for document in DOCUMENTS {
        assert_eq!(missing_tests(&text(document), &files), Vec::<&str>::new(), "{document}");
    }
}

#[test]
fn a_test_that_is_gone_is_seen() {
    let files = source_files("tests", &[".rs"]);
    let document = "Kept by `a_test_that_is_gone_is_seen` and `a_test_that_never_was`.";
    assert_eq!(missing_tests(document, &files), ["a_test_that_never_was"]);
}
