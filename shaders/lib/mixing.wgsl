// Requires elementary. Derivations: server/render/src/twin/mixing.rs

fn lobe_shares(emission: vec3<f32>, log_scale: vec3<f32>) -> vec4<f32> {
  let in_use = emission > vec3<f32>(0.0);
  let counted = select(vec3<f32>(-1.0e30), log_scale, in_use);
  let largest = max(max(counted.x, counted.y), counted.z);
  let relative = select(vec3<f32>(0.0), log_scale - largest, in_use);
  let amounts = emission * vec3<f32>(natural_exp(relative.x), natural_exp(relative.y), natural_exp(relative.z));
  let sum = amounts.x + amounts.y + amounts.z;
  return vec4<f32>(amounts / sum, largest + natural_log(sum));
}

// Of server/tables/src/curvature.rs.
const MAX_CURVATURE: f32 = 1.0;
const SIXTH: f32 = 1.0 / 6.0;

// From ln of the lobes' scales at the nodes below, at and above.
fn mixed_curvature(shares: vec3<f32>, below: vec3<f32>, at: vec3<f32>, above: vec3<f32>) -> f32 {
  let slope = 0.5 * (above - below);
  let apart = slope - dot(shares, slope);
  let curvature = dot(shares, (below - at) + (above - at) + apart * apart);
  return clamp(curvature, -MAX_CURVATURE, MAX_CURVATURE);
}

// `log_scale` and `curvature` of the lower and the upper node.
fn log_scale_between(log_scale: vec2<f32>, curvature: vec2<f32>, upper_weight: f32) -> f32 {
  let both_curvatures = curvature.x + curvature.y + curvature.x * (1.0 - upper_weight) + curvature.y * upper_weight;
  return log_scale.x + (log_scale.y - log_scale.x) * upper_weight
    - upper_weight * (1.0 - upper_weight) * both_curvatures * SIXTH;
}

fn cell_weights(flux_w: f32, log_scale: vec2<f32>, curvature: vec2<f32>, upper_weight: f32) -> vec2<f32> {
  let scale = flux_w * natural_exp(log_scale_between(log_scale, curvature, upper_weight));
  return vec2<f32>(scale * (1.0 - upper_weight), scale * upper_weight);
}
