//! Each pass on the device against the same pass of the CPU executor, fed with what the device itself had before it.

use super::{GpuExecutor, context::Context};
use crate::{
    cpu::{
        azimuth_fft::azimuth_fft,
        basis_sum::{BlockedBasis, basis_sum},
        blend::blend,
        cell_weights::cell_weights,
        coefficients::coefficients,
        inverse_fft::inverse_fft,
        lanes::Aligned,
        layout::{
            CellWeights, ColumnBlock, FrequencySums, GroupSpectra, MixedNode, NodeScales, empty_spectra,
        },
        mix_scale::mix_scale,
        mix_shape::mix_shape,
    },
    executor::Executor,
    plan::RenderPlan,
    prepare::Prepared,
    request::RenderRequest,
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
        flux_per_dnb_flux: synthetic::flux_per_dnb_flux(),
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
    /// A batch of two on the device, rendered.
    fn rendered(turbidity: f64) -> Self {
        let set = TableSet::new(synthetic::table_set_with_skylines(&[2.0, 3.0, 4.0], BASIS_COUNT)).unwrap();
        let context = Context::open(crate::synthetic::tested_device()).unwrap();
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

    /// Scales of one request's nodes as the device has them.
    fn scales(&self, request: usize) -> Vec<NodeScales> {
        let total = self.plan().node_count;
        let list = |view: &wgpu::TextureView, items: usize| {
            let width = twin::indexing::CELLS_PER_ROW as usize;
            self.texture(view, width, items.div_ceil(width)).concat()
        };
        let work = &self.executor.workspace;
        let (shares, logs) = (list(&work.scales, BAND_COUNT * total), list(&work.log_scales, 2 * total));
        let (first, count) = (self.first(request).0, self.batch[request].nodes.len());
        let scales = |node: usize| {
            let bands = &shares[BAND_COUNT * node..][..BAND_COUNT];
            let mut scales = NodeScales {
                log_scale: logs[2 * node],
                curvature: logs[2 * node + 1],
                ..NodeScales::default()
            };
            for (band, [a, b, c, log_scale]) in bands.iter().enumerate() {
                scales.shares[band] = [*a, *b, *c];
                assert_eq!(*log_scale, logs[2 * node][band]);
            }
            scales
        };
        (first..first + count).map(scales).collect()
    }

    /// Shape coefficients of one request's nodes.
    fn mixed(&self, request: usize) -> Vec<MixedNode> {
        let (first, count) = (self.first(request).0, self.batch[request].nodes.len());
        let rows = self.texture(&self.executor.workspace.mixed, BAND_COUNT * QUAD_COUNT, first + count);
        let mut mixed = vec![MixedNode::default(); count];
        for (node, row) in mixed.iter_mut().zip(&rows[first..]) {
            for (band, functions) in node.0.iter_mut().enumerate() {
                for (k, value) in functions[..4 * QUAD_COUNT].iter_mut().enumerate() {
                    *value = row[band * QUAD_COUNT + k / 4][k % 4];
                }
            }
        }
        mixed
    }

    /// Weights of one request's cells.
    fn weights(&self, request: usize) -> Vec<CellWeights> {
        let total = self.plan().cell_count;
        let height = total.div_ceil(twin::indexing::CELLS_PER_ROW as usize);
        let texels = self.texture(&self.executor.workspace.weights, BAND_COUNT * 1024, height);
        let (first, count) = (self.first(request).1, self.batch[request].cells.len());
        let weights = |cell: usize| {
            [2, 3].map(|part| {
                twin::band_channels(std::array::from_fn(|band| {
                    let [x, y] = twin::cell_texel(cell as u32, band as u32);
                    texels[y as usize][x as usize][part]
                }))
            })
        };
        (first..first + count).map(weights).collect()
    }

    /// H of one request by azimuth.
    fn columns(&self, request: usize) -> Vec<ColumnBlock> {
        let functions = 4 * QUAD_COUNT;
        let view = &self.executor.workspace.coefficients;
        let rows = self.texture(view, AZIMUTH_COUNT, 2 * BAND_COUNT * QUAD_COUNT);
        let mut columns = vec![ColumnBlock::default(); AZIMUTH_COUNT];
        for (azimuth, column) in columns.iter_mut().enumerate() {
            for (band, sums) in column.0.iter_mut().enumerate() {
                for (k, sum) in sums[..functions].iter_mut().enumerate() {
                    *sum = rows[(request * BAND_COUNT + band) * QUAD_COUNT + k / 4][azimuth][k % 4];
                }
            }
        }
        columns
    }

    /// F[H] of one request; functions beyond those in use are 0 here and whatever they are on the device.
    fn spectra(&self, request: usize) -> Vec<GroupSpectra> {
        let pairs = 2 * QUAD_COUNT;
        let rows = self.texture(&self.executor.workspace.spectra, FREQUENCY_COUNT, 2 * BAND_COUNT * pairs);
        let mut spectra = vec![empty_spectra(); BAND_COUNT];
        for (band, spectra) in spectra.iter_mut().enumerate() {
            for k in 0..BASIS_COUNT {
                let row = &rows[(request * BAND_COUNT + band) * pairs + k / 2];
                for (target, texel) in spectra.0.iter_mut().zip(row) {
                    for part in 0..2 {
                        target[part][k] = texel[2 * (k % 2) + part];
                    }
                }
            }
        }
        spectra
    }

    fn sums(&self, request: usize) -> Vec<FrequencySums> {
        let height = 2 * BAND_COUNT * ELEVATION_COUNT / 2;
        let rows = self.texture(&self.executor.workspace.sums, FREQUENCY_COUNT, height);
        let mut sums = vec![Aligned([[[0.0; ELEVATION_COUNT]; 2]; BAND_COUNT]); FREQUENCY_COUNT];
        for (f, sums) in sums.iter_mut().enumerate() {
            for band in 0..BAND_COUNT {
                for row in 0..ELEVATION_COUNT {
                    let pair = ((request * BAND_COUNT + band) * ELEVATION_COUNT + row) / 2;
                    let texel = rows[pair][f];
                    for part in 0..2 {
                        sums.0[band][part][row] = texel[2 * (row % 2) + part];
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

/// Each pass agrees with the CPU on the same input.
#[test]
fn each_pass_agrees_with_the_cpu() {
    let rig = Rig::rendered(3.0);
    let tables = &rig.set.tables()[1];
    let twiddles = twin::twiddles();
    for (request, prepared) in rig.batch.iter().enumerate() {
        let scales = rig.scales(request);
        let mut expected = Vec::new();
        mix_scale(tables, prepared, true, &mut expected);
        let flat = |scales: &[NodeScales]| -> Vec<f32> {
            let values = |s: &NodeScales| [s.log_scale.to_vec(), s.shares.as_flattened().to_vec()].concat();
            scales.iter().flat_map(values).collect()
        };
        assert_close("mix_scale", &flat(&scales), &flat(&expected), 3e-7);
        let curvatures =
            |scales: &[NodeScales]| scales.iter().flat_map(|s| s.curvature).collect::<Vec<f32>>();
        // A difference of logarithms around 30: the rounding of those over a curvature of a tenth.
        assert_close("curvatures", &curvatures(&scales), &curvatures(&expected), 1e-4);

        let mut expected = Vec::new();
        mix_shape(tables, prepared, &scales, true, &mut expected);
        let mixed = rig.mixed(request);
        let flat =
            |mixed: &[MixedNode]| mixed.iter().flat_map(|n| n.0.as_flattened().to_vec()).collect::<Vec<_>>();
        assert_close("mix_shape", &flat(&mixed), &flat(&expected), 1e-6);

        let weights = rig.weights(request);
        let mut expected = Vec::new();
        cell_weights(prepared, &scales, true, &mut expected);
        let flat = |weights: &[CellWeights]| weights.as_flattened().as_flattened().to_vec();
        assert_close("cell_weights", &flat(&weights), &flat(&expected), 5e-6);

        let columns = rig.columns(request);
        let mut expected = Vec::new();
        coefficients(prepared, &mixed, &weights, true, &mut expected);
        let flat = |columns: &[ColumnBlock]| {
            columns.iter().flat_map(|c| c.0.as_flattened().to_vec()).collect::<Vec<_>>()
        };
        assert_close("coefficients", &flat(&columns), &flat(&expected), 1e-6);

        let spectra = rig.spectra(request);
        let mut expected = Vec::new();
        azimuth_fft(&twiddles, [true; BAND_COUNT], &columns, BASIS_COUNT, true, &mut expected);
        let flat = |spectra: &[GroupSpectra]| -> Vec<f32> {
            spectra.iter().flat_map(|s| s.0.as_flattened().as_flattened().to_vec()).collect()
        };
        assert_close("azimuth_fft", &flat(&spectra), &flat(&expected), 1e-6);

        let sums = rig.sums(request);
        let mut expected = Vec::new();
        basis_sum(&BlockedBasis::of(tables), &spectra, BASIS_COUNT, true, &mut expected);
        let flat = |sums: &[FrequencySums]| -> Vec<f32> {
            sums.iter().flat_map(|s| s.0.as_flattened().as_flattened().to_vec()).collect()
        };
        assert_close("basis_sum", &flat(&sums), &flat(&expected), 1e-6);

        let mut expected = Vec::new();
        inverse_fft(&twiddles, 0.0, [true; BAND_COUNT], &sums, true, &mut expected);
        assert_close("inverse_fft", &rig.rendered[request], &expected, 1e-6);
    }
}

/// The blend agrees with the CPU on the same input.
#[test]
fn the_blend_agrees_with_the_cpu() {
    let rig = Rig::rendered(2.4);
    let all = rig.buffer(&rig.executor.workspace.radiance, 3 * 2 * Panorama::LEN);
    for (request, prepared) in rig.batch.iter().enumerate() {
        let sky = |slot: usize| all[(slot * 2 + request) * Panorama::LEN..][..Panorama::LEN].to_vec();
        let skies = [sky(0), sky(1), sky(2)];
        let expected = blend(&skies.each_ref().map(Vec::as_slice), &prepared.turbidity_stencil, true);
        assert_close("blend", &rig.rendered[request], &expected, 1e-5);
    }
}

/// The budget is kept before anything is allocated.
#[test]
fn the_budget_is_kept_before_allocating() {
    let set = TableSet::new(synthetic::table_set(&[2.0], 8)).unwrap();
    let context = Context::open(crate::synthetic::tested_device()).unwrap();
    let refused = GpuExecutor::new(context, set, 1_000_000).err().unwrap().to_string();
    assert!(refused.ends_with("the budget is 1000000"), "{refused}");
}

/// A wrong command comes back as an error and the next batch is rendered.
#[test]
fn a_wrong_command_comes_back_as_an_error() {
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
