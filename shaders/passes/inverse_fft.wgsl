// Radiance of four elevations at once: one workgroup for them.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> twiddles: array<vec4<f32>>;
@group(0) @binding(2) var sums: texture_storage_2d<rgba32float, read>;
// [pack slot][request][band][elevation][azimuth]
@group(0) @binding(3) var<storage, read_write> radiance: array<f32>;

fn point(f: u32, pair: u32) -> vec4<f32> {
  let mirrored = f >= FREQUENCY_COUNT;
  let source = select(f, AZIMUTH_COUNT - f, mirrored);
  return vec4<f32>(
    pair_from_spectra(textureLoad(sums, vec2<u32>(source, pair)), mirrored),
    pair_from_spectra(textureLoad(sums, vec2<u32>(source, pair + 1u)), mirrored),
  );
}

fn store(target_row: u32, azimuth: u32, both: vec4<f32>) {
  let values = max(vec4<f32>(both.x, -both.y, both.z, -both.w) * (1.0 / 256.0), vec4<f32>(0.0));
  let first = target_row * AZIMUTH_COUNT + azimuth;
  radiance[first] = values.x;
  radiance[first + AZIMUTH_COUNT] = values.y;
  radiance[first + 2u * AZIMUTH_COUNT] = values.z;
  radiance[first + 3u * AZIMUTH_COUNT] = values.w;
}

@compute @workgroup_size(16, 1, 1)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
  let lane = local.x;
  let pair = (group.z * BAND_COUNT + group.y) * ELEVATION_COUNT / 2u + 2u * group.x;
  let x = Sixteen(
    Legs(point(lane + 0u, pair), point(lane + 64u, pair), point(lane + 128u, pair), point(lane + 192u, pair)),
    Legs(point(lane + 16u, pair), point(lane + 80u, pair), point(lane + 144u, pair), point(lane + 208u, pair)),
    Legs(point(lane + 32u, pair), point(lane + 96u, pair), point(lane + 160u, pair), point(lane + 224u, pair)),
    Legs(point(lane + 48u, pair), point(lane + 112u, pair), point(lane + 176u, pair), point(lane + 240u, pair)),
  );
  let y = transform_256(lane, x);
  let slot = frame.pack_slot * frame.request_count * BAND_COUNT * ELEVATION_COUNT;
  let target_row = slot + 2u * pair;
  store(target_row, lane + 0u, y.a.a);
  store(target_row, lane + 16u, y.b.a);
  store(target_row, lane + 32u, y.c.a);
  store(target_row, lane + 48u, y.d.a);
  store(target_row, lane + 64u, y.a.b);
  store(target_row, lane + 80u, y.b.b);
  store(target_row, lane + 96u, y.c.b);
  store(target_row, lane + 112u, y.d.b);
  store(target_row, lane + 128u, y.a.c);
  store(target_row, lane + 144u, y.b.c);
  store(target_row, lane + 160u, y.c.c);
  store(target_row, lane + 176u, y.d.c);
  store(target_row, lane + 192u, y.a.d);
  store(target_row, lane + 208u, y.b.d);
  store(target_row, lane + 224u, y.c.d);
  store(target_row, lane + 240u, y.d.d);
}
