//! Buffers and textures that every batch uses again, as large as the largest batch.

use super::context::Context;
use crate::{
    MAX_BATCH,
    error::RenderError,
    plan::{FUNCTIONS_PER_TABLE_TEXEL, Pass},
    table_set::TableSet,
    twin::{
        indexing::{CELLS_PER_ROW, NODE_ROWS},
        twiddle,
        types::{Column, Frame, Node, Request},
    },
};
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, Panorama, interpolation::MAX_STENCIL};
use skyglow_tables::resident::FREQUENCY_COUNT;
use wgpu::{BufferUsages, TextureUsages};

/// Timestamps a batch writes at most: at the start, and after each pass of each pack.
pub(crate) const TIMESTAMP_COUNT: u32 = (MAX_STENCIL * Pass::ALL.len()) as u32 + 1;

/// Everything between the packs and the panorama.
pub(crate) struct Workspace {
    pub(crate) frames: Vec<wgpu::Buffer>,
    pub(crate) requests: wgpu::Buffer,
    pub(crate) nodes: wgpu::Buffer,
    pub(crate) cells: wgpu::TextureView,
    pub(crate) columns: wgpu::Buffer,
    pub(crate) twiddles: wgpu::Buffer,
    pub(crate) scales: wgpu::TextureView,
    pub(crate) log_scales: wgpu::TextureView,
    pub(crate) mixed: wgpu::TextureView,
    pub(crate) weights: wgpu::TextureView,
    pub(crate) coefficients: wgpu::TextureView,
    pub(crate) spectra: wgpu::TextureView,
    pub(crate) sums: wgpu::TextureView,
    pub(crate) radiance: wgpu::Buffer,
    pub(crate) blended: wgpu::Buffer,
    /// Panoramas, then timestamps, on their way back.
    pub(crate) read_back: wgpu::Buffer,
    pub(crate) timestamps: Option<(wgpu::QuerySet, wgpu::Buffer)>,
}

/// Sizes of the workspace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct WorkspaceSize {
    pub(crate) node_count: usize,
    pub(crate) cell_count: usize,
    pub(crate) function_count: usize,
}

/// Bytes where the timestamps begin in the read-back buffer.
pub(crate) const READ_BACK_PANORAMA_BYTES: u64 = (MAX_BATCH * Panorama::LEN * 4) as u64;

impl WorkspaceSize {
    /// What a set of packs can ask for.
    pub(crate) fn of(set: &TableSet) -> Self {
        Self {
            node_count: crate::MAX_BATCH_NODES.max(set.node_count()),
            cell_count: crate::MAX_BATCH_CELLS.max(set.cell_count()),
            function_count: set.basis_count().next_multiple_of(FUNCTIONS_PER_TABLE_TEXEL),
        }
    }

    fn mixed_extent(self) -> [usize; 2] {
        let rows = NODE_ROWS as usize;
        let side_by_side = self.node_count.div_ceil(rows);
        [side_by_side * BAND_COUNT * self.function_count / 4, self.node_count.min(rows)]
    }

    fn weights_extent(self) -> [usize; 2] {
        [BAND_COUNT * CELLS_PER_ROW as usize, self.cell_count.div_ceil(CELLS_PER_ROW as usize)]
    }

    /// A list of so many texels.
    fn list_extent(items: usize) -> [usize; 2] {
        [CELLS_PER_ROW as usize, items.div_ceil(CELLS_PER_ROW as usize)]
    }

    fn coefficients_extent(self) -> [usize; 2] {
        [AZIMUTH_COUNT, MAX_BATCH * BAND_COUNT * self.function_count / 4]
    }

    fn spectra_extent(self) -> [usize; 2] {
        [FREQUENCY_COUNT, MAX_BATCH * BAND_COUNT * self.function_count / 2]
    }

    fn sums_extent() -> [usize; 2] {
        [FREQUENCY_COUNT, MAX_BATCH * BAND_COUNT * ELEVATION_COUNT / 2]
    }

    fn radiance_bytes() -> usize {
        MAX_STENCIL * MAX_BATCH * Panorama::LEN * 4
    }

    /// Bytes of everything large.
    pub(crate) fn bytes(self) -> u64 {
        let textures = [
            Self::list_extent(self.cell_count),
            Self::list_extent(BAND_COUNT * self.node_count),
            Self::list_extent(2 * self.node_count),
            self.mixed_extent(),
            self.weights_extent(),
            self.coefficients_extent(),
            self.spectra_extent(),
            Self::sums_extent(),
        ];
        let texels: usize = textures.iter().map(|[width, height]| width * height).sum();
        let buffers =
            Self::radiance_bytes() + self.node_count * size_of::<Node>() + 2 * MAX_BATCH * Panorama::LEN * 4;
        (16 * texels + buffers) as u64
    }
}

impl Workspace {
    /// Makes everything.
    ///
    /// # Errors
    /// [`RenderError::BeyondLimit`] where a size is too large for the adapter.
    pub(crate) fn new(context: &Context, size: WorkspaceSize) -> Result<Self, RenderError> {
        let limits = context.device.limits();
        let buffer = |label: &'static str, bytes: usize, usage: BufferUsages| {
            context.check_limit(label, bytes as u64, limits.max_storage_buffer_binding_size)?;
            Ok::<_, RenderError>(context.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes as u64,
                usage,
                mapped_at_creation: false,
            }))
        };
        let input = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let inner = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let texture = |label: &'static str, [width, height]: [usize; 2]| {
            let side = u64::from(limits.max_texture_dimension_2d);
            context.check_limit(label, width.max(height) as u64, side)?;
            let texture = context.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba32Float,
                usage: TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC | TextureUsages::COPY_DST,
                view_formats: &[],
            });
            Ok::<_, RenderError>(texture.create_view(&wgpu::TextureViewDescriptor::default()))
        };
        let twiddles = buffer("twiddles", AZIMUTH_COUNT * 8, input)?;
        // `[n][m]`: e^{−2πi·n·m/256}.
        let table: Vec<[f32; 2]> = (0..AZIMUTH_COUNT).map(|at| twiddle((at / 16) * (at % 16))).collect();
        context.queue.write_buffer(&twiddles, 0, bytemuck::cast_slice(&table));
        let frames = (0..=MAX_STENCIL)
            .map(|_| buffer("frame", size_of::<Frame>(), BufferUsages::UNIFORM | BufferUsages::COPY_DST))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            frames,
            requests: buffer(
                "requests",
                MAX_BATCH * size_of::<Request>(),
                BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            )?,
            nodes: buffer("nodes", size.node_count * size_of::<Node>(), input)?,
            cells: texture("cells", WorkspaceSize::list_extent(size.cell_count))?,
            columns: buffer("columns", MAX_BATCH * AZIMUTH_COUNT * size_of::<Column>(), input)?,
            twiddles,
            scales: texture("scales", WorkspaceSize::list_extent(BAND_COUNT * size.node_count))?,
            log_scales: texture("log_scales", WorkspaceSize::list_extent(2 * size.node_count))?,
            mixed: texture("mixed", size.mixed_extent())?,
            weights: texture("weights", size.weights_extent())?,
            coefficients: texture("coefficients", size.coefficients_extent())?,
            spectra: texture("spectra", size.spectra_extent())?,
            sums: texture("sums", WorkspaceSize::sums_extent())?,
            radiance: buffer("radiance", WorkspaceSize::radiance_bytes(), inner)?,
            blended: buffer("blended", MAX_BATCH * Panorama::LEN * 4, inner)?,
            read_back: buffer(
                "read_back",
                READ_BACK_PANORAMA_BYTES as usize + 8 * TIMESTAMP_COUNT as usize,
                BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            )?,
            timestamps: context.nanoseconds_per_tick.map(|_| timestamps(&context.device)),
        })
    }
}

fn timestamps(device: &wgpu::Device) -> (wgpu::QuerySet, wgpu::Buffer) {
    let set = device.create_query_set(&wgpu::QuerySetDescriptor {
        label: Some("pass times"),
        ty: wgpu::QueryType::Timestamp,
        count: TIMESTAMP_COUNT,
    });
    let resolved = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("pass times"),
        size: 8 * u64::from(TIMESTAMP_COUNT),
        usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    (set, resolved)
}
