//! The packs that come with the program and the demo scene, read once for all tests of a file.

use skyglow_lab::setup::observatory;
use skyglow_observatory::Observatory;
use skyglow_scene::{SceneStore, create_demo};
use skyglow_tests::tree;
use std::path::Path;

/// An observatory over the demo scene in a folder of this name among cargo's temporary ones, emptied first: what is shared by
/// tests is dropped by none.
pub(crate) fn demo(name: &str) -> Observatory {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
    create_demo(&SceneStore::new(&folder), &mut |_| {}).unwrap();
    observatory(&folder, &tree::root().join("precomputed")).unwrap()
}
