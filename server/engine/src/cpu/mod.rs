//! The same pipeline in plain Rust f32: the executor for machines without Vulkan, and the passes' twins.

pub(crate) mod accumulate;
pub(crate) mod basis_sum;
pub(crate) mod blend;
pub(crate) mod coefficients;
pub(crate) mod mix;
pub(crate) mod transforms;

use crate::{
    error::DeviceFault,
    executor::{BatchOutput, Executor, PassClock},
    plan::Pass,
    prepare::Prepared,
    request::ExecutorKind,
    table_set::TableSet,
};
use basis_sum::BlockedBasis;
use skyglow_physics::Panorama;
use transforms::Transforms;

/// Renders one request after the other, each on all cores.
pub(crate) struct CpuExecutor {
    set: TableSet,
    basis: Vec<BlockedBasis>,
    transforms: Transforms,
}

impl CpuExecutor {
    /// Lays the tables out for the passes.
    pub(crate) fn new(set: TableSet) -> Self {
        let basis = set.tables().iter().map(|tables| BlockedBasis::of(tables)).collect();
        Self { set, basis, transforms: Transforms::new() }
    }

    fn render_one(&self, request: &Prepared, clock: &mut PassClock) -> Vec<f32> {
        let mut rendered: Vec<Vec<f32>> = request
            .turbidity_taps
            .indices()
            .iter()
            .map(|&pack| self.render_pack(request, pack, clock))
            .collect();
        if rendered.len() == 1 {
            return rendered.swap_remove(0);
        }
        clock.time(Pass::Blend, || blend::blend(&rendered, &request.turbidity_taps))
    }

    fn render_pack(&self, request: &Prepared, pack: usize, clock: &mut PassClock) -> Vec<f32> {
        let tables = &self.set.tables()[pack];
        let scales = clock.time(Pass::MixScale, || mix::mix_scale(tables, request));
        let mixed = clock.time(Pass::MixShape, || mix::mix_shape(tables, request, &scales));
        let weights = clock.time(Pass::CellWeights, || coefficients::weigh_cells(request, &scales));
        let columns = clock.time(Pass::Coefficients, || coefficients::sum_columns(request, &mixed, &weights));
        let spectra = clock.time(Pass::AzimuthFft, || {
            self.transforms.forward(request, &columns, mixed.basis_count, mixed.padded_count)
        });
        let sums = clock.time(Pass::BasisSum, || basis_sum::basis_sum(&self.basis[pack], &spectra));
        clock.time(Pass::InverseFft, || self.transforms.inverse(&sums))
    }
}

impl Executor for CpuExecutor {
    fn kind(&self) -> ExecutorKind {
        ExecutorKind::Cpu
    }

    fn resident_bytes(&self) -> u64 {
        let tables: usize = self
            .set
            .tables()
            .iter()
            .map(|pack| {
                let blocked = pack.blocked.as_ref();
                4 * (pack.log_scale.len() + blocked.map_or(0, |blocked| blocked.log_scale.len()))
                    + 2 * (pack.shape.len() + blocked.map_or(0, |blocked| blocked.shape.len()))
                    + 4 * pack.basis_spectrum.len()
            })
            .sum();
        tables as u64 + self.basis.iter().map(BlockedBasis::bytes).sum::<u64>()
    }

    fn render(&mut self, batch: &[&Prepared]) -> Result<BatchOutput, DeviceFault> {
        let mut clock = PassClock::default();
        let radiance_w_m2_sr: Vec<Vec<f32>> =
            batch.iter().map(|request| self.render_one(request, &mut clock)).collect();
        debug_assert!(radiance_w_m2_sr.iter().all(|sky| sky.len() == Panorama::LEN));
        Ok(BatchOutput { radiance_w_m2_sr, passes: clock.into_passes() })
    }

    fn lose(&mut self) {}
}
