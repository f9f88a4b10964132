// A point of light blurred by the eye before the sky; the brighter of it and the sky is kept.

flat in vec4 peak;
flat in vec4 before;
flat in float dazzled;
flat in float blur_px;
flat in float size_px;
out vec4 colour;

void main() {
  vec2 away_px = (gl_PointCoord - 0.5) * size_px;
  float part = exp(-0.5 * dot(away_px, away_px) / (blur_px * blur_px));
  colour = vec4(shown_light(before + part * peak, dazzled), 1.0);
}
