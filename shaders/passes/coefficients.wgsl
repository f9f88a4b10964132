// H of every column: sixteen functions in one band an invocation.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> columns: array<Column>;
@group(0) @binding(2) var weights: texture_storage_2d<rgba32float, read>;
@group(0) @binding(3) var mixed: texture_storage_2d<rgba32float, read>;
// Row: (request, band, four functions); column: azimuth.
@group(0) @binding(4) var coefficients: texture_storage_2d<rgba32float, write>;

// Four functions from `first` on, of both nodes of a cell.
fn weighed(weight: vec2<f32>, lower: vec2<u32>, upper: vec2<u32>, first: u32) -> vec4<f32> {
  let right = vec2<u32>(first, 0u);
  return weight.x * textureLoad(mixed, lower + right) + weight.y * textureLoad(mixed, upper + right);
}

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let lane_count = (frame.quad_count + 3u) / 4u;
  let column = columns[invocation.x / lane_count];
  let quad = invocation.x % lane_count * 4u;
  let band = invocation.y;
  var first = vec4<f32>(0.0);
  var second = vec4<f32>(0.0);
  var third = vec4<f32>(0.0);
  var fourth = vec4<f32>(0.0);
  for (var cell = column.first_cell; cell < column.end_cell; cell++) {
    let weight = textureLoad(weights, cell_texel(cell, band));
    let lower = mixed_texel(u32(weight.x), band, quad, frame.quad_count);
    let upper = mixed_texel(u32(weight.y), band, quad, frame.quad_count);
    // Functions beyond the last are what lies there, and are not stored.
    first += weighed(weight.zw, lower, upper, 0u);
    second += weighed(weight.zw, lower, upper, 1u);
    third += weighed(weight.zw, lower, upper, 2u);
    fourth += weighed(weight.zw, lower, upper, 3u);
  }
  let texel = vec2<u32>(column.azimuth, (column.request * BAND_COUNT + band) * frame.quad_count + quad);
  let left = frame.quad_count - quad;
  textureStore(coefficients, texel, first);
  if left > 1u {
    textureStore(coefficients, texel + vec2<u32>(0u, 1u), second);
  }
  if left > 2u {
    textureStore(coefficients, texel + vec2<u32>(0u, 2u), third);
  }
  if left > 3u {
    textureStore(coefficients, texel + vec2<u32>(0u, 3u), fourth);
  }
}
