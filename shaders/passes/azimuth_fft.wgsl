// Spectra of two functions at once: one workgroup a pair.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> twiddles: array<vec2<f32>>;
@group(0) @binding(2) var<storage, read> coefficients: array<vec2<f32>>;
// Row: (request, band, pair); column: frequency; texel: both spectra.
@group(0) @binding(3) var spectra: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
  let lane = local.x;
  let row = (group.z * BAND_COUNT + group.y) * frame.quad_count * 2u + group.x;
  for (var n = lane; n < AZIMUTH_COUNT; n += 64u) {
    points[n] = coefficients[row * AZIMUTH_COUNT + n];
  }
  transform_256(lane);
  for (var f = lane; f < FREQUENCY_COUNT; f += 64u) {
    let mirrored = (AZIMUTH_COUNT - f) % AZIMUTH_COUNT;
    textureStore(spectra, vec2<u32>(f, row), split_pair_spectrum(points[f], points[mirrored]));
  }
}
