// Shape coefficients of every node in use: four functions an invocation.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> requests: array<Request>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
@group(0) @binding(3) var<storage, read> scales: array<vec4<f32>>;
// Layer: observer altitude; row: (lobe, band, ring); column: (offset, four functions).
@group(0) @binding(4) var shape: texture_2d_array<f32>;
// Row: node; column: (band, four functions).
@group(0) @binding(5) var mixed: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 4, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let quad = invocation.x;
  let node_index = invocation.y;
  let band = invocation.z;
  if quad >= frame.quad_count || node_index >= frame.node_count {
    return;
  }
  let node = nodes[node_index];
  let shares = scales[band * frame.node_count + node_index];
  var sum = vec4<f32>(0.0);
  if quad < frame.table_quad_count {
    for (var lobe = 0u; lobe < LOBE_COUNT; lobe++) {
      if shares[lobe] > 0.0 {
        let texel = shape_texel(
          lobe, band, node.ring, frame.ring_count, node.offset, quad, frame.table_quad_count);
        for (var tap = 0u; tap < requests[node.request].tap_count; tap++) {
          let layer = requests[node.request].tap_layer[tap];
          let factor = shares[lobe] * requests[node.request].tap_weight[tap];
          sum += factor * textureLoad(shape, texel, layer, 0);
        }
      }
    }
  }
  let function_index = 4u * quad + vec4<u32>(0u, 1u, 2u, 3u);
  let in_use = select(vec4<f32>(0.0), sum, function_index < vec4<u32>(frame.basis_count));
  textureStore(mixed, mixed_texel(node_index, band, quad, frame.quad_count), in_use);
}
