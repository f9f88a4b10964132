// The sky as a camera would show it: X, Y, Z to sRGB at a fixed exposure, white balance and film curve. The server's `realistic` is the
// authority, and `shaders/light.glsl` has the same.

import type { FourValues } from "./compact.ts";
import { encodeSrgb, type Three } from "./srgb.ts";

/** Luminance that an exposure of 0 EV shows as middle grey, cd m⁻²: f/2, 15 s at ISO 3 200. */
const MIDDLE_GREY_LUMINANCE_CD_M2 = 1e-3;
const EXPOSURE_TIME_S = 15;
/** Of display white. */
const MIDDLE_GREY = 0.18;
/** Linear sRGB from X, Y, Z where light of 4 200 K is white (Bradford). */
const CAMERA_FROM_XYZ = [
  [3.0537492, -1.7256532, -0.482897],
  [-1.0011991, 1.9840248, 0.0275717],
  [0.0862492, -0.251268, 1.6848894],
] as const;
/** The film's curve (Lottes 2016): contrast, shoulder, and what is white, in times middle grey: ten stops above it. */
const CONTRAST = 1.15;
const SHOULDER = 0.85;
const FILM_WHITE = 1024;
const WHITE_POWER = FILM_WHITE ** CONTRAST;
const WHITE_SHOULDER = WHITE_POWER ** SHOULDER;
const SLOPE = (WHITE_POWER * MIDDLE_GREY - 1) / ((WHITE_SHOULDER - 1) * MIDDLE_GREY);
const TOE = (WHITE_SHOULDER - WHITE_POWER * MIDDLE_GREY) / ((WHITE_SHOULDER - 1) * MIDDLE_GREY);
const LUMINANCE_WEIGHTS = [0.2126, 0.7152, 0.0722] as const;

/** Scene luminance of middle grey. */
export function referenceCdM2(exposureEv: number): number {
  return MIDDLE_GREY_LUMINANCE_CD_M2 / 2 ** exposureEv;
}

/** How long a camera at f/2 and ISO 3 200 is open. */
export function exposureTimeS(exposureEv: number): number {
  return EXPOSURE_TIME_S * 2 ** exposureEv;
}

/** Part of display white that the film makes of light in times middle grey. */
function filmCurve(light: number): number {
  const power = Math.min(light, FILM_WHITE) ** CONTRAST;
  return power / (SLOPE * power ** SHOULDER + TOE);
}

/** Linear sRGB before the film curve, in times middle grey; channels may be negative. */
export function seenByCamera([x, y, z]: FourValues, reference: number): Three {
  return CAMERA_FROM_XYZ.map((row) => (row[0] * x + row[1] * y + row[2] * z) / reference) as Three;
}

/**
 * Linear sRGB, 0 to 1, after the film curve of the brightest channel; the others keep their ratio to it and come up to it
 * as it nears white. Colours outside sRGB move towards grey of their own luminance until they fit.
 */
export function filmed(linear: Three): Three {
  const grey = LUMINANCE_WEIGHTS[0] * linear[0] + LUMINANCE_WEIGHTS[1] * linear[1] + LUMINANCE_WEIGHTS[2] * linear[2];
  const lowest = Math.min(...linear);
  const saturation = lowest < 0 && grey > lowest ? grey / (grey - lowest) : 1;
  const inside = linear.map((channel) => Math.max(grey + saturation * (channel - grey), 0)) as Three;
  const brightest = Math.max(...inside);
  if (brightest === 0) return [0, 0, 0];
  const shown = filmCurve(brightest);
  const whiteness = shown ** 4;
  return inside.map((channel) => shown * (channel / brightest + (1 - channel / brightest) * whiteness)) as Three;
}

/** The grey that a luminance is shown as, a byte. */
export function cameraGrey(luminanceCdM2: number, exposureEv: number): number {
  return Math.round(255 * encodeSrgb(filmCurve(luminanceCdM2 / referenceCdM2(exposureEv))));
}
