//! Truncation error bounds (triangle and Cauchy–Schwarz inequalities): how far a sky of the first basis functions alone can be from that of
//! all, from the tables, before anything is rendered (`docs/model.md#truncation`).
//!
//! The measure is the norm over the open sky, ‖L‖² = Σ_samples ω·L², relative to the whole sky's, in the worst band.
//! With the cells' weights w (flux × scale), the shape coefficients c of their nodes and all K functions,
//!
//! * ‖L − L_M‖ ≤ Σ_cells w·‖Σ_{M≤k<K} c_k·B_k‖, by the triangle inequality, for turning an image in azimuth keeps its norm;
//! * ‖L‖ ≥ Σ_cells w·∫Σ_k c_k·B_k dΩ / √Ω by the Cauchy–Schwarz inequality, Ω the solid angle of the sky.
//!
//! Both hold for radiance held at 0 too, which moves no two skies apart and adds to the integral. Between turbidities
//! the logarithms of radiances are interpolated, and a norm says nothing of logarithms: there all functions are used.

use crate::{
    cpu::{cell_weights::cell_weights, mix_scale::mix_scale},
    error::RenderError,
    node_norms::{FUNCTIONS_PER_STEP, NodeNorms},
    node_table::NodeTable,
    prepare::{MixNode, Prepared},
    request::RenderRequest,
    table_set::TableSet,
};
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT, Panorama, panorama::solid_angle_sr,
};
use skyglow_tables::resident::{FREQUENCY_COUNT, ResidentBlocked, ResidentTables};
use std::sync::{Arc, OnceLock};

/// Relative difference that rounding in f32 may add to every bound: a tenth of what the executors' tests allow.
const ROUNDING: f64 = 1e-6;

/// A number of functions, and what it costs in accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BasisWithin {
    /// Functions to use.
    pub basis_count: usize,
    /// Upper bound of ‖L − L_M‖/‖L‖ over the open sky in the worst band; 0 with all functions.
    pub error_bound: f64,
}

/// Chooses basis sizes. What it needs of a pack it computes when it is first asked about that pack, which takes some
/// tenths of a second.
#[derive(Debug)]
pub struct BasisChooser {
    set: Arc<TableSet>,
    norms: Vec<OnceLock<PackNorms>>,
}

/// The norms of a pack's nodes: those under an open sky, and those behind skylines.
#[derive(Debug)]
struct PackNorms {
    open: NodeNorms,
    blocked: Option<NodeNorms>,
}

impl BasisChooser {
    /// For the packs of a set.
    pub fn new(set: Arc<TableSet>) -> Self {
        let norms = set.tables().iter().map(|_| OnceLock::new()).collect();
        Self { set, norms }
    }

    /// The fewest functions whose sky is within a tolerance, a relative difference above 0; all of them where no bound
    /// says so of fewer. Takes milliseconds, and the first time for a pack longer.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn basis_within(&self, request: &RenderRequest, tolerance: f64) -> Result<BasisWithin, RenderError> {
        let all = Prepared::new(&RenderRequest { basis: None, ..request.clone() }, &self.set)?;
        let whole = BasisWithin { basis_count: all.basis_count, error_bound: 0.0 };
        let bounds = self.error_bounds(&all);
        Ok(bounds.into_iter().find(|within| within.error_bound <= tolerance).unwrap_or(whole))
    }

    /// Bounds by basis size, ascending; none where all functions must be used.
    fn error_bounds(&self, request: &Prepared) -> Vec<BasisWithin> {
        let packs = request.turbidity_stencil.nodes();
        if packs.len() > 1 || request.is_dark() {
            return Vec::new();
        }
        let pack = packs.start;
        let tables = &self.set.tables()[pack];
        let norms = self.norms[pack].get_or_init(|| PackNorms::of(tables));
        let sums = Sums::of(request, tables, norms);
        let bound = |(step, remainders): (usize, &[f64; BAND_COUNT])| BasisWithin {
            basis_count: (step + 1) * FUNCTIONS_PER_STEP,
            error_bound: sums.relative(remainders) + ROUNDING,
        };
        sums.remainders.iter().enumerate().map(bound).collect()
    }
}

impl PackNorms {
    fn of(tables: &ResidentTables) -> Self {
        let gram = gram_matrix(tables);
        let integrals: Vec<f64> = (0..tables.basis_count).map(|k| integral_sr(tables, k)).collect();
        let open = NodeNorms::of(&tables.shape, tables.basis_count, &gram, &integrals);
        let of_blocked =
            |blocked: &ResidentBlocked| NodeNorms::of(&blocked.shape, blocked.basis_count, &gram, &integrals);
        let blocked = tables.blocked.as_ref().map(of_blocked);
        Self { open, blocked }
    }
}

/// Sums over the cells of a request, by band.
struct Sums {
    /// Σ w·‖Σ_{k≥M} c_k·B_k‖, `[M/8 − 1][band]`.
    remainders: Vec<[f64; BAND_COUNT]>,
    /// Σ w·∫Σ_k c_k·B_k dΩ.
    integral: [f64; BAND_COUNT],
}

impl Sums {
    fn of(request: &Prepared, tables: &ResidentTables, norms: &PackNorms) -> Self {
        let (mut scales, mut weights) = (Vec::new(), Vec::new());
        mix_scale(tables, request, true, &mut scales);
        cell_weights(request, &scales, true, &mut weights);
        let mut of_node = vec![[0f64; BAND_COUNT]; request.nodes.len()];
        for (cell, [to_lower, to_upper]) in request.cells.iter().zip(&weights) {
            for band in 0..BAND_COUNT {
                of_node[cell.lower_node as usize][band] += f64::from(to_lower[band]);
                of_node[cell.upper_node() as usize][band] += f64::from(to_upper[band]);
            }
        }
        let steps = request.basis_count.div_ceil(FUNCTIONS_PER_STEP) - 1;
        let mut sums = Self { remainders: vec![[0.0; BAND_COUNT]; steps], integral: [0.0; BAND_COUNT] };
        for ((node, weights), scales) in request.nodes.iter().zip(&of_node).zip(&scales) {
            for band in (0..BAND_COUNT).filter(|&band| weights[band] > 0.0) {
                sums.add(request, tables, norms, node, band, weights[band], scales.shares[band]);
            }
        }
        sums
    }

    /// Adds a node whose cells have a weight in a band.
    fn add(
        &mut self,
        request: &Prepared,
        tables: &ResidentTables,
        norms: &PackNorms,
        node: &MixNode,
        band: usize,
        weight: f64,
        shares: [f32; LOBE_COUNT],
    ) {
        let table = NodeTable::of(tables, request, node);
        let norms = norms.blocked.as_ref().filter(|_| table.is_behind_skyline()).unwrap_or(&norms.open);
        for lobe in (0..LOBE_COUNT).filter(|&lobe| shares[lobe] > 0.0) {
            for (altitude, of_altitude) in table.altitudes {
                let weight = weight * f64::from(shares[lobe]) * of_altitude;
                let node = table.shape_index(altitude, lobe, band);
                self.integral[band] += weight * norms.integral(node);
                // Interpolation takes some altitudes away; norms add up all the same.
                for (sums, remainder) in self.remainders.iter_mut().zip(norms.remainders(node)) {
                    sums[band] += weight.abs() * f64::from(*remainder);
                }
            }
        }
    }

    /// The bound in the worst band that has light.
    fn relative(&self, remainders: &[f64; BAND_COUNT]) -> f64 {
        let sky_sr: f64 = (0..ELEVATION_COUNT).map(|row| AZIMUTH_COUNT as f64 * solid_angle_sr(row)).sum();
        let bands = remainders.iter().zip(self.integral).filter(|(remainder, _)| **remainder > 0.0);
        bands.fold(0.0, |worst, (remainder, integral)| {
            let norm = integral / sky_sr.sqrt();
            worst.max(if norm > 0.0 { remainder / norm } else { f64::INFINITY })
        })
    }
}

/// ‖L − L'‖/‖L‖ over the open sky in the worst band that has light: what [`BasisWithin::error_bound`] bounds.
pub fn relative_difference(sky: &Panorama, other: &Panorama) -> f64 {
    let (mut worst, mut squares) = (0f64, [[0f64; 2]; BAND_COUNT]);
    for (position, (a, b)) in sky.samples().iter().zip(other.samples()).enumerate() {
        let row = position / AZIMUTH_COUNT % ELEVATION_COUNT;
        let [difference, size] = &mut squares[position / (AZIMUTH_COUNT * ELEVATION_COUNT)];
        *difference += solid_angle_sr(row) * (f64::from(*a) - f64::from(*b)).powi(2);
        *size += solid_angle_sr(row) * f64::from(*a).powi(2);
    }
    for [difference, size] in squares {
        worst = worst.max(if size > 0.0 { (difference / size).sqrt() } else { 0.0 });
    }
    worst
}

/// ∫B_k·B_l dΩ, `[k][l]`, by Parseval's theorem along azimuth.
pub fn gram_matrix(tables: &ResidentTables) -> Vec<f64> {
    let count = tables.basis_count;
    let row =
        |k: usize, row: usize| &tables.basis_spectrum[tables.spectrum_index(k, row, 0)..][..FREQUENCY_COUNT];
    let mut gram = vec![0.0; count * count];
    for k in 0..count {
        for l in 0..=k {
            let product = |elevation: usize| {
                let values = row(k, elevation).iter().zip(row(l, elevation)).enumerate();
                let sum: f64 = values
                    .map(|(f, (a, b))| {
                        let twice = if f == 0 || f == FREQUENCY_COUNT - 1 { 1.0 } else { 2.0 };
                        twice * f64::from(*a) * f64::from(*b)
                    })
                    .sum();
                solid_angle_sr(elevation) * sum / AZIMUTH_COUNT as f64
            };
            let sum: f64 = (0..ELEVATION_COUNT).map(product).sum();
            (gram[k * count + l], gram[l * count + k]) = (sum, sum);
        }
    }
    gram
}

/// ∫B_k dΩ, sr.
fn integral_sr(tables: &ResidentTables, k: usize) -> f64 {
    let of_row =
        |row| solid_angle_sr(row) * f64::from(tables.basis_spectrum[tables.spectrum_index(k, row, 0)]);
    (0..ELEVATION_COUNT).map(of_row).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DeviceChoice, Engine, EngineConfig, synthetic};
    use skyglow_physics::Turbidity;
    use skyglow_scene::PolarGrid;

    fn engine() -> Engine {
        let tables = synthetic::table_set_with_skylines(&[2.0, 3.0], 40);
        Engine::start(EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() }).unwrap()
    }

    fn request(polar: PolarGrid, turbidity: f64) -> RenderRequest {
        synthetic::request(polar, Turbidity::new(turbidity).unwrap())
    }

    /// A sky within a tolerance differs from that of all functions by no more than its bound.
    #[test]
    fn truncated_skies_keep_their_bound() {
        let engine = engine();
        let chooser = engine.basis_chooser();
        let grids = [
            synthetic::polar_grid(5, 3000),
            synthetic::polar_grid_with_skylines(6, 3000),
            synthetic::polar_grid_of(&[(3, 60, 1e5, 900.0)]),
            synthetic::polar_grid_of(&[(3, 20, 1e3, 1700.0), (131, 150, 1e7, 100.0)]),
        ];
        let mut sizes = Vec::new();
        for grid in grids {
            let asked = request(grid, 2.0);
            let render = |basis| {
                engine
                    .render_blocking(RenderRequest { basis: Some(basis), ..asked.clone() })
                    .unwrap()
                    .panorama
            };
            let all = render(40);
            for tolerance in [0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 1e-4] {
                let within = chooser.basis_within(&asked, tolerance).unwrap();
                let error = relative_difference(&all, &render(within.basis_count));
                println!("{tolerance}: {within:?}, {error:.1e}");
                assert!(
                    error <= within.error_bound && within.error_bound <= tolerance,
                    "{error:e} {within:?}"
                );
                // The bound is of this sky: with fewer functions it would be passed.
                let fewer = relative_difference(&all, &render(within.basis_count / 8));
                assert!(within.basis_count == 8 || fewer > within.error_bound, "{fewer:e} {within:?}");
                sizes.push(within.basis_count);
            }
        }
        assert!(sizes.iter().any(|&size| size < 24) && sizes.contains(&40), "{sizes:?}");
    }

    /// Between turbidities and without light no bound is claimed of fewer functions.
    #[test]
    fn no_bound_between_packs_or_in_the_dark() {
        let chooser = engine().basis_chooser();
        let all = BasisWithin { basis_count: 40, error_bound: 0.0 };
        let between = request(synthetic::polar_grid(5, 300), 2.4);
        assert_eq!(chooser.basis_within(&between, 0.5).unwrap(), all);
        assert_eq!(chooser.basis_within(&request(synthetic::dark_grid(), 2.0), 0.5).unwrap(), all);
        let resident = request(synthetic::polar_grid(5, 300), 2.0);
        assert!(chooser.basis_within(&resident, 0.5).unwrap().basis_count < 40);
    }
}
