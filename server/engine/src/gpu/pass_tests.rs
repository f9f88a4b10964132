//! Each pass on lavapipe against the same pass of the CPU executor, fed with what the device itself had before it.

use super::{GpuExecutor, context::Context};
use crate::{
    cpu::{
        basis_sum::{self, BLOCK, BlockedBasis},
        blend, coefficients, mix,
        transforms::{PADDED, Spectra, Transforms},
    },
    executor::Executor,
    plan::RenderPlan,
    prepare::Prepared,
    request::{ExecutorKind, RenderRequest},
    synthetic,
    table_set::TableSet,
    twin,
};
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, EmissionMix, Panorama, Turbidity};
use skyglow_tables::{Scattering, resident::FREQUENCY_COUNT};
use std::sync::{Arc, mpsc::channel};

/// 12 functions: not a multiple of eight, so that padding is seen.
const BASIS_COUNT: usize = 12;
const QUAD_COUNT: usize = 4;

fn prepared(seed: u64, observer_altitude_m: f64, turbidity: f64, set: &TableSet) -> Prepared {
    let request = RenderRequest {
        polar: Arc::new(synthetic::polar_grid_with_skylines(seed, 900)),
        observer_altitude_m,
        turbidity: Turbidity::new(turbidity).unwrap(),
        scattering: Scattering::Single,
        cloud_base_m: None,
        emission: EmissionMix::new([0.5, 0.3, 0.2]).unwrap(),
        flux_per_dnb_flux: [0.4, 0.6, 0.2],
        basis: None,
    };
    Prepared::new(&request, set).unwrap()
}

struct Rig {
    set: TableSet,
    executor: GpuExecutor,
    batch: Vec<Prepared>,
    /// Panoramas of the batch.
    rendered: Vec<Vec<f32>>,
}

impl Rig {
    /// A batch of two on lavapipe, rendered.
    fn rendered(turbidity: f64) -> Self {
        let set = TableSet::new(synthetic::table_set_with_skylines(&[2.0, 3.0, 4.0], BASIS_COUNT)).unwrap();
        let context = Context::open(ExecutorKind::Lavapipe).unwrap();
        let mut executor = GpuExecutor::new(context, set.clone(), 1 << 30).unwrap();
        let batch = vec![prepared(1, 1661.0, turbidity, &set), prepared(2, 0.0, turbidity, &set)];
        let requests: Vec<&Prepared> = batch.iter().collect();
        let rendered = executor.render(&requests).unwrap().radiance_w_m2_sr;
        Self { set, executor, batch, rendered }
    }

    fn plan(&self) -> RenderPlan {
        RenderPlan::of(&self.batch.iter().collect::<Vec<_>>(), &self.set)
    }

    /// First node and first cell of a request in the batch.
    fn first(&self, request: usize) -> (usize, usize) {
        let before = &self.batch[..request];
        (before.iter().map(|b| b.nodes.len()).sum(), before.iter().map(|b| b.cells.len()).sum())
    }

    fn submit_and_map(&self, encoder: wgpu::CommandEncoder, buffer: &wgpu::Buffer) -> Vec<f32> {
        let context = &self.executor.context;
        context.queue.submit([encoder.finish()]);
        let (sender, receiver) = channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| sender.send(result).unwrap());
        context.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        receiver.recv().unwrap().unwrap();
        bytemuck::pod_collect_to_vec(&buffer.get_mapped_range(..).unwrap())
    }

    fn read_back_buffer(&self, size: u64) -> wgpu::Buffer {
        self.executor.context.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    fn buffer(&self, source: &wgpu::Buffer, values: usize) -> Vec<f32> {
        let target = self.read_back_buffer(4 * values as u64);
        let mut encoder = self.executor.context.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(source, 0, &target, 0, 4 * values as u64);
        self.submit_and_map(encoder, &target)
    }

    /// The top rows of a texture as `[row][column]` texels.
    fn texture(&self, source: &wgpu::TextureView, width: usize, height: usize) -> Vec<Vec<[f32; 4]>> {
        let row_bytes = (16 * width).next_multiple_of(256);
        let target = self.read_back_buffer((row_bytes * height) as u64);
        let mut encoder = self.executor.context.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            source.texture().as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &target,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row_bytes as u32),
                    rows_per_image: None,
                },
            },
            wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 },
        );
        let values = self.submit_and_map(encoder, &target);
        values.chunks_exact(row_bytes / 4).map(|row| row.as_chunks::<4>().0[..width].to_vec()).collect()
    }

    /// `[band][node]` of one request as the device has it.
    fn scales(&self, request: usize) -> Vec<[f32; 4]> {
        let total = self.plan().node_count;
        let all = self.buffer(&self.executor.workspace.scales, 4 * BAND_COUNT * total);
        let (first, count) = (self.first(request).0, self.batch[request].nodes.len());
        let band = |band: usize| &all.as_chunks::<4>().0[band * total + first..][..count];
        (0..BAND_COUNT).flat_map(|b| band(b).to_vec()).collect()
    }

    /// `[band][node][padded function]` of one request.
    fn mixed(&self, request: usize) -> Vec<f32> {
        let (first, count) = (self.first(request).0, self.batch[request].nodes.len());
        let rows = self.texture(&self.executor.workspace.mixed, BAND_COUNT * QUAD_COUNT, first + count);
        let padded = BASIS_COUNT.next_multiple_of(mix::BLOCK);
        let mut values = vec![0.0; BAND_COUNT * count * padded];
        for (position, node) in values.chunks_exact_mut(padded).enumerate() {
            let (band, row) = (position / count, &rows[first + position % count]);
            for (k, value) in node[..4 * QUAD_COUNT].iter_mut().enumerate() {
                *value = row[band * QUAD_COUNT + k / 4][k % 4];
            }
        }
        values
    }

    /// `[band][cell]` (lower weight, upper weight) of one request.
    fn weights(&self, request: usize) -> Vec<[f32; 2]> {
        let total = self.plan().cell_count;
        let height = total.div_ceil(twin::indexing::CELLS_PER_ROW as usize);
        let texels = self.texture(&self.executor.workspace.weights, 3 * 1024, height);
        let (first, count) = (self.first(request).1, self.batch[request].cells.len());
        let mut weights = Vec::new();
        for band in 0..BAND_COUNT {
            for cell in first..first + count {
                let [x, y] = twin::cell_texel(cell as u32, band as u32);
                let texel = texels[y as usize][x as usize];
                weights.push([texel[2], texel[3]]);
            }
        }
        weights
    }

    /// `[column slot][band][padded function]` of one request.
    fn columns(&self, request: usize) -> Vec<f32> {
        let functions = 4 * QUAD_COUNT;
        let values = 2 * BAND_COUNT * functions * AZIMUTH_COUNT;
        let all = self.buffer(&self.executor.workspace.coefficients, values);
        let padded = BASIS_COUNT.next_multiple_of(mix::BLOCK);
        let mut columns = Vec::new();
        for lit in &self.batch[request].columns {
            for band in 0..BAND_COUNT {
                for k in 0..padded {
                    let pair = (request * BAND_COUNT + band) * functions / 2 + k / 2;
                    let position = (pair * AZIMUTH_COUNT + lit.azimuth as usize) * 2 + k % 2;
                    columns.push(if k < functions { all[position] } else { 0.0 });
                }
            }
        }
        columns
    }

    fn spectra(&self, request: usize) -> Spectra {
        let pairs = 2 * QUAD_COUNT;
        let rows = self.texture(&self.executor.workspace.spectra, FREQUENCY_COUNT, 2 * BAND_COUNT * pairs);
        let padded = BASIS_COUNT.next_multiple_of(mix::BLOCK);
        let mut values = vec![0.0; BAND_COUNT * padded * 2 * PADDED];
        for band in 0..BAND_COUNT {
            for k in 0..2 * pairs {
                let row = &rows[(request * BAND_COUNT + band) * pairs + k / 2];
                for (f, texel) in row.iter().enumerate() {
                    let start = (band * padded + k) * 2 * PADDED + f;
                    values[start] = texel[2 * (k % 2)];
                    values[start + PADDED] = texel[2 * (k % 2) + 1];
                }
            }
        }
        Spectra { basis_count: BASIS_COUNT, values }
    }

    fn sums(&self, request: usize) -> basis_sum::SpectrumSums {
        let values = 2 * BAND_COUNT * ELEVATION_COUNT * FREQUENCY_COUNT * 2;
        let all = self.buffer(&self.executor.workspace.sums, values);
        let mut sums = vec![[[0.0; BLOCK]; 2]; PADDED / BLOCK * ELEVATION_COUNT * BAND_COUNT];
        for band in 0..BAND_COUNT {
            for row in 0..ELEVATION_COUNT {
                for f in 0..FREQUENCY_COUNT {
                    let pair = ((request * BAND_COUNT + band) * ELEVATION_COUNT + row) / 2;
                    let texel = &all.as_chunks::<4>().0[pair * FREQUENCY_COUNT + f];
                    for part in 0..2 {
                        sums[(f / BLOCK * ELEVATION_COUNT + row) * BAND_COUNT + band][part][f % BLOCK] =
                            texel[2 * (row % 2) + part];
                    }
                }
            }
        }
        sums
    }
}

/// Largest difference over the largest value: the passes are sums, whose rounding scales with their terms.
fn assert_close(what: &str, got: &[f32], expected: &[f32], tolerance: f32) {
    assert_eq!(got.len(), expected.len(), "{what}");
    let size = expected.iter().fold(0f32, |size, value| size.max(value.abs()));
    let difference = got.iter().zip(expected).fold(0f32, |most, (a, b)| most.max((a - b).abs()));
    println!("{what}: {:.1e} of {size:.1e}", difference / size);
    assert!(size > 0.0 && difference <= tolerance * size, "{what}: {difference} of {size}");
}

#[test]
fn each_pass_agrees_with_the_cpu_on_the_same_input() {
    let rig = Rig::rendered(3.0);
    let tables = &rig.set.tables()[1];
    let transforms = Transforms::new();
    for (request, prepared) in rig.batch.iter().enumerate() {
        let scales = rig.scales(request);
        let expected = mix::mix_scale(tables, prepared);
        assert_close("mix_scale", scales.as_flattened(), expected.as_flattened(), 3e-7);

        let mut mixed = mix::mix_shape(tables, prepared, &scales);
        let got = rig.mixed(request);
        assert_close("mix_shape", &got, &mixed.shape, 1e-6);
        mixed.shape = got;

        let weights = rig.weights(request);
        let expected = coefficients::weigh_cells(prepared, &scales);
        assert_close("cell_weights", weights.as_flattened(), expected.as_flattened(), 5e-6);

        let columns = rig.columns(request);
        let expected = coefficients::sum_columns(prepared, &mixed, &weights);
        assert_close("coefficients", &columns, &expected, 1e-6);

        let spectra = rig.spectra(request);
        let expected = transforms.forward(prepared, &columns, BASIS_COUNT, mixed.padded_count);
        assert_close("azimuth_fft", &spectra.values, &expected.values, 1e-6);

        let sums = rig.sums(request);
        let expected = basis_sum::basis_sum(&BlockedBasis::of(tables), &spectra);
        let flat = |sums: &basis_sum::SpectrumSums| sums.as_flattened().as_flattened().to_vec();
        assert_close("basis_sum", &flat(&sums), &flat(&expected), 1e-6);

        let expected = transforms.inverse(&sums);
        assert_close("inverse_fft", &rig.rendered[request], &expected, 1e-6);
    }
}

#[test]
fn the_blend_agrees_with_the_cpu_on_the_same_input() {
    let rig = Rig::rendered(2.4);
    let all = rig.buffer(&rig.executor.workspace.radiance, 3 * 2 * Panorama::LEN);
    for (request, prepared) in rig.batch.iter().enumerate() {
        let sky = |slot: usize| all[(slot * 2 + request) * Panorama::LEN..][..Panorama::LEN].to_vec();
        let expected = blend::blend(&[sky(0), sky(1), sky(2)], &prepared.turbidity_taps);
        assert_close("blend", &rig.rendered[request], &expected, 1e-5);
    }
}

#[test]
fn the_budget_is_kept_before_anything_is_allocated() {
    let set = TableSet::new(synthetic::table_set(&[2.0], 8)).unwrap();
    let context = Context::open(ExecutorKind::Lavapipe).unwrap();
    let refused = GpuExecutor::new(context, set, 1_000_000).err().unwrap().to_string();
    assert!(refused.ends_with("the budget is 1000000"), "{refused}");
}

#[test]
fn a_wrong_command_comes_back_as_an_error_and_the_next_batch_is_rendered() {
    let mut rig = Rig::rendered(2.0);
    // A copy beyond the end of its target is refused by validation, without a panic.
    let work = &rig.executor.workspace;
    let mut encoder = rig.executor.context.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(&work.radiance, 0, &work.blended, 4, work.blended.size());
    rig.executor.context.queue.submit([encoder.finish()]);
    let requests: Vec<&Prepared> = rig.batch.iter().collect();
    assert!(rig.executor.render(&requests).is_err());
    let again = rig.executor.render(&requests).unwrap().radiance_w_m2_sr;
    assert_eq!(again, rig.rendered);
}
