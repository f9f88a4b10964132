// S at four elevations and one frequency an invocation, in all bands.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var spectra: texture_2d<f32>;
// Row: (function, four elevations); column: frequency.
@group(0) @binding(2) var basis: texture_2d<f32>;
// [request][band][pair of elevations][frequency] of both spectra.
@group(0) @binding(3) var<storage, read_write> sums: array<vec4<f32>>;

fn store(request: u32, band: u32, rows: u32, f: u32, real: vec4<f32>, imaginary: vec4<f32>) {
  let pair = (request * BAND_COUNT + band) * ELEVATION_COUNT / 2u + 2u * rows;
  sums[pair * FREQUENCY_COUNT + f] = vec4<f32>(real.x, imaginary.x, real.y, imaginary.y);
  sums[(pair + 1u) * FREQUENCY_COUNT + f] = vec4<f32>(real.z, imaginary.z, real.w, imaginary.w);
}

@compute @workgroup_size(8, 4, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let f = invocation.x;
  let rows = invocation.y;
  let request = invocation.z;
  if f >= FREQUENCY_COUNT {
    return;
  }
  let pair_count = frame.quad_count * 2u;
  let first_row = request * BAND_COUNT * pair_count;
  var real_r = vec4<f32>(0.0);
  var real_g = vec4<f32>(0.0);
  var real_b = vec4<f32>(0.0);
  var imaginary_r = vec4<f32>(0.0);
  var imaginary_g = vec4<f32>(0.0);
  var imaginary_b = vec4<f32>(0.0);
  for (var pair = 0u; pair < pair_count; pair++) {
    let low = textureLoad(basis, vec2<u32>(f, pair * 32u + rows), 0);
    let high = textureLoad(basis, vec2<u32>(f, pair * 32u + 16u + rows), 0);
    let r = textureLoad(spectra, vec2<u32>(f, first_row + pair), 0);
    let g = textureLoad(spectra, vec2<u32>(f, first_row + pair_count + pair), 0);
    let b = textureLoad(spectra, vec2<u32>(f, first_row + 2u * pair_count + pair), 0);
    real_r += low * r.x + high * r.z;
    imaginary_r += low * r.y + high * r.w;
    real_g += low * g.x + high * g.z;
    imaginary_g += low * g.y + high * g.w;
    real_b += low * b.x + high * b.z;
    imaginary_b += low * b.y + high * b.w;
  }
  store(request, 0u, rows, f, real_r, imaginary_r);
  store(request, 1u, rows, f, real_g, imaginary_g);
  store(request, 2u, rows, f, real_b, imaginary_b);
}
