// Shape coefficients of every node in use: eight functions in one band an invocation, one node a workgroup.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> requests: array<Request, MAX_BATCH>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
// The list of (node, band): shares of the lobes, and what this pass does not read.
@group(0) @binding(3) var scales: texture_storage_2d<rgba32float, read>;
// Layer: observer altitude; row: (lobe, band, ring); column: (offset, eight functions of 16 bits).
@group(0) @binding(4) var shape: texture_storage_2d_array<rgba32uint, read>;
// The same with a layer for every (observer altitude, angle).
@group(0) @binding(5) var blocked_shape: texture_storage_2d_array<rgba32uint, read>;
// Row: node; column: (band, four functions).
@group(0) @binding(6) var mixed: texture_storage_2d<rgba32float, write>;

struct Octet {
  low: vec4<f32>,
  high: vec4<f32>,
}

fn add_shape(sum: Octet, factor: f32, halves: vec4<u32>) -> Octet {
  return Octet(
    sum.low + factor * vec4<f32>(unpack2x16float(halves.x), unpack2x16float(halves.y)),
    sum.high + factor * vec4<f32>(unpack2x16float(halves.z), unpack2x16float(halves.w)),
  );
}

@compute @workgroup_size(8, 1, 1)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(global_invocation_id) invocation: vec3<u32>) {
  let octet_count = frame.quad_count / 2u;
  let octet = invocation.x % octet_count;
  // Lanes beyond the last band work on the last and store nothing.
  let band = min(invocation.x / octet_count, BAND_COUNT - 1u);
  let node_index = group.y;
  // The same for the whole workgroup, and read before any branch: software then reads it once for all lanes.
  let node = nodes[node_index];
  let shares = textureLoad(scales, list_texel(BAND_COUNT * node_index + band));
  let is_open = node.blocking == 0u;
  let tap_layer = requests[node.request].tap_layer;
  let tap_weight = requests[node.request].tap_weight;
  let tap_count = select(0u, requests[node.request].tap_count, is_open);
  let blocked_tap_layer = requests[node.request].blocked_tap_layer;
  let blocked_tap_weight = requests[node.request].blocked_tap_weight;
  // The table may hold fewer functions: the others are 0.
  let is_blocked = !is_open && octet < frame.blocked_octet_count;
  let blocked_tap_count = select(0u, requests[node.request].blocked_tap_count, is_blocked);
  var sum = Octet(vec4<f32>(0.0), vec4<f32>(0.0));
  for (var lobe = 0u; lobe < LOBE_COUNT; lobe++) {
    // A loop that does not run costs software less than a branch, both sides of which it takes.
    let in_use = shares[lobe] > 0.0;
    let texel = shape_texel(
      lobe, band, node.ring, frame.ring_count, node.offset, octet, frame.table_octet_count,
    );
    for (var tap = 0u; tap < select(0u, tap_count, in_use); tap++) {
      sum = add_shape(sum, shares[lobe] * tap_weight[tap], textureLoad(shape, texel, tap_layer[tap]));
    }
    let blocked_texel = shape_texel(
      lobe, band, node.ring, frame.ring_count, node.offset, octet, frame.blocked_octet_count,
    );
    for (var tap = 0u; tap < select(0u, blocked_tap_count, in_use); tap++) {
      let layer = blocked_layer(blocked_tap_layer[tap], node.blocking - 1u);
      sum = add_shape(sum, shares[lobe] * blocked_tap_weight[tap], textureLoad(blocked_shape, blocked_texel, layer));
    }
  }
  if invocation.x < BAND_COUNT * octet_count {
    let low = 8u * octet + vec4<u32>(0u, 1u, 2u, 3u);
    let count = vec4<u32>(frame.basis_count);
    let texel = mixed_texel(node_index, band, 2u * octet, frame.quad_count);
    textureStore(mixed, texel, select(vec4<f32>(0.0), sum.low, low < count));
    textureStore(mixed, texel + vec2<u32>(1u, 0u), select(vec4<f32>(0.0), sum.high, low + 4u < count));
  }
}
