//! Products of cells with a correlated measure.

use rayon::prelude::*;
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, simd::multiply_add, simd_dispatch};
use skyglow_render::{
    cpu::layout::{BLOCK, ColumnBlock, MixedNode},
    prepare::{LitColumn, Prepared, PreparedCell},
};

/// Partial sums side by side in a product of two rows of functions.
const LANES: usize = 8;

/// Σ_k shape_k·G_k of both nodes of every cell, `[cell][lower, upper][band]`.
pub(super) type Products = Vec<[[f32; BAND_COUNT]; 2]>;

pub(super) fn products(request: &Prepared, mixed: &[MixedNode], correlated: &[ColumnBlock]) -> Products {
    let mut products = vec![[[0f32; BAND_COUNT]; 2]; request.cells.len()];
    let node_count = request.nodes.len();
    // Each column's cells are one piece of work.
    let mut pieces: Vec<(&LitColumn, &mut [[[f32; BAND_COUNT]; 2]])> = Vec::new();
    let mut rest = products.as_mut_slice();
    for column in &request.columns {
        let (piece, behind) = rest.split_at_mut((column.end_cell - column.first_cell) as usize);
        pieces.push((column, piece));
        rest = behind;
    }
    pieces.into_par_iter().with_min_len(4).for_each(|(column, products)| {
        let cells = &request.cells[column.first_cell as usize..column.end_cell as usize];
        let blocks: Vec<(&[MixedNode], &ColumnBlock)> = mixed
            .chunks_exact(node_count)
            .zip(correlated.chunks_exact(AZIMUTH_COUNT))
            .map(|(nodes, columns)| (nodes, &columns[column.azimuth as usize]))
            .collect();
        add_products(cells, &blocks, products);
    });
    products
}

simd_dispatch! {
    /// The products of one column's cells, over all blocks of functions.
    fn add_products(
        cells: &[PreparedCell],
        blocks: &[(&[MixedNode], &ColumnBlock)],
        products: &mut [[[f32; BAND_COUNT]; 2]],
    ) = add_products_body::<FUSED>;
}

#[inline(always)]
fn add_products_body<const FUSED: bool>(
    cells: &[PreparedCell],
    blocks: &[(&[MixedNode], &ColumnBlock)],
    products: &mut [[[f32; BAND_COUNT]; 2]],
) {
    for (cell, products) in cells.iter().zip(products) {
        for (node, products) in [cell.lower_node, cell.upper_node()].into_iter().zip(products) {
            let mut sums = [[0f32; LANES]; BAND_COUNT];
            for (nodes, correlated) in blocks {
                let node = &nodes[node as usize].0;
                for band in 0..BAND_COUNT {
                    for first in (0..BLOCK).step_by(LANES) {
                        for lane in 0..LANES {
                            let (a, b) = (node[band][first + lane], correlated.0[band][first + lane]);
                            sums[band][lane] = multiply_add::<FUSED>(a, b, sums[band][lane]);
                        }
                    }
                }
            }
            *products = sums.map(|lanes| lanes.iter().sum());
        }
    }
}
