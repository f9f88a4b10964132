//! What parsers of bytes from outside must keep to, whatever the bytes: each function here takes any, and panics where the program
//! would be wrong. Fuzzers call them (`tests/fuzz`), and so does a test with what fuzzers start from and have found.

mod packs;
mod rasters;
mod requests;

pub use packs::{celestial, pack};
pub use rasters::{places, raster};
pub use requests::{body, boundary, parameters};

/// A parser's rules.
pub type Rules = fn(&[u8]);

/// All of them by the names of their fuzz targets, which are those of their folders of seeds.
pub const ALL: [(&str, Rules); 7] = [
    ("parameters", parameters),
    ("body", body),
    ("boundary", boundary),
    ("pack", pack),
    ("celestial", celestial),
    ("raster", raster),
    ("places", places),
];
