//! Writes what fuzzers start from where the program makes it: the smallest pack and the smallest raster.

use skyglow_tests::{
    outside::{smallest_pack, smallest_raster},
    tree::root,
};

fn main() -> std::io::Result<()> {
    let seeds = root().join("tests/fuzz/seeds");
    for (name, content) in [("pack/smallest", smallest_pack()), ("raster/smallest", smallest_raster())] {
        let path = seeds.join(name);
        std::fs::write(&path, content)?;
        println!("{}", path.display());
    }
    Ok(())
}
