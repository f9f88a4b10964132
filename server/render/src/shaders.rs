//! The WGSL files and what each requires.

use crate::plan::Pass;

/// A file of functions and types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LibraryFile {
    /// File name without its ending.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! library {
    ($name:literal) => {
        LibraryFile { name: $name, text: include_str!(concat!("../../../shaders/lib/", $name, ".wgsl")) }
    };
}
macro_rules! pass_text {
    ($name:literal) => {
        include_str!(concat!("../../../shaders/passes/", $name, ".wgsl"))
    };
}

/// Types shared with the host.
pub const TYPES: LibraryFile = library!("types");
/// exp and ln.
pub const ELEMENTARY: LibraryFile = library!("elementary");
/// Mixing of lobes, weights of cells.
pub const MIXING: LibraryFile = library!("mixing");
/// Interpolation between packs.
pub const BLENDING: LibraryFile = library!("blending");
/// Parts of the transform.
pub const FFT: LibraryFile = library!("fft");
/// The transform in workgroup memory.
pub const WORKGROUP_FFT: LibraryFile = library!("workgroup_fft");
/// Places in textures.
pub const INDEXING: LibraryFile = library!("indexing");

/// All library files, each after those that it requires.
pub const LIBRARY: [LibraryFile; 7] = [TYPES, ELEMENTARY, MIXING, BLENDING, FFT, WORKGROUP_FFT, INDEXING];

/// The library files of a pass, in the order in which they are put before it.
pub const fn requirements(pass: Pass) -> &'static [LibraryFile] {
    match pass {
        Pass::MixScale => &[TYPES, ELEMENTARY, MIXING, INDEXING],
        Pass::MixShape => &[TYPES, INDEXING],
        Pass::CellWeights => &[TYPES, ELEMENTARY, MIXING, INDEXING],
        Pass::Coefficients => &[TYPES, INDEXING],
        Pass::AzimuthFft | Pass::InverseFft => &[TYPES, FFT, WORKGROUP_FFT],
        Pass::BasisSum => &[TYPES],
        Pass::Blend => &[TYPES, ELEMENTARY, BLENDING],
    }
}

/// The text of a pass alone.
pub const fn pass_text(pass: Pass) -> &'static str {
    match pass {
        Pass::MixScale => pass_text!("mix_scale"),
        Pass::MixShape => pass_text!("mix_shape"),
        Pass::CellWeights => pass_text!("cell_weights"),
        Pass::Coefficients => pass_text!("coefficients"),
        Pass::AzimuthFft => pass_text!("azimuth_fft"),
        Pass::BasisSum => pass_text!("basis_sum"),
        Pass::InverseFft => pass_text!("inverse_fft"),
        Pass::Blend => pass_text!("blend"),
    }
}

/// A pass with everything it requires: one module.
pub fn module_text(pass: Pass) -> String {
    let mut text: String = requirements(pass).iter().map(|file| file.text).collect();
    text.push_str(pass_text(pass));
    text
}
