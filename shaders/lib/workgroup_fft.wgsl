// Derivations: server/render/src/twin/workgroup_fft.rs. Requires fft, and a pass that binds `twiddles`: array<vec4<f32>>, at [n][m/2] e^{-2 pi i n m/256} for the two m.

var<workgroup> points: array<vec4<f32>, 256>;

// Transforms 256 points with 16 invocations, of which this is `lane`: it gives points lane + 16 m and gets
// frequencies lane + 16 m, in the order of Sixteen. Two transforms of 16 points with one exchange between them: in
// software every access to workgroup memory is a loop over the lanes. What others stored before must be read already.
fn transform_256(lane: u32, given: Sixteen) -> Sixteen {
  let x = transform_16(given);
  let turn_0 = twiddles[lane * 8u];
  let turn_2 = twiddles[lane * 8u + 1u];
  let turn_4 = twiddles[lane * 8u + 2u];
  let turn_6 = twiddles[lane * 8u + 3u];
  let turn_8 = twiddles[lane * 8u + 4u];
  let turn_10 = twiddles[lane * 8u + 5u];
  let turn_12 = twiddles[lane * 8u + 6u];
  let turn_14 = twiddles[lane * 8u + 7u];
  points[lane] = x.a.a;
  points[16u + lane] = complex_multiply(x.b.a, turn_0.zw);
  points[32u + lane] = complex_multiply(x.c.a, turn_2.xy);
  points[48u + lane] = complex_multiply(x.d.a, turn_2.zw);
  points[64u + lane] = complex_multiply(x.a.b, turn_4.xy);
  points[80u + lane] = complex_multiply(x.b.b, turn_4.zw);
  points[96u + lane] = complex_multiply(x.c.b, turn_6.xy);
  points[112u + lane] = complex_multiply(x.d.b, turn_6.zw);
  points[128u + lane] = complex_multiply(x.a.c, turn_8.xy);
  points[144u + lane] = complex_multiply(x.b.c, turn_8.zw);
  points[160u + lane] = complex_multiply(x.c.c, turn_10.xy);
  points[176u + lane] = complex_multiply(x.d.c, turn_10.zw);
  points[192u + lane] = complex_multiply(x.a.d, turn_12.xy);
  points[208u + lane] = complex_multiply(x.b.d, turn_12.zw);
  points[224u + lane] = complex_multiply(x.c.d, turn_14.xy);
  points[240u + lane] = complex_multiply(x.d.d, turn_14.zw);
  workgroupBarrier();
  return transform_16(Sixteen(
    Legs(points[16u * lane], points[16u * lane + 4u], points[16u * lane + 8u], points[16u * lane + 12u]),
    Legs(points[16u * lane + 1u], points[16u * lane + 5u], points[16u * lane + 9u], points[16u * lane + 13u]),
    Legs(points[16u * lane + 2u], points[16u * lane + 6u], points[16u * lane + 10u], points[16u * lane + 14u]),
    Legs(points[16u * lane + 3u], points[16u * lane + 7u], points[16u * lane + 11u], points[16u * lane + 15u]),
  ));
}

// Puts all frequencies into `points`, each at its own place, where all invocations can read them.
fn share_points(lane: u32, y: Sixteen) {
  workgroupBarrier();
  points[lane] = y.a.a;
  points[16u + lane] = y.b.a;
  points[32u + lane] = y.c.a;
  points[48u + lane] = y.d.a;
  points[64u + lane] = y.a.b;
  points[80u + lane] = y.b.b;
  points[96u + lane] = y.c.b;
  points[112u + lane] = y.d.b;
  points[128u + lane] = y.a.c;
  points[144u + lane] = y.b.c;
  points[160u + lane] = y.c.c;
  points[176u + lane] = y.d.c;
  points[192u + lane] = y.a.d;
  points[208u + lane] = y.b.d;
  points[224u + lane] = y.c.d;
  points[240u + lane] = y.d.d;
  workgroupBarrier();
}
