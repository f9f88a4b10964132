//! Import cycles between the files of a crate: the strongly connected components of its import graph.
//!
//! An edge goes from a file to the file that defines what it names: by `use`, by a path in its code, within macros too.
//! Names are followed through re-exports to their definition, so importing `crate::Panorama` points to `panorama.rs`, not
//! to `lib.rs`. No edge comes from `mod child;`, nor from a re-export whose name the file itself does not use. Code and
//! files behind `#[cfg(test)]` are left out. What no path names (a method called on a value) is not seen.

use crate::{
    imports::{ItemPath, Module},
    tree::SourceFile,
};
use std::collections::{BTreeMap, BTreeSet};

/// Groups of files that import each other, of each crate among `files` (`…/src/lib.rs` or `…/src/main.rs` with the files
/// beside and below), by the folder of its root file. Crates without cycles have an empty list.
///
/// # Panics
/// Where a file is not Rust.
pub fn cycles(files: &[SourceFile]) -> BTreeMap<String, Vec<Vec<String>>> {
    let is_root = |file: &&SourceFile| ["/lib.rs", "/main.rs"].iter().any(|end| file.path.ends_with(end));
    let folder_of = |file: &SourceFile| file.path[..file.path.rfind('/').unwrap_or(0)].to_owned();
    let crates: BTreeSet<String> = files.iter().filter(is_root).map(folder_of).collect();
    crates.into_iter().map(|folder| (folder.clone(), cycles_of(&folder, files))).collect()
}

/// What goes beyond the number of groups that a crate may have, each as one line; 0 for crates that are not listed.
pub fn violations(files: &[SourceFile], allowed: &[(&str, usize)]) -> Vec<String> {
    let mut found = Vec::new();
    for (folder, groups) in cycles(files) {
        let limit = allowed.iter().find(|(name, _)| *name == folder).map_or(0, |(_, limit)| *limit);
        if groups.len() > limit {
            found.push(format!("{folder}: {} cycles, {limit} allowed: {groups:?}", groups.len()));
        }
    }
    found
}

fn cycles_of(folder: &str, files: &[SourceFile]) -> Vec<Vec<String>> {
    let prefix = format!("{folder}/");
    let modules: Vec<Module> = files
        .iter()
        .filter_map(|file| Some((file, file.path.strip_prefix(&prefix)?)))
        .map(|(file, inside)| Module::read(file, module_path(inside)))
        .collect();
    let tests: Vec<&ItemPath> = modules.iter().flat_map(|module| &module.test_modules).collect();
    let test_files: BTreeSet<&String> = modules.iter().flat_map(|module| &module.test_files).collect();
    let modules: BTreeMap<&ItemPath, &Module> = modules
        .iter()
        .filter(|module| !test_files.contains(&module.file))
        .filter(|module| !tests.iter().any(|test| module.path.starts_with(test)))
        .map(|module| (&module.path, module))
        .collect();
    let edges: BTreeMap<&str, BTreeSet<&str>> =
        modules.values().map(|module| (module.file.as_str(), targets(module, &modules))).collect();
    components(&edges)
}

/// The path of the module that a file is, from its place below the root file's folder.
fn module_path(inside: &str) -> ItemPath {
    let stem = inside.trim_end_matches(".rs");
    let stem = stem.strip_suffix("/mod").unwrap_or(stem);
    if ["lib", "main"].contains(&stem) { Vec::new() } else { stem.split('/').map(str::to_owned).collect() }
}

/// Files that a module names something of, without itself.
fn targets<'a>(module: &Module, modules: &BTreeMap<&ItemPath, &'a Module>) -> BTreeSet<&'a str> {
    let used = |name: &String| module.identifiers.get(name).is_some_and(|count| *count > 1);
    let re_exports = module.re_exports.iter().filter(|(name, _)| used(name)).map(|(_, path)| path);
    re_exports
        .chain(&module.named)
        .filter_map(|path| defining_file(path, modules, 0))
        .filter(|file| *file != module.file)
        .collect()
}

/// The file that defines what a path names.
fn defining_file<'a>(
    path: &[String],
    modules: &BTreeMap<&ItemPath, &'a Module>,
    followed: usize,
) -> Option<&'a str> {
    const MAX_FOLLOWED: usize = 16;
    let length = (0..=path.len()).rev().find(|&length| modules.contains_key(&path[..length].to_vec()))?;
    let module = modules[&path[..length].to_vec()];
    let alias = path.get(length).and_then(|name| module.imports.get(name));
    match alias {
        Some(target) if followed < MAX_FOLLOWED => {
            let whole = [target.as_slice(), &path[length + 1..]].concat();
            defining_file(&whole, modules, followed + 1)
        }
        _ => Some(&module.file),
    }
}

/// Sets of more than one node that all reach each other.
fn components(edges: &BTreeMap<&str, BTreeSet<&str>>) -> Vec<Vec<String>> {
    let reached = |start: &str| {
        let mut seen = BTreeSet::new();
        let mut waiting: Vec<&str> = edges[start].iter().copied().collect();
        while let Some(node) = waiting.pop() {
            if seen.insert(node) {
                waiting.extend(&edges[node]);
            }
        }
        seen
    };
    let reach: BTreeMap<&str, BTreeSet<&str>> = edges.keys().map(|&node| (node, reached(node))).collect();
    let cycle_of = |node: &str| -> Vec<String> {
        let mutual = |other: &&&str| reach[**other].contains(node);
        reach[node].iter().filter(mutual).map(|&other| other.to_owned()).collect()
    };
    let cycles: BTreeSet<Vec<String>> = edges.keys().map(|node| cycle_of(node)).collect();
    cycles.into_iter().filter(|cycle| cycle.len() > 1).collect()
}
