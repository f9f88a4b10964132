// H of every lit column: eight functions an invocation, one column a row of eight lanes.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> columns: array<Column>;
@group(0) @binding(2) var weights: texture_2d<f32>;
@group(0) @binding(3) var mixed: texture_2d<f32>;
// [request][band][pair of functions][azimuth]; dark columns were cleared.
@group(0) @binding(4) var<storage, read_write> coefficients: array<vec2<f32>>;

@compute @workgroup_size(8, 4, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let quad = invocation.x * 2u;
  let column_index = invocation.y;
  let band = invocation.z;
  if quad >= frame.quad_count || column_index >= frame.column_count {
    return;
  }
  let column = columns[column_index];
  var first = vec4<f32>(0.0);
  var second = vec4<f32>(0.0);
  for (var cell = column.first_cell; cell < column.end_cell; cell++) {
    let weight = textureLoad(weights, cell_texel(cell, band), 0);
    let lower = mixed_texel(u32(weight.x), band, quad, frame.quad_count);
    let upper = mixed_texel(u32(weight.y), band, quad, frame.quad_count);
    first += weight.z * textureLoad(mixed, lower, 0) + weight.w * textureLoad(mixed, upper, 0);
    second += weight.z * textureLoad(mixed, lower + vec2<u32>(1u, 0u), 0)
      + weight.w * textureLoad(mixed, upper + vec2<u32>(1u, 0u), 0);
  }
  let pair = (column.request * BAND_COUNT + band) * frame.quad_count * 2u + quad * 2u;
  coefficients[pair * AZIMUTH_COUNT + column.azimuth] = first.xy;
  coefficients[(pair + 1u) * AZIMUTH_COUNT + column.azimuth] = first.zw;
  coefficients[(pair + 2u) * AZIMUTH_COUNT + column.azimuth] = second.xy;
  coefficients[(pair + 3u) * AZIMUTH_COUNT + column.azimuth] = second.zw;
}
