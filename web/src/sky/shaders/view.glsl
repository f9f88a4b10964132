// Directions from pixels and back. The twin of projection.ts; angles in radians, pixels from the lower left of the plot.

const int EQUIRECTANGULAR = 0;
const int FISHEYE = 1;
const int PERSPECTIVE = 2;
const float PI = 3.14159265358979;

uniform int projection;
/** Width and height of the plot. */
uniform vec2 plot_px;
/** Columns right, above and ahead of the perspective, in (east, north, up). */
uniform mat3 camera;
/** Distance from the eye to the plot. */
uniform float focal_px;

/** Azimuth and elevation at a position; y is NaN-free: outside a fisheye the elevation is below the horizon. */
vec2 direction_at(vec2 at_px) {
  vec2 away_px = at_px - 0.5 * plot_px;
  if (projection == EQUIRECTANGULAR) return vec2(at_px.x / plot_px.x * 2.0 * PI, at_px.y / plot_px.y * 0.5 * PI);
  if (projection == FISHEYE) {
    float radius_px = 0.5 * min(plot_px.x, plot_px.y);
    return vec2(atan(-away_px.x, away_px.y), 0.5 * PI * (1.0 - length(away_px) / radius_px));
  }
  vec3 enu = camera * vec3(away_px, focal_px);
  return vec2(atan(enu.x, enu.y), atan(enu.z, length(enu.xy)));
}

/** East, north, up. */
vec3 vector_of(vec2 direction) {
  return vec3(cos(direction.y) * vec2(sin(direction.x), cos(direction.x)), sin(direction.y));
}

/** Where a direction lies on the plot. */
vec4 clip_position(vec2 direction) {
  if (projection == EQUIRECTANGULAR) return vec4(direction.x / PI - 1.0, direction.y / (0.25 * PI) - 1.0, 0.0, 1.0);
  if (projection == FISHEYE) {
    float distance_px = (1.0 - direction.y / (0.5 * PI)) * min(plot_px.x, plot_px.y);
    return vec4(distance_px * vec2(-sin(direction.x), cos(direction.x)) / plot_px, 0.0, 1.0);
  }
  vec3 local = vector_of(direction) * camera;
  return vec4(2.0 * focal_px * local.xy / plot_px, 0.0, local.z);
}

/** Where a direction lies on textures of the grid: column 0 looks north, row 0 is half a row above the horizon. */
vec2 place_of(vec2 direction, vec2 size) {
  return vec2(direction.x / (2.0 * PI) + 0.5 / size.x, direction.y / (0.5 * PI) * (size.y - 1.0) / size.y);
}

/** Angle that a pixel in the middle of the plot subtends along its height. */
float pixel_rad() {
  if (projection == EQUIRECTANGULAR) return 0.5 * PI / plot_px.y;
  return projection == FISHEYE ? PI / min(plot_px.x, plot_px.y) : 1.0 / focal_px;
}
