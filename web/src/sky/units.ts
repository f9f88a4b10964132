// The units that a brightness can be read in, and the marks of the scale in each.

import { luminanceFromBrightnessCdM2 } from "../photometry.ts";
import { logRange, SCALE } from "./scale.ts";
import { PHOTOPIC, type Seen } from "./seen.ts";

export const UNITS = ["magnitude", "luminance", "ratio"] as const;
/** mag arcsec⁻², the unit of what sees the sky (cd m⁻²), or times the natural sky. */
export type BrightnessUnit = (typeof UNITS)[number];

/** Steps within a decade. */
const STEPS = [1, 2, 5] as const;

/** A mark of the scale. */
export interface Tick {
  /** In the unit of what sees the sky. */
  value: number;
  /** One that is left out first where there is little room. */
  isMinor: boolean;
}

/** The marks of the scale, faintest first: round numbers of the unit. */
export function ticks(unit: BrightnessUnit, seen: Seen = PHOTOPIC): Tick[] {
  if (unit === "magnitude") {
    const count = SCALE.faintestMagArcsec2 - SCALE.brightestMagArcsec2 + 1;
    return Array.from({ length: count }, (_, i) => ({
      value: luminanceFromBrightnessCdM2(SCALE.faintestMagArcsec2 - i),
      isMinor: i % 2 === 1,
    }));
  }
  const one = unit === "ratio" ? (seen.natural ?? NaN) : 1;
  const [faintest, brightest] = logRange(seen.unit);
  const found: Tick[] = [];
  for (let decade = -9; decade <= 6; decade++) {
    for (const step of STEPS) {
      const value = step * 10 ** decade * one;
      const log = Math.log10(value);
      if (log >= faintest && log <= brightest) found.push({ value, isMinor: step !== 1 });
    }
  }
  return found;
}

/** The wanted unit, or another one where it has none. */
export function unitFor(wanted: BrightnessUnit, { hasMagnitude, natural }: Seen): BrightnessUnit {
  const isThere = { magnitude: hasMagnitude, luminance: true, ratio: natural !== null }[wanted];
  return isThere ? wanted : "luminance";
}

/** The unit that stands beside one; null: there is no second one. */
export function unitBeside(unit: BrightnessUnit, { hasMagnitude, natural }: Seen): BrightnessUnit | null {
  if (unit === "magnitude") return "luminance";
  if (hasMagnitude) return "magnitude";
  if (unit === "ratio") return "luminance";
  return natural === null ? null : "ratio";
}
