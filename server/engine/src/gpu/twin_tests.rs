//! Each WGSL function against its Rust twin: a generated entry point runs it over thousands of inputs on lavapipe.

use super::{context::Context, pipelines::shader_module};
use crate::{
    request::ExecutorKind,
    shaders::{self, LIBRARY, LibraryFile},
    synthetic::Noise,
    twin,
};
use std::{collections::BTreeSet, fmt::Write, sync::mpsc::channel};
use wgpu::util::DeviceExt;

const INPUT_COUNT: usize = 4096;

/// One argument: its WGSL expression over the words `in[at]`, how many words it takes, and a random value.
#[derive(Clone, Copy)]
enum Argument {
    /// f32 in a range.
    Real(f64, f64),
    /// f32 evenly in the logarithm.
    Logarithmic(f64, f64),
    /// u32 below a bound.
    Whole(u32),
    /// vec2, vec3 or vec4 of f32 in a range.
    Vector(usize, f64, f64),
    /// bool.
    Flag,
    /// Two complex numbers side by side, four times.
    Legs,
    /// The same sixteen times.
    Sixteen,
}

impl Argument {
    fn words(self) -> usize {
        match self {
            Argument::Vector(size, ..) => size,
            Argument::Legs => 16,
            Argument::Sixteen => 64,
            _ => 1,
        }
    }

    fn draw(self, noise: &mut Noise, words: &mut Vec<u32>) {
        let mut real = |low: f64, high: f64| ((low + (high - low) * noise.unit()) as f32).to_bits();
        match self {
            Argument::Real(low, high) => words.push(real(low, high)),
            Argument::Logarithmic(low, high) => {
                let log = f32::from_bits(real(low.ln(), high.ln()));
                words.push((f64::from(log).exp() as f32).to_bits());
            }
            Argument::Whole(bound) => words.push((noise.unit() * f64::from(bound)) as u32),
            Argument::Vector(size, low, high) => words.extend((0..size).map(|_| real(low, high))),
            Argument::Flag => words.push(u32::from(noise.unit() < 0.5)),
            Argument::Legs | Argument::Sixteen => {
                words.extend((0..self.words()).map(|_| real(-2.0, 2.0)));
            }
        }
    }

    fn expression(self, at: usize) -> String {
        let real = |offset: usize| format!("bitcast<f32>(inputs[first + {}u])", at + offset);
        let vector = |at: usize, size: usize| {
            let parts: Vec<String> = (0..size).map(|offset| real(at + offset)).collect();
            format!("vec{size}<f32>({})", parts.join(", "))
        };
        match self {
            Argument::Real(..) | Argument::Logarithmic(..) => real(0),
            Argument::Whole(_) => format!("inputs[first + {at}u]"),
            Argument::Vector(size, ..) => vector(0, size),
            Argument::Flag => format!("(inputs[first + {at}u] != 0u)"),
            Argument::Legs => {
                let legs: Vec<String> = (0..4).map(|leg| vector(4 * leg, 4)).collect();
                format!("Legs({})", legs.join(", "))
            }
            Argument::Sixteen => {
                // Point j + 4m is member m of row j.
                let rows: Vec<String> = (0..4)
                    .map(|j| {
                        let legs: Vec<String> = (0..4).map(|m| vector(4 * (j + 4 * m), 4)).collect();
                        format!("Legs({})", legs.join(", "))
                    })
                    .collect();
                format!("Sixteen({})", rows.join(", "))
            }
        }
    }
}

/// What a function answers, as words.
#[derive(Clone, Copy)]
enum Answer {
    Real,
    Whole,
    RealVector(usize),
    WholeVector(usize),
    Legs,
    Sixteen,
}

struct Case {
    function: &'static str,
    files: &'static [LibraryFile],
    arguments: Vec<Argument>,
    answer: Answer,
    twin: fn(&[u32]) -> Vec<u32>,
    /// Allowed |difference| / max(|value|, scale), by the rounding that the function's own steps may do.
    tolerance: f64,
    scale: f64,
}

fn real(word: u32) -> f32 {
    f32::from_bits(word)
}

fn reals<const N: usize>(words: &[u32]) -> [f32; N] {
    std::array::from_fn(|position| real(words[position]))
}

fn bits<const N: usize>(values: [f32; N]) -> Vec<u32> {
    values.map(f32::to_bits).to_vec()
}

/// A twin's answers for two transforms whose points lie side by side.
fn both<const N: usize>(words: &[u32], twin: fn([[f32; 2]; N]) -> [[f32; 2]; N]) -> Vec<u32> {
    let [first, second] = [0, 2].map(|at| twin(std::array::from_fn(|point| reals(&words[4 * point + at..]))));
    let points = first.into_iter().zip(second).flat_map(|(first, second)| [first, second]);
    points.flatten().map(f32::to_bits).collect()
}

fn cases() -> Vec<Case> {
    use Argument::*;
    let elementary: &'static [LibraryFile] = &[shaders::ELEMENTARY];
    let mixing: &'static [LibraryFile] = &[shaders::ELEMENTARY, shaders::MIXING];
    let blending: &'static [LibraryFile] = &[shaders::ELEMENTARY, shaders::BLENDING];
    let fft: &'static [LibraryFile] = &[shaders::FFT];
    let indexing: &'static [LibraryFile] = &[shaders::INDEXING];
    let case = |function, files, arguments: &[Argument], answer, twin, tolerance, scale| Case {
        function,
        files,
        arguments: arguments.to_vec(),
        answer,
        twin,
        tolerance,
        scale,
    };
    let ulps = 4.0 * f64::from(f32::EPSILON);
    vec![
        case(
            "natural_exp",
            elementary,
            &[Real(-95.0, 90.0)],
            Answer::Real,
            |w| bits([twin::natural_exp(real(w[0]))]),
            ulps,
            0.0,
        ),
        case(
            "natural_log",
            elementary,
            &[Logarithmic(1e-37, 1e37)],
            Answer::Real,
            |w| bits([twin::natural_log(real(w[0]))]),
            ulps,
            0.1,
        ),
        case(
            "lobe_shares",
            mixing,
            &[Vector(3, 0.0, 1.0), Vector(3, -60.0, -10.0)],
            Answer::RealVector(4),
            |w| bits(twin::lobe_shares(reals(w), reals(&w[3..]))),
            2.0 * ulps,
            1e-6,
        ),
        case(
            "cell_weights",
            mixing,
            &[Logarithmic(1.0, 1e8), Real(-45.0, -20.0), Real(-45.0, -20.0), Real(0.0, 1.0)],
            Answer::RealVector(2),
            |w| bits(twin::cell_weights(real(w[0]), real(w[1]), real(w[2]), real(w[3]))),
            // The interpolated logarithm, up to 45, is rounded to 2e-6.
            1e-5,
            0.0,
        ),
        case(
            "blend_radiance",
            blending,
            &[Vector(4, 0.0, 1e-9), Vector(4, -0.2, 0.8), Vector(4, -0.2, 0.8)],
            Answer::Real,
            |w| bits([twin::blend_radiance(reals(w), reals(&w[4..]), reals(&w[8..]))]),
            1e-5,
            1e-12,
        ),
        case(
            "complex_multiply",
            fft,
            &[Vector(4, -2.0, 2.0), Vector(2, -2.0, 2.0)],
            Answer::RealVector(4),
            |w| {
                let [a, b] = [0, 2].map(|at| twin::complex_multiply(reals(&w[at..]), reals(&w[4..])));
                bits([a[0], a[1], b[0], b[1]])
            },
            ulps,
            1.0,
        ),
        case("radix4_butterfly", fft, &[Legs], Answer::Legs, |w| both(w, twin::radix4_butterfly), ulps, 1.0),
        case(
            "transform_16",
            fft,
            &[Sixteen],
            Answer::Sixteen,
            |w| both(w, twin::transform_16),
            2.0 * ulps,
            4.0,
        ),
        case(
            "split_pair_spectrum",
            fft,
            &[Vector(2, -2.0, 2.0), Vector(2, -2.0, 2.0)],
            Answer::RealVector(4),
            |w| bits(twin::split_pair_spectrum(reals(w), reals(&w[2..]))),
            ulps,
            1.0,
        ),
        case(
            "pair_from_spectra",
            fft,
            &[Vector(4, -2.0, 2.0), Flag],
            Answer::RealVector(2),
            |w| bits(twin::pair_from_spectra(reals(w), w[4] != 0)),
            ulps,
            1.0,
        ),
        case(
            "cell_texel",
            indexing,
            &[Whole(400_000), Whole(3)],
            Answer::WholeVector(2),
            |w| twin::cell_texel(w[0], w[1]).to_vec(),
            0.0,
            0.0,
        ),
        case(
            "list_texel",
            indexing,
            &[Whole(400_000)],
            Answer::WholeVector(2),
            |w| twin::list_texel(w[0]).to_vec(),
            0.0,
            0.0,
        ),
        case(
            "mixed_texel",
            indexing,
            &[Whole(20_000), Whole(3), Whole(64), Whole(65)],
            Answer::WholeVector(2),
            |w| twin::mixed_texel(w[0], w[1], w[2], w[3]).to_vec(),
            0.0,
            0.0,
        ),
        case(
            "blocked_layer",
            indexing,
            &[Whole(8), Whole(7)],
            Answer::Whole,
            |w| vec![twin::blocked_layer(w[0], w[1])],
            0.0,
            0.0,
        ),
        case(
            "shape_texel",
            indexing,
            &[Whole(3), Whole(3), Whole(192), Whole(193), Whole(15), Whole(32), Whole(33)],
            Answer::WholeVector(2),
            |w| twin::shape_texel(w[0], w[1], w[2], w[3], w[4], w[5], w[6]).to_vec(),
            0.0,
            0.0,
        ),
    ]
}

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

#[test]
fn every_function_of_the_library_has_a_twin_that_is_compared() {
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

#[test]
fn wgsl_functions_agree_with_their_twins_on_lavapipe() {
    let context = Context::open(ExecutorKind::Lavapipe).unwrap();
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
        assert!(largest <= case.tolerance, "{}: {largest}", case.function);
        assert!(varied.len() > 8, "{} answered {} values only", case.function, varied.len());
    }
}

#[test]
fn the_transform_in_workgroup_memory_agrees_with_its_twin() {
    let context = Context::open(ExecutorKind::Lavapipe).unwrap();
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
        let mut expected = *row;
        twin::transform_256(&mut expected);
        for (expected, got) in expected.iter().flatten().zip(got) {
            assert!((expected - real(*got)).abs() < 1e-5, "{expected} {}", real(*got));
        }
    }
}
