// Requires fft, and a pass that binds `twiddles`: array<vec2<f32>> of e^{-2 pi i n/256}.

var<workgroup> points: array<vec2<f32>, 256>;

// Transforms `points` in place with 64 invocations, of which this is `lane`. Every invocation must have stored
// its points; on return all of them may be read.
fn transform_256(lane: u32) {
  for (var span = 1u; span < 256u; span *= 4u) {
    workgroupBarrier();
    let legs = radix4_butterfly(Legs(
      points[lane],
      complex_multiply(points[lane + 64u], twiddles[twiddle_index(lane, span, 1u)]),
      complex_multiply(points[lane + 128u], twiddles[twiddle_index(lane, span, 2u)]),
      complex_multiply(points[lane + 192u], twiddles[twiddle_index(lane, span, 3u)]),
    ));
    workgroupBarrier();
    points[stockham_target(lane, span, 0u)] = legs.a;
    points[stockham_target(lane, span, 1u)] = legs.b;
    points[stockham_target(lane, span, 2u)] = legs.c;
    points[stockham_target(lane, span, 3u)] = legs.d;
  }
  workgroupBarrier();
}
