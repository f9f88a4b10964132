// Ends of lines in CSS pixels from the upper left.

layout(location = 0) in vec2 at_px;
uniform vec2 canvas_px;

void main() {
  gl_Position = vec4((2.0 * at_px / canvas_px - 1.0) * vec2(1.0, -1.0), 0.0, 1.0);
}
