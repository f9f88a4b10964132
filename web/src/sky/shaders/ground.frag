// Ground that hides the sky, smooth along its edge.

uniform vec3 ground;
in vec3 interpolated;
out vec4 colour;

void main() {
  float part = clamp(0.5 - interpolated.r / max(fwidth(interpolated.r), 1e-9), 0.0, 1.0);
  colour = vec4(ground * part, part);
}
