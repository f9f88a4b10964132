// Lobe shares and the logarithm of the mixed scale of every node in use, in all bands.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> requests: array<Request, MAX_BATCH>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
// [observer altitude][lobe][band][ring][offset]
@group(0) @binding(3) var<storage, read> log_scale: array<f32>;
// [observer altitude][angle][lobe][band][ring][offset]
@group(0) @binding(4) var<storage, read> blocked_log_scale: array<f32>;
// The list of (node, band): shares and logarithm.
@group(0) @binding(5) var scales: texture_storage_2d<rgba32float, write>;
// The logarithms alone, in R, G, B.
@group(0) @binding(6) var log_scales: texture_storage_2d<rgba32float, write>;

fn open_lobes(node: Node, band: u32) -> vec3<f32> {
  let per_band = frame.ring_count * frame.offset_count;
  let per_lobe = BAND_COUNT * per_band;
  let in_layer = band * per_band + node.ring * frame.offset_count + node.offset;
  let tap_count = select(0u, requests[node.request].tap_count, node.blocking == 0u);
  var lobes = vec3<f32>(0.0);
  for (var tap = 0u; tap < tap_count; tap++) {
    let first = requests[node.request].tap_layer[tap] * LOBE_COUNT * per_lobe + in_layer;
    lobes += requests[node.request].tap_weight[tap]
      * vec3<f32>(log_scale[first], log_scale[first + per_lobe], log_scale[first + 2u * per_lobe]);
  }
  return lobes;
}

fn blocked_lobes(node: Node, band: u32) -> vec3<f32> {
  let per_band = frame.ring_count * frame.blocked_offset_count;
  let per_lobe = BAND_COUNT * per_band;
  let in_layer = band * per_band + node.ring * frame.blocked_offset_count + node.offset;
  let tap_count = select(requests[node.request].blocked_tap_count, 0u, node.blocking == 0u);
  var lobes = vec3<f32>(0.0);
  for (var tap = 0u; tap < tap_count; tap++) {
    let layer = blocked_layer(requests[node.request].blocked_tap_layer[tap], node.blocking - 1u);
    let first = layer * LOBE_COUNT * per_lobe + in_layer;
    lobes += requests[node.request].blocked_tap_weight[tap] * vec3<f32>(
      blocked_log_scale[first],
      blocked_log_scale[first + per_lobe],
      blocked_log_scale[first + 2u * per_lobe],
    );
  }
  return lobes;
}

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let node_index = invocation.x;
  if node_index >= frame.node_count {
    return;
  }
  let node = nodes[node_index];
  var log_sums = vec4<f32>(0.0);
  for (var band = 0u; band < BAND_COUNT; band++) {
    // One of the two is 0: a loop that does not run costs software less than a branch, both sides of which it takes.
    let shares = lobe_shares(requests[node.request].emission, open_lobes(node, band) + blocked_lobes(node, band));
    textureStore(scales, list_texel(BAND_COUNT * node_index + band), shares);
    log_sums[band] = shares.w;
  }
  textureStore(log_scales, list_texel(node_index), log_sums);
}
