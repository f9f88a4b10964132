//! Each WGSL function against its Rust twin: a generated entry point runs it over thousands of inputs on lavapipe.

mod arguments;
mod cases;

use super::{context::Context, pipelines::shader_module};
use crate::{
    shaders::{self, LIBRARY},
    synthetic::Noise,
    twin,
};
use arguments::Answer;
use cases::{Case, cases, real};
use std::{collections::BTreeSet, fmt::Write, sync::mpsc::channel};
use wgpu::util::DeviceExt;

const INPUT_COUNT: usize = 4096;

/// A module whose entry point runs the case's function on every row of words.
fn module_text(case: &Case) -> String {
    let mut text: String = case.files.iter().map(|file| file.text).collect();
    let mut at = 0;
    let mut arguments = Vec::new();
    for argument in &case.arguments {
        arguments.push(argument.expression(at));
        at += argument.words();
    }
    let size = answer_words(case.answer);
    let parts: Vec<String> = match case.answer {
        Answer::Real => vec!["bitcast<u32>(answer)".into()],
        Answer::Whole => vec!["answer".into()],
        Answer::RealVector(size) => (0..size).map(|i| format!("bitcast<u32>(answer[{i}])")).collect(),
        Answer::WholeVector(size) => (0..size).map(|i| format!("answer[{i}]")).collect(),
        Answer::Legs => parts_of(&["a", "b", "c", "d"]),
        Answer::Sixteen => parts_of(&[
            "a.a", "b.a", "c.a", "d.a", "a.b", "b.b", "c.b", "d.b", "a.c", "b.c", "c.c", "d.c", "a.d", "b.d",
            "c.d", "d.d",
        ]),
    };
    let _ = write!(
        text,
        "@group(0) @binding(0) var<storage, read> inputs: array<u32>;
        @group(0) @binding(1) var<storage, read_write> outputs: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {{
          let first = invocation.x * {at}u;
          let answer = {}({});",
        case.function,
        arguments.join(", ")
    );
    for (offset, part) in parts.iter().enumerate() {
        let _ = write!(text, "outputs[invocation.x * {size}u + {offset}u] = {part};");
    }
    text + "}"
}

/// All components of members that are vec4.
fn parts_of(members: &[&str]) -> Vec<String> {
    let parts = members.iter().flat_map(|member| ["x", "y", "z", "w"].map(|part| format!("{member}.{part}")));
    parts.map(|part| format!("bitcast<u32>(answer.{part})")).collect()
}

fn answer_words(answer: Answer) -> usize {
    match answer {
        Answer::Real | Answer::Whole => 1,
        Answer::RealVector(size) | Answer::WholeVector(size) => size,
        Answer::Legs => 16,
        Answer::Sixteen => 64,
    }
}

/// Runs a compute module on words; binding 0 is the input, 1 the output, and 2 `extra` where there is any.
fn run(
    context: &Context,
    text: String,
    inputs: &[u32],
    output_words: usize,
    extra: Option<&[u8]>,
    groups: u32,
) -> Vec<u32> {
    let device = &context.device;
    let module = shader_module(device, "twin", text);
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("twin"),
        layout: None,
        module: &module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let filled = |contents: &[u8]| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("twin"),
            contents,
            usage: wgpu::BufferUsages::STORAGE,
        })
    };
    let made = |usage| {
        let size = 4 * output_words as u64;
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("twin"),
            size,
            usage,
            mapped_at_creation: false,
        })
    };
    let input = filled(bytemuck::cast_slice(inputs));
    let output = made(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let read_back = made(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let extra = extra.map(filled);
    let buffers = [Some(&input), Some(&output), extra.as_ref()];
    let entries: Vec<_> = (0..)
        .zip(buffers.into_iter().flatten())
        .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
        .collect();
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("twin"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(groups, 1, 1);
    drop(pass);
    encoder.copy_buffer_to_buffer(&output, 0, &read_back, 0, 4 * output_words as u64);
    context.queue.submit([encoder.finish()]);
    let (sender, receiver) = channel();
    read_back.map_async(wgpu::MapMode::Read, .., move |result| sender.send(result).unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    context.check().unwrap();
    receiver.recv().unwrap().unwrap();
    let view = read_back.get_mapped_range(..).unwrap();
    bytemuck::pod_collect_to_vec(&view)
}

/// Every function of the library has a twin that is compared.
#[test]
fn every_library_function_has_a_twin() {
    let written: BTreeSet<String> = LIBRARY
        .iter()
        .flat_map(|file| file.text.lines())
        .filter_map(|line| Some(line.strip_prefix("fn ")?.split('(').next()?.to_owned()))
        .collect();
    let mut compared: BTreeSet<String> = cases().iter().map(|case| case.function.to_owned()).collect();
    // Compared below: they work on workgroup memory.
    compared.extend(["transform_256", "share_points"].map(String::from));
    assert_eq!(written, compared);
}

/// WGSL functions agree with their twins on the device.
#[test]
fn functions_agree_with_their_twins() {
    let context = Context::open(crate::synthetic::tested_device()).unwrap();
    let mut wrong = Vec::new();
    for (seed, case) in (1..).zip(cases()) {
        let mut noise = Noise::new(seed);
        let mut inputs = Vec::new();
        for _ in 0..INPUT_COUNT {
            for argument in &case.arguments {
                argument.draw(&mut noise, &mut inputs);
            }
        }
        let size = answer_words(case.answer);
        let got =
            run(&context, module_text(&case), &inputs, INPUT_COUNT * size, None, INPUT_COUNT as u32 / 64);
        let stride = inputs.len() / INPUT_COUNT;
        let mut largest = 0f64;
        let mut varied = BTreeSet::new();
        for (words, got) in inputs.chunks_exact(stride).zip(got.chunks_exact(size)) {
            let expected = (case.twin)(words);
            for (got, expected) in got.iter().zip(&expected) {
                varied.insert(*expected);
                let error = match case.answer {
                    Answer::Whole | Answer::WholeVector(_) => f64::from(u8::from(got != expected)),
                    _ => {
                        let (got, expected) = (f64::from(real(*got)), f64::from(real(*expected)));
                        assert!(got.is_finite() && expected.is_finite(), "{}", case.function);
                        let size = expected.abs().max(case.scale);
                        if size == 0.0 { got.abs() } else { (got - expected).abs() / size }
                    }
                };
                largest = largest.max(error);
            }
        }
        println!("{:<20} {largest:.1e} (allowed {:.1e})", case.function, case.tolerance);
        if largest > case.tolerance {
            wrong.push(format!("{}: {largest}", case.function));
        }
        assert!(varied.len() > 8, "{} answered {} values only", case.function, varied.len());
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// The transform in workgroup memory agrees with its twin.
#[test]
fn the_workgroup_fft_agrees_with_its_twin() {
    let context = Context::open(crate::synthetic::tested_device()).unwrap();
    let text = [shaders::FFT.text, shaders::WORKGROUP_FFT.text].concat()
        + "@group(0) @binding(0) var<storage, read> inputs: array<vec2<f32>>;
        @group(0) @binding(1) var<storage, read_write> outputs: array<vec2<f32>>;
        @group(0) @binding(2) var<storage, read> twiddles: array<vec4<f32>>;
        fn point(first: u32, n: u32) -> vec4<f32> { return vec4<f32>(inputs[first + n], inputs[first + 256u + n]); }
        fn legs(first: u32, n: u32) -> Legs {
          return Legs(point(first, n), point(first, n + 64u), point(first, n + 128u), point(first, n + 192u));
        }
        @compute @workgroup_size(16)
        fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
          let first = group.x * 512u;
          let lane = local.x;
          let x = Sixteen(legs(first, lane), legs(first, lane + 16u), legs(first, lane + 32u), legs(first, lane + 48u));
          share_points(lane, transform_256(lane, x));
          for (var n = lane; n < 256u; n += 16u) {
            outputs[first + n] = points[n].xy;
            outputs[first + 256u + n] = points[n].zw;
          }
        }";
    let mut noise = Noise::new(99);
    let rows: Vec<[[f32; 2]; 256]> =
        (0..32).map(|_| [[0.0; 2]; 256].map(|_| [0, 1].map(|_| noise.unit() as f32 - 0.5))).collect();
    let table: Vec<[f32; 2]> = (0..256).map(|at| twin::twiddle((at / 16) * (at % 16))).collect();
    let words = bytemuck::cast_slice(&rows);
    let got = run(&context, text, words, words.len(), Some(bytemuck::cast_slice(&table)), 16);
    for (row, got) in rows.iter().zip(got.chunks_exact(512)) {
        let mut expected: twin::Points<1> = row.map(|point| point.map(|part| [part]));
        twin::transform_256(&twin::twiddles(), &mut expected);
        for (expected, got) in expected.as_flattened().as_flattened().iter().zip(got) {
            assert!((expected - real(*got)).abs() < 1e-5, "{expected} {}", real(*got));
        }
    }
}
