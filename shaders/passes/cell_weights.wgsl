// Weights of the two nodes of every lit cell: one texel (lower node, upper node, their weights) a band.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> requests: array<Request>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
@group(0) @binding(3) var<storage, read> cells: array<Cell>;
@group(0) @binding(4) var<storage, read> scales: array<vec4<f32>>;
@group(0) @binding(5) var weights: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let cell_index = invocation.x;
  let band = invocation.y;
  if cell_index >= frame.cell_count {
    return;
  }
  let cell = cells[cell_index];
  let request = nodes[cell.lower_node].request;
  let first = band * frame.node_count;
  let pair = cell_weights(
    cell.flux_dnb_w * requests[request].flux_per_dnb_flux[band],
    scales[first + cell.lower_node].w,
    scales[first + cell.upper_node].w,
    cell.upper_weight,
  );
  // Node numbers stay below 2^24, so that f32 holds them exactly.
  let texel = vec4<f32>(f32(cell.lower_node), f32(cell.upper_node), pair.x, pair.y);
  textureStore(weights, cell_texel(cell_index, band), texel);
}
