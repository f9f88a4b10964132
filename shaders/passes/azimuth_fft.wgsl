// Spectra of four functions at once: one workgroup for them.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> twiddles: array<vec4<f32>>;
// Row: (request, band, four functions); column: azimuth.
@group(0) @binding(2) var coefficients: texture_storage_2d<rgba32float, read>;
// Row: (request, band, pair); column: frequency; texel: both spectra.
@group(0) @binding(3) var spectra: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(16, 1, 1)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
  let lane = local.x;
  let row = (group.z * BAND_COUNT + group.y) * frame.quad_count + group.x;
  let x = Sixteen(
    Legs(textureLoad(coefficients, vec2<u32>(lane + 0u, row)), textureLoad(coefficients, vec2<u32>(lane + 64u, row)), textureLoad(coefficients, vec2<u32>(lane + 128u, row)), textureLoad(coefficients, vec2<u32>(lane + 192u, row))),
    Legs(textureLoad(coefficients, vec2<u32>(lane + 16u, row)), textureLoad(coefficients, vec2<u32>(lane + 80u, row)), textureLoad(coefficients, vec2<u32>(lane + 144u, row)), textureLoad(coefficients, vec2<u32>(lane + 208u, row))),
    Legs(textureLoad(coefficients, vec2<u32>(lane + 32u, row)), textureLoad(coefficients, vec2<u32>(lane + 96u, row)), textureLoad(coefficients, vec2<u32>(lane + 160u, row)), textureLoad(coefficients, vec2<u32>(lane + 224u, row))),
    Legs(textureLoad(coefficients, vec2<u32>(lane + 48u, row)), textureLoad(coefficients, vec2<u32>(lane + 112u, row)), textureLoad(coefficients, vec2<u32>(lane + 176u, row)), textureLoad(coefficients, vec2<u32>(lane + 240u, row))),
  );
  share_points(lane, transform_256(lane, x));
  for (var f = lane; f < FREQUENCY_COUNT; f += 16u) {
    let z = points[f];
    let mirrored = points[(AZIMUTH_COUNT - f) % AZIMUTH_COUNT];
    textureStore(spectra, vec2<u32>(f, 2u * row), split_pair_spectrum(z.xy, mirrored.xy));
    textureStore(spectra, vec2<u32>(f, 2u * row + 1u), split_pair_spectrum(z.zw, mirrored.zw));
  }
}
