// Requires elementary. Derivations: server/engine/src/twin/mixing.rs

fn lobe_shares(emission: vec3<f32>, log_scale: vec3<f32>) -> vec4<f32> {
  let in_use = emission > vec3<f32>(0.0);
  let counted = select(vec3<f32>(-1.0e30), log_scale, in_use);
  let largest = max(max(counted.x, counted.y), counted.z);
  let relative = select(vec3<f32>(0.0), log_scale - largest, in_use);
  let amounts = emission * vec3<f32>(natural_exp(relative.x), natural_exp(relative.y), natural_exp(relative.z));
  let sum = amounts.x + amounts.y + amounts.z;
  return vec4<f32>(amounts / sum, largest + natural_log(sum));
}

fn cell_weights(flux_w: f32, lower_log_scale: f32, upper_log_scale: f32, upper_weight: f32) -> vec2<f32> {
  let log_scale = lower_log_scale + (upper_log_scale - lower_log_scale) * upper_weight;
  let scale = flux_w * natural_exp(log_scale);
  return vec2<f32>(scale * (1.0 - upper_weight), scale * upper_weight);
}
