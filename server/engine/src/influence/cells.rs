//! The measure of every lit cell of a request.

use super::{correlation::correlate, sensitivity::sensitivities};
use crate::{
    cpu::{
        CpuExecutor,
        coefficients::ColumnBlock,
        dispatch::{dispatch_wide, multiply_add},
        mix::{BLOCK, MixedNode, NodeScales, mix_scale, mix_shape},
        scratch::Scratch,
    },
    error::EngineError,
    prepare::{LitColumn, Prepared, PreparedCell, shines},
    request::RenderRequest,
    table_set::TableSet,
    truncation::gram_matrix,
    twin::log_scale_between,
};
use rayon::prelude::*;
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, Band, LinearMeasure};
use std::sync::{Arc, OnceLock};

/// Partial sums side by side in a product of two rows of functions.
const LANES: usize = 8;
/// Step in the weight of the upper node over which slopes are differences.
const SLOPE_STEP: f32 = 0.02;
/// Step in altitude over which the place on an axis is differenced, metres.
const ALTITUDE_STEP_M: f32 = 10.0;
/// Steepest slope of ln(measure) over altitude in use, m⁻¹: next to the ground of a near lamp a step of the axis is metres.
const STEEPEST_PER_M: f64 = 0.02;

/// What is asked of every cell.
#[derive(Clone, Copy, Debug)]
pub enum MeasureOfCells<'a> {
    /// A linear measure of luminance: cells add up to the sky's own value.
    Linear(&'a LinearMeasure),
    /// ‖luminance image of the cell alone‖ = (∫ L² dΩ)^½ over the open upper hemisphere, cd m⁻² sr^½ (paper Eq. 10–11 for any
    /// basis: √(cᵀ·gram·c)). Between turbidities the logarithms of the packs' norms are blended.
    Norm,
}

/// What a cell does to a measure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellInfluence {
    /// The measure per DNB watt of the cell. Where a dark direction hangs on rounding a share may be below 0.
    pub per_dnb_w: f64,
    /// d ln(measure)/d(altitude of the cell), m⁻¹; 0 where the measure is not above 0.
    pub log_slope_per_m: f32,
}

/// Finds influences, on the processor; what it needs of a pack for norms it computes once.
pub struct InfluenceSolver {
    set: Arc<TableSet>,
    executor: CpuExecutor,
    grams: Vec<OnceLock<Vec<f32>>>,
}

impl std::fmt::Debug for InfluenceSolver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("InfluenceSolver").finish_non_exhaustive()
    }
}

/// The scales of a cell's nodes in one pack.
struct CellScales<'a>([&'a NodeScales; 2]);

impl CellScales<'_> {
    /// s_b·scale of every band at a weight of the upper node, W m⁻² sr⁻¹ per DNB watt.
    fn scale(&self, flux_per_dnb_flux: [f32; BAND_COUNT], upper_weight: f32) -> [f32; BAND_COUNT] {
        std::array::from_fn(|band| {
            let log_scale = self.0.map(|scales| scales.log_scale[band]);
            let bow = self.0.map(|scales| scales.bow[band]);
            flux_per_dnb_flux[band] * log_scale_between(log_scale, bow, upper_weight).exp()
        })
    }
}

impl InfluenceSolver {
    /// For the packs of a set.
    pub fn new(set: Arc<TableSet>) -> Self {
        let grams = set.tables().iter().map(|_| OnceLock::new()).collect();
        Self { executor: CpuExecutor::new(set.as_ref().clone()), set, grams }
    }

    /// The measure of each cell of the request's grid, by its place in [`PolarGrid::cells`](skyglow_scene::PolarGrid::cells).
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn cells(
        &self,
        request: &RenderRequest,
        measure: MeasureOfCells<'_>,
    ) -> Result<Vec<CellInfluence>, EngineError> {
        let prepared = Prepared::new(request, &self.set)?;
        let mut found = vec![CellInfluence::default(); request.polar.cells.len()];
        if prepared.is_dark() {
            return Ok(found);
        }
        let of_cells = match measure {
            MeasureOfCells::Linear(measure) => self.linear(&prepared, measure),
            MeasureOfCells::Norm => self.norms(&prepared),
        };
        // Cells that shine on clouds from above are in the grid and not among those prepared.
        let highest_source_m = request.kind().cloud_altitude_m();
        let places = (0..found.len()).filter(|&at| shines(&request.polar.cells[at], highest_source_m));
        for ((at, influence), cell) in places.zip(of_cells).zip(&prepared.cells) {
            let per_m = self.upper_weight_per_m(request, &prepared, at, cell);
            let slope = (influence.slope * per_m).clamp(-STEEPEST_PER_M, STEEPEST_PER_M);
            found[at] = CellInfluence { per_dnb_w: influence.value, log_slope_per_m: slope as f32 };
        }
        Ok(found)
    }

    /// d(place on the offset axis)/d(altitude) of a cell, m⁻¹.
    fn upper_weight_per_m(
        &self,
        request: &RenderRequest,
        prepared: &Prepared,
        at: usize,
        cell: &PreparedCell,
    ) -> f64 {
        let node = prepared.nodes[cell.lower_node as usize];
        let ring = node.ring as usize;
        let axis = match (node.blocking, self.set.blocked()) {
            (0, _) | (_, None) => self.set.axis(ring),
            (blocking, Some(blocked)) => blocked.axis(blocking as usize, ring),
        };
        let offset_m = request.polar.cells[at].altitude_m - request.observer_altitude_m.max(0.0) as f32;
        let apart = axis.position(offset_m + ALTITUDE_STEP_M) - axis.position(offset_m - ALTITUDE_STEP_M);
        f64::from(apart / (2.0 * ALTITUDE_STEP_M))
    }

    fn linear(&self, request: &Prepared, measure: &LinearMeasure) -> Vec<Slope> {
        let packs = request.turbidity_taps.indices();
        let rendered: Vec<(Vec<f32>, Scratch)> =
            packs.par_iter().map(|&pack| self.executor.render_keeping(request, pack)).collect();
        let (skies, kept): (Vec<Vec<f32>>, Vec<Scratch>) = rendered.into_iter().unzip();
        let weights = sensitivities(&skies, &request.turbidity_taps, measure);
        let mut sum = vec![Slope::default(); request.cells.len()];
        for ((&pack, scratch), weights) in packs.iter().zip(&kept).zip(&weights) {
            let tables = &self.set.tables()[pack];
            let basis_count = request.basis_count.min(tables.basis_count);
            let correlated = correlate(self.executor.transforms(), tables, basis_count, weights);
            let products = products(request, &scratch.mixed, &correlated);
            sum.par_iter_mut().zip(&request.cells).zip(&products).for_each(|((sum, cell), products)| {
                let scales = scales_of(cell, &scratch.scales);
                let at = |upper_weight: f32| -> f64 {
                    let scale = scales.scale(request.flux_per_dnb_flux, upper_weight);
                    let bands = 0..BAND_COUNT;
                    let of_band = |band: usize| {
                        let shape =
                            (1.0 - upper_weight) * products[0][band] + upper_weight * products[1][band];
                        f64::from(scale[band]) * f64::from(shape)
                    };
                    bands.map(of_band).sum()
                };
                sum.add_at(cell.upper_weight, at);
            });
        }
        for sum in &mut sum {
            sum.slope = if sum.value > 0.0 { sum.slope / sum.value } else { 0.0 };
        }
        sum
    }

    fn norms(&self, request: &Prepared) -> Vec<Slope> {
        let taps = &request.turbidity_taps;
        let mut logs = vec![Slope::default(); request.cells.len()];
        for (&pack, weight) in taps.indices().iter().zip(taps.weights()) {
            let tables = &self.set.tables()[pack];
            let gram = self.grams[pack]
                .get_or_init(|| gram_matrix(tables).into_iter().map(|value| value as f32).collect());
            let basis_count = request.basis_count.min(tables.basis_count);
            // The nodes alone: a norm knows no azimuth, and no sky is needed.
            let (mut scales, mut mixed) = (Vec::new(), Vec::new());
            mix_scale(tables, request, true, &mut scales);
            mix_shape(tables, request, &scales, true, &mut mixed);
            let nodes = request.nodes.len();
            logs.par_iter_mut().zip(&request.cells).for_each(|(logs, cell)| {
                let of_cell = scales_of(cell, &scales);
                let ends = [cell.lower_node, cell.upper_node()].map(|node| node as usize);
                let at = |upper_weight: f32| -> f64 {
                    let scale = of_cell.scale(request.flux_per_dnb_flux, upper_weight);
                    let share = [1.0 - upper_weight, upper_weight];
                    let coefficient = |k: usize| -> f32 {
                        let of_band = |band: Band| {
                            let b = band.index();
                            let shape = |end: usize| mixed[k / BLOCK * nodes + ends[end]].0[b][k % BLOCK];
                            let shape = share[0] * shape(0) + share[1] * shape(1);
                            band.luminous_efficacy_lm_w() as f32 * scale[b] * shape
                        };
                        Band::ALL.into_iter().map(of_band).sum()
                    };
                    let coefficients: Vec<f32> = (0..basis_count).map(coefficient).collect();
                    quadratic_form(&coefficients, gram, tables.basis_count).max(0.0).sqrt()
                };
                let mut norm = Slope::default();
                norm.add_at(cell.upper_weight, at);
                logs.value += weight * norm.value.max(f64::MIN_POSITIVE).ln();
                logs.slope += weight * if norm.value > 0.0 { norm.slope / norm.value } else { 0.0 };
            });
        }
        logs.into_iter().map(|log| Slope { value: log.value.exp(), slope: log.slope }).collect()
    }
}

/// A value per DNB watt, and how it changes with the place on the offset axis: as a difference while it is added up, then over
/// the value.
#[derive(Clone, Copy, Debug, Default)]
struct Slope {
    value: f64,
    slope: f64,
}

impl Slope {
    /// Adds what `at` gives at a weight of the upper node.
    fn add_at(&mut self, upper_weight: f32, at: impl Fn(f32) -> f64) {
        self.value += at(upper_weight);
        // Right on a node there is no other beside it.
        if upper_weight > 0.0 {
            let (low, high) = ((upper_weight - SLOPE_STEP).max(0.0), (upper_weight + SLOPE_STEP).min(1.0));
            self.slope += (at(high) - at(low)) / f64::from(high - low);
        }
    }
}

fn scales_of<'a>(cell: &PreparedCell, scales: &'a [NodeScales]) -> CellScales<'a> {
    CellScales([cell.lower_node, cell.upper_node()].map(|node| &scales[node as usize]))
}

/// cᵀ·gram·c.
fn quadratic_form(coefficients: &[f32], gram: &[f32], stride: usize) -> f64 {
    let count = coefficients.len();
    let row = |k: usize| -> f64 {
        let product: f32 = gram[k * stride..][..count].iter().zip(coefficients).map(|(g, c)| g * c).sum();
        f64::from(product) * f64::from(coefficients[k])
    };
    (0..count).map(row).sum()
}

/// Σ_k shape_k·G_k of both nodes of every cell, `[cell][lower, upper][band]`.
type Products = Vec<[[f32; BAND_COUNT]; 2]>;

fn products(request: &Prepared, mixed: &[MixedNode], correlated: &[ColumnBlock]) -> Products {
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
        for (nodes, columns) in mixed.chunks_exact(node_count).zip(correlated.chunks_exact(AZIMUTH_COUNT)) {
            add_products(cells, nodes, &columns[column.azimuth as usize], products);
        }
    });
    products
}

dispatch_wide!(
    /// Adds the products of one column's cells in one block of functions.
    add_products, add_products_wide, add_products_body,
    (
        cells: &[PreparedCell],
        nodes: &[MixedNode],
        correlated: &ColumnBlock,
        products: &mut [[[f32; BAND_COUNT]; 2]]
    )
);

#[inline(always)]
fn add_products_body<const FUSED: bool>(
    cells: &[PreparedCell],
    nodes: &[MixedNode],
    correlated: &ColumnBlock,
    products: &mut [[[f32; BAND_COUNT]; 2]],
) {
    for (cell, products) in cells.iter().zip(products) {
        for (node, products) in [cell.lower_node, cell.upper_node()].into_iter().zip(products) {
            let node = &nodes[node as usize].0;
            for band in 0..BAND_COUNT {
                let mut sums = [0f32; LANES];
                for first in (0..BLOCK).step_by(LANES) {
                    for lane in 0..LANES {
                        let (a, b) = (node[band][first + lane], correlated.0[band][first + lane]);
                        sums[lane] = multiply_add::<FUSED>(a, b, sums[lane]);
                    }
                }
                products[band] += sums.iter().sum::<f32>();
            }
        }
    }
}
