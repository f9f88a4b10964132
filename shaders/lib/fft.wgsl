// Derivations: server/engine/src/twin/fft.rs

struct Legs {
  a: vec2<f32>,
  b: vec2<f32>,
  c: vec2<f32>,
  d: vec2<f32>,
}

fn complex_multiply(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
  return vec2<f32>(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

fn radix4_butterfly(x: Legs) -> Legs {
  let even_sum = x.a + x.c;
  let even_difference = x.a - x.c;
  let odd_sum = x.b + x.d;
  let odd_turned = vec2<f32>(x.b.y - x.d.y, x.d.x - x.b.x);
  return Legs(even_sum + odd_sum, even_difference + odd_turned, even_sum - odd_sum, even_difference - odd_turned);
}

fn twiddle_index(lane: u32, span: u32, leg: u32) -> u32 {
  return leg * (lane % span) * (64u / span);
}

fn stockham_target(lane: u32, span: u32, leg: u32) -> u32 {
  return (lane / span) * span * 4u + lane % span + leg * span;
}

fn split_pair_spectrum(z: vec2<f32>, z_mirrored: vec2<f32>) -> vec4<f32> {
  return 0.5 * vec4<f32>(z.x + z_mirrored.x, z.y - z_mirrored.y, z.y + z_mirrored.y, z_mirrored.x - z.x);
}

fn pair_from_spectra(spectra: vec4<f32>, mirrored: bool) -> vec2<f32> {
  let turn = select(1.0, -1.0, mirrored);
  return vec2<f32>(spectra.x - turn * spectra.w, -(turn * spectra.y + spectra.z));
}
