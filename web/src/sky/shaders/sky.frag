// The sky between the samples of the grid: colours, or places in a colour table.

uniform sampler2D table;
in vec3 interpolated;
out vec4 colour;

/** Half a step of the display to either side, so that dark skies have no bands (interleaved gradient noise, Jimenez 2014). */
float noise(vec2 at_px) {
  return (fract(52.9829189 * fract(dot(at_px, vec2(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

void main() {
  colour = vec4(interpolated + noise(gl_FragCoord.xy), 1.0);
  if (finish == TABLE) colour = texelFetch(table, ivec2(clamp(interpolated.r, 0.0, 1.0) * float(textureSize(table, 0).x - 1) + 0.5, 0), 0);
}
