//! Pipelines of all passes.

use super::{bindings::bindings, context::Context};
use crate::{plan::Pass, shaders};

/// A compiled pass.
pub(crate) struct Pipeline {
    pub(crate) layout: wgpu::BindGroupLayout,
    pub(crate) pipeline: wgpu::ComputePipeline,
}

/// Compiles every pass; drivers finish the work at the first dispatch.
pub(crate) fn compile_all(context: &Context) -> Vec<Pipeline> {
    Pass::ALL.into_iter().map(|pass| compile(&context.device, pass)).collect()
}

fn compile(device: &wgpu::Device, pass: Pass) -> Pipeline {
    let entries: Vec<wgpu::BindGroupLayoutEntry> = (0..)
        .zip(bindings(pass))
        .map(|(binding, resource)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: resource.kind(),
            count: None,
        })
        .collect();
    let label = Some(pass.name());
    let layout =
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let module = shader_module(device, pass.name(), shaders::module_text(pass));
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label,
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions {
            // Each pass writes all of its workgroup memory before it reads any.
            zero_initialize_workgroup_memory: false,
            ..Default::default()
        },
        cache: None,
    });
    Pipeline { layout, pipeline }
}

/// A module of the given text.
pub(crate) fn shader_module(device: &wgpu::Device, label: &str, text: String) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    })
}
