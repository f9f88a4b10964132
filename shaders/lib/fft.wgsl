// Derivations: server/render/src/twin/fft.rs. Every vec4 is two complex numbers side by side, of two transforms.

// cos(pi/8), sin(pi/8), sqrt(1/2)
const COSINE_EIGHTH: f32 = 0.9238795325112867;
const SINE_EIGHTH: f32 = 0.3826834323650898;
const ROOT_HALF: f32 = 0.7071067811865476;

struct Legs {
  a: vec4<f32>,
  b: vec4<f32>,
  c: vec4<f32>,
  d: vec4<f32>,
}

// Point j + 4m is member m of row j.
struct Sixteen {
  a: Legs,
  b: Legs,
  c: Legs,
  d: Legs,
}

fn complex_multiply(a: vec4<f32>, b: vec2<f32>) -> vec4<f32> {
  return a * b.x + vec4<f32>(-a.y, a.x, -a.w, a.z) * b.y;
}

fn radix4_butterfly(x: Legs) -> Legs {
  let even_sum = x.a + x.c;
  let even_difference = x.a - x.c;
  let odd_sum = x.b + x.d;
  let odd = x.b - x.d;
  let odd_turned = vec4<f32>(odd.y, -odd.x, odd.w, -odd.z);
  return Legs(even_sum + odd_sum, even_difference + odd_turned, even_sum - odd_sum, even_difference - odd_turned);
}

fn transform_16(x: Sixteen) -> Sixteen {
  let a = radix4_butterfly(x.a);
  let b = radix4_butterfly(x.b);
  let c = radix4_butterfly(x.c);
  let d = radix4_butterfly(x.d);
  let one = vec2<f32>(COSINE_EIGHTH, -SINE_EIGHTH);
  let two = vec2<f32>(ROOT_HALF, -ROOT_HALF);
  let three = vec2<f32>(SINE_EIGHTH, -COSINE_EIGHTH);
  let four = vec2<f32>(0.0, -1.0);
  let six = vec2<f32>(-ROOT_HALF, -ROOT_HALF);
  let nine = vec2<f32>(-COSINE_EIGHTH, SINE_EIGHTH);
  return Sixteen(
    radix4_butterfly(Legs(a.a, b.a, c.a, d.a)),
    radix4_butterfly(Legs(a.b, complex_multiply(b.b, one), complex_multiply(c.b, two), complex_multiply(d.b, three))),
    radix4_butterfly(Legs(a.c, complex_multiply(b.c, two), complex_multiply(c.c, four), complex_multiply(d.c, six))),
    radix4_butterfly(Legs(a.d, complex_multiply(b.d, three), complex_multiply(c.d, six), complex_multiply(d.d, nine))),
  );
}

fn split_pair_spectrum(z: vec2<f32>, z_mirrored: vec2<f32>) -> vec4<f32> {
  return 0.5 * vec4<f32>(z.x + z_mirrored.x, z.y - z_mirrored.y, z.y + z_mirrored.y, z_mirrored.x - z.x);
}

fn pair_from_spectra(spectra: vec4<f32>, mirrored: bool) -> vec2<f32> {
  let turn = select(1.0, -1.0, mirrored);
  return vec2<f32>(spectra.x - turn * spectra.w, -(turn * spectra.y + spectra.z));
}
