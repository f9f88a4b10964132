//! Layout of lists and tables in textures.

use skyglow_physics::{BAND_COUNT, LOBE_COUNT};
use skyglow_tables::resident::ResidentBlocked;

const BANDS: u32 = BAND_COUNT as u32;

/// Cells in one row of the cell-weight texture, and items in one of a list.
pub const CELLS_PER_ROW: u32 = 1024;

/// Texel (x, y) of an item of a list that is wrapped into rows.
#[inline(always)]
pub fn list_texel(item: u32) -> [u32; 2] {
    [item % CELLS_PER_ROW, item / CELLS_PER_ROW]
}

/// Texel (x, y) of a cell's weights in one band.
#[inline(always)]
pub fn cell_texel(cell: u32, band: u32) -> [u32; 2] {
    [(cell % CELLS_PER_ROW) * BANDS + band, cell / CELLS_PER_ROW]
}

/// Nodes in one column of the mixed texture; more stand beside them, for no texture need be higher.
pub const NODE_ROWS: u32 = 8192;

/// Texel (x, y) of four consecutive mixed shape coefficients, the `quad`th of `quad_count` in one band of a node.
#[inline(always)]
pub fn mixed_texel(node: u32, band: u32, quad: u32, quad_count: u32) -> [u32; 2] {
    [(node / NODE_ROWS * BANDS + band) * quad_count + quad, node % NODE_ROWS]
}

/// Layer of an observer altitude and an angle in the tables of sources behind skylines.
#[inline(always)]
pub fn blocked_layer(observer_altitude: u32, angle_index: u32) -> u32 {
    observer_altitude * ResidentBlocked::ANGLE_COUNT as u32 + angle_index
}

/// Texel (x, y) of eight consecutive shape coefficients of an image of the node in a row: `[ring][offset]`.
#[inline(always)]
pub fn shape_texel(
    row: u32,
    observer_altitude: u32,
    lobe: u32,
    band: u32,
    octet: u32,
    octet_count: u32,
) -> [u32; 2] {
    [((observer_altitude * LOBE_COUNT as u32 + lobe) * BANDS + band) * octet_count + octet, row]
}
