//! The measure of every lit cell of a request.

use super::{
    blended_sky::blended,
    correlation::correlate,
    norms::NormsOfPack,
    products::products,
    ready::{KnownSky, ReadyRequest, ReadyRequests},
    scales::{Slope, scales_of},
    sensitivity::{SeenMeasure, sensitivities, spectral_weights},
};
use crate::{cache_sizes::CacheSizes, error::ObservatoryError};
use rayon::prelude::*;
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, LinearMeasure, Panorama, panorama::solid_angle_sr, spectrum::SpectralRule,
};
use skyglow_render::{
    cpu::CpuExecutor,
    light_share::LightShare,
    prepare::{Prepared, PreparedCell, basis_count_in_use},
    request::RenderRequest,
    table_set::TableSet,
    truncation::gram_matrix,
};
use std::sync::{Arc, OnceLock};

/// Cells that a task works on.
const CELLS_AT_ONCE: usize = 1024;
/// Steepest slope of ln(measure) over altitude in use, m⁻¹: next to the ground of a near lamp a step of the axis is metres.
const STEEPEST_PER_M: f64 = 0.02;

/// What is asked of every cell.
#[derive(Clone, Copy, Debug)]
pub enum MeasureOfCells<'a> {
    /// A linear measure: cells add up to the sky's own value.
    Linear(SeenMeasure<'a>),
    /// ‖image of the cell alone‖ = (∫ L² dΩ)^½ over the open upper hemisphere, in the response's unit times sr^½ (paper Eq. 10–11 for
    /// any basis: √(cᵀ·gram·c)). Between turbidities the logarithms of the packs' norms are blended.
    Norm(&'a SpectralRule),
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

/// Finds influences, on the processor; what it needs of a pack for norms it computes once, and what maps of one light under one
/// air have in common it keeps for a while.
pub struct InfluenceSolver {
    set: Arc<TableSet>,
    executor: CpuExecutor,
    grams: Vec<OnceLock<Vec<f32>>>,
    ready: ReadyRequests,
}

impl std::fmt::Debug for InfluenceSolver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("InfluenceSolver").finish_non_exhaustive()
    }
}

impl InfluenceSolver {
    /// For the packs of a set.
    pub fn new(set: Arc<TableSet>) -> Self {
        Self::keeping(set, CacheSizes::most(0).ready_requests_bytes)
    }

    /// The same with so many bytes of requests made ready.
    pub(crate) fn keeping(set: Arc<TableSet>, ready_bytes: u64) -> Self {
        let grams = set.tables().iter().map(|_| OnceLock::new()).collect();
        Self {
            executor: CpuExecutor::new(set.as_ref().clone()),
            set,
            grams,
            ready: ReadyRequests::new(ready_bytes),
        }
    }

    /// Basis functions that a request takes.
    ///
    /// # Errors
    /// As [`Prepared::new`] for what is not resident or out of range.
    pub(crate) fn basis_count(&self, request: &RenderRequest) -> Result<usize, ObservatoryError> {
        Ok(basis_count_in_use(request, &self.set)?)
    }

    /// The measure of each cell of the request's grid, by its place in [`PolarGrid::cells`](skyglow_scene::PolarGrid::cells).
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn cells(
        &self,
        request: &RenderRequest,
        measure: MeasureOfCells<'_>,
    ) -> Result<Vec<CellInfluence>, ObservatoryError> {
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
    ) -> Result<CellsInSky, ObservatoryError> {
        let is_linear = matches!(measure, MeasureOfCells::Linear(_));
        // A norm asks for no sky.
        let ready = self.ready.get(request, is_linear.then_some(sky), &self.set, &self.executor)?;
        let prepared = &ready.prepared;
        let mut cells = vec![CellInfluence::default(); request.polar.cells.len()];
        let mut of_sky = None;
        if prepared.is_dark() {
            of_sky = is_linear.then_some(0.0);
            return Ok(CellsInSky { cells, of_sky });
        }
        // Cells that shine on clouds from above are in the grid and not among those prepared.
        let (observer_m, cloud_m) = (prepared.observer_altitude_m, request.kind().cloud_altitude_m());
        let places: Vec<(u32, LightShare)> = (0u32..)
            .zip(request.polar.cells.iter().map(|cell| LightShare::of(cell, observer_m, cloud_m)))
            .filter(|(_, counts)| counts.share > 0.0)
            .collect();
        let mut of_cells = vec![Slope::default(); prepared.cells.len()];
        match measure {
            MeasureOfCells::Linear(measure) => {
                of_sky = Some(self.linear(&ready, measure, &mut of_cells));
            }
            MeasureOfCells::Norm(rule) => self.norms(&ready, rule, &mut of_cells),
        }
        let found: Vec<CellInfluence> = (places.par_iter().zip(&of_cells).zip(&prepared.cells))
            .with_min_len(CELLS_AT_ONCE)
            .map(|((&(at, counts), of_cell), cell)| {
                let per_m = self.upper_weight_per_m(request, prepared, at as usize, cell);
                let slope = of_cell.log_slope() * f64::from(per_m) + counts.log_slope_per_m;
                let per_dnb_w = f64::from(counts.share) * of_cell.value;
                let log_slope_per_m = slope.clamp(-STEEPEST_PER_M, STEEPEST_PER_M) as f32;
                CellInfluence { per_dnb_w, log_slope_per_m }
            })
            .collect();
        if found.len() == cells.len() {
            return Ok(CellsInSky { cells: found, of_sky });
        }
        for ((at, _), cell) in places.into_iter().zip(found) {
            cells[at as usize] = cell;
        }
        Ok(CellsInSky { cells, of_sky })
    }

    /// The norm of the sky of a request, as [`MeasureOfCells::Norm`] has it of a cell's.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn norm(&self, request: &RenderRequest, rule: &SpectralRule) -> Result<f64, ObservatoryError> {
        let prepared = Prepared::new(request, &self.set)?;
        if prepared.is_dark() {
            return Ok(0.0);
        }
        let stencil = &prepared.turbidity_stencil;
        let skies: Vec<Vec<f32>> =
            stencil.nodes().map(|pack| self.executor.sky(&prepared, pack, false)).collect();
        Ok(blended(skies, stencil, false).map_or(0.0, |mut sky| {
            if let Some(near) = &prepared.near {
                near.apply(&self.set, sky.samples_mut());
            }
            norm_of_values(&values_of(&sky, rule))
        }))
    }

    /// The sky that [`Self::cells_in_sky`] finds parts of, with near lights as they are.
    ///
    /// # Errors
    /// As [`Prepared::new`] of either.
    pub fn sky(&self, request: &RenderRequest, sky: &RenderRequest) -> Result<Panorama, ObservatoryError> {
        let ready = self.ready.get(request, Some(sky), &self.set, &self.executor)?;
        let known = ready.sky.as_ref().and_then(KnownSky::whole);
        Ok(known.cloned().unwrap_or_else(Panorama::dark))
    }

    /// What near lights do to a linear measure of the sky of `sky` beyond what its cells have of them, by their place in the
    /// `near` of its grid; `request` is that of [`Self::cells_in_sky`].
    ///
    /// # Errors
    /// As [`Prepared::new`] of either.
    pub fn near_lights(
        &self,
        request: &RenderRequest,
        sky: &RenderRequest,
        measure: SeenMeasure<'_>,
    ) -> Result<Vec<(usize, f64)>, ObservatoryError> {
        let ready = self.ready.get(request, Some(sky), &self.set, &self.executor)?;
        let known = ready.sky.as_ref();
        let Some(((between, whole), (near, shown))) =
            known.and_then(|sky| sky.between.as_ref().zip(sky.whole()).zip(sky.near.as_ref()))
        else {
            return Ok(Vec::new());
        };
        Ok(near.influences(&self.set, between.samples(), shown, spectral_weights(whole, measure)))
    }

    /// What each cell of the request's grid alone does to a linear measure of the kernel at every node, per DNB watt. The turbidity is
    /// to be one of the packs': between them skies are no sums.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn kernels(
        &self,
        request: &RenderRequest,
        measure: &LinearMeasure,
    ) -> Result<Vec<[f64; BAND_COUNT]>, ObservatoryError> {
        let ready = self.ready.get(request, None, &self.set, &self.executor)?;
        let prepared = &ready.prepared;
        let mut sums = vec![[0.0; BAND_COUNT]; prepared.cells.len()];
        let weights: Vec<f32> =
            (0..BAND_COUNT).flat_map(|_| measure.weights().iter().map(|weight| *weight as f32)).collect();
        for (pack, nodes) in prepared.turbidity_stencil.nodes().zip(&ready.nodes) {
            let tables = &self.set.tables()[pack];
            let basis_count = prepared.basis_count.min(tables.basis_count);
            let correlated = correlate(self.executor.twiddles(), tables, basis_count, &weights);
            let products = products(prepared, &nodes.mixed, &correlated);
            let flux = prepared.flux_per_dnb_flux;
            for ((sum, cell), products) in sums.iter_mut().zip(&prepared.cells).zip(&products) {
                *sum = scales_of(cell, &nodes.scales)
                    .times(flux, cell.upper_weight, products)
                    .map(|slope| slope.value);
            }
        }
        Ok(sums)
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

    /// Adds up what cells do, and gives what they do to the sky together.
    fn linear(&self, ready: &ReadyRequest, measure: SeenMeasure<'_>, sum: &mut [Slope]) -> f64 {
        let (request, Some(sky)) = (&ready.prepared, &ready.sky) else { return 0.0 };
        let (Some(between), Some(whole)) = (&sky.between, sky.whole()) else { return 0.0 };
        let stencil = &request.turbidity_stencil;
        let of_sky = spectral_weights(whole, measure);
        let weights = sensitivities(&sky.of_packs, stencil, &of_sky);
        for ((pack, weights), nodes) in stencil.nodes().zip(&weights).zip(&ready.nodes) {
            let tables = &self.set.tables()[pack];
            let basis_count = request.basis_count.min(tables.basis_count);
            let correlated = correlate(self.executor.twiddles(), tables, basis_count, weights);
            let products = products(request, &nodes.mixed, &correlated);
            let flux = request.flux_per_dnb_flux;
            let cells = sum.par_iter_mut().zip(&request.cells).zip(&products).with_min_len(CELLS_AT_ONCE);
            cells.for_each(|((sum, cell), products)| {
                let of_bands = scales_of(cell, &nodes.scales).times(flux, cell.upper_weight, products);
                of_bands.into_iter().for_each(|of_band| sum.add(of_band));
            });
        }
        let weighed = of_sky.iter().zip(between.samples()).filter(|(weight, _)| **weight != 0.0);
        weighed.map(|(weight, kernel)| f64::from(*weight) * f64::from(*kernel)).sum()
    }

    fn norms(&self, ready: &ReadyRequest, rule: &SpectralRule, logs: &mut [Slope]) {
        let (request, stencil) = (&ready.prepared, &ready.prepared.turbidity_stencil);
        for ((pack, weight), nodes) in stencil.iter().zip(&ready.nodes) {
            let tables = &self.set.tables()[pack];
            let gram = self.grams[pack]
                .get_or_init(|| gram_matrix(tables).into_iter().map(|value| value as f32).collect());
            let basis_count = request.basis_count.min(tables.basis_count);
            // The nodes alone: a norm knows no azimuth, and no sky is needed.
            let (scales, mixed, stride) = (&nodes.scales, &nodes.mixed, tables.basis_count);
            let of_pack = NormsOfPack { request, rule, scales, mixed, gram, basis_count, stride };
            logs.par_iter_mut().zip(&request.cells).with_min_len(64).for_each(|(log, cell)| {
                let norm = of_pack.norm(cell);
                log.value += weight * norm.value.max(f64::MIN_POSITIVE).ln();
                log.slope += weight * norm.log_slope();
            });
        }
        for log in logs {
            log.value = log.value.exp();
            log.slope *= log.value;
        }
    }
}

/// What a rule makes of a kernel in every direction, `[row][column]`.
pub(super) fn values_of(kernel: &Panorama, rule: &SpectralRule) -> Vec<f32> {
    let count = Panorama::LEN / BAND_COUNT;
    let value = |direction: usize| {
        rule.value(std::array::from_fn(|band| f64::from(kernel.samples()[band * count + direction])))
    };
    (0..count).map(|direction| value(direction) as f32).collect()
}

/// (∫ L² dΩ)^½ of values over the grid, `[row][column]`, in their unit times sr^½.
pub(crate) fn norm_of_values(values: &[f32]) -> f64 {
    let square = |(row, values): (usize, &[f32])| {
        solid_angle_sr(row) * values.iter().map(|value| f64::from(*value).powi(2)).sum::<f64>()
    };
    values.chunks_exact(AZIMUTH_COUNT).enumerate().map(square).sum::<f64>().sqrt()
}
