// S at eight elevations and one frequency an invocation, in all bands.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var spectra: texture_storage_2d<rgba32float, read>;
// Row: (function, four elevations); column: frequency.
@group(0) @binding(2) var basis: texture_storage_2d<rgba32float, read>;
// Row: (request, band, pair of elevations); column: frequency; texel: both spectra.
@group(0) @binding(3) var sums: texture_storage_2d<rgba32float, write>;

// Sums at eight elevations.
struct Sums {
  real_low: vec4<f32>,
  real_high: vec4<f32>,
  imaginary_low: vec4<f32>,
  imaginary_high: vec4<f32>,
}

// Basis of two functions, a and b, at eight elevations.
struct Rows {
  a_low: vec4<f32>,
  a_high: vec4<f32>,
  b_low: vec4<f32>,
  b_high: vec4<f32>,
}

fn add_pair(sums: Sums, rows: Rows, spectra: vec4<f32>) -> Sums {
  return Sums(
    sums.real_low + rows.a_low * spectra.x + rows.b_low * spectra.z,
    sums.real_high + rows.a_high * spectra.x + rows.b_high * spectra.z,
    sums.imaginary_low + rows.a_low * spectra.y + rows.b_low * spectra.w,
    sums.imaginary_high + rows.a_high * spectra.y + rows.b_high * spectra.w,
  );
}

fn store_pairs(first_pair: u32, f: u32, real: vec4<f32>, imaginary: vec4<f32>) {
  textureStore(sums, vec2<u32>(f, first_pair), vec4<f32>(real.x, imaginary.x, real.y, imaginary.y));
  textureStore(sums, vec2<u32>(f, first_pair + 1u), vec4<f32>(real.z, imaginary.z, real.w, imaginary.w));
}

fn store(request: u32, band: u32, octet: u32, f: u32, sum: Sums) {
  let pair = (request * BAND_COUNT + band) * ELEVATION_COUNT / 2u + 4u * octet;
  store_pairs(pair, f, sum.real_low, sum.imaginary_low);
  store_pairs(pair + 2u, f, sum.real_high, sum.imaginary_high);
}

@compute @workgroup_size(8, 1, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let f = invocation.x;
  let octet = invocation.y;
  let request = invocation.z;
  let pair_count = frame.quad_count * 2u;
  let first_row = request * BAND_COUNT * pair_count;
  let dark = vec4<f32>(0.0);
  // Written out: software keeps an array of them in memory.
  var sums_0 = Sums(dark, dark, dark, dark);
  var sums_1 = sums_0;
  var sums_2 = sums_0;
  var sums_3 = sums_0;
  // Lanes beyond the last frequency read 0 or what lies there, and store nothing.
  for (var pair = 0u; pair < pair_count; pair++) {
    let row = pair * 32u + 2u * octet;
    let rows = Rows(
      textureLoad(basis, vec2<u32>(f, row)),
      textureLoad(basis, vec2<u32>(f, row + 1u)),
      textureLoad(basis, vec2<u32>(f, row + 16u)),
      textureLoad(basis, vec2<u32>(f, row + 17u)),
    );
    sums_0 = add_pair(sums_0, rows, textureLoad(spectra, vec2<u32>(f, first_row + pair)));
    sums_1 = add_pair(sums_1, rows, textureLoad(spectra, vec2<u32>(f, first_row + pair_count + pair)));
    sums_2 = add_pair(sums_2, rows, textureLoad(spectra, vec2<u32>(f, first_row + 2u * pair_count + pair)));
    if BAND_COUNT > 3u {
      sums_3 = add_pair(sums_3, rows, textureLoad(spectra, vec2<u32>(f, first_row + 3u * pair_count + pair)));
    }
  }
  if f < FREQUENCY_COUNT {
    store(request, 0u, octet, f, sums_0);
    store(request, 1u, octet, f, sums_1);
    store(request, 2u, octet, f, sums_2);
    if BAND_COUNT > 3u {
      store(request, 3u, octet, f, sums_3);
    }
  }
}
