// The fixed brightness scale of the false-colour picture. It never adapts to a sky, so two pictures compare.

import { luminanceFromBrightnessCdM2 } from "../photometry.ts";

/** A scale in magnitudes: faint at the left end, bright at the right. */
export interface BrightnessScale {
  faintestMagArcsec2: number;
  brightestMagArcsec2: number;
}

/** The server's default for `scale=magnitude`: from a sixteenth of the natural sky to the horizon over a city. */
export const SCALE: Readonly<BrightnessScale> = { faintestMagArcsec2: 25, brightestMagArcsec2: 15 };

/** Position on the scale, 0 (faintest) to 1 (brightest), clamped. */
export function scalePosition(scale: BrightnessScale, brightnessMagArcsec2: number): number {
  const span = scale.faintestMagArcsec2 - scale.brightestMagArcsec2;
  return Math.min(Math.max((scale.faintestMagArcsec2 - brightnessMagArcsec2) / span, 0), 1);
}

/** Ends of the scale as log10 luminance [cd m⁻²]: faintest, brightest. */
export function logLuminanceRange(scale: BrightnessScale): [number, number] {
  return [
    Math.log10(luminanceFromBrightnessCdM2(scale.faintestMagArcsec2)),
    Math.log10(luminanceFromBrightnessCdM2(scale.brightestMagArcsec2)),
  ];
}
