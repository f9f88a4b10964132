// Moon or Sun at its true size with its phase, and its glare, before the sky behind it.

/** Azimuth and elevation of its middle. */
uniform vec2 middle;
uniform float radius;
uniform vec4 lit;
uniform vec4 dark;
uniform float lit_share;
/** Direction of the bright limb, from up towards growing azimuth. */
uniform float bright_limb;
/** X, Y, Z and scotopic illuminance at the eye. */
uniform vec4 illuminance;
/** Whose veil the samples of the sky have; no more is drawn beyond it, and there is none for a camera: 0. */
uniform float halo_deg;
out vec4 colour;

/** Samples of a pixel along each side. */
const int SAMPLES = 4;
/** The twin of glare.ts. */
const float LEAST_DEG = 0.1;
const float AGEING = 1.0 + 0.48 * 0.48 * 0.48 * 0.48;
const float PIGMENT = 0.5;

float veil_facing(float angle_deg) {
  float theta = max(angle_deg, LEAST_DEG);
  float veil = 10.0 / (theta * theta * theta) + (5.0 / (theta * theta) + 0.1 * PIGMENT / theta) * AGEING + 0.0025 * PIGMENT;
  return veil * max(cos(radians(angle_deg)), 0.0);
}

void main() {
  vec3 ahead = vector_of(middle);
  vec3 right = vec3(cos(middle.x), -sin(middle.x), 0.0);
  vec3 above = vec3(-sin(middle.y) * vec2(sin(middle.x), cos(middle.x)), cos(middle.y));
  vec2 direction = direction_at(gl_FragCoord.xy - origin_px);
  // The chord tells small angles better than a cosine.
  float angle = 2.0 * asin(min(0.5 * length(vector_of(direction) - ahead), 1.0));
  float veil_deg = max(degrees(angle), degrees(radius));
  float more = veil_deg < halo_deg ? veil_facing(veil_deg) - veil_facing(halo_deg) : 0.0;
  vec4 sum = vec4(0.0);
  if (angle < 1.5 * radius + 2.0 * pixel_rad()) {
    for (int i = 0; i < SAMPLES * SAMPLES; i++) {
      vec2 inside = (vec2(i % SAMPLES, i / SAMPLES) + 0.5) / float(SAMPLES) - 0.5;
      vec3 away = vector_of(direction_at(gl_FragCoord.xy - origin_px + inside)) - ahead;
      vec2 on_disc = vec2(dot(away, right), dot(away, above)) / radius;
      if (dot(on_disc, on_disc) > 1.0 || dot(away, ahead) < -0.5) continue;
      float limb = on_disc.y * cos(bright_limb) + on_disc.x * sin(bright_limb);
      float along = on_disc.x * cos(bright_limb) - on_disc.y * sin(bright_limb);
      float terminator = (1.0 - 2.0 * lit_share) * sqrt(max(1.0 - along * along, 0.0));
      sum += limb >= terminator ? lit : dark;
    }
  }
  if (sum.y == 0.0 && more == 0.0) discard;
  vec4 veiled = between_samples(sky, direction) + more * illuminance;
  float dazzled = dazzle(veiled.y, between_samples(veil, direction).r + more * illuminance.y);
  colour = vec4(shown_light(veiled + sum / float(SAMPLES * SAMPLES), dazzled), 1.0);
}
