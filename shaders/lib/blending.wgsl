// Requires elementary. Derivations: server/engine/src/twin/blending.rs

const RADIANCE_FLOOR_W_M2_SR: f32 = 1e-13;

fn blend_radiance(radiance_w_m2_sr: vec4<f32>, weight: vec4<f32>) -> f32 {
  let floored = max(radiance_w_m2_sr, vec4<f32>(RADIANCE_FLOOR_W_M2_SR));
  let largest = max(max(floored.x, floored.y), max(floored.z, floored.w));
  let log_ratio = weight.x * natural_log(floored.x / largest)
    + weight.y * natural_log(floored.y / largest)
    + weight.z * natural_log(floored.z / largest)
    + weight.w * natural_log(floored.w / largest);
  let blended = largest * natural_exp(log_ratio);
  return select(blended, 0.0, blended <= 1.00001 * RADIANCE_FLOOR_W_M2_SR);
}
