//! The render plan of a batch as data: it prints, and tests read it without a device.

use crate::{prepare::Prepared, table_set::TableSet};
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT};
use skyglow_tables::resident::FREQUENCY_COUNT;
use std::fmt;

/// The passes, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pass {
    /// Lobe shares and mixed scale of each node in use.
    MixScale,
    /// Shape coefficients of each node in use.
    MixShape,
    /// Weights of each lit cell's nodes.
    CellWeights,
    /// H_k of each lit column.
    Coefficients,
    /// F[H_k].
    AzimuthFft,
    /// Σ_k F[H_k]·F[B_k].
    BasisSum,
    /// Radiance.
    InverseFft,
    /// Interpolation between packs.
    Blend,
}

impl Pass {
    /// All passes, in order.
    pub const ALL: [Pass; 8] = [
        Pass::MixScale,
        Pass::MixShape,
        Pass::CellWeights,
        Pass::Coefficients,
        Pass::AzimuthFft,
        Pass::BasisSum,
        Pass::InverseFft,
        Pass::Blend,
    ];

    /// The name of its file in `shaders/passes`, and of its time in answers.
    pub const fn name(self) -> &'static str {
        match self {
            Pass::MixScale => "mix_scale",
            Pass::MixShape => "mix_shape",
            Pass::CellWeights => "cell_weights",
            Pass::Coefficients => "coefficients",
            Pass::AzimuthFft => "azimuth_fft",
            Pass::BasisSum => "basis_sum",
            Pass::InverseFft => "inverse_fft",
            Pass::Blend => "blend",
        }
    }

    /// Position in [`Self::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// Basis functions in a texel of the tables: what lies on a device holds whole texels.
pub const FUNCTIONS_PER_TABLE_TEXEL: usize = 8;
/// Basis functions in a texel between the passes, and in one workgroup of the transform.
pub const FUNCTIONS_PER_TEXEL: usize = 4;
/// Basis functions that one invocation mixes. Software Vulkan computes addresses for eight invocations at once: the more each
/// reads there, the less that costs.
pub const MIXED_PER_LANE: usize = 32;
/// Basis functions that one invocation of the coefficient pass sums.
pub const SUMMED_PER_LANE: usize = 16;
/// Invocations in a workgroup of the pass over frequencies: one vector of an eight-wide machine.
pub const LANES: usize = 8;
/// Elevations that one invocation of the basis sum works on.
pub const ELEVATIONS_PER_LANE: usize = 8;
/// Elevations that one workgroup transforms.
pub const ELEVATIONS_PER_TRANSFORM: usize = 4;
/// Invocations in a workgroup of the transforms: the root of their points.
pub const TRANSFORM_LANES: usize = 16;
/// Invocations in a workgroup of the other passes.
pub const WORKGROUP: usize = 64;

/// One dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlannedPass {
    /// What runs.
    pub pass: Pass,
    /// Which of the plan's packs it reads; None for the blend, which reads them all.
    pub pack_slot: Option<usize>,
    /// Workgroups in x, y, z.
    pub workgroups: [u32; 3],
}

/// One pack as a batch uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedPack {
    /// Index in the table set.
    pub index: usize,
    /// Its turbidity.
    pub turbidity: f64,
    /// Functions in use.
    pub basis_count: usize,
    /// Groups of four functions, rounded up so that lanes are full.
    pub quad_count: usize,
}

/// Everything that one submission runs.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderPlan {
    /// Requests in the batch.
    pub request_count: usize,
    /// Nodes of all requests.
    pub node_count: usize,
    /// Lit cells of all requests.
    pub cell_count: usize,
    /// Lit columns of all requests.
    pub column_count: usize,
    /// Packs, in the order of their slots.
    pub packs: Vec<PlannedPack>,
    /// Dispatches, in order.
    pub passes: Vec<PlannedPass>,
}

impl RenderPlan {
    /// The plan of a batch of compatible requests with light.
    pub fn of(batch: &[&Prepared], set: &TableSet) -> Self {
        let sum = |count: fn(&Prepared) -> usize| batch.iter().map(|request| count(request)).sum::<usize>();
        let indices = batch.first().map_or(0..0, |request| request.turbidity_stencil.nodes());
        let packs = indices
            .map(|index| {
                let tables = &set.tables()[index];
                let basis_count =
                    batch.first().map_or(0, |request| request.basis_count.min(tables.basis_count));
                let quad_count =
                    basis_count.next_multiple_of(FUNCTIONS_PER_TABLE_TEXEL) / FUNCTIONS_PER_TEXEL;
                PlannedPack { index, turbidity: tables.turbidity, basis_count, quad_count }
            })
            .collect();
        let mut plan = Self {
            request_count: batch.len(),
            node_count: sum(|request| request.nodes.len()),
            cell_count: sum(|request| request.cells.len()),
            column_count: sum(|request| request.columns.len()),
            packs,
            passes: Vec::new(),
        };
        plan.list_passes();
        plan
    }

    fn list_passes(&mut self) {
        let groups = |items: usize, size: usize| items.div_ceil(size) as u32;
        let (bands, requests) = (BAND_COUNT as u32, self.request_count as u32);
        for (slot, pack) in self.packs.iter().enumerate() {
            let functions = pack.quad_count * FUNCTIONS_PER_TEXEL;
            // Dark columns are written too: nothing else clears what another batch left there.
            let columns = self.request_count * AZIMUTH_COUNT;
            let mixed = self.node_count * BAND_COUNT * functions.div_ceil(MIXED_PER_LANE);
            let summed = columns * functions.div_ceil(SUMMED_PER_LANE);
            for (pass, workgroups) in [
                (Pass::MixScale, [groups(self.node_count, WORKGROUP), 1, 1]),
                (Pass::MixShape, [groups(mixed, WORKGROUP), 1, 1]),
                (Pass::CellWeights, [groups(self.cell_count, WORKGROUP), 1, 1]),
                (Pass::Coefficients, [groups(summed, WORKGROUP), bands, 1]),
                (Pass::AzimuthFft, [pack.quad_count as u32, bands, requests]),
                (
                    Pass::BasisSum,
                    [groups(FREQUENCY_COUNT, LANES), groups(ELEVATION_COUNT, ELEVATIONS_PER_LANE), requests],
                ),
                (Pass::InverseFft, [groups(ELEVATION_COUNT, ELEVATIONS_PER_TRANSFORM), bands, requests]),
            ] {
                self.passes.push(PlannedPass { pass, pack_slot: Some(slot), workgroups });
            }
        }
        if self.packs.len() > 1 {
            let samples = BAND_COUNT * ELEVATION_COUNT * AZIMUTH_COUNT;
            let workgroups = [groups(samples, WORKGROUP), requests, 1];
            self.passes.push(PlannedPass { pass: Pass::Blend, pack_slot: None, workgroups });
        }
    }
}

impl fmt::Display for RenderPlan {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            out,
            "{} requests, {} nodes, {} cells, {} columns",
            self.request_count, self.node_count, self.cell_count, self.column_count
        )?;
        for planned in &self.passes {
            let [x, y, z] = planned.workgroups;
            write!(out, "{:<13} {x} x {y} x {z}", planned.pass.name())?;
            match planned.pack_slot {
                Some(slot) => {
                    let pack = &self.packs[slot];
                    writeln!(out, "  T = {}, {} functions", pack.turbidity, pack.basis_count)?;
                }
                None => writeln!(out, "  {} packs", self.packs.len())?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{request::RenderRequest, synthetic};
    use skyglow_physics::{EmissionMix, Turbidity};
    use skyglow_tables::Scattering;
    use std::sync::Arc;

    fn prepared(turbidity: f64, cells: &[(usize, u32, f32, f32)], set: &TableSet) -> Prepared {
        let request = RenderRequest {
            polar: Arc::new(synthetic::polar_grid_of(cells)),
            observer_altitude_m: 300.0,
            turbidity: Turbidity::new(turbidity).unwrap(),
            scattering: Scattering::Single,
            cloud_base_m: None,
            emission: EmissionMix::garstang(),
            flux_per_dnb_flux: [1.0; BAND_COUNT],
            basis: Some(10),
        };
        Prepared::new(&request, set).unwrap()
    }

    #[test]
    fn the_plan_of_one_pack_prints_as_expected() {
        let set = TableSet::new(synthetic::table_set(&[2.0, 3.0], 12)).unwrap();
        let request = prepared(2.0, &[(0, 5, 1.0, 0.0), (9, 5, 1.0, 10.0), (9, 6, 1.0, 10.0)], &set);
        let expected = format!(
            "\
2 requests, 8 nodes, 6 cells, 4 columns
mix_scale     1 x 1 x 1  T = 2, 10 functions
mix_shape     1 x 1 x 1  T = 2, 10 functions
cell_weights  1 x 1 x 1  T = 2, 10 functions
coefficients  8 x {BAND_COUNT} x 1  T = 2, 10 functions
azimuth_fft   4 x {BAND_COUNT} x 2  T = 2, 10 functions
basis_sum     17 x 8 x 2  T = 2, 10 functions
inverse_fft   16 x {BAND_COUNT} x 2  T = 2, 10 functions
"
        );
        assert_eq!(RenderPlan::of(&[&request, &request], &set).to_string(), expected);
    }

    /// A turbidity between packs runs every neighbour and blends once.
    #[test]
    fn between_packs_each_runs_and_one_blends() {
        let set = TableSet::new(synthetic::table_set(&[2.0, 3.0, 4.0], 12)).unwrap();
        let plan = RenderPlan::of(&[&prepared(2.5, &[(0, 5, 1.0, 0.0)], &set)], &set);
        let turbidities: Vec<f64> = plan.packs.iter().map(|pack| pack.turbidity).collect();
        assert_eq!(turbidities, [2.0, 3.0, 4.0]);
        assert_eq!(plan.passes.len(), 3 * 7 + 1);
        assert_eq!(
            plan.passes.last().map(|last| (last.pass, last.workgroups)),
            Some((Pass::Blend, [256 * BAND_COUNT as u32, 1, 1]))
        );
    }
}
