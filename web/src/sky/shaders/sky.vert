// Samples of the sky and points of the ground, where the projection has them.

/** Azimuth and elevation. */
layout(location = 0) in vec2 direction;
/** Red, green and blue of the sky as the display takes them; of the ground how many degrees above its edge it lies. */
layout(location = 1) in vec3 shown;
out vec3 interpolated;

void main() {
  vec2 there = projection == PERSPECTIVE ? direction : vec2(direction.x, max(direction.y, 0.0));
  // No sky is moved by this, and ground to where it still is as far from its edge as it says.
  interpolated = shown + vec3(degrees(there.y - direction.y), 0.0, 0.0);
  gl_Position = clip_position(there);
}
