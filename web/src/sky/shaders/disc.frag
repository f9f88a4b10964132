// Moon or Sun at its true size with its phase, before the sky behind it.

/** Azimuth and elevation of its middle. */
uniform vec2 middle;
uniform float radius;
uniform vec4 lit;
uniform vec4 dark;
uniform float lit_share;
/** Direction of the bright limb, from up towards growing azimuth. */
uniform float bright_limb;
out vec4 colour;

/** Samples of a pixel along each side. */
const int SAMPLES = 4;

void main() {
  vec3 ahead = vector_of(middle);
  vec3 right = vec3(cos(middle.x), -sin(middle.x), 0.0);
  vec3 above = vec3(-sin(middle.y) * vec2(sin(middle.x), cos(middle.x)), cos(middle.y));
  vec4 sum = vec4(0.0);
  for (int i = 0; i < SAMPLES * SAMPLES; i++) {
    vec2 inside = (vec2(i % SAMPLES, i / SAMPLES) + 0.5) / float(SAMPLES) - 0.5;
    vec2 direction = direction_at(gl_FragCoord.xy - origin_px + inside);
    vec3 away = vector_of(direction) - ahead;
    vec2 on_disc = vec2(dot(away, right), dot(away, above)) / radius;
    if (dot(on_disc, on_disc) > 1.0 || dot(away, ahead) < -0.5) continue;
    float limb = on_disc.y * cos(bright_limb) + on_disc.x * sin(bright_limb);
    float along = on_disc.x * cos(bright_limb) - on_disc.y * sin(bright_limb);
    float terminator = (1.0 - 2.0 * lit_share) * sqrt(max(1.0 - along * along, 0.0));
    sum += limb >= terminator ? lit : dark;
  }
  if (sum.y == 0.0) discard;
  colour = vec4(shown_light(sky_at(direction_at(gl_FragCoord.xy - origin_px)) + sum / float(SAMPLES * SAMPLES)), 1.0);
}
