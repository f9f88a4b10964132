// Radiance of two elevations at once: one workgroup a pair.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> twiddles: array<vec2<f32>>;
@group(0) @binding(2) var<storage, read> sums: array<vec4<f32>>;
// [pack slot][request][band][elevation][azimuth]
@group(0) @binding(3) var<storage, read_write> radiance: array<f32>;

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
  let lane = local.x;
  let pair = (group.z * BAND_COUNT + group.y) * ELEVATION_COUNT / 2u + group.x;
  for (var f = lane; f < AZIMUTH_COUNT; f += 64u) {
    let mirrored = f >= FREQUENCY_COUNT;
    let source = select(f, AZIMUTH_COUNT - f, mirrored);
    points[f] = pair_from_spectra(sums[pair * FREQUENCY_COUNT + source], mirrored);
  }
  transform_256(lane);
  let slot = frame.pack_slot * frame.request_count * BAND_COUNT * ELEVATION_COUNT;
  let target_row = (slot + 2u * pair) * AZIMUTH_COUNT;
  for (var n = lane; n < AZIMUTH_COUNT; n += 64u) {
    let value = points[n] * (1.0 / 256.0);
    radiance[target_row + n] = max(value.x, 0.0);
    radiance[target_row + AZIMUTH_COUNT + n] = max(-value.y, 0.0);
  }
}
