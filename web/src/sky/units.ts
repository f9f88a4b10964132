// The units that a brightness can be read in, and the marks of the scale in each.

import { NATURAL_SKY_CD_M2, luminance_from_brightness_cd_m2 } from "../photometry.ts";
import { SCALE, log_luminance_ends } from "./scale.ts";

export const UNITS = ["magnitude", "luminance", "ratio"] as const;
/** mag arcsec⁻², cd m⁻², or times the natural sky. */
export type BrightnessUnit = (typeof UNITS)[number];

/** Steps within a decade. */
const STEPS = [1, 2, 5] as const;

/** A mark of the scale. */
export interface Mark {
  luminance_cd_m2: number;
  /** One that is left out first where there is little room. */
  is_minor: boolean;
}

/** The marks of the scale, faintest first: round numbers of the unit. */
export function marks(unit: BrightnessUnit): Mark[] {
  if (unit === "magnitude") {
    const count = SCALE.faintest_mag_arcsec2 - SCALE.brightest_mag_arcsec2 + 1;
    return Array.from({ length: count }, (_, i) => ({ luminance_cd_m2: luminance_from_brightness_cd_m2(SCALE.faintest_mag_arcsec2 - i), is_minor: i % 2 === 1 }));
  }
  const one_cd_m2 = unit === "ratio" ? NATURAL_SKY_CD_M2 : 1;
  const [faintest, brightest] = log_luminance_ends(SCALE);
  const found: Mark[] = [];
  for (let decade = -9; decade <= 6; decade++) {
    for (const step of STEPS) {
      const luminance_cd_m2 = step * 10 ** decade * one_cd_m2;
      const log = Math.log10(luminance_cd_m2);
      if (log >= faintest && log <= brightest) found.push({ luminance_cd_m2, is_minor: step !== 1 });
    }
  }
  return found;
}
