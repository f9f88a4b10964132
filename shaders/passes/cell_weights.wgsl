// Weights of the two nodes of every lit cell: one texel (lower node, upper node, their weights) a band.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> requests: array<Request, MAX_BATCH>;
// Flux in DNB watts, lower node, weight of the upper node, request.
@group(0) @binding(2) var cells: texture_storage_2d<rgba32float, read>;
// Two texels a node: ln of its scale and the curvature of that, a channel a band.
@group(0) @binding(3) var log_scales: texture_storage_2d<rgba32float, read>;
@group(0) @binding(4) var weights: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let cell_index = invocation.x;
  // Beyond the last cell lies whatever another batch left; nothing of it is stored.
  let cell = textureLoad(cells, list_texel(cell_index));
  let lower_node = u32(cell.y);
  let upper_weight = cell.z;
  // Nodes in use are numbered through: the one above is the next.
  let upper_node = lower_node + select(0u, 1u, upper_weight > 0.0);
  let lower = textureLoad(log_scales, list_texel(2u * lower_node));
  let upper = textureLoad(log_scales, list_texel(2u * upper_node));
  let lower_curvature = textureLoad(log_scales, list_texel(2u * lower_node + 1u));
  let upper_curvature = textureLoad(log_scales, list_texel(2u * upper_node + 1u));
  let flux_w = cell.x * requests[u32(cell.w)].flux_per_dnb_flux;
  // Node numbers stay below 2^24, so that f32 holds them exactly.
  let nodes = vec2<f32>(f32(lower_node), f32(upper_node));
  let weights_0 = cell_weights(flux_w.x, vec2<f32>(lower.x, upper.x), vec2<f32>(lower_curvature.x, upper_curvature.x), upper_weight);
  let weights_1 = cell_weights(flux_w.y, vec2<f32>(lower.y, upper.y), vec2<f32>(lower_curvature.y, upper_curvature.y), upper_weight);
  let weights_2 = cell_weights(flux_w.z, vec2<f32>(lower.z, upper.z), vec2<f32>(lower_curvature.z, upper_curvature.z), upper_weight);
  let weights_3 = cell_weights(flux_w.w, vec2<f32>(lower.w, upper.w), vec2<f32>(lower_curvature.w, upper_curvature.w), upper_weight);
  if cell_index < frame.cell_count {
    textureStore(weights, cell_texel(cell_index, 0u), vec4<f32>(nodes, weights_0));
    textureStore(weights, cell_texel(cell_index, 1u), vec4<f32>(nodes, weights_1));
    textureStore(weights, cell_texel(cell_index, 2u), vec4<f32>(nodes, weights_2));
    if BAND_COUNT > 3u {
      textureStore(weights, cell_texel(cell_index, 3u), vec4<f32>(nodes, weights_3));
    }
  }
}
