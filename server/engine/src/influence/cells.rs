//! The measure of every lit cell of a request.

use super::{correlation::correlate, sensitivity::sensitivities};
use crate::{
    cpu::{
        CpuExecutor,
        blend::blend,
        coefficients::ColumnBlock,
        dispatch::{dispatch_wide, multiply_add},
        mix::{BLOCK, MixedNode, NodeScales, mix_scale, mix_shape},
        scratch::Scratch,
    },
    error::EngineError,
    prepare::{LitColumn, Prepared, PreparedCell, shines},
    request::RenderRequest,
    table_set::TableSet,
    taps::Taps,
    truncation::gram_matrix,
    twin::log_scale_between,
};
use rayon::prelude::*;
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, Band, ELEVATION_COUNT, LinearMeasure, Panorama, panorama::solid_angle_sr,
};
use std::sync::{Arc, OnceLock};

/// Partial sums side by side in a product of two rows of functions.
const LANES: usize = 8;
/// Cells that a task works on.
const CELLS_AT_ONCE: usize = 1024;
/// Step in the weight of the upper node over which slopes are differences.
const SLOPE_STEP: f32 = 0.02;
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

/// What cells do to a sky.
#[derive(Clone, Debug, PartialEq)]
pub struct CellsInSky {
    /// By their place in the grid.
    pub cells: Vec<CellInfluence>,
    /// The sky's own value of a linear measure; None for the norm.
    pub of_sky: Option<f64>,
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
    /// Σ_b scale·shape of products with a measure, `[lower, upper][band]`, and its slope over the weight of the upper node.
    fn times(
        &self,
        flux_per_dnb_flux: [f32; BAND_COUNT],
        upper_weight: f32,
        products: &[[f32; BAND_COUNT]; 2],
    ) -> Slope {
        let mut sum = Slope::default();
        let steps = steps_around(upper_weight);
        for band in 0..BAND_COUNT {
            let log_scale = |weight: f32| self.log_scale(band, weight);
            let scale = flux_per_dnb_flux[band] * log_scale(upper_weight).exp();
            let [lower, upper] = products.map(|product| product[band]);
            let shape = (1.0 - upper_weight) * lower + upper_weight * upper;
            sum.value += f64::from(scale * shape);
            if let Some((low, high)) = steps {
                let log_slope = (log_scale(high) - log_scale(low)) / (high - low);
                sum.slope += f64::from(scale * (log_slope * shape + upper - lower));
            }
        }
        sum
    }

    fn log_scale(&self, band: usize, upper_weight: f32) -> f32 {
        let log_scale = self.0.map(|scales| scales.log_scale[band]);
        let bow = self.0.map(|scales| scales.bow[band]);
        log_scale_between(log_scale, bow, upper_weight)
    }

    /// s_b·scale of every band at a weight of the upper node, W m⁻² sr⁻¹ per DNB watt.
    fn scale(&self, flux_per_dnb_flux: [f32; BAND_COUNT], upper_weight: f32) -> [f32; BAND_COUNT] {
        std::array::from_fn(|band| flux_per_dnb_flux[band] * self.log_scale(band, upper_weight).exp())
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
        Ok(self.cells_in_sky(request, request, measure)?.cells)
    }

    /// The same in the sky of another request, which may gather the same light in another way: where a direction is black, and
    /// between turbidities, what a cell adds depends on what is there already.
    ///
    /// # Errors
    /// As [`Prepared::new`] of either.
    pub fn cells_in_sky(
        &self,
        request: &RenderRequest,
        sky: &RenderRequest,
        measure: MeasureOfCells<'_>,
    ) -> Result<CellsInSky, EngineError> {
        let prepared = Prepared::new(request, &self.set)?;
        let mut cells = vec![CellInfluence::default(); request.polar.cells.len()];
        let mut of_sky = None;
        if prepared.is_dark() {
            return Ok(CellsInSky { cells, of_sky: Some(0.0) });
        }
        // Cells that shine on clouds from above are in the grid and not among those prepared.
        let highest_source_m = request.kind().cloud_altitude_m();
        let places: Vec<u32> = (0u32..)
            .zip(&request.polar.cells)
            .filter(|(_, cell)| shines(cell, highest_source_m))
            .map(|(at, _)| at)
            .collect();
        let mut of_cells = vec![Slope::default(); prepared.cells.len()];
        match measure {
            MeasureOfCells::Linear(measure) => {
                let sky = Prepared::new(sky, &self.set)?;
                of_sky = Some(self.linear(&prepared, &sky, measure, &mut of_cells));
            }
            MeasureOfCells::Norm => self.norms(&prepared, &mut of_cells),
        }
        let found: Vec<CellInfluence> = (places.par_iter().zip(&of_cells).zip(&prepared.cells))
            .with_min_len(CELLS_AT_ONCE)
            .map(|((&at, of_cell), cell)| {
                let per_m = self.upper_weight_per_m(request, &prepared, at as usize, cell);
                let slope = (of_cell.log_slope() * f64::from(per_m)).clamp(-STEEPEST_PER_M, STEEPEST_PER_M);
                CellInfluence { per_dnb_w: of_cell.value, log_slope_per_m: slope as f32 }
            })
            .collect();
        if found.len() == cells.len() {
            return Ok(CellsInSky { cells: found, of_sky });
        }
        for (at, cell) in places.into_iter().zip(found) {
            cells[at as usize] = cell;
        }
        Ok(CellsInSky { cells, of_sky })
    }

    /// The norm of the sky of a request, as [`MeasureOfCells::Norm`] has it of a cell's.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn norm(&self, request: &RenderRequest) -> Result<f64, EngineError> {
        let prepared = Prepared::new(request, &self.set)?;
        if prepared.is_dark() {
            return Ok(0.0);
        }
        let taps = &prepared.turbidity_taps;
        let skies: Vec<Vec<f32>> =
            taps.indices().iter().map(|&pack| self.executor.sky(&prepared, pack, false)).collect();
        let square = |row: usize, column: usize, sky: &Panorama| {
            solid_angle_sr(row) * sky.luminance_cd_m2(row, column).powi(2)
        };
        Ok(blended(skies, taps, false).map_or(0.0, |sky| {
            let directions =
                (0..ELEVATION_COUNT).flat_map(|row| (0..AZIMUTH_COUNT).map(move |column| (row, column)));
            directions.map(|(row, column)| square(row, column, &sky)).sum::<f64>().sqrt()
        }))
    }

    /// d(place on the offset axis)/d(altitude) of a cell, m⁻¹.
    fn upper_weight_per_m(
        &self,
        request: &RenderRequest,
        prepared: &Prepared,
        at: usize,
        cell: &PreparedCell,
    ) -> f32 {
        let node = prepared.nodes[cell.lower_node as usize];
        let ring = node.ring as usize;
        let axis = match (node.blocking, self.set.blocked()) {
            (0, _) | (_, None) => self.set.axis(ring),
            (blocking, Some(blocked)) => blocked.axis(blocking as usize, ring),
        };
        let offset_m = request.polar.cells[at].altitude_m - request.observer_altitude_m.max(0.0) as f32;
        axis.position_per_m(offset_m)
    }

    /// Adds up what cells do, and gives the sky's own value.
    fn linear(&self, request: &Prepared, sky: &Prepared, measure: &LinearMeasure, sum: &mut [Slope]) -> f64 {
        let taps = &request.turbidity_taps;
        let skies: Vec<Vec<f32>> = match sky.is_dark() {
            true => vec![vec![0.0; Panorama::LEN]; taps.indices().len()],
            false => taps.indices().par_iter().map(|&pack| self.executor.sky(sky, pack, true)).collect(),
        };
        let weights = sensitivities(&skies, taps, measure);
        for (&pack, weights) in taps.indices().iter().zip(&weights) {
            let tables = &self.set.tables()[pack];
            let basis_count = request.basis_count.min(tables.basis_count);
            let correlated = correlate(self.executor.transforms(), tables, basis_count, weights);
            let mut scratch = self.executor.scratch().take();
            let Scratch { scales, mixed, .. } = &mut scratch;
            mix_scale(tables, request, true, scales);
            mix_shape(tables, request, scales, true, mixed);
            let products = products(request, mixed, &correlated);
            let cells = sum.par_iter_mut().zip(&request.cells).zip(&products).with_min_len(CELLS_AT_ONCE);
            cells.for_each(|((sum, cell), products)| {
                sum.add(scales_of(cell, scales).times(
                    request.flux_per_dnb_flux,
                    cell.upper_weight,
                    products,
                ));
            });
            self.executor.scratch().keep(scratch);
        }
        blended(skies, taps, true).map_or(0.0, |sky| measure.of(&sky))
    }

    fn norms(&self, request: &Prepared, logs: &mut [Slope]) {
        let taps = &request.turbidity_taps;
        for (&pack, weight) in taps.indices().iter().zip(taps.weights()) {
            let tables = &self.set.tables()[pack];
            let gram = self.grams[pack]
                .get_or_init(|| gram_matrix(tables).into_iter().map(|value| value as f32).collect());
            let basis_count = request.basis_count.min(tables.basis_count);
            // The nodes alone: a norm knows no azimuth, and no sky is needed.
            let mut scratch = self.executor.scratch().take();
            let Scratch { scales, mixed, .. } = &mut scratch;
            mix_scale(tables, request, true, scales);
            mix_shape(tables, request, scales, true, mixed);
            let of_pack =
                NormsOfPack { request, scales, mixed, gram, basis_count, stride: tables.basis_count };
            logs.par_iter_mut().zip(&request.cells).with_min_len(64).for_each(|(log, cell)| {
                let norm = of_pack.norm(cell);
                log.value += weight * norm.value.max(f64::MIN_POSITIVE).ln();
                log.slope += weight * norm.log_slope();
            });
            self.executor.scratch().keep(scratch);
        }
        for log in logs {
            log.value = log.value.exp();
            log.slope *= log.value;
        }
    }
}

/// The sky between those of packs.
fn blended(mut skies: Vec<Vec<f32>>, taps: &Taps, side_by_side: bool) -> Option<Panorama> {
    let samples = match skies.len() {
        1 => skies.swap_remove(0),
        _ => blend(&skies.iter().map(Vec::as_slice).collect::<Vec<_>>(), taps, side_by_side),
    };
    Panorama::from_samples(samples)
}

/// What the norms of cells in one pack are computed from.
struct NormsOfPack<'a> {
    request: &'a Prepared,
    scales: &'a [NodeScales],
    mixed: &'a [MixedNode],
    /// `[function][function]`, `stride` to a row.
    gram: &'a [f32],
    stride: usize,
    basis_count: usize,
}

/// Most functions that a pack may have.
const MOST_FUNCTIONS: usize = 256;
/// Coefficients of luminance, those beyond the basis 0.
type Coefficients = [f32; MOST_FUNCTIONS];

impl NormsOfPack<'_> {
    /// √(cᵀ·gram·c) of a cell, and how it changes with its place on the offset axis: (gram·c)·dc/norm.
    fn norm(&self, cell: &PreparedCell) -> Slope {
        let (mut here, mut times) = ([0f32; MOST_FUNCTIONS], [0f32; MOST_FUNCTIONS]);
        self.coefficients(cell, cell.upper_weight, &mut here);
        times_gram(self.gram, self.stride, self.basis_count, &here, &mut times);
        let dot = |other: &Coefficients| -> f64 {
            let products = times[..self.basis_count].iter().zip(other);
            products.map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
        };
        let norm = dot(&here).max(0.0).sqrt();
        let mut slope = 0.0;
        if let Some((low, high)) = steps_around(cell.upper_weight)
            && norm > 0.0
        {
            let (mut below, mut above) = ([0f32; MOST_FUNCTIONS], [0f32; MOST_FUNCTIONS]);
            self.coefficients(cell, low, &mut below);
            self.coefficients(cell, high, &mut above);
            slope = (dot(&above) - dot(&below)) / (f64::from(high - low) * norm);
        }
        Slope { value: norm, slope }
    }

    fn coefficients(&self, cell: &PreparedCell, upper_weight: f32, coefficients: &mut Coefficients) {
        let nodes = self.request.nodes.len();
        let scale = scales_of(cell, self.scales).scale(self.request.flux_per_dnb_flux, upper_weight);
        let ends = [cell.lower_node, cell.upper_node()].map(|node| node as usize);
        let blocks = coefficients[..self.basis_count].chunks_mut(BLOCK);
        for (nodes, coefficients) in self.mixed.chunks_exact(nodes).zip(blocks) {
            for band in Band::ALL {
                let b = band.index();
                let factor = band.luminous_efficacy_lm_w() as f32 * scale[b];
                let factors = [factor * (1.0 - upper_weight), factor * upper_weight];
                let [lower, upper] = ends.map(|end| &nodes[end].0[b]);
                for ((sum, lower), upper) in coefficients.iter_mut().zip(lower).zip(upper) {
                    *sum += factors[0] * lower + factors[1] * upper;
                }
            }
        }
    }
}

dispatch_wide!(
    /// gram·c.
    times_gram, times_gram_wide, times_gram_body,
    (gram: &[f32], stride: usize, basis_count: usize, coefficients: &Coefficients, product: &mut Coefficients)
);

#[inline(always)]
fn times_gram_body<const FUSED: bool>(
    gram: &[f32],
    stride: usize,
    basis_count: usize,
    coefficients: &Coefficients,
    product: &mut Coefficients,
) {
    // It is symmetric: rows are columns, and a few functions at a time stay in registers.
    for first in (0..basis_count).step_by(BLOCK) {
        let mut sums = [0f32; BLOCK];
        let width = BLOCK.min(stride - first);
        for (row, coefficient) in gram.chunks_exact(stride).zip(&coefficients[..basis_count]) {
            if width == BLOCK {
                for (sum, value) in sums.iter_mut().zip(&row[first..first + BLOCK]) {
                    *sum = multiply_add::<FUSED>(*coefficient, *value, *sum);
                }
            } else {
                for (sum, value) in sums.iter_mut().zip(&row[first..]) {
                    *sum = multiply_add::<FUSED>(*coefficient, *value, *sum);
                }
            }
        }
        product[first..first + width].copy_from_slice(&sums[..width]);
    }
}

/// A value per DNB watt, and how it changes with the place on the offset axis.
#[derive(Clone, Copy, Debug, Default)]
struct Slope {
    value: f64,
    slope: f64,
}

impl Slope {
    fn add(&mut self, other: Self) {
        self.value += other.value;
        self.slope += other.slope;
    }

    /// d ln(value)/d(place); 0 where the value is not above 0.
    fn log_slope(self) -> f64 {
        if self.value > 0.0 { self.slope / self.value } else { 0.0 }
    }
}

/// The weights that a slope is a difference between; None right on a node, which has no other beside it.
fn steps_around(upper_weight: f32) -> Option<(f32, f32)> {
    let ends = ((upper_weight - SLOPE_STEP).max(0.0), (upper_weight + SLOPE_STEP).min(1.0));
    (upper_weight > 0.0).then_some(ends)
}

fn scales_of<'a>(cell: &PreparedCell, scales: &'a [NodeScales]) -> CellScales<'a> {
    CellScales([cell.lower_node, cell.upper_node()].map(|node| &scales[node as usize]))
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
        let blocks: Vec<(&[MixedNode], &ColumnBlock)> = mixed
            .chunks_exact(node_count)
            .zip(correlated.chunks_exact(AZIMUTH_COUNT))
            .map(|(nodes, columns)| (nodes, &columns[column.azimuth as usize]))
            .collect();
        add_products(cells, &blocks, products);
    });
    products
}

dispatch_wide!(
    /// The products of one column's cells, over all blocks of functions.
    add_products, add_products_wide, add_products_body,
    (
        cells: &[PreparedCell],
        blocks: &[(&[MixedNode], &ColumnBlock)],
        products: &mut [[[f32; BAND_COUNT]; 2]]
    )
);

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
