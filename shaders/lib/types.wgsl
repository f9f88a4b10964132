// Types shared with the host. A test compares their layout with server/render/src/twin/types.rs.

const BAND_COUNT: u32 = 4u;
// Bands that the channels of one texel hold; those beyond the last band are 0.
const MAX_BAND_COUNT: u32 = 4u;
const LOBE_COUNT: u32 = 3u;
const AZIMUTH_COUNT: u32 = 256u;
const ELEVATION_COUNT: u32 = 64u;
const FREQUENCY_COUNT: u32 = 129u;
const MAX_BATCH: u32 = 8u;

// One pack's share of a batch.
struct Frame {
  request_count: u32,
  node_count: u32,
  cell_count: u32,
  // Functions in use, and texels of four of them.
  basis_count: u32,
  quad_count: u32,
  // Groups of eight functions in the pack's tables.
  table_octet_count: u32,
  ring_count: u32,
  offset_count: u32,
  // Where this pack's radiance goes, and how many packs are blended.
  pack_slot: u32,
  pack_count: u32,
  // Of the tables of sources behind skylines; 0 where the pack has none.
  blocked_octet_count: u32,
  blocked_offset_count: u32,
  // Where the offset axes have their kink.
  kink_node: u32,
  blocked_kink_node: u32,
}

// One request of a batch.
struct Request {
  altitude_index: vec4<u32>,
  altitude_weight: vec4<f32>,
  blend_weight: vec4<f32>,
  // Of linear interpolation between the two packs around.
  linear_weight: vec4<f32>,
  emission: vec3<f32>,
  altitude_count: u32,
  // A channel a band.
  flux_per_dnb_flux: vec4<f32>,
  blocked_altitude_index: vec4<u32>,
  blocked_altitude_weight: vec4<f32>,
  blocked_altitude_count: u32,
}

// A (blocking angle, ring, offset) to mix for a request.
struct Node {
  request: u32,
  ring: u32,
  offset: u32,
  blocking: u32,
}

// An azimuth column and its cells; none where it is dark.
struct Column {
  request: u32,
  azimuth: u32,
  first_cell: u32,
  end_cell: u32,
}
