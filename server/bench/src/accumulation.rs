//! The second baseline, accumulation of source images: the sky as the sum of every lit cell's own image, interpolated between
//! resident images.
//!
//! The obvious fast way without a basis. For each node (ring × source altitude) that a cell touches there is an image of
//! 256 × 64 directions in every band for this observer and these lobes. A cell's image is a line between those of its two
//! nodes, turned to the cell's column and added. The same nodes and weights as the engine's, so that both skies differ by
//! rounding alone. Where these images come from is timed apart ([`crate::image_mixing`]).

use crate::images::{ImageTable, TASK_LEN, TASKS_PER_BAND};
use rayon::prelude::*;
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, Panorama, simd::multiply_add, simd_dispatch};
use skyglow_render::{
    prepare::{Prepared, PreparedCell},
    reference::{ExactNode, mixed_node},
};
use skyglow_tables::ResidentTables;

/// A cell with its column, ready to be added.
#[derive(Clone, Copy, Debug)]
struct PlacedCell {
    azimuth: usize,
    cell: PreparedCell,
}

/// The cells of a request in one band: where each goes, and the weights of its two images.
#[derive(Clone, Copy, Debug)]
struct WeighedCell {
    azimuth: usize,
    nodes: [usize; 2],
    weights: [f32; 2],
}

/// Images at the nodes of a request, from one pack.
#[derive(Clone, Debug)]
pub struct SourceImages {
    cells: Vec<PlacedCell>,
    node_count: usize,
    /// `[band][node]`; their shapes are in the images.
    nodes: Vec<ExactNode>,
    images: ImageTable,
    flux_per_dnb_flux: [f32; BAND_COUNT],
}

impl SourceImages {
    /// Images of every node that some of the request's cells need: at most `max_cells` of them, evenly chosen.
    pub fn of(request: &Prepared, tables: &ResidentTables, max_cells: usize) -> Self {
        let stride = request.cells.len().div_ceil(max_cells.max(1)).max(1);
        let placed = request.columns.iter().flat_map(|column| {
            let cells = &request.cells[column.first_cell as usize..column.end_cell as usize];
            cells.iter().map(|&cell| PlacedCell { azimuth: column.azimuth as usize, cell })
        });
        let mut cells: Vec<PlacedCell> = placed.step_by(stride).collect();
        let mut nodes: Vec<u32> =
            cells.iter().flat_map(|placed| [placed.cell.lower_node, placed.cell.upper_node()]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: u32| nodes.partition_point(|&other| other < node) as u32;
        for PlacedCell { cell, .. } in &mut cells {
            // Both nodes of a cell are listed, so that the upper one stays the next.
            cell.lower_node = place(cell.lower_node);
        }
        let basis_count = request.basis_count.min(tables.basis_count);
        let (nodes_mixed, shape): (Vec<ExactNode>, Vec<Vec<f32>>) = (0..BAND_COUNT * nodes.len())
            .into_par_iter()
            .map(|slot| {
                let node = &request.nodes[nodes[slot % nodes.len()] as usize];
                let mut mixed = mixed_node(request, tables, slot / nodes.len(), node, basis_count);
                let shape = std::mem::take(&mut mixed.shape);
                (mixed, shape.into_iter().map(|value| value as f32).collect::<Vec<f32>>())
            })
            .unzip();
        Self {
            cells,
            node_count: nodes.len(),
            nodes: nodes_mixed,
            images: ImageTable::expand(tables, &shape),
            flux_per_dnb_flux: request.flux_per_dnb_flux,
        }
    }

    /// Cells that are accumulated.
    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// Bytes of the images.
    pub fn bytes(&self) -> u64 {
        self.images.bytes()
    }

    /// The sky of the cells, radiance `[band][row][column]`, W m⁻² sr⁻¹.
    pub fn accumulate(&self) -> Vec<f32> {
        let mut radiance_w_m2_sr = vec![0.0; Panorama::LEN];
        let weighed: Vec<Vec<WeighedCell>> = (0..BAND_COUNT).map(|band| self.weighed(band)).collect();
        radiance_w_m2_sr.par_chunks_mut(TASK_LEN).enumerate().for_each(|(task, rows)| {
            accumulate_rows(&weighed[task / TASKS_PER_BAND], self.images.of_task(task), rows);
            for sample in rows {
                *sample = sample.max(0.0);
            }
        });
        radiance_w_m2_sr
    }

    /// Φ · exp(ln scale between the nodes) for each cell, shared between its two images.
    fn weighed(&self, band: usize) -> Vec<WeighedCell> {
        let mixed = &self.nodes[band * self.node_count..][..self.node_count];
        let weigh = |&PlacedCell { azimuth, cell }: &PlacedCell| {
            let nodes = [cell.lower_node as usize, cell.upper_node() as usize];
            let up = f64::from(cell.upper_weight);
            let log = mixed[nodes[0]].log_scale_between(&mixed[nodes[1]], up);
            let scale = f64::from(cell.flux_dnb_w) * f64::from(self.flux_per_dnb_flux[band]) * log.exp();
            WeighedCell { azimuth, nodes, weights: [(scale * (1.0 - up)) as f32, (scale * up) as f32] }
        };
        self.cells.iter().map(weigh).collect()
    }
}

simd_dispatch! {
    /// Adds every cell's image to some rows of the sky.
    fn accumulate_rows(
        cells: &[WeighedCell],
        images: &[f32],
        rows: &mut [f32],
    ) = accumulate_rows_body::<FUSED>;
}

#[inline(always)]
fn accumulate_rows_body<const FUSED: bool>(cells: &[WeighedCell], images: &[f32], rows: &mut [f32]) {
    for WeighedCell { azimuth, nodes, weights } in cells {
        let [lower, upper] = nodes.map(|node| &images[node * TASK_LEN..][..TASK_LEN]);
        let parts = lower.chunks_exact(AZIMUTH_COUNT).zip(upper.chunks_exact(AZIMUTH_COUNT));
        for (target, (lower, upper)) in rows.chunks_exact_mut(AZIMUTH_COUNT).zip(parts) {
            // The image's column 0 lies at the cell's own; behind the last column the first one follows.
            let (first, second) = target.split_at_mut(*azimuth);
            let turned = second.len();
            add_between::<FUSED>(&lower[..turned], &upper[..turned], *weights, second);
            add_between::<FUSED>(&lower[turned..], &upper[turned..], *weights, first);
        }
    }
}

#[inline(always)]
fn add_between<const FUSED: bool>(lower: &[f32], upper: &[f32], weights: [f32; 2], target: &mut [f32]) {
    for ((target, lower), upper) in target.iter_mut().zip(lower).zip(upper) {
        let sum = multiply_add::<FUSED>(weights[0], *lower, *target);
        *target = multiply_add::<FUSED>(weights[1], *upper, sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::LitScene;
    use skyglow_physics::{EmissionMix, Turbidity};
    use skyglow_render::{DeviceChoice, Engine, EngineConfig, RenderRequest, TableSet, synthetic};
    use skyglow_tables::Scattering;
    use std::sync::Arc;

    /// Largest difference between the engine's sky and an accumulated one, of the brighter of the two, where either is a
    /// thousandth of the brightest direction.
    fn difference(request: &RenderRequest, accumulated: &Prepared, max_cells: usize) -> f64 {
        let tables = synthetic::table_set(&[2.0], 24);
        let config =
            EngineConfig { device: DeviceChoice::Cpu, tables: tables.clone(), ..EngineConfig::default() };
        let rendered = Engine::start(config).unwrap().render_blocking(request.clone()).unwrap();
        let sky = SourceImages::of(accumulated, &tables[0], max_cells).accumulate();
        let brightest = sky.iter().copied().fold(0.0, f32::max);
        let of_sample = |(a, b): (&f32, &f32)| f64::from((a - b).abs() / a.max(*b).max(1e-3 * brightest));
        rendered.panorama.samples().iter().zip(&sky).map(of_sample).fold(0.0, f64::max)
    }

    /// The accumulated sky is the engine's and that of half the cells is not.
    #[test]
    fn accumulation_equals_the_engine() {
        let set = TableSet::new(synthetic::table_set(&[2.0], 24)).unwrap();
        let scene = LitScene::of_cells(200);
        let request = RenderRequest {
            polar: Arc::clone(&scene.polar),
            observer_altitude_m: scene.observer_altitude_m,
            turbidity: Turbidity::new(2.0).unwrap(),
            scattering: Scattering::Single,
            cloud_base_m: None,
            emission: EmissionMix::garstang(),
            flux_per_dnb_flux: synthetic::flux_per_dnb_flux(),
            basis: None,
        };
        let prepared = Prepared::new(&request, &set).unwrap();
        let same = difference(&request, &prepared, usize::MAX);
        assert!(same < 1e-3, "{same}");
        assert!(difference(&request, &prepared, 100) > 0.1);
        let raised = RenderRequest { observer_altitude_m: 900.0, ..request.clone() };
        assert!(difference(&request, &Prepared::new(&raised, &set).unwrap(), usize::MAX) > 0.02);
    }
}
