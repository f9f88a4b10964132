//! The seeds of the fuzzers.

use crate::arguments::Outcome;
use skyglow_lab::seeds::{smallest_celestial_table, smallest_pack, smallest_raster};
use std::path::Path;

pub(crate) fn run() -> Outcome {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fuzz/seeds");
    for (name, content) in [
        ("pack/smallest", smallest_pack()),
        ("celestial/smallest", smallest_celestial_table()),
        ("raster/smallest", smallest_raster()),
    ] {
        let path = seeds.join(name);
        std::fs::write(&path, content)?;
        println!("{}", path.display());
    }
    Ok(())
}
