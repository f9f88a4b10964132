//! What the passes hand to each other, laid out so that vectors read straight on.

use super::lanes::{Aligned, LANES};
use crate::twin::MAX_BAND_COUNT;
use skyglow_physics::{BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT};
use skyglow_tables::resident::FREQUENCY_COUNT;

/// Functions that one run of the coefficient kernel sums in registers.
pub const BLOCK: usize = 32;
/// Functions that one forward transform takes.
pub const FUNCTIONS_PER_GROUP: usize = 2 * LANES;
/// Elevations summed side by side, and rows that one inverse transform takes.
pub const ROWS_PER_GROUP: usize = 2 * LANES;
/// Groups of rows in a panorama.
pub const ROW_GROUPS: usize = ELEVATION_COUNT / ROWS_PER_GROUP;

/// Shares of the lobes at a node, the logarithm of its mixed scale and that one's curvature:
/// [`lobe_shares`](crate::twin::lobe_shares), [`mixed_curvature`](crate::twin::mixed_curvature).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NodeScales {
    /// ln of the mixed scale in every band, 0 beyond the last: a vector.
    pub log_scale: [f32; MAX_BAND_COUNT],
    /// Its second difference over the offset, as long: [`skyglow_tables::curvature`].
    pub curvature: [f32; MAX_BAND_COUNT],
    /// `[band][lobe]`, summing to 1.
    pub shares: [[f32; LOBE_COUNT]; BAND_COUNT],
}

/// Shape coefficients of one node in one block of functions: `[band][function]`; functions beyond those in use are 0.
pub type MixedNode = Aligned<[[f32; BLOCK]; BAND_COUNT]>;

/// Weights of a cell's lower and upper node in every band, 0 beyond the last: vectors.
pub type CellWeights = [[f32; MAX_BAND_COUNT]; 2];

/// H of one azimuth in one block of functions: `[band][function]`.
pub type ColumnBlock = Aligned<[[f32; BLOCK]; BAND_COUNT]>;

/// Spectra of one group of functions in one band: `[frequency][real, imaginary][function in group]`.
pub type GroupSpectra = Aligned<[[[f32; FUNCTIONS_PER_GROUP]; 2]; FREQUENCY_COUNT]>;

/// Spectra of functions that are 0.
pub const fn empty_spectra() -> GroupSpectra {
    Aligned([[[0.0; FUNCTIONS_PER_GROUP]; 2]; FREQUENCY_COUNT])
}

/// The sums over the basis at one frequency: `[band][real, imaginary][elevation]`.
pub type FrequencySums = Aligned<[[[f32; ELEVATION_COUNT]; 2]; BAND_COUNT]>;
