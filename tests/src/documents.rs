//! What the documents promise: commands, files, tests, links and sections of the model that exist.

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
/// rest of the path, and what follows a `#` is an anchor.
pub fn missing_paths<'a>(document: &'a str, root: &Path) -> Vec<&'a str> {
    code_spans(document)
        .into_iter()
        .filter(|span| FOLDERS.iter().any(|folder| span.starts_with(folder)) && !span.contains(' '))
        .filter(|span| !root.join(span.split(['*', '#']).next().unwrap_or(span)).exists())
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

/// Where the model is cited: the page, and an anchor of it.
const CITED: &str = "docs/model.md#";
/// Ways of citing the model that name no section of the page.
const VAGUE: [&str; 3] = ["model, section", "model section", "model.md"];

/// Anchors that a document defines with `<a id="…">`.
pub fn anchors(document: &str) -> Vec<&str> {
    document.split("<a id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// Citations of the model in `files` that name no section which `model` has, as `FILE: CITATION`.
pub fn broken_citations(model: &str, files: &[SourceFile]) -> Vec<String> {
    let anchors = anchors(model);
    let mut broken = Vec::new();
    for file in files {
        for line in file.text.lines() {
            let mut rest = String::new();
            for (place, part) in line.split(CITED).enumerate() {
                let end = if place == 0 { 0 } else { anchor_length(part) };
                if place > 0 && !anchors.contains(&&part[..end]) {
                    broken.push(format!("{}: {CITED}{}", file.path, &part[..end]));
                }
                rest.push_str(&part[end..]);
            }
            if VAGUE.iter().any(|words| rest.contains(words)) {
                broken.push(format!("{}: {}", file.path, line.trim()));
            }
        }
    }
    broken
}

/// Length of the anchor that a text starts with.
fn anchor_length(text: &str) -> usize {
    text.find(|c: char| !c.is_ascii_lowercase() && !c.is_ascii_digit() && c != '-').unwrap_or(text.len())
}

/// Links of a document to files of the project, relative to `folder` below `root`, that lead nowhere; with an anchor, to
/// a heading or an anchor that the file does not have.
pub fn broken_links<'a>(document: &'a str, folder: &Path) -> Vec<&'a str> {
    let targets = document.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let leads_nowhere = |target: &&str| {
        if target.starts_with("http") || target.contains(' ') {
            return false;
        }
        let (path, anchor) = target.split_once('#').unwrap_or((*target, ""));
        let there = if path.is_empty() { document.to_owned() } else { read(&folder.join(path)) };
        let exists = path.is_empty() || folder.join(path).exists();
        !exists || !(anchor.is_empty() || has_anchor(&there, anchor))
    };
    targets.filter(leads_nowhere).collect()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

/// Whether a document has an anchor: one of its own, or that of a heading.
fn has_anchor(document: &str, anchor: &str) -> bool {
    let slug = |heading: &str| -> String {
        let kept = heading.trim().to_lowercase();
        let kept = kept.chars().filter(|c| c.is_alphanumeric() || *c == '-' || *c == ' ' || *c == '_');
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    let headings =
        document.lines().filter(|line| line.starts_with('#')).map(|line| slug(line.trim_start_matches('#')));
    anchors(document).contains(&anchor) || headings.into_iter().any(|heading| heading == anchor)
}
