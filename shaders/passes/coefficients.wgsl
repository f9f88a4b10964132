// H of every column: four functions an invocation, one column a workgroup.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> columns: array<Column>;
@group(0) @binding(2) var weights: texture_storage_2d<rgba32float, read>;
@group(0) @binding(3) var mixed: texture_storage_2d<rgba32float, read>;
// Row: (request, band, four functions); column: azimuth.
@group(0) @binding(4) var coefficients: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 1, 1)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(global_invocation_id) invocation: vec3<u32>) {
  let quad = invocation.x;
  let band = group.z;
  // The same for the whole workgroup, and read before any branch: software then reads it once for all lanes.
  let column = columns[group.y];
  var sum = vec4<f32>(0.0);
  for (var cell = column.first_cell; cell < column.end_cell; cell++) {
    let weight = textureLoad(weights, cell_texel(cell, band));
    let lower = mixed_texel(u32(weight.x), band, quad, frame.quad_count);
    let upper = mixed_texel(u32(weight.y), band, quad, frame.quad_count);
    sum += weight.z * textureLoad(mixed, lower) + weight.w * textureLoad(mixed, upper);
  }
  if quad < frame.quad_count {
    let row = (column.request * BAND_COUNT + band) * frame.quad_count + quad;
    textureStore(coefficients, vec2<u32>(column.azimuth, row), sum);
  }
}
