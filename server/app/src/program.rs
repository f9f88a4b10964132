//! Which build of the program this is.

use std::sync::LazyLock;

/// What tells this build of the program from any other: the hash of its executable, for a change in how something
/// is found, drawn or worded is another answer, whatever the version says.
pub fn program() -> &'static str {
    static HASH: LazyLock<String> = LazyLock::new(|| {
        let hash = |path| {
            let mut hasher = blake3::Hasher::new();
            hasher.update_reader(std::fs::File::open(path)?)?;
            std::io::Result::Ok(hasher.finalize().to_hex().to_string())
        };
        std::env::current_exe().and_then(hash).unwrap_or_else(|_| env!("CARGO_PKG_VERSION").to_owned())
    });
    &HASH
}
