// sRGB (IEC 61966-2-1).

export type Three = [number, number, number];

/** XYZ from linear sRGB primaries, D65, inverted. */
export const SRGB_FROM_XYZ = [
  [3.2404542, -1.5371385, -0.4985314],
  [-0.969266, 1.8760108, 0.041556],
  [0.0556434, -0.2040259, 1.0572252],
] as const;

/** Linear 0 to 1 as the display takes it. */
export function encodeSrgb(linear: number): number {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
}
