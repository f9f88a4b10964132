// From radiance to what people see. The server's `physics` crate is the authority; these are its formulas.

/** Luminance of 0 mag arcsec⁻², cd m⁻². */
export const ZERO_POINT_CD_M2 = 1.08e5;
/** −2.5·log10(luminance / 1.08e5), mag arcsec⁻²; null for a sky without light. */
export function brightnessMagArcsec2(luminanceCdM2: number): number | null {
  return luminanceCdM2 > 0 ? -2.5 * Math.log10(luminanceCdM2 / ZERO_POINT_CD_M2) : null;
}

/** The inverse of `brightnessMagArcsec2`: luminance, cd m⁻². */
export function luminanceFromBrightnessCdM2(brightnessMagArcsec2: number): number {
  return ZERO_POINT_CD_M2 * 10 ** (-0.4 * brightnessMagArcsec2);
}
