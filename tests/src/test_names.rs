//! Rules for tests: short names, as what a test says in full is its doc comment, and no test that no command runs.

use crate::tree::SourceFile;

/// Longest name of a test, characters.
pub const MAX_TEST_NAME: usize = 45;

/// Names of the tests in a file, those in macros too: of functions that follow `#[test]`, or an attribute like
/// `#[tokio::test(…)]`.
pub fn test_names(text: &str) -> Vec<&str> {
    let mut names = Vec::new();
    let mut is_test = false;
    for line in text.lines().map(str::trim_start) {
        is_test |= line.starts_with("#[test]") || line.starts_with("#[tokio::test");
        let Some((before, after)) = line.split_once("fn ").filter(|_| is_test) else { continue };
        let before = before.trim_end();
        if before.is_empty() || before == "async" || before.ends_with(']') {
            names.push(after.split(['(', '<']).next().unwrap_or(after));
            is_test = false;
        }
    }
    names
}

/// Tests with longer names, as path and name.
pub fn violations(files: &[SourceFile]) -> Vec<String> {
    files
        .iter()
        .flat_map(|file| test_names(&file.text).into_iter().map(|name| (&file.path, name)))
        .filter(|(_, name)| name.len() > MAX_TEST_NAME)
        .map(|(path, name)| format!("{path}: {name}: {} characters", name.len()))
        .collect()
}

/// Whether a test may be ignored in the file of a path.
type IsAllowedIn = fn(&str) -> bool;

/// Reasons for which a test may be `#[ignore]`d, each with where: `make test` runs both kinds.
const IGNORED: [(&str, IsAllowedIn); 2] = [
    ("#[ignore = \"slow: `make check` leaves it to `make test`\"]", |path| path.contains("/src/")),
    ("#[ignore = \"needs the folder of real rasters\"]", |path| path.ends_with("/tests/real_rasters.rs")),
];

/// Tests that are ignored for other reasons or elsewhere, as path and line.
pub fn ignored_elsewhere(files: &[SourceFile]) -> Vec<String> {
    let mut found = Vec::new();
    for file in files {
        for (index, line) in file.text.lines().map(str::trim).enumerate() {
            let is_allowed = || IGNORED.iter().any(|(reason, here)| line == *reason && here(&file.path));
            if (line.starts_with("#[ignore") || line.starts_with("#[cfg_attr(") && line.contains("ignore"))
                && !is_allowed()
            {
                found.push(format!("{}:{}: {line}", file.path, index + 1));
            }
        }
    }
    found
}
