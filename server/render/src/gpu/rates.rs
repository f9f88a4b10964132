//! A device's bandwidth and arithmetic rate, as of the roofline model (Williams, Waterman and Patterson 2009): a benchmark compares the
//! passes with them.

use super::{context::Context, pipelines::shader_module};
use crate::{
    error::{DeviceFault, RenderError},
    request::ExecutorKind,
};
use std::time::{Duration, Instant};
use wgpu::{BufferUsages, util::DeviceExt};

const STREAM: &str = include_str!("../../../../shaders/bench/stream.wgsl");
const MULTIPLY: &str = include_str!("../../../../shaders/bench/multiply.wgsl");
/// Invocations of a workgroup.
const WORKGROUP: u64 = 256;
/// Bytes that an invocation copies.
const COPIED: u64 = 16;
/// Multiply-adds of an invocation each round: four chains of vectors of four.
const CHAINED: u64 = 16;
/// x ← 0.999 x + 0.001, which goes to 1.
const FACTOR: f32 = 0.999;
const ADDEND: f32 = 1e-3;
const ROUNDS: u32 = 1_024;
/// A submission that takes no longer than this is mostly its own cost.
const MIN_SUBMISSION: Duration = Duration::from_millis(20);
const MAX_DISPATCHES: u32 = 1 << 12;

/// What a device does at its fastest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceRates {
    /// Bytes read and written a second by a copy of a buffer that is larger than caches are.
    pub bandwidth_bytes_s: f64,
    /// Fused multiply-adds of f32 a second, in registers.
    pub multiply_adds_s: f64,
    /// Seconds from the submission of nothing but a copy of one panorama's bytes to the host having them.
    pub read_back_s: f64,
}

/// How much is done to find out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RatesExtent {
    /// Bytes of the buffer that is copied; no more than a buffer may have.
    pub stream_bytes: usize,
    /// Multiply-adds of a dispatch, about.
    pub multiply_adds: usize,
}

/// Tries some work over and over and answers the seconds of the fastest try.
pub type Timer<'a> = &'a dyn Fn(&mut dyn FnMut()) -> f64;

/// Measures the device that an executor renders on.
///
/// # Errors
/// No such adapter, or a device that fails or computes something else.
pub fn device_rates(
    executor: ExecutorKind,
    extent: RatesExtent,
    timer: Timer<'_>,
) -> Result<DeviceRates, RenderError> {
    let context = Context::open(executor)?;
    let bandwidth_bytes_s = bandwidth_bytes_s(&context, extent, timer)?;
    let multiply_adds_s = multiply_adds_s(&context, extent, timer)?;
    let read_back_s = read_back_s(&context, timer)?;
    Ok(DeviceRates { bandwidth_bytes_s, multiply_adds_s, read_back_s })
}

fn bandwidth_bytes_s(context: &Context, extent: RatesExtent, timer: Timer<'_>) -> Result<f64, RenderError> {
    let limits = context.device.limits();
    let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let bytes = (extent.stream_bytes as u64).clamp(COPIED * WORKGROUP, most) / (COPIED * WORKGROUP)
        * (COPIED * WORKGROUP);
    let groups = bytes / (COPIED * WORKGROUP);
    let columns = groups.min(u64::from(limits.max_compute_workgroups_per_dimension)) as u32;
    let rows = groups.div_ceil(u64::from(columns)) as u32;
    let first: Vec<f32> = (0..WORKGROUP).map(|i| i as f32).collect();
    let from = buffer(context, bytes, BufferUsages::STORAGE | BufferUsages::COPY_DST);
    context.queue.write_buffer(&from, 0, bytemuck::cast_slice(&first));
    let to = buffer(context, bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
    let work = Work::new(context, "stream", STREAM, [&from, &to], [columns, rows]);
    let seconds = work.timed(timer)?;
    let copied = read(context, &to, first.len())?;
    if copied != first {
        return Err(DeviceFault::Other("a copy of a buffer is none".into()).into());
    }
    Ok((2 * bytes) as f64 / seconds)
}

fn multiply_adds_s(context: &Context, extent: RatesExtent, timer: Timer<'_>) -> Result<f64, RenderError> {
    let of_group = WORKGROUP * CHAINED * u64::from(ROUNDS);
    let most = u64::from(context.device.limits().max_compute_workgroups_per_dimension);
    let groups = (extent.multiply_adds as u64 / of_group).clamp(1, most);
    let chain: [u32; 4] = [FACTOR.to_bits(), ADDEND.to_bits(), 5f32.to_bits(), ROUNDS];
    let chain = context.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("chain"),
        contents: bytemuck::cast_slice(&chain),
        usage: BufferUsages::STORAGE,
    });
    let results =
        buffer(context, groups * WORKGROUP * COPIED, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
    let work = Work::new(context, "multiply", MULTIPLY, [&chain, &results], [groups as u32, 1]);
    let seconds = work.timed(timer)?;
    let first = read(context, &results, 1)?[0];
    // Four chains from 5, 6, 7 and 8.
    let mean = 1.0 + 5.5 * f64::from(FACTOR).powi(ROUNDS as i32);
    if (f64::from(first) / mean - 1.0).abs() > 1e-3 {
        return Err(DeviceFault::Other(format!("multiply-adds came to {first}, not {mean}")).into());
    }
    Ok((groups * of_group) as f64 / seconds)
}

fn read_back_s(context: &Context, timer: Timer<'_>) -> Result<f64, RenderError> {
    let bytes = (skyglow_physics::Panorama::LEN * size_of::<f32>()) as u64;
    let panorama = buffer(context, bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
    let host = buffer(context, bytes, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
    timed(timer, || read_through(context, &panorama, &host).map(drop))
}

fn buffer(context: &Context, size: u64, usage: BufferUsages) -> wgpu::Buffer {
    context.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size,
        usage,
        mapped_at_creation: false,
    })
}

/// The first values of a buffer.
fn read(context: &Context, from: &wgpu::Buffer, count: usize) -> Result<Vec<f32>, RenderError> {
    let bytes = (count * size_of::<f32>()) as u64;
    let host = buffer(context, bytes, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
    read_through(context, from, &host)
}

/// The first values of a buffer, by way of one that the host can map.
fn read_through(
    context: &Context,
    from: &wgpu::Buffer,
    host: &wgpu::Buffer,
) -> Result<Vec<f32>, RenderError> {
    let mut encoder = context.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(from, 0, host, 0, host.size());
    context.queue.submit([encoder.finish()]);
    host.map_async(wgpu::MapMode::Read, .., |_| ());
    context.wait()?;
    let view = host.get_mapped_range(..).map_err(|error| DeviceFault::Other(error.to_string()))?;
    let values = bytemuck::pod_collect_to_vec(&view);
    drop(view);
    host.unmap();
    Ok(values)
}

/// Seconds of the fastest try.
fn timed(timer: Timer<'_>, mut work: impl FnMut() -> Result<(), RenderError>) -> Result<f64, RenderError> {
    let mut done = Ok(());
    let seconds = timer(&mut || {
        if done.is_ok() {
            done = work();
        }
    });
    done.map(|()| seconds)
}

/// A shader over two buffers, dispatched over and over.
struct Work<'a> {
    context: &'a Context,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    workgroups: [u32; 2],
}

impl<'a> Work<'a> {
    fn new(
        context: &'a Context,
        label: &str,
        text: &str,
        buffers: [&wgpu::Buffer; 2],
        workgroups: [u32; 2],
    ) -> Self {
        let device = &context.device;
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: None,
            module: &shader_module(device, label, text.to_owned()),
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let entries = [0, 1]
            .map(|at| wgpu::BindGroupEntry { binding: at as u32, resource: buffers[at].as_entire_binding() });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        Self { context, pipeline, group, workgroups }
    }

    /// Dispatches so many times in one submission and waits.
    fn run(&self, dispatches: u32) -> Result<(), RenderError> {
        let device = &self.context.device;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        for _ in 0..dispatches {
            pass.dispatch_workgroups(self.workgroups[0], self.workgroups[1], 1);
        }
        drop(pass);
        self.context.queue.submit([encoder.finish()]);
        Ok(self.context.wait()?)
    }

    /// Seconds of a dispatch among so many that submitting and waiting weigh little.
    fn timed(&self, timer: Timer<'_>) -> Result<f64, RenderError> {
        self.run(1)?;
        let mut dispatches = 1;
        loop {
            let start = Instant::now();
            self.run(dispatches)?;
            if start.elapsed() >= MIN_SUBMISSION || dispatches >= MAX_DISPATCHES {
                break;
            }
            dispatches *= 2;
        }
        Ok(timed(timer, || self.run(dispatches))? / f64::from(dispatches))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Devices copy and multiply and what is not there is refused.
    #[test]
    fn devices_copy_and_multiply() {
        let extent = RatesExtent { stream_bytes: 1 << 22, multiply_adds: 1 << 24 };
        let once = |work: &mut dyn FnMut()| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        };
        let rates = device_rates(crate::synthetic::tested_device(), extent, &once).unwrap();
        assert!(rates.bandwidth_bytes_s > 1e7 && rates.bandwidth_bytes_s < 1e13, "{rates:?}");
        assert!(rates.multiply_adds_s > 1e6 && rates.multiply_adds_s < 1e15, "{rates:?}");
        assert!(rates.read_back_s > 0.0 && rates.read_back_s < 10.0, "{rates:?}");
        // No adapter is plain Rust.
        assert!(matches!(device_rates(ExecutorKind::Cpu, extent, &once), Err(RenderError::NoAdapter { .. })));
    }
}
