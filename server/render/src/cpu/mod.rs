//! The CPU executor: the same passes in plain Rust f32, file by file under the names of `shaders/passes`.

pub mod azimuth_fft;
pub mod basis_sum;
pub mod blend;
pub mod cell_weights;
pub mod coefficients;
pub mod inverse_fft;
pub mod kept_shapes;
pub mod lanes;
pub mod layout;
pub mod mix_scale;
pub mod mix_shape;
pub mod scratch;
mod work;

use crate::{
    error::DeviceFault,
    executor::{BatchOutput, Executor, PassClock},
    plan::Pass,
    prepare::Prepared,
    request::ExecutorKind,
    table_set::TableSet,
    twin::{Twiddles, twiddles},
};
use azimuth_fft::azimuth_fft;
use basis_sum::{BlockedBasis, basis_sum};
use blend::blend;
use cell_weights::cell_weights;
use coefficients::coefficients;
use inverse_fft::inverse_fft;
use kept_shapes::{FilledNodes, KeptShapes};
use mix_scale::mix_scale;
use mix_shape::mix_shape;
use rayon::prelude::*;
use scratch::{Scratch, ScratchPool};
use skyglow_physics::Panorama;
use std::time::Instant;

/// Renders the packs of all requests of a batch side by side, one on each core; where there are fewer of them than
/// cores, the cores share the work within each.
pub struct CpuExecutor {
    set: TableSet,
    basis: Vec<BlockedBasis>,
    twiddles: Twiddles,
    scratch: ScratchPool,
    kept: KeptShapes,
}

/// One pack's share of one request.
struct Item<'a> {
    request: &'a Prepared,
    pack: usize,
}

impl CpuExecutor {
    /// Lays the tables out for the passes.
    pub fn new(set: TableSet) -> Self {
        let basis = set.tables().iter().map(|tables| BlockedBasis::of(tables)).collect();
        Self {
            set,
            basis,
            twiddles: twiddles(),
            scratch: ScratchPool::default(),
            kept: KeptShapes::default(),
        }
    }

    /// Renders a batch on the threads of the pool, of which the calling thread is one.
    fn render_all(&mut self, batch: &[&Prepared]) -> BatchOutput {
        let start = Instant::now();
        let items: Vec<Item<'_>> = batch
            .iter()
            .flat_map(|&request| request.turbidity_stencil.nodes().map(move |pack| Item { request, pack }))
            .collect();
        let cores = rayon::current_num_threads();
        // Cores without an item of their own help with those of others.
        let share_within = cores > 1 && !items.len().is_multiple_of(cores) && items.len() < 4 * cores;
        let mut clock = PassClock::default();
        let mut rendered: Vec<(Vec<f32>, PassClock)> = Vec::with_capacity(items.len());
        for items in items.chunks(cores) {
            let since = self.kept.now();
            let fill = |item: &Item<'_>| self.kept.fill(&self.set, item.request, item.pack, since);
            let filled: Vec<FilledNodes> = clock.time(Pass::MixShape, || items.iter().map(fill).collect());
            let render = |(item, nodes): (&Item<'_>, &FilledNodes)| {
                let (mut scratch, start) = (self.scratch.take(), Instant::now());
                self.kept.interpolate(nodes, share_within, &mut scratch.mixed);
                let microseconds = start.elapsed().as_secs_f64() * 1e6;
                let (sky, mut clock) = self.finish(item, share_within, scratch);
                clock.add(Pass::MixShape, microseconds);
                (sky, clock)
            };
            rendered.par_extend(items.par_iter().zip(&filled).with_max_len(1).map(render));
        }
        self.kept.shrink();
        let mut rendered = rendered.into_iter().map(|(sky, times)| {
            clock.merge(&times);
            sky
        });
        let mut radiance_w_m2_sr = Vec::with_capacity(batch.len());
        let mut skies: Vec<Vec<Vec<f32>>> = Vec::with_capacity(batch.len());
        for request in batch {
            skies.push(rendered.by_ref().take(request.turbidity_stencil.nodes().len()).collect());
        }
        drop(rendered);
        // Passes that ran side by side took less than their sum.
        clock.scale_to(start.elapsed().as_secs_f64() * 1e6);
        for (request, mut packs) in batch.iter().zip(skies) {
            let sky = match packs.len() {
                1 => packs.swap_remove(0),
                _ => clock.time(Pass::Blend, || {
                    let sources: Vec<&[f32]> = packs.iter().map(Vec::as_slice).collect();
                    blend(&sources, &request.turbidity_stencil, true)
                }),
            };
            packs.into_iter().for_each(|sky| self.scratch.keep_panorama(sky));
            radiance_w_m2_sr.push(sky);
        }
        debug_assert!(radiance_w_m2_sr.iter().all(|sky| sky.len() == Panorama::LEN));
        BatchOutput { radiance_w_m2_sr, passes: clock.into_passes() }
    }

    /// The sky of one pack of a request, mixed for its very altitude, which keeps nothing; with all cores where
    /// `side_by_side`.
    pub fn sky(&self, request: &Prepared, pack: usize, side_by_side: bool) -> Vec<f32> {
        let (mut scratch, tables) = (self.scratch.take(), &self.set.tables()[pack]);
        mix_scale(tables, request, side_by_side, &mut scratch.scales);
        mix_shape(tables, request, &scratch.scales, side_by_side, &mut scratch.mixed);
        self.finish(&Item { request, pack }, side_by_side, scratch).0
    }

    /// The table of its transforms.
    pub fn twiddles(&self) -> &Twiddles {
        &self.twiddles
    }

    /// The passes of an item whose shapes are mixed.
    fn finish(&self, item: &Item<'_>, side_by_side: bool, mut scratch: Scratch) -> (Vec<f32>, PassClock) {
        let mut sky = self.scratch.take_panorama();
        let clock = self.run_passes(item, side_by_side, &mut scratch, &mut sky);
        self.scratch.keep(scratch);
        (sky, clock)
    }

    fn run_passes(
        &self,
        item: &Item<'_>,
        side_by_side: bool,
        scratch: &mut Scratch,
        sky: &mut Vec<f32>,
    ) -> PassClock {
        let (request, tables) = (item.request, &self.set.tables()[item.pack]);
        let basis_count = request.basis_count.min(tables.basis_count);
        let lit_bands = request.flux_per_dnb_flux.map(|flux| flux > 0.0);
        let mut clock = PassClock::default();
        let Scratch { scales, mixed, weights, columns, spectra, sums } = scratch;
        clock.time(Pass::MixScale, || mix_scale(tables, request, side_by_side, scales));
        clock.time(Pass::CellWeights, || cell_weights(request, scales, side_by_side, weights));
        clock.time(Pass::Coefficients, || {
            coefficients(request, mixed, weights, side_by_side, columns);
        });
        clock.time(Pass::AzimuthFft, || {
            azimuth_fft(&self.twiddles, lit_bands, columns, basis_count, side_by_side, spectra);
        });
        clock.time(Pass::BasisSum, || {
            basis_sum(&self.basis[item.pack], spectra, basis_count, side_by_side, sums);
        });
        clock.time(Pass::InverseFft, || inverse_fft(&self.twiddles, 0.0, lit_bands, sums, side_by_side, sky));
        clock
    }
}

impl Executor for CpuExecutor {
    fn kind(&self) -> ExecutorKind {
        ExecutorKind::Cpu
    }

    fn resident_bytes(&self) -> u64 {
        let tables: usize = self.set.tables().iter().map(|pack| pack.byte_count()).sum();
        tables as u64 + self.basis.iter().map(BlockedBasis::bytes).sum::<u64>()
    }

    fn render(&mut self, batch: &[&Prepared]) -> Result<BatchOutput, DeviceFault> {
        // One step into the pool for the whole batch: every step from outside wakes its threads anew.
        Ok(rayon::scope(|_| self.render_all(batch)))
    }

    fn lose(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{device::warm_up_requests, request::RenderRequest, synthetic};
    use kept_shapes::MAX_KEPT_BYTES;
    use skyglow_physics::{EmissionMix, Turbidity, simd};
    use std::sync::Arc;

    fn prepared(set: &TableSet, basis: usize) -> Prepared {
        let polar = synthetic::polar_grid_with_skylines(7, 3000);
        let request = synthetic::request(polar, Turbidity::new(2.0).unwrap());
        Prepared::new(&RenderRequest { basis: Some(basis), ..request }, set).unwrap()
    }

    fn render(executor: &CpuExecutor, request: &Prepared, baseline: bool) -> Vec<f32> {
        let sky = || executor.sky(request, 0, false);
        if baseline { simd::with_baseline(sky) } else { sky() }
    }

    /// Loops without the fast instructions give the same sky.
    #[test]
    fn baseline_loops_give_the_same_sky() {
        let set = TableSet::new(synthetic::table_set_with_skylines(&[2.0], 44)).unwrap();
        let executor = CpuExecutor::new(set.clone());
        // Not a multiple of the block, the group or the vector.
        let request = prepared(&set, 43);
        let difference = |a: &[f32], b: &[f32]| {
            let mean = b.iter().sum::<f32>() / b.len() as f32;
            a.iter().zip(b).map(|(a, b)| (a - b).abs() / b.max(1e-3 * mean)).fold(0f32, f32::max)
        };
        let (wide, baseline) = (render(&executor, &request, false), render(&executor, &request, true));
        assert!(difference(&wide, &baseline) < 1e-5, "{:e}", difference(&wide, &baseline));
        let fewer = render(&executor, &prepared(&set, 42), true);
        assert!(difference(&wide, &fewer) > 1e-5);
    }

    /// Shapes that are kept change no bit: of a request as it was, at another altitude, with another emission, with dark
    /// bands, with fewer functions, be there room for all of them or for hardly one.
    #[test]
    fn kept_shapes_change_no_bit() {
        let set = TableSet::new(synthetic::table_set_with_skylines(&[2.0, 3.0, 4.0], 80)).unwrap();
        let polar = Arc::new(synthetic::polar_grid_with_skylines(7, 3000));
        let first = synthetic::request(synthetic::dark_grid(), Turbidity::new(2.4).unwrap());
        let first = RenderRequest { polar, ..first };
        let other = Arc::new(synthetic::polar_grid_with_skylines(8, 2000));
        let mut dark_band = first.flux_per_dnb_flux;
        dark_band[1] = 0.0;
        let altitude_m = first.observer_altitude_m;
        let requests: Vec<Prepared> = [
            first.clone(),
            RenderRequest { polar: other, observer_altitude_m: altitude_m + 1.0, ..first.clone() },
            RenderRequest { observer_altitude_m: altitude_m + 100.0, ..first.clone() },
            RenderRequest { emission: EmissionMix::lambert(), ..first.clone() },
            RenderRequest { flux_per_dnb_flux: dark_band, ..first.clone() },
            RenderRequest { basis: Some(41), ..first.clone() },
            first,
        ]
        .iter()
        .map(|request| Prepared::new(request, &set).unwrap())
        .collect();
        let cold: Vec<Vec<f32>> = requests
            .iter()
            .map(|request| CpuExecutor::new(set.clone()).render_all(&[request]).radiance_w_m2_sr.remove(0))
            .collect();
        assert_ne!(cold[0], cold[2]);
        for max_bytes in [MAX_KEPT_BYTES, 9 << 20, 1] {
            let mut warm = CpuExecutor::new(set.clone());
            warm.kept = KeptShapes::with_room(max_bytes);
            for round in 0..2 {
                for (request, cold) in requests.iter().zip(&cold) {
                    let sky = warm.render_all(&[request]).radiance_w_m2_sr.remove(0);
                    assert!(sky == *cold, "{max_bytes} bytes, round {round}");
                }
                let batch: Vec<&Prepared> =
                    requests.iter().filter(|r| r.is_compatible(&requests[0])).collect();
                let together = warm.render_all(&batch).radiance_w_m2_sr;
                assert!(batch.len() > 4);
                for (sky, request) in together.iter().zip(batch) {
                    let alone = requests.iter().position(|other| std::ptr::eq(other, request)).unwrap();
                    assert!(*sky == cold[alone], "{max_bytes} bytes, round {round}, together");
                }
            }
            let kept = warm.kept.byte_count();
            assert!(kept <= max_bytes && (kept > 0 || max_bytes == 1), "{kept} of {max_bytes}");
        }
    }

    /// Buffers left over from another request leave no trace.
    #[test]
    fn reused_buffers_leave_no_trace() {
        let set = TableSet::new(synthetic::table_set_with_skylines(&[2.0], 44)).unwrap();
        let mut used = CpuExecutor::new(set.clone());
        let (large, small) = (prepared(&set, 44), prepared(&set, 5));
        let warm_up = warm_up_requests(&set);
        for request in [&large, &warm_up[0], &small, &large] {
            let fresh = CpuExecutor::new(set.clone());
            assert_eq!(render(&used, request, false), render(&fresh, request, false));
        }
        assert_ne!(render(&used, &small, false), render(&used, &large, false));
        let batch: Vec<&Prepared> = vec![&large, &small, &large];
        let together = used.render_all(&batch).radiance_w_m2_sr;
        for (sky, request) in together.iter().zip(batch) {
            let alone = CpuExecutor::new(set.clone()).render_all(&[request]).radiance_w_m2_sr;
            assert_eq!(*sky, alone[0]);
        }
    }
}
