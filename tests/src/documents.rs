//! What README.md and ARCHITECTURE.md promise: commands, files and tests that exist.

use crate::tree::SourceFile;
use std::path::Path;

/// Every text between single backticks on one line, outside fenced blocks.
pub fn code_spans(document: &str) -> Vec<&str> {
    let mut fenced = false;
    let mut spans = Vec::new();
    for line in document.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            spans.extend(line.split('`').skip(1).step_by(2));
        }
    }
    spans
}

/// Every `make TARGET` in a document, fenced blocks included, in order, once each. A command starts a line or a
/// code span, and ends it or is followed by a comment.
pub fn make_targets(document: &str) -> Vec<&str> {
    let mut targets: Vec<&str> = Vec::new();
    for line in document.lines() {
        for (start, found) in line.match_indices("make ") {
            let (before, rest) = (&line[..start], &line[start + found.len()..]);
            let end = rest.find(|c: char| !c.is_ascii_lowercase() && c != '-').unwrap_or(rest.len());
            let (target, after) = rest.split_at(end);
            let starts = before.trim().is_empty() || before.ends_with('`');
            let ends = after.is_empty() || after.starts_with('`') || after.trim_start().starts_with('#');
            if starts && ends && !target.is_empty() && !targets.contains(&target) {
                targets.push(target);
            }
        }
    }
    targets
}

/// Targets that `makefile` does not have.
pub fn missing_targets<'a>(document: &'a str, makefile: &str) -> Vec<&'a str> {
    make_targets(document)
        .into_iter()
        .filter(|target| !makefile.lines().any(|line| line.starts_with(&format!("{target}:"))))
        .collect()
}

/// Folders of the project whose files a document may name.
const FOLDERS: [&str; 8] =
    ["server/", "shaders/", "web/", "tests/", "scripts/", "deploy/", "precomputed/", "docs/"];

/// Files and folders that `document` names in backticks and that are not below `root`. A `*` stands for the
/// rest of the path.
pub fn missing_paths<'a>(document: &'a str, root: &Path) -> Vec<&'a str> {
    code_spans(document)
        .into_iter()
        .filter(|span| FOLDERS.iter().any(|folder| span.starts_with(folder)) && !span.contains(' '))
        .filter(|span| !root.join(span.split('*').next().unwrap_or(span)).exists())
        .collect()
}

/// Tests that `document` names (in backticks, with at least three underscores) and that no file defines.
pub fn missing_tests<'a>(document: &'a str, rust_files: &[SourceFile]) -> Vec<&'a str> {
    let is_test_name = |span: &&str| {
        span.matches('_').count() >= 3
            && span.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
    };
    let is_defined = |name: &str| {
        let head = format!("fn {name}(");
        rust_files.iter().any(|file| file.text.contains(&head))
    };
    code_spans(document).into_iter().filter(is_test_name).filter(|name| !is_defined(name)).collect()
}
