//! The passes on a Vulkan device.

mod bindings;
pub(crate) mod context;
#[cfg(test)]
mod pass_tests;
pub(crate) mod pipelines;
pub(crate) mod rates;
mod resident;
#[cfg(test)]
mod shader_tests;
#[cfg(test)]
mod twin_tests;
mod upload;
mod workspace;

use crate::{
    error::{DeviceFault, RenderError},
    executor::{BatchOutput, Executor, PassClock},
    plan::Pass,
    plan::{PlannedPass, RenderPlan},
    prepare::Prepared,
    request::{ExecutorKind, PassTime},
    table_set::TableSet,
};
use bindings::{Binding, bindings};
use context::Context;
use pipelines::Pipeline;
use resident::ResidentPack;
use skyglow_physics::Panorama;
use std::{collections::HashMap, sync::mpsc::channel};
use upload::BatchArrays;
use workspace::{READ_BACK_PANORAMA_BYTES, TIMESTAMP_COUNT, Workspace, WorkspaceSize};

/// Renders on a Vulkan device.
pub(crate) struct GpuExecutor {
    pub(crate) context: Context,
    set: TableSet,
    pipelines: Vec<Pipeline>,
    packs: Vec<ResidentPack>,
    workspace: Workspace,
    resident_bytes: u64,
    /// Bind groups by (pass, pack, slot): all that they bind stays where it is.
    groups: HashMap<(Pass, usize, usize), wgpu::BindGroup>,
}

impl GpuExecutor {
    /// Puts the packs on the device and compiles the passes.
    ///
    /// # Errors
    /// Packs and workspace over the budget or the adapter's limits, or a device that fails.
    pub(crate) fn new(context: Context, set: TableSet, budget_bytes: u64) -> Result<Self, RenderError> {
        let size = WorkspaceSize::of(&set);
        let needed_bytes = resident::bytes(&set) + size.bytes();
        if needed_bytes > budget_bytes {
            return Err(RenderError::OverBudget { needed_bytes, budget_bytes });
        }
        let workspace = Workspace::new(&context, size)?;
        let mut packs = Vec::new();
        for tables in set.tables() {
            packs.push(ResidentPack::upload(&context, tables)?);
            // Submits the upload, so that its staging memory is freed before the next pack's is taken.
            context.queue.submit([]);
            let _ = context.device.poll(wgpu::PollType::Poll);
        }
        let pipelines = pipelines::compile_all(&context);
        context.check()?;
        let groups = HashMap::new();
        Ok(Self { context, set, pipelines, packs, workspace, resident_bytes: needed_bytes, groups })
    }

    fn upload(&self, batch: &[&Prepared], plan: &RenderPlan) {
        let arrays = BatchArrays::of(batch);
        let queue = &self.context.queue;
        queue.write_buffer(&self.workspace.requests, 0, bytemuck::cast_slice(&arrays.requests));
        queue.write_buffer(&self.workspace.nodes, 0, bytemuck::cast_slice(&arrays.nodes));
        upload::write_list(queue, self.workspace.cells.texture(), arrays.cells);
        queue.write_buffer(&self.workspace.columns, 0, bytemuck::cast_slice(&arrays.columns));
        for slot in 0..=plan.packs.len() {
            let frame = upload::frame(plan, &self.set, slot);
            queue.write_buffer(&self.workspace.frames[slot], 0, bytemuck::bytes_of(&frame));
        }
    }

    fn make_groups(&mut self, plan: &RenderPlan) {
        for planned in &plan.passes {
            let key = group_key(plan, planned);
            if !self.groups.contains_key(&key) {
                let group = self.bind_group(key);
                self.groups.insert(key, group);
            }
        }
    }

    fn bind_group(&self, (pass, pack, slot): (Pass, usize, usize)) -> wgpu::BindGroup {
        let (work, pack) = (&self.workspace, &self.packs[pack]);
        let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
            .zip(bindings(pass))
            .map(|(binding, resource)| {
                let view = wgpu::BindingResource::TextureView;
                let resource = match resource {
                    Binding::Frame => work.frames[slot].as_entire_binding(),
                    Binding::Requests => work.requests.as_entire_binding(),
                    Binding::Nodes => work.nodes.as_entire_binding(),
                    Binding::Cells => view(&work.cells),
                    Binding::Columns => work.columns.as_entire_binding(),
                    Binding::Twiddles => work.twiddles.as_entire_binding(),
                    Binding::LogScale => pack.open.log_scale.as_entire_binding(),
                    Binding::BlockedLogScale => pack.blocked.log_scale.as_entire_binding(),
                    Binding::Shape => view(&pack.open.shape),
                    Binding::BlockedShape => view(&pack.blocked.shape),
                    Binding::Basis => view(&pack.basis),
                    Binding::Scales(_) => view(&work.scales),
                    Binding::LogScales(_) => view(&work.log_scales),
                    Binding::Mixed(_) => view(&work.mixed),
                    Binding::Weights(_) => view(&work.weights),
                    Binding::Coefficients(_) => view(&work.coefficients),
                    Binding::Spectra(_) => view(&work.spectra),
                    Binding::Sums(_) => view(&work.sums),
                    Binding::Radiance(_) => work.radiance.as_entire_binding(),
                    Binding::Blended => work.blended.as_entire_binding(),
                };
                wgpu::BindGroupEntry { binding, resource }
            })
            .collect();
        self.context.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(pass.name()),
            layout: &self.pipelines[pass.index()].layout,
            entries: &entries,
        })
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.context.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// Runs a plan and answers the passes' times where the device cannot tell them itself: lavapipe stamps a
    /// pass's beginning after its work as often as before, so there each pass is submitted and waited for.
    fn run(&self, plan: &RenderPlan) -> Result<PassClock, DeviceFault> {
        let mut clock = PassClock::default();
        let mut encoder = self.encoder();
        let stepwise = self.workspace.timestamps.is_none();
        if stepwise {
            self.context.queue.submit([]);
            self.context.wait()?;
        } else {
            drop(encoder.begin_compute_pass(&self.pass_descriptor("start", 0)));
        }
        for (index, planned) in (1u32..).zip(&plan.passes) {
            self.record_pass(&mut encoder, plan, planned, index);
            if stepwise {
                let step = std::mem::replace(&mut encoder, self.encoder());
                clock.time(planned.pass, || {
                    self.context.queue.submit([step.finish()]);
                    self.context.wait()
                })?;
            }
        }
        self.record_read_back(&mut encoder, plan);
        self.context.queue.submit([encoder.finish()]);
        Ok(clock)
    }

    fn record_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        plan: &RenderPlan,
        planned: &PlannedPass,
        timestamp: u32,
    ) {
        let mut pass = encoder.begin_compute_pass(&self.pass_descriptor(planned.pass.name(), timestamp));
        let [x, y, z] = planned.workgroups;
        pass.set_pipeline(&self.pipelines[planned.pass.index()].pipeline);
        pass.set_bind_group(0, self.groups.get(&group_key(plan, planned)), &[]);
        pass.dispatch_workgroups(x, y, z);
    }

    fn record_read_back(&self, encoder: &mut wgpu::CommandEncoder, plan: &RenderPlan) {
        let work = &self.workspace;
        let result = if plan.packs.len() > 1 { &work.blended } else { &work.radiance };
        let bytes = (plan.request_count * Panorama::LEN * 4) as u64;
        encoder.copy_buffer_to_buffer(result, 0, &work.read_back, 0, bytes);
        if let Some((query_set, resolved)) = &work.timestamps {
            let count = plan.passes.len() as u32 + 1;
            encoder.resolve_query_set(query_set, 0..count, resolved, 0);
            let bytes = 8 * u64::from(count);
            encoder.copy_buffer_to_buffer(resolved, 0, &work.read_back, READ_BACK_PANORAMA_BYTES, bytes);
        }
    }

    fn pass_descriptor<'a>(&'a self, label: &'a str, timestamp: u32) -> wgpu::ComputePassDescriptor<'a> {
        let timestamp_writes =
            self.workspace.timestamps.as_ref().map(|(query_set, _)| wgpu::ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: None,
                end_of_pass_write_index: Some(timestamp),
            });
        wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes }
    }

    /// Waits for the submission and maps what came back.
    fn read_back(&self, plan: &RenderPlan, clock: PassClock) -> Result<BatchOutput, DeviceFault> {
        let buffer = &self.workspace.read_back;
        let (sender, receiver) = channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            let _ = sender.send(result);
        });
        self.context.wait()?;
        receiver
            .try_recv()
            .map_err(|error| DeviceFault::Lost(format!("no answer came: {error}")))?
            .map_err(|error| DeviceFault::Lost(error.to_string()))?;
        let view = buffer.get_mapped_range(..).map_err(|error| DeviceFault::Other(error.to_string()))?;
        let (panoramas, ticks) = view.split_at(READ_BACK_PANORAMA_BYTES as usize);
        let radiance_w_m2_sr = panoramas
            .chunks_exact(Panorama::LEN * 4)
            .take(plan.request_count)
            .map(bytemuck::pod_collect_to_vec)
            .collect();
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(ticks);
        debug_assert_eq!(ticks.len(), TIMESTAMP_COUNT as usize);
        drop(view);
        buffer.unmap();
        Ok(BatchOutput { radiance_w_m2_sr, passes: self.pass_times(plan, clock, &ticks) })
    }

    fn pass_times(&self, plan: &RenderPlan, mut clock: PassClock, ticks: &[u64]) -> Vec<PassTime> {
        if let Some(nanoseconds) = self.context.nanoseconds_per_tick {
            for (planned, ticks) in plan.passes.iter().zip(ticks.windows(2)) {
                let elapsed = ticks[1].saturating_sub(ticks[0]) as f64 * nanoseconds;
                clock.add(planned.pass, elapsed / 1000.0);
            }
        }
        clock.into_passes()
    }
}

/// The blend reads no pack: it is filed under the first one.
fn group_key(plan: &RenderPlan, planned: &PlannedPass) -> (Pass, usize, usize) {
    match planned.pack_slot {
        Some(slot) => (planned.pass, plan.packs[slot].index, slot),
        None => (planned.pass, 0, plan.packs.len()),
    }
}

impl Executor for GpuExecutor {
    fn kind(&self) -> ExecutorKind {
        self.context.kind
    }

    fn resident_bytes(&self) -> u64 {
        self.resident_bytes
    }

    fn render(&mut self, batch: &[&Prepared]) -> Result<BatchOutput, DeviceFault> {
        self.context.check()?;
        let plan = RenderPlan::of(batch, &self.set);
        self.upload(batch, &plan);
        self.make_groups(&plan);
        let clock = self.run(&plan)?;
        self.read_back(&plan, clock)
    }

    fn lose(&mut self) {
        self.context.device.destroy();
    }
}
