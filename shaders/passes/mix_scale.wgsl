// Lobe shares and the logarithm of the mixed scale of every node in use.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> requests: array<Request>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
// [observer altitude][lobe][band][ring][offset]
@group(0) @binding(3) var<storage, read> log_scale: array<f32>;
// [observer altitude][angle][lobe][band][ring][offset]
@group(0) @binding(4) var<storage, read> blocked_log_scale: array<f32>;
// [band][node]
@group(0) @binding(5) var<storage, read_write> scales: array<vec4<f32>>;

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let node_index = invocation.x;
  let band = invocation.y;
  if node_index >= frame.node_count {
    return;
  }
  let node = nodes[node_index];
  var mixed = vec3<f32>(0.0);
  if node.blocking == 0u {
    let per_band = frame.ring_count * frame.offset_count;
    let per_lobe = BAND_COUNT * per_band;
    let in_layer = band * per_band + node.ring * frame.offset_count + node.offset;
    for (var tap = 0u; tap < requests[node.request].tap_count; tap++) {
      let first = requests[node.request].tap_layer[tap] * LOBE_COUNT * per_lobe + in_layer;
      let weight = requests[node.request].tap_weight[tap];
      mixed += weight
        * vec3<f32>(log_scale[first], log_scale[first + per_lobe], log_scale[first + 2u * per_lobe]);
    }
  } else {
    let per_band = frame.ring_count * frame.blocked_offset_count;
    let per_lobe = BAND_COUNT * per_band;
    let in_layer = band * per_band + node.ring * frame.blocked_offset_count + node.offset;
    for (var tap = 0u; tap < requests[node.request].blocked_tap_count; tap++) {
      let layer = blocked_layer(requests[node.request].blocked_tap_layer[tap], node.blocking - 1u);
      let first = layer * LOBE_COUNT * per_lobe + in_layer;
      let weight = requests[node.request].blocked_tap_weight[tap];
      mixed += weight * vec3<f32>(
        blocked_log_scale[first],
        blocked_log_scale[first + per_lobe],
        blocked_log_scale[first + 2u * per_lobe],
      );
    }
  }
  scales[band * frame.node_count + node_index] = lobe_shares(requests[node.request].emission, mixed);
}
