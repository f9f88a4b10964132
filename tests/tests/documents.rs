//! The documents name commands, files, tests, links and sections of the model that exist, and stay short.

use skyglow_tests::{
    documents::{
        broken_citations, broken_links, make_targets, missing_paths, missing_targets, missing_tests,
    },
    tree::{SourceFile, root, source_files, text},
};

/// All but the notebook, which tells of commands and files as they were.
const DOCUMENTS: [&str; 17] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "docs/accuracy.md",
    "docs/data.md",
    "docs/glossary.md",
    "docs/guide.md",
    "docs/measurements.md",
    "docs/model.md",
    "docs/security.md",
    "docs/standards.md",
    "deploy/README.md",
    "precomputed/README.md",
    "python/README.md",
    "python/engine/README.md",
    "qgis/README.md",
];

/// Commands of `make` in the documents are in the Makefile.
#[test]
fn documented_make_commands_exist() {
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

/// A newcomer reads these two first.
#[test]
fn the_first_two_pages_are_short() {
    assert!(text("README.md").len() <= 8 * 1024);
    assert!(text("ARCHITECTURE.md").len() <= 15 * 1024);
}

#[test]
fn links_lead_somewhere() {
    let notebook = source_files("docs/notebook", &[".md"]).into_iter().map(|file| file.path);
    for document in DOCUMENTS.map(str::to_owned).into_iter().chain(notebook) {
        let page = root().join(&document);
        let folder = page.parent().unwrap_or(&page).to_owned();
        assert_eq!(broken_links(&text(&document), &folder), Vec::<&str>::new(), "{document}");
    }
}

#[test]
fn a_link_to_nowhere_is_seen() {
    let document =
        "# Top it\n[a](README.md) [b](gone.md) [c](#top-it) [d](#bottom) [e](https://example.org/)";
    assert_eq!(broken_links(document, &root()), ["gone.md", "#bottom"]);
}

/// Code cites the model as `docs/model.md#` and an anchor.
#[test]
fn cited_sections_of_the_model_exist() {
    let mut files = source_files("server", &[".rs"]);
    files.extend(source_files("shaders", &[".wgsl"]));
    files.extend(source_files("web/src", &[".ts"]));
    files.extend(
        source_files("tests", &[".rs"]).into_iter().filter(|file| !file.path.ends_with("/documents.rs")),
    );
    let cited = files.iter().filter(|file| file.text.contains("docs/model.md#")).count();
    assert!(cited > 20, "{cited} files");
    assert_eq!(broken_citations(&text("docs/model.md"), &files), Vec::<String>::new());
}

#[test]
fn a_citation_of_nothing_is_seen() {
    let model = "<a id=\"geometry\"></a>\n## 1. Geometry\n";
    let of = |text: &str| {
        let file = SourceFile { path: "a.rs".to_owned(), text: text.to_owned() };
        broken_citations(model, &[file]).len()
    };
    assert_eq!(of("//! See `docs/model.md#geometry`.\n"), 0);
    assert_eq!(of("//! See `docs/model.md#geometry-of-old`, `docs/model.md#geometry`.\n"), 1);
    assert_eq!(of("//! As the model, section 4, has it.\n//! (`docs/model.md`)\n"), 2);
}
