// Derivations: server/render/src/twin/elementary.rs

const LOG2_E: f32 = 1.442695040888963;
const LN_2_HIGH: f32 = 0.693359375;
const LN_2_LOW: f32 = -0.000212194440054690583;
const SQRT_2: f32 = 1.4142135623730951;

fn natural_exp(x_any: f32) -> f32 {
  let x = clamp(x_any, -87.0, 88.0);
  let n = round(x * LOG2_E);
  let r = x - n * LN_2_HIGH - n * LN_2_LOW;
  var sum = 1.0 / 720.0 + r * (1.0 / 5040.0);
  sum = 1.0 / 120.0 + r * sum;
  sum = 1.0 / 24.0 + r * sum;
  sum = 1.0 / 6.0 + r * sum;
  sum = 0.5 + r * sum;
  sum = 1.0 + r * sum;
  sum = 1.0 + r * sum;
  return sum * bitcast<f32>(u32(i32(n) + 127) << 23u);
}

fn natural_log(x: f32) -> f32 {
  let bits = bitcast<u32>(x);
  let fraction = bitcast<f32>((bits & 0x007fffffu) | 0x3f800000u);
  let high = fraction > SQRT_2;
  let m = select(fraction, 0.5 * fraction, high);
  let exponent = f32(i32(bits >> 23u) - 127 + select(0, 1, high));
  let s = (m - 1.0) / (m + 1.0);
  let z = s * s;
  var sum = 1.0 / 9.0 + z * (1.0 / 11.0);
  sum = 1.0 / 7.0 + z * sum;
  sum = 1.0 / 5.0 + z * sum;
  sum = 1.0 / 3.0 + z * sum;
  sum = 1.0 + z * sum;
  return exponent * LN_2_HIGH + (exponent * LN_2_LOW + 2.0 * s * sum);
}
