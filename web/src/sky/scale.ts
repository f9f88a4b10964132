// The fixed brightness scale of the false-colour picture. It never adapts to a sky, so two pictures compare.

import { luminance_from_brightness_cd_m2 } from "../photometry.ts";

/** A scale in magnitudes: faint at the left end, bright at the right. */
export interface BrightnessScale {
  faintest_mag_arcsec2: number;
  brightest_mag_arcsec2: number;
}

/** The server's default for `scale=magnitude`: from a sixteenth of the natural sky to the horizon over a city. */
export const SCALE: Readonly<BrightnessScale> = { faintest_mag_arcsec2: 25, brightest_mag_arcsec2: 15 };

/** Position on the scale, 0 (faintest) to 1 (brightest), clamped. */
export function scale_position(scale: BrightnessScale, brightness_mag_arcsec2: number): number {
  const span = scale.faintest_mag_arcsec2 - scale.brightest_mag_arcsec2;
  return Math.min(Math.max((scale.faintest_mag_arcsec2 - brightness_mag_arcsec2) / span, 0), 1);
}

/** Ends of the scale as log10 luminance [cd m⁻²]: faintest, brightest. */
export function log_luminance_ends(scale: BrightnessScale): [number, number] {
  return [
    Math.log10(luminance_from_brightness_cd_m2(scale.faintest_mag_arcsec2)),
    Math.log10(luminance_from_brightness_cd_m2(scale.brightest_mag_arcsec2)),
  ];
}
