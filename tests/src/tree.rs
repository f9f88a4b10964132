//! The project's own files.

use std::path::{Path, PathBuf};

/// The root folder of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Folders that hold what was built or fetched.
const NOT_OURS: [&str; 5] = [".git", "target", "node_modules", "dist", "tmp"];

/// A file of the project: its path from the root with `/` between folders, and its text.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// Path from the root.
    pub path: String,
    /// The whole text.
    pub text: String,
}

/// All files below `folder` whose name ends with one of `endings`, sorted by path.
///
/// # Panics
/// Where a folder or a file cannot be read: a rule that saw nothing must not pass.
pub fn source_files(folder: &str, endings: &[&str]) -> Vec<SourceFile> {
    let root = root();
    let mut found = Vec::new();
    let mut waiting = vec![root.join(folder)];
    while let Some(folder) = waiting.pop() {
        let entries = std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
        for entry in entries {
            let entry = entry.unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = entry.path();
            if path.is_dir() {
                if !NOT_OURS.contains(&name.as_str()) {
                    waiting.push(path);
                }
            } else if endings.iter().any(|ending| name.ends_with(ending)) {
                let text =
                    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                let path = path.strip_prefix(&root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
                found.push(SourceFile { path, text });
            }
        }
    }
    assert!(!found.is_empty(), "no {endings:?} below {folder}");
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

/// The text of one file of the project.
///
/// # Panics
/// Where it is not there.
pub fn text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}
