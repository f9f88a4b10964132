//! Packs as textures and buffers on the device.

use super::context::Context;
use crate::{error::RenderError, plan::FUNCTIONS_PER_TABLE_TEXEL, table_set::TableSet};
use half::f16;
use skyglow_physics::{BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT};
use skyglow_tables::resident::{FREQUENCY_COUNT, ResidentBlocked, ResidentTables};
use std::borrow::Cow;

/// One pack as the passes bind it.
pub(crate) struct ResidentPack {
    /// Sources under an open sky: one layer.
    pub(crate) open: ResidentNodes,
    /// Sources behind skylines: layers are angles. A single empty node where the pack has none.
    pub(crate) blocked: ResidentNodes,
    /// f32, four elevations a texel.
    pub(crate) basis: wgpu::TextureView,
}

/// The numbers at a table's nodes.
pub(crate) struct ResidentNodes {
    /// `[observer altitude][layer][lobe][band][ring][offset]`.
    pub(crate) log_scale: wgpu::Buffer,
    /// `[layer][ring][offset]` by `[observer altitude][lobe][band][function]`, f16 as in the pack, eight functions a texel of four words: on software Vulkan the pass then takes
    /// half the processor time that it takes with half-float texels.
    pub(crate) shape: wgpu::TextureView,
}

/// A table's nodes on the host.
#[derive(Clone, Copy)]
struct HostNodes<'a> {
    layers: usize,
    observer_altitudes: usize,
    rings: usize,
    offsets: usize,
    basis_count: usize,
    log_scale: &'a [f32],
    shape: &'a [f16],
}

/// What is bound where there is no table: nothing reads it.
const NO_NODES: HostNodes<'static> = HostNodes {
    layers: 1,
    observer_altitudes: 1,
    rings: 1,
    offsets: 1,
    basis_count: FUNCTIONS_PER_TABLE_TEXEL,
    log_scale: &[0.0; LOBE_COUNT * BAND_COUNT],
    shape: &[f16::ZERO; LOBE_COUNT * BAND_COUNT * FUNCTIONS_PER_TABLE_TEXEL],
};

impl<'a> HostNodes<'a> {
    fn open(tables: &'a ResidentTables) -> Self {
        Self {
            layers: 1,
            observer_altitudes: tables.observer_altitude_m.len(),
            rings: tables.ring_distance_m.len(),
            offsets: tables.offset_count,
            basis_count: tables.basis_count,
            log_scale: &tables.log_scale,
            shape: &tables.shape,
        }
    }

    fn blocked(tables: &'a ResidentTables) -> Self {
        tables.blocked.as_ref().map_or(NO_NODES, |blocked| Self {
            layers: ResidentBlocked::ANGLE_COUNT,
            observer_altitudes: blocked.observer_altitude_m.len(),
            rings: tables.ring_distance_m.len(),
            offsets: blocked.offset_count,
            basis_count: blocked.basis_count,
            log_scale: &blocked.log_scale,
            shape: &blocked.shape,
        })
    }

    /// Width, height and layers of the shape texture.
    fn shape_extent(&self) -> wgpu::Extent3d {
        let images = self.observer_altitudes * LOBE_COUNT * BAND_COUNT;
        wgpu::Extent3d {
            width: (images * self.basis_count.div_ceil(FUNCTIONS_PER_TABLE_TEXEL)) as u32,
            height: (self.rings * self.offsets) as u32,
            depth_or_array_layers: self.layers as u32,
        }
    }

    /// The shape table with each image's functions padded to whole texels.
    fn whole_lanes(&self) -> Cow<'a, [f16]> {
        let padded = self.basis_count.next_multiple_of(FUNCTIONS_PER_TABLE_TEXEL);
        if padded == self.basis_count {
            return Cow::Borrowed(self.shape);
        }
        let zeros = vec![f16::ZERO; padded - self.basis_count];
        let rows = self.shape.chunks_exact(self.basis_count);
        Cow::Owned(rows.flat_map(|row| row.iter().chain(&zeros)).copied().collect())
    }

    fn upload(&self, context: &Context) -> Result<ResidentNodes, RenderError> {
        let limits = context.device.limits();
        let log_scale_bytes: &[u8] = bytemuck::cast_slice(self.log_scale);
        context.check_limit(
            "the scale table",
            log_scale_bytes.len() as u64,
            limits.max_storage_buffer_binding_size,
        )?;
        let log_scale = context.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("log_scale"),
            size: log_scale_bytes.len() as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        context.queue.write_buffer(&log_scale, 0, log_scale_bytes);
        let shape = upload_texture(
            context,
            "shape",
            wgpu::TextureFormat::Rgba32Uint,
            self.shape_extent(),
            bytemuck::cast_slice(&self.whole_lanes()),
        )?;
        Ok(ResidentNodes { log_scale, shape })
    }

    fn bytes(&self) -> u64 {
        4 * self.log_scale.len() as u64 + 16 * texels(self.shape_extent())
    }
}

fn texels(extent: wgpu::Extent3d) -> u64 {
    u64::from(extent.width) * u64::from(extent.height) * u64::from(extent.depth_or_array_layers)
}

/// Width and height of a pack's basis texture: whole texels of functions, zero beyond the last.
fn basis_extent(tables: &ResidentTables) -> wgpu::Extent3d {
    let functions = tables.basis_count.next_multiple_of(FUNCTIONS_PER_TABLE_TEXEL);
    wgpu::Extent3d {
        width: FREQUENCY_COUNT as u32,
        height: (functions * ELEVATION_COUNT / 4) as u32,
        depth_or_array_layers: 1,
    }
}

/// Bytes of a set's packs on the device.
pub(crate) fn bytes(set: &TableSet) -> u64 {
    let pack = |tables: &ResidentTables| {
        HostNodes::open(tables).bytes()
            + HostNodes::blocked(tables).bytes()
            + 16 * texels(basis_extent(tables))
    };
    set.tables().iter().map(|tables| pack(tables)).sum()
}

impl ResidentPack {
    /// Uploads a pack.
    ///
    /// # Errors
    /// [`RenderError::BeyondLimit`] where it is too large for the adapter.
    pub(crate) fn upload(context: &Context, tables: &ResidentTables) -> Result<Self, RenderError> {
        let basis = upload_texture(
            context,
            "basis",
            wgpu::TextureFormat::Rgba32Float,
            basis_extent(tables),
            bytemuck::cast_slice(&basis_texels(tables)),
        )?;
        Ok(Self {
            open: HostNodes::open(tables).upload(context)?,
            blocked: HostNodes::blocked(tables).upload(context)?,
            basis,
        })
    }
}

/// The basis as `[function][four elevations][frequency]` texels.
fn basis_texels(tables: &ResidentTables) -> Vec<[f32; 4]> {
    let extent = basis_extent(tables);
    let mut texels = vec![[0.0; 4]; (extent.width * extent.height) as usize];
    for (row, line) in texels.chunks_exact_mut(FREQUENCY_COUNT).enumerate() {
        let (function, quad) = (row / (ELEVATION_COUNT / 4), row % (ELEVATION_COUNT / 4));
        if function < tables.basis_count {
            for (f, texel) in line.iter_mut().enumerate() {
                *texel = std::array::from_fn(|elevation| {
                    tables.basis_spectrum[tables.spectrum_index(function, 4 * quad + elevation, f)]
                });
            }
        }
    }
    texels
}

fn upload_texture(
    context: &Context,
    label: &'static str,
    format: wgpu::TextureFormat,
    size: wgpu::Extent3d,
    bytes: &[u8],
) -> Result<wgpu::TextureView, RenderError> {
    let limits = context.device.limits();
    let side = u64::from(limits.max_texture_dimension_2d);
    context.check_limit("a table's texture width", u64::from(size.width), side)?;
    context.check_limit("a table's texture height", u64::from(size.height), side)?;
    let layers = u64::from(size.depth_or_array_layers);
    context.check_limit("a table's layers", layers, u64::from(limits.max_texture_array_layers))?;
    let texture = context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layer_bytes = bytes.len() / size.depth_or_array_layers as usize;
    for (layer, bytes) in (0..).zip(bytes.chunks_exact(layer_bytes)) {
        context.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level: 0,
                origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
                aspect: wgpu::TextureAspect::All,
            },
            bytes,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some((layer_bytes / size.height as usize) as u32),
                rows_per_image: Some(size.height),
            },
            wgpu::Extent3d { depth_or_array_layers: 1, ..size },
        );
    }
    let dimension =
        if label == "shape" { wgpu::TextureViewDimension::D2Array } else { wgpu::TextureViewDimension::D2 };
    Ok(texture.create_view(&wgpu::TextureViewDescriptor { dimension: Some(dimension), ..Default::default() }))
}
