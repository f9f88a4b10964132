// Lobe shares and the logarithm of the mixed scale of every node in use.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> requests: array<Request>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
// [observer altitude][lobe][band][ring][offset]
@group(0) @binding(3) var<storage, read> log_scale: array<f32>;
// [band][node]
@group(0) @binding(4) var<storage, read_write> scales: array<vec4<f32>>;

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let node_index = invocation.x;
  let band = invocation.y;
  if node_index >= frame.node_count {
    return;
  }
  let node = nodes[node_index];
  let per_band = frame.ring_count * frame.offset_count;
  let per_lobe = BAND_COUNT * per_band;
  let in_layer = band * per_band + node.ring * frame.offset_count + node.offset;
  var mixed = vec3<f32>(0.0);
  for (var tap = 0u; tap < requests[node.request].tap_count; tap++) {
    let first = requests[node.request].tap_layer[tap] * LOBE_COUNT * per_lobe + in_layer;
    let weight = requests[node.request].tap_weight[tap];
    mixed += weight
      * vec3<f32>(log_scale[first], log_scale[first + per_lobe], log_scale[first + 2u * per_lobe]);
  }
  scales[band * frame.node_count + node_index] = lobe_shares(requests[node.request].emission, mixed);
}
