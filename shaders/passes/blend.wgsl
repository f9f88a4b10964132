// Interpolation between packs, sample by sample.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> requests: array<Request, MAX_BATCH>;
@group(0) @binding(2) var<storage, read> radiance: array<f32>;
// [request][band][elevation][azimuth]
@group(0) @binding(3) var<storage, read_write> blended: array<f32>;

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {
  let sample_count = BAND_COUNT * ELEVATION_COUNT * AZIMUTH_COUNT;
  let sample = invocation.x;
  let request = invocation.y;
  if sample >= sample_count {
    return;
  }
  let per_pack = frame.request_count * sample_count;
  let first = request * sample_count + sample;
  // A pack that is not there has no weight; any other's sample stands in for it.
  let last = frame.pack_count - 1u;
  let samples = vec4<f32>(
    radiance[first],
    radiance[first + min(1u, last) * per_pack],
    radiance[first + min(2u, last) * per_pack],
    radiance[first + min(3u, last) * per_pack],
  );
  blended[first] = blend_radiance(samples, requests[request].blend_weight, requests[request].linear_weight);
}
