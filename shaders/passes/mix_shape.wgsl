// Shape coefficients of every node in use: thirty-two functions in one band an invocation.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> requests: array<Request, MAX_BATCH>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
// The list of (node, band): shares of the lobes, and what this pass does not read.
@group(0) @binding(3) var scales: texture_storage_2d<rgba32float, read>;
// Row: (ring, offset); column: (observer altitude, lobe, band, eight functions of 16 bits); one layer.
@group(0) @binding(4) var shape: texture_storage_2d_array<rgba32uint, read>;
// The same with a layer for every angle.
@group(0) @binding(5) var blocked_shape: texture_storage_2d_array<rgba32uint, read>;
// Row: node; column: (band, four functions).
@group(0) @binding(6) var mixed: texture_storage_2d<rgba32float, write>;

struct Octet {
  low: vec4<f32>,
  high: vec4<f32>,
}

const NO_FUNCTIONS: Octet = Octet(vec4<f32>(0.0), vec4<f32>(0.0));

fn add_shape(sum: Octet, factor: f32, halves: vec4<u32>) -> Octet {
  return Octet(
    sum.low + factor * vec4<f32>(unpack2x16float(halves.x), unpack2x16float(halves.y)),
    sum.high + factor * vec4<f32>(unpack2x16float(halves.z), unpack2x16float(halves.w)),
  );
}

fn open_shape(sum: Octet, factor: f32, texel: vec2<u32>, first: u32) -> Octet {
  return add_shape(sum, factor, textureLoad(shape, texel + vec2<u32>(first, 0u), 0u));
}

// The table may hold fewer functions than the pack: the others are 0.
fn hidden_shape(sum: Octet, factor: f32, texel: vec2<u32>, octet: u32, first: u32, layer: u32) -> Octet {
  let in_table = select(0.0, factor, octet + first < frame.blocked_octet_count);
  return add_shape(sum, in_table, textureLoad(blocked_shape, texel + vec2<u32>(first, 0u), layer));
}

fn store(texel: vec2<u32>, octet: u32, sum: Octet) {
  let low = 8u * octet + vec4<u32>(0u, 1u, 2u, 3u);
  let count = vec4<u32>(frame.basis_count);
  if 2u * octet < frame.quad_count {
    textureStore(mixed, texel, select(vec4<f32>(0.0), sum.low, low < count));
    textureStore(mixed, texel + vec2<u32>(1u, 0u), select(vec4<f32>(0.0), sum.high, low + 4u < count));
  }
}

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  // Lanes that share a (node, band).
  let lane_count = (frame.quad_count + 7u) / 8u;
  let octet = invocation.x % lane_count * 4u;
  let listed = invocation.x / lane_count;
  let band = listed % BAND_COUNT;
  let node_index = listed / BAND_COUNT;
  if node_index >= frame.node_count {
    return;
  }
  let node = nodes[node_index];
  let shares = textureLoad(scales, list_texel(listed));
  let is_open = node.blocking == 0u;
  let altitude_index = requests[node.request].altitude_index;
  let altitude_weight = requests[node.request].altitude_weight;
  let altitude_count = select(0u, requests[node.request].altitude_count, is_open);
  let blocked_altitude_index = requests[node.request].blocked_altitude_index;
  let blocked_altitude_weight = requests[node.request].blocked_altitude_weight;
  let blocked_altitude_count = select(requests[node.request].blocked_altitude_count, 0u, is_open);
  let row = node.ring * frame.offset_count + node.offset;
  let hidden_row = node.ring * frame.blocked_offset_count + node.offset;
  var first = NO_FUNCTIONS;
  var second = NO_FUNCTIONS;
  var third = NO_FUNCTIONS;
  var fourth = NO_FUNCTIONS;
  for (var lobe = 0u; lobe < LOBE_COUNT; lobe++) {
    // A loop that does not run costs software less than a branch, both sides of which it takes.
    let in_use = shares[lobe] > 0.0;
    for (var altitude = 0u; altitude < select(0u, altitude_count, in_use); altitude++) {
      let factor = shares[lobe] * altitude_weight[altitude];
      let texel = shape_texel(row, altitude_index[altitude], lobe, band, octet, frame.table_octet_count);
      first = open_shape(first, factor, texel, 0u);
      second = open_shape(second, factor, texel, 1u);
      third = open_shape(third, factor, texel, 2u);
      fourth = open_shape(fourth, factor, texel, 3u);
    }
    for (var altitude = 0u; altitude < select(0u, blocked_altitude_count, in_use); altitude++) {
      let factor = shares[lobe] * blocked_altitude_weight[altitude];
      let texel =
        shape_texel(hidden_row, blocked_altitude_index[altitude], lobe, band, octet, frame.blocked_octet_count);
      first = hidden_shape(first, factor, texel, octet, 0u, node.blocking - 1u);
      second = hidden_shape(second, factor, texel, octet, 1u, node.blocking - 1u);
      third = hidden_shape(third, factor, texel, octet, 2u, node.blocking - 1u);
      fourth = hidden_shape(fourth, factor, texel, octet, 3u, node.blocking - 1u);
    }
  }
  let texel = mixed_texel(node_index, band, 2u * octet, frame.quad_count);
  store(texel, octet, first);
  store(texel + vec2<u32>(2u, 0u), octet + 1u, second);
  store(texel + vec2<u32>(4u, 0u), octet + 2u, third);
  store(texel + vec2<u32>(6u, 0u), octet + 3u, fourth);
}
