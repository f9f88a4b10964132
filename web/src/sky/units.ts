// The units that a brightness can be read in, and the marks of the scale in each.

import { luminanceFromBrightnessCdM2, NATURAL_SKY_CD_M2 } from "../photometry.ts";
import { logLuminanceRange, SCALE } from "./scale.ts";

export const UNITS = ["magnitude", "luminance", "ratio"] as const;
/** mag arcsec⁻², cd m⁻², or times the natural sky. */
export type BrightnessUnit = (typeof UNITS)[number];

/** Steps within a decade. */
const STEPS = [1, 2, 5] as const;

/** A mark of the scale. */
export interface Tick {
  luminanceCdM2: number;
  /** One that is left out first where there is little room. */
  isMinor: boolean;
}

/** The marks of the scale, faintest first: round numbers of the unit. */
export function ticks(unit: BrightnessUnit): Tick[] {
  if (unit === "magnitude") {
    const count = SCALE.faintestMagArcsec2 - SCALE.brightestMagArcsec2 + 1;
    return Array.from({ length: count }, (_, i) => ({
      luminanceCdM2: luminanceFromBrightnessCdM2(SCALE.faintestMagArcsec2 - i),
      isMinor: i % 2 === 1,
    }));
  }
  const oneCdM2 = unit === "ratio" ? NATURAL_SKY_CD_M2 : 1;
  const [faintest, brightest] = logLuminanceRange(SCALE);
  const found: Tick[] = [];
  for (let decade = -9; decade <= 6; decade++) {
    for (const step of STEPS) {
      const luminanceCdM2 = step * 10 ** decade * oneCdM2;
      const log = Math.log10(luminanceCdM2);
      if (log >= faintest && log <= brightest) found.push({ luminanceCdM2, isMinor: step !== 1 });
    }
  }
  return found;
}
