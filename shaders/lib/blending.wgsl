// Requires elementary. Derivations: server/engine/src/twin/blending.rs

const RADIANCE_FLOOR_W_M2_SR: f32 = 1e-13;

fn blend_radiance(radiance_w_m2_sr: vec4<f32>, weight: vec4<f32>) -> f32 {
  let log_floor = natural_log(RADIANCE_FLOOR_W_M2_SR);
  let floored = max(radiance_w_m2_sr, vec4<f32>(RADIANCE_FLOOR_W_M2_SR));
  let above = vec4<f32>(
    natural_log(floored.x) - log_floor,
    natural_log(floored.y) - log_floor,
    natural_log(floored.z) - log_floor,
    natural_log(floored.w) - log_floor,
  );
  let log_ratio = weight.x * above.x + weight.y * above.y + weight.z * above.z + weight.w * above.w;
  return select(natural_exp(log_floor + log_ratio), 0.0, log_ratio <= 0.0);
}
