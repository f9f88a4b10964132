//! A batch as the arrays that the passes read.

use crate::{
    plan::RenderPlan,
    prepare::Prepared,
    table_set::TableSet,
    twin::{
        indexing::CELLS_PER_ROW,
        types::{Column, Frame, Node, Request, band_channels},
    },
};
use skyglow_physics::{
    AZIMUTH_COUNT,
    interpolation::{MAX_STENCIL, Stencil},
};
use skyglow_tables::OffsetAxis;

/// The arrays of all requests, one behind the other; node numbers are global.
#[derive(Default)]
pub(crate) struct BatchArrays {
    pub(crate) requests: Vec<Request>,
    pub(crate) nodes: Vec<Node>,
    /// Flux in DNB watts, lower node, weight of the upper node, request; the upper node is the next.
    pub(crate) cells: Vec<[f32; 4]>,
    /// All columns of every request.
    pub(crate) columns: Vec<Column>,
}

/// Nodes as the shaders take them, 0 behind the last.
fn node_numbers(stencil: &Stencil) -> [u32; MAX_STENCIL] {
    let mut numbers = [0; MAX_STENCIL];
    numbers.iter_mut().zip(stencil.nodes()).for_each(|(number, node)| *number = node as u32);
    numbers
}

impl BatchArrays {
    /// Lists a batch.
    pub(crate) fn of(batch: &[&Prepared]) -> Self {
        let mut arrays = Self::default();
        for (request, prepared) in (0u32..).zip(batch) {
            arrays.push(request, prepared);
        }
        arrays
    }

    fn push(&mut self, request: u32, prepared: &Prepared) {
        let (first_node, first_cell) = (self.nodes.len() as u32, self.cells.len() as u32);
        self.requests.push(Request {
            altitude_index: node_numbers(&prepared.altitude_stencil),
            altitude_weight: prepared.altitude_stencil.weights_f32(),
            blend_weight: prepared.turbidity_stencil.weights_f32(),
            linear_weight: prepared.turbidity_stencil.linear_weights_f32(),
            emission: prepared.emission,
            altitude_count: prepared.altitude_stencil.nodes().len() as u32,
            flux_per_dnb_flux: band_channels(prepared.flux_per_dnb_flux),
            blocked_altitude_index: node_numbers(&prepared.blocked_altitude_stencil),
            blocked_altitude_weight: prepared.blocked_altitude_stencil.weights_f32(),
            blocked_altitude_count: prepared.blocked_altitude_stencil.nodes().len() as u32,
            padding: [0; 3],
        });
        let nodes = prepared.nodes.iter();
        self.nodes.extend(nodes.map(|node| Node {
            request,
            ring: node.ring,
            offset: node.offset,
            blocking: node.blocking,
        }));
        // Numbers of nodes and requests stay below 2^24, so that f32 holds them exactly.
        self.cells.extend(prepared.cells.iter().map(|cell| {
            [cell.flux_dnb_w, (cell.lower_node + first_node) as f32, cell.upper_weight, request as f32]
        }));
        let first_column = self.columns.len();
        let dark = |azimuth| Column { request, azimuth, first_cell: 0, end_cell: 0 };
        self.columns.extend((0..AZIMUTH_COUNT as u32).map(dark));
        for lit in &prepared.columns {
            let column = &mut self.columns[first_column + lit.azimuth as usize];
            (column.first_cell, column.end_cell) = (lit.first_cell + first_cell, lit.end_cell + first_cell);
        }
    }
}

/// Writes a list into the rows of a texture; behind its end the last row is 0.
pub(crate) fn write_list(queue: &wgpu::Queue, texture: &wgpu::Texture, mut list: Vec<[f32; 4]>) {
    let width = CELLS_PER_ROW as usize;
    list.resize(list.len().next_multiple_of(width), [0.0; 4]);
    queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&list),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(16 * CELLS_PER_ROW),
            rows_per_image: None,
        },
        wgpu::Extent3d {
            width: CELLS_PER_ROW,
            height: (list.len() / width) as u32,
            depth_or_array_layers: 1,
        },
    );
}

/// The frame of a pack slot; one past the last pack is the blend's.
pub(crate) fn frame(plan: &RenderPlan, set: &TableSet, slot: usize) -> Frame {
    let pack = plan.packs.get(slot);
    let tables = pack.map(|pack| &set.tables()[pack.index]);
    let blocked = tables.and_then(|tables| tables.blocked.as_ref());
    // The same on every ring, and behind every skyline.
    let kink_node = |axis: Option<&OffsetAxis>| axis.map_or(0, |axis| axis.kink_node) as u32;
    Frame {
        request_count: plan.request_count as u32,
        node_count: plan.node_count as u32,
        cell_count: plan.cell_count as u32,
        basis_count: pack.map_or(0, |pack| pack.basis_count) as u32,
        quad_count: pack.map_or(0, |pack| pack.quad_count) as u32,
        table_octet_count: tables.map_or(0, |tables| tables.basis_count.div_ceil(8)) as u32,
        ring_count: set.ring_count() as u32,
        offset_count: set.offset_count() as u32,
        pack_slot: slot as u32,
        pack_count: plan.packs.len() as u32,
        blocked_octet_count: blocked.map_or(0, |blocked| blocked.basis_count.div_ceil(8)) as u32,
        blocked_offset_count: blocked.map_or(0, |blocked| blocked.offset_count) as u32,
        kink_node: kink_node(tables.and_then(|tables| tables.offset_axis.first())),
        blocked_kink_node: kink_node(blocked.and_then(|blocked| blocked.offset_axis.first()?.first())),
    }
}
