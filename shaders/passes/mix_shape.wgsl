// Shape coefficients of every node in use: eight functions an invocation.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> requests: array<Request>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
@group(0) @binding(3) var<storage, read> scales: array<vec4<f32>>;
// Layer: observer altitude; row: (lobe, band, ring); column: (offset, eight functions of 16 bits).
@group(0) @binding(4) var shape: texture_2d_array<u32>;
// The same with a layer for every (observer altitude, angle).
@group(0) @binding(5) var blocked_shape: texture_2d_array<u32>;
// Row: node; column: (band, four functions).
@group(0) @binding(6) var mixed: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 4, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let octet = invocation.x;
  let node_index = invocation.y;
  let band = invocation.z;
  if 2u * octet >= frame.quad_count || node_index >= frame.node_count {
    return;
  }
  let node = nodes[node_index];
  let shares = scales[band * frame.node_count + node_index];
  var first = vec4<f32>(0.0);
  var second = vec4<f32>(0.0);
  let is_open = node.blocking == 0u;
  var tap_layer = requests[node.request].tap_layer;
  var tap_weight = requests[node.request].tap_weight;
  var tap_count = requests[node.request].tap_count;
  var octet_count = frame.table_octet_count;
  if !is_open {
    tap_layer = requests[node.request].blocked_tap_layer;
    tap_weight = requests[node.request].blocked_tap_weight;
    // The table may hold fewer functions: the others are 0.
    tap_count = select(0u, requests[node.request].blocked_tap_count, octet < frame.blocked_octet_count);
    octet_count = frame.blocked_octet_count;
  }
  for (var lobe = 0u; lobe < LOBE_COUNT; lobe++) {
    if shares[lobe] > 0.0 {
      let texel = shape_texel(lobe, band, node.ring, frame.ring_count, node.offset, octet, octet_count);
      for (var tap = 0u; tap < tap_count; tap++) {
        let factor = shares[lobe] * tap_weight[tap];
        var halves: vec4<u32>;
        if is_open {
          halves = textureLoad(shape, texel, tap_layer[tap], 0);
        } else {
          halves = textureLoad(blocked_shape, texel, blocked_layer(tap_layer[tap], node.blocking - 1u), 0);
        }
        first += factor * vec4<f32>(unpack2x16float(halves.x), unpack2x16float(halves.y));
        second += factor * vec4<f32>(unpack2x16float(halves.z), unpack2x16float(halves.w));
      }
    }
  }
  let low = 8u * octet + vec4<u32>(0u, 1u, 2u, 3u);
  let count = vec4<u32>(frame.basis_count);
  let texel = mixed_texel(node_index, band, 2u * octet, frame.quad_count);
  textureStore(mixed, texel, select(vec4<f32>(0.0), first, low < count));
  textureStore(mixed, texel + vec2<u32>(1u, 0u), select(vec4<f32>(0.0), second, low + 4u < count));
}
