// The fixed brightness scale of the false-colour picture. It never adapts to a sky, so two pictures compare.

import { luminanceFromBrightnessCdM2 } from "../photometry.ts";

/** A scale in magnitudes: faint at the left end, bright at the right. */
export interface BrightnessScale {
  faintestMagArcsec2: number;
  brightestMagArcsec2: number;
}

/** The server's default for `scale=magnitude`: from a sixteenth of the natural sky to the horizon over a city. */
export const SCALE: Readonly<BrightnessScale> = { faintestMagArcsec2: 25, brightestMagArcsec2: 15 };

/** Ends of the scale of values in what a satellite's radiance is told in, nW cm⁻² sr⁻¹: the server's default too. */
const RADIANCE_ENDS = [1e-3, 10] as const;

/** Ends of the scale of values in this unit, faintest and brightest, in the unit. */
export function scaleEndsIn(unit: string): readonly [number, number] {
  if (unit === "nW/cm²/sr") return RADIANCE_ENDS;
  return [luminanceFromBrightnessCdM2(SCALE.faintestMagArcsec2), luminanceFromBrightnessCdM2(SCALE.brightestMagArcsec2)];
}

/** The same as log10. */
export function logRange(unit: string): [number, number] {
  const [faintest, brightest] = scaleEndsIn(unit);
  return [Math.log10(faintest), Math.log10(brightest)];
}

/** Position of a value on the scale of its unit, 0 (faintest) to 1 (brightest), clamped. */
export function scalePosition(unit: string, value: number): number {
  const [faintest, brightest] = logRange(unit);
  return Math.min(Math.max((Math.log10(value) - faintest) / (brightest - faintest), 0), 1);
}
