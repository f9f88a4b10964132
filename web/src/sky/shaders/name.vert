// A rectangle with a name: left, top, width and height in CSS pixels.

uniform vec4 box_px;
uniform vec2 canvas_px;
out vec2 within;

void main() {
  within = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = vec4((2.0 * (box_px.xy + within * box_px.zw) / canvas_px - 1.0) * vec2(1.0, -1.0), 0.0, 1.0);
}
