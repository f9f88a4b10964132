// The light behind what stands before the sky.

/** X, Y, Z and scotopic luminance of the grid's samples with the veil, and of the highest row once more across the zenith. */
uniform sampler2D sky;
/** Luminance of the veil alone. */
uniform sampler2D veil;
/** The lower left corner of the plot on the canvas. */
uniform vec2 origin_px;

/** By bilinear interpolation, which textures of 32 bits have not. */
vec4 between_samples(sampler2D samples, vec2 direction) {
  ivec2 size = textureSize(samples, 0);
  vec2 at = place_of(direction, vec2(size)) * vec2(size) - 0.5;
  ivec2 low = ivec2(floor(at));
  vec2 part = at - vec2(low);
  #define TEXEL(right, above) texelFetch(samples, ivec2((low.x + right + size.x) % size.x, clamp(low.y + above, 0, size.y - 1)), 0)
  return mix(mix(TEXEL(0, 0), TEXEL(1, 0), part.x), mix(TEXEL(0, 1), TEXEL(1, 1), part.x), part.y);
}
