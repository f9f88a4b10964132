//! Where data and packs lie when nobody says.

use crate::failure::Failure;
use skyglow_tables::packs_in;
use std::path::{Path, PathBuf};

/// `$XDG_DATA_HOME/skyglow`, else `~/.local/share/skyglow`, else (no home either) `skyglow` in the current
/// folder.
pub(crate) fn default_data_folder() -> PathBuf {
    data_folder(
        std::env::var_os("XDG_DATA_HOME").map(PathBuf::from),
        std::env::var_os("HOME").map(PathBuf::from),
    )
}

fn data_folder(xdg_data_home: Option<PathBuf>, home: Option<PathBuf>) -> PathBuf {
    // The XDG specification says that a relative path there counts as none.
    xdg_data_home
        .filter(|path| path.is_absolute())
        .or_else(|| home.filter(|path| path.is_absolute()).map(|home| home.join(".local/share")))
        .unwrap_or_default()
        .join("skyglow")
}

/// The packs that come with the program: `precomputed/` beside the executable, or `share/skyglow/precomputed/`
/// of the tree it is installed in, or of the source tree it was built from. Where none of these is there, the
/// first, so that a message names a sensible place.
pub(crate) fn default_packs_folder() -> PathBuf {
    let executable = std::env::current_exe().ok().and_then(|path| path.canonicalize().ok());
    let beside = executable.as_deref().and_then(Path::parent);
    packs_folder(beside, Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../precomputed")), Path::is_dir)
}

/// `$SKYGLOW_PACKS`, else the packs that come with the program.
pub(crate) fn packs_folder_in_force() -> PathBuf {
    std::env::var_os("SKYGLOW_PACKS").map_or_else(default_packs_folder, PathBuf::from)
}

fn packs_folder(beside: Option<&Path>, source: &Path, is_folder: impl Fn(&Path) -> bool) -> PathBuf {
    let installed = beside.map(|folder| folder.join("precomputed"));
    let shared = beside.and_then(Path::parent).map(|prefix| prefix.join("share/skyglow/precomputed"));
    let candidates: Vec<PathBuf> =
        [installed, shared, source.canonicalize().ok()].into_iter().flatten().collect();
    candidates
        .iter()
        .find(|path| is_folder(path))
        .or(candidates.first())
        .cloned()
        .unwrap_or_else(|| PathBuf::from("precomputed"))
}

/// The packs of a folder, one at least.
///
/// # Errors
/// [`Failure::Work`] that says where packs come from.
pub(crate) fn packs_of(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    match packs_in(folder) {
        Ok(packs) if packs.is_empty() => Err(no_packs(format!("{} has none", folder.display()))),
        found => found.map_err(no_packs),
    }
}

/// There are no packs for this reason: says where they come from.
pub(crate) fn no_packs(reason: impl std::fmt::Display) -> Failure {
    Failure::Work(format!(
        "no table packs: {reason}; they are the folder `precomputed` of the project: copy it to share/skyglow beside the \
         program's bin, or name it by --packs or SKYGLOW_PACKS; `skyglow precompute` makes others"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Data lies where xdg says else in the home folder.
    #[test]
    fn data_lies_where_xdg_says_else_at_home() {
        let path = |text: &str| Some(PathBuf::from(text));
        assert_eq!(data_folder(path("/x"), path("/home/a")), PathBuf::from("/x/skyglow"));
        assert_eq!(data_folder(path("x"), path("/home/a")), PathBuf::from("/home/a/.local/share/skyglow"));
        assert_eq!(data_folder(None, path("/home/a")), PathBuf::from("/home/a/.local/share/skyglow"));
        assert_eq!(data_folder(None, None), PathBuf::from("skyglow"));
    }

    /// Packs beside the executable win over shared ones and over the source tree.
    #[test]
    fn packs_beside_the_executable_win() {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).canonicalize().unwrap();
        let find = |there: &[&str]| {
            let there: Vec<PathBuf> = there.iter().map(PathBuf::from).collect();
            packs_folder(Some(Path::new("/opt/bin")), &source, |path| {
                path == source || there.iter().any(|known| known == path)
            })
        };
        let (beside, shared) = ("/opt/bin/precomputed", "/opt/share/skyglow/precomputed");
        assert_eq!(find(&[beside, shared]), PathBuf::from(beside));
        assert_eq!(find(&[shared]), PathBuf::from(shared));
        assert_eq!(find(&[]), source);
        let nowhere = packs_folder(Some(Path::new("/opt/bin")), Path::new("/gone"), |_| false);
        assert_eq!(nowhere, PathBuf::from(beside));
    }
}
