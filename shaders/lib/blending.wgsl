// Requires elementary. Derivations: server/render/src/twin/blending.rs

const RADIANCE_FLOOR_W_M2_SR: f32 = 1e-13;
const MAX_DEVIATION: f32 = 0.1;
const MAX_DEVIATION_SHARE: f32 = 0.06;
const MIN_PACK_RATIO: f32 = 1e-3;

fn blend_radiance(radiance_w_m2_sr: vec4<f32>, weight: vec4<f32>, linear: vec4<f32>) -> f32 {
  let floored = max(radiance_w_m2_sr, vec4<f32>(RADIANCE_FLOOR_W_M2_SR));
  let largest = max(max(floored.x, floored.y), max(floored.z, floored.w));
  // The two packs around.
  let is_around = linear > vec4<f32>(0.0);
  let around = select(vec4<f32>(0.0), floored, is_around);
  let least = MIN_PACK_RATIO * max(max(around.x, around.y), max(around.z, around.w));
  let log_ratios = vec4<f32>(
    natural_log(max(floored.x, least) / largest),
    natural_log(max(floored.y, least) / largest),
    natural_log(max(floored.z, least) / largest),
    natural_log(max(floored.w, least) / largest),
  );
  // Logarithms are not above 0.
  let lows = select(vec4<f32>(0.0), log_ratios, is_around);
  let highs = select(vec4<f32>(-1e30), log_ratios, is_around);
  let low = min(min(lows.x, lows.y), min(lows.z, lows.w));
  let high = max(max(highs.x, highs.y), max(highs.z, highs.w));
  let max_deviation = MAX_DEVIATION + MAX_DEVIATION_SHARE * (high - low);
  let line = dot(linear, log_ratios);
  let log_ratio = line + min(max(dot(weight, log_ratios) - line, -max_deviation), max_deviation);
  let blended = largest * natural_exp(log_ratio);
  return select(blended, 0.0, blended <= 1.00001 * RADIANCE_FLOOR_W_M2_SR);
}
