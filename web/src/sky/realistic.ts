// The sky as a camera would show it: X, Y, Z to sRGB at a fixed exposure. The server's `realistic` is the authority, and
// `shaders/light.glsl` has the same.

import type { FourValues } from "./compact.ts";
import { encodeSrgb, SRGB_FROM_XYZ, type Three } from "./srgb.ts";

/** Luminance that an exposure of 0 EV shows as middle grey (18 % of display white), cd m⁻². */
const MIDDLE_GREY_LUMINANCE_CD_M2 = 1e-3;
const LUMINANCE_WEIGHTS = [0.2126, 0.7152, 0.0722] as const;

/** Scene luminance that counts as 1 before the film curve: 1 − exp(−x) is 0.18 at x = 0.198. */
export function referenceCdM2(exposureEv: number): number {
  return MIDDLE_GREY_LUMINANCE_CD_M2 / -Math.log(1 - 0.18) / 2 ** exposureEv;
}

/** Linear sRGB before the film curve; channels may be negative. */
export function seenByCamera([x, y, z]: FourValues, reference: number): Three {
  return SRGB_FROM_XYZ.map((row) => (row[0] * x + row[1] * y + row[2] * z) / reference) as Three;
}

/**
 * Linear sRGB, 0 to 1, after the film curve 1 − exp(−x) of the brightest channel; the others keep their ratio to it and come up to it
 * as it nears white. Colours outside sRGB move towards grey of their own luminance until they fit.
 */
export function filmed(linear: Three): Three {
  const grey = LUMINANCE_WEIGHTS[0] * linear[0] + LUMINANCE_WEIGHTS[1] * linear[1] + LUMINANCE_WEIGHTS[2] * linear[2];
  const lowest = Math.min(...linear);
  const saturation = lowest < 0 && grey > lowest ? grey / (grey - lowest) : 1;
  const inside = linear.map((channel) => Math.max(grey + saturation * (channel - grey), 0)) as Three;
  const brightest = Math.max(...inside);
  if (brightest === 0) return [0, 0, 0];
  const shown = 1 - Math.exp(-brightest);
  const whiteness = shown ** 4;
  return inside.map((channel) => shown * (channel / brightest + (1 - channel / brightest) * whiteness)) as Three;
}

/** The grey that a luminance is shown as, a byte. */
export function cameraGrey(luminanceCdM2: number, exposureEv: number): number {
  return Math.round(255 * encodeSrgb(1 - Math.exp(-luminanceCdM2 / referenceCdM2(exposureEv))));
}
