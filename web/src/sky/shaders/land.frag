// The land in light, from four pictures of it, before the sky. The twin of land-faces.ts.

/** Towards north, east, south and west, a quarter turn wide and high. */
uniform sampler2DArray faces;
/** The lower left corner of the plot on the canvas. */
uniform vec2 origin_px;
in vec3 interpolated;
out vec4 colour;

/** Between the columns of the grid the skyline is a straight line, and ridges of the pictures rise above it: they have so much of the sky
 * above the line with them, whose colours are the same, and fade into it. */
const float COVERED_DEG = 0.35;
const float FADING_DEG = 0.15;

/** In (east, north, up), of any length. */
vec3 ray_at(vec2 at_px) {
  return projection == PERSPECTIVE ? camera * vec3(at_px - 0.5 * plot_px, focal_px) : vector_of(direction_at(at_px));
}

void main() {
  float part = clamp((COVERED_DEG + FADING_DEG - interpolated.r) / FADING_DEG, 0.0, 1.0);
  if (part == 0.0) discard;
  vec3 ray = ray_at(gl_FragCoord.xy - origin_px);
  bool across = abs(ray.x) > abs(ray.y);
  float ahead = max(abs(ray.x), abs(ray.y));
  float right = across ? -ray.y * sign(ray.x) : ray.x * (ray.y < 0.0 ? -1.0 : 1.0);
  float face = across ? (ray.x > 0.0 ? 1.0 : 3.0) : (ray.y < 0.0 ? 2.0 : 0.0);
  // Where a picture ends, what is near goes on below it: it differs by azimuth alone.
  vec2 at = 0.5 + 0.5 * vec2(right, -ray.z) / ahead;
  float texels = 0.5 * float(textureSize(faces, 0).x) * pixel_rad();
  colour = vec4(encoded(textureLod(faces, vec3(at, face), log2(texels)).rgb) * part, part);
}
