// From light to the display: the twins of eye.ts, realistic.ts and srgb.ts.

const int TABLE = 0;
const int FILM = 1;
const int EYE = 2;
const vec3 LUMINANCE_WEIGHTS = vec3(0.2126, 0.7152, 0.0722);
/** XYZ from linear sRGB primaries, D65 (IEC 61966-2-1), inverted. */
const mat3 SRGB_FROM_XYZ = mat3(3.2404542, -0.969266, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.041556, 1.0572252);
/** The same for a camera whose white is that of 4 200 K. */
const mat3 CAMERA_FROM_XYZ = mat3(3.0537492, -1.0011991, 0.0862492, -1.7256532, 1.9840248, -0.251268, -0.482897, 0.0275717, 1.6848894);
/** The film: contrast, shoulder, and what is white, in times middle grey. */
const float MIDDLE_GREY = 0.18;
const float FILM_CONTRAST = 1.15;
const float FILM_SHOULDER = 0.85;
const float FILM_WHITE = 1024.0;
const float WHITE_POWER = pow(FILM_WHITE, FILM_CONTRAST);
const float WHITE_SHOULDER = pow(WHITE_POWER, FILM_SHOULDER);
const float FILM_SLOPE = (WHITE_POWER * MIDDLE_GREY - 1.0) / ((WHITE_SHOULDER - 1.0) * MIDDLE_GREY);
const float FILM_TOE = (WHITE_SHOULDER - WHITE_POWER * MIDDLE_GREY) / ((WHITE_SHOULDER - 1.0) * MIDDLE_GREY);
/** V'(555 nm). */
const float SCOTOPIC_AT_555_NM = 683.0 / 1699.0;
const float RESPONSE_EXPONENT = 0.73;
const float ADAPTATION_EXPONENT = 0.8;
const float EQUIVALENT_BACKGROUND = 0.0025;
const float DARKEST = 1e-4;
const float CONTRAST_EXPONENT = 2.0;
/** X and Z over Y of what rods alone see: chromaticity (0.271, 0.276). */
const vec3 RODS = vec3(0.271 / 0.276, 1.0, (1.0 - 0.271 - 0.276) / 0.276);
const vec3 WHITE = vec3(0.3127 / 0.329, 1.0, (1.0 - 0.3127 - 0.329) / 0.329);
/** What the table spans: powers of ten of photopic luminance, and powers of two of scotopic over photopic, down to the same below 0. */
const float TABLE_FROM = -3.5;
const float TABLE_TO = 1.5;
const float TABLE_RATIO_LOG2 = 3.0;
/** The part of the cones. */
uniform sampler2D cone_table;

uniform int finish;
/** Of the eye, what the exposure makes of half of the brightest to the power of its response; of the film, the luminance of middle grey. */
uniform float exposure;
/** Luminance that the eye is adapted to. */
uniform float adaptation;

vec3 encoded(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(max(linear, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, linear));
}

/** Luminance and the part of the cones (CIE 191:2010, MES-2), by the table of eye.ts. */
vec2 mesopic(float photopic, float scotopic) {
  vec2 size = vec2(textureSize(cone_table, 0));
  vec2 at = vec2((log2(max(photopic, 1e-30)) * 0.30103 - TABLE_FROM) / (TABLE_TO - TABLE_FROM), 0.5 + 0.5 * log2(max(scotopic, 1e-30) / max(photopic, 1e-30)) / TABLE_RATIO_LOG2);
  float cones = texture(cone_table, (0.5 + clamp(at, 0.0, 1.0) * (size - 1.0)) / size).r;
  float rods = (1.0 - cones) * SCOTOPIC_AT_555_NM;
  return vec2((cones * photopic + rods * scotopic) / (cones + rods), cones);
}

/** How much more the eye is adapted to where a veil lies over a luminance, both together (eye.ts). */
float dazzle(float luminance, float veil) {
  return 1.0 + veil / max(luminance - veil, 1e-5);
}

/** Of light, where the eye is dazzled so many times. */
vec3 seen_by_eye(vec4 light, float dazzled) {
  vec2 seen = mesopic(light.y, light.w);
  float power = pow(max(seen.x, 1e-30), RESPONSE_EXPONENT);
  float half_power = exposure * pow(max(adaptation * dazzled, DARKEST) + EQUIVALENT_BACKGROUND, ADAPTATION_EXPONENT * RESPONSE_EXPONENT);
  float shown = pow(power / (power + half_power), CONTRAST_EXPONENT);
  vec3 rods = mix(RODS, WHITE, seen.y);
  vec3 cones = light.y > 0.0 ? light.xyz / light.y : rods;
  vec3 linear = SRGB_FROM_XYZ * (shown * mix(rods, cones, seen.y));
  // Towards grey of its own luminance until every channel is 0 to 1.
  vec3 away = abs(linear - shown);
  vec3 room = mix(vec3(shown), vec3(1.0 - shown), step(shown, linear));
  vec3 saturation = min(room / max(away, vec3(1e-12)), vec3(1.0));
  return clamp(shown + min(saturation.x, min(saturation.y, saturation.z)) * (linear - shown), 0.0, 1.0);
}

/** The film's curve, after colours outside sRGB moved towards grey. */
vec3 filmed(vec3 linear) {
  float grey = dot(LUMINANCE_WEIGHTS, linear);
  float lowest = min(linear.x, min(linear.y, linear.z));
  float saturation = lowest < 0.0 && grey > lowest ? grey / (grey - lowest) : 1.0;
  vec3 inside = max(grey + saturation * (linear - grey), 0.0);
  float brightest = max(inside.x, max(inside.y, inside.z));
  if (brightest <= 0.0) return vec3(0.0);
  float power = pow(min(brightest, FILM_WHITE), FILM_CONTRAST);
  float shown = power / (FILM_SLOPE * pow(power, FILM_SHOULDER) + FILM_TOE);
  return shown * mix(inside / brightest, vec3(1.0), pow(shown, 4.0));
}

/** What X, Y, Z and scotopic light look like where the eye is dazzled so many times. */
vec3 shown_light(vec4 light, float dazzled) {
  return encoded(finish == EYE ? seen_by_eye(light, dazzled) : filmed(CAMERA_FROM_XYZ * light.xyz / exposure));
}
