// The colours of a look for every sample of the grid. Between samples they are interpolated: by the GPU, or by `paint.ts` where there
// is none. The server interpolates light instead; between samples 1.4° apart no display shows the difference.

import { type ColourMapName, colourTable, type PictureStyle } from "./colour-maps.ts";
import type { FourValues } from "./compact.ts";
import { dazzle, halfPower, seenByEye } from "./eye.ts";
import { glareOf } from "./glare.ts";
import type { SkyGrid, SkyKind } from "./grid.ts";
import { filmed, referenceCdM2, seenByCamera } from "./realistic.ts";
import { logRange } from "./scale.ts";
import { encodeSrgb, type Three } from "./srgb.ts";

/** Below every unit's scale. */
const DARKEST = 1e-9;
export const TABLE_SIZE = 1024;
/** Ground that hides the sky: brown-grey, and by night darker than any sky, as in the server's pictures. */
export const GROUND_RGB = [58, 54, 49] as const;
export const DARK_GROUND_RGB = [2, 2, 3] as const;
/** What a picture shows, and how. */
export interface PictureLook {
  sky: SkyKind;
  colours: PictureStyle;
  /** Of the pictures of eye and camera, stops. */
  exposureEv: number;
  /** Luminance that the eye is adapted to, cd m⁻²; null: the mean of the sky that is shown. */
  adaptationCdM2: number | null;
}

export interface Shading {
  /** Whether the first number of a texel is a place in a colour table, 0 to 1. */
  isTable: boolean;
  /** [row][column], four numbers each: red, green and blue as the display takes them, 0 to 1. One row more than the grid has. */
  texels: Float32Array;
  groundRgb: readonly [number, number, number];
}

/** The luminance that the eye is adapted to before a sky, or before a sky over brighter land: to the mean of their logarithms. */
export function adaptationOf(grid: SkyGrid, look: Pick<PictureLook, "sky" | "adaptationCdM2">, landCdM2 = 0): number {
  if (look.adaptationCdM2 !== null) return look.adaptationCdM2;
  const { meanCdM2 } = glareOf(grid, look.sky);
  return Math.sqrt(meanCdM2 * Math.max(landCdM2, meanCdM2));
}

/** Light of a sample with the veil over it, and the luminance of that. */
export function veiledAt(grid: SkyGrid, sky: SkyKind, sample: number): { light: FourValues; veilCdM2: number } {
  const { veil } = glareOf(grid, sky);
  const at = (i: number) => veil[4 * sample + i] as number;
  const [x, y, z, scotopic] = grid.eyeAt(sky, sample);
  return { light: [x + at(0), y + at(1), z + at(2), scotopic + at(3)], veilCdM2: at(1) };
}

export function shadingOf(grid: SkyGrid, look: PictureLook): Shading {
  const { sky, colours, exposureEv } = look;
  const encoded = (linear: Three) => linear.map(encodeSrgb);
  if (colours === "eye") {
    const adaptation = adaptationOf(grid, look);
    const texels = texelsOf(grid, (sample) => {
      const { light, veilCdM2 } = veiledAt(grid, sky, sample);
      return encoded(seenByEye(light, halfPower(exposureEv, adaptation * dazzle(light[1], veilCdM2))));
    });
    return { isTable: false, texels, groundRgb: DARK_GROUND_RGB };
  }
  if (colours === "realistic") {
    const reference = referenceCdM2(exposureEv);
    const texels = texelsOf(grid, (sample) => encoded(filmed(seenByCamera(grid.eyeAt(sky, sample), reference))));
    return { isTable: false, texels, groundRgb: GROUND_RGB };
  }
  const [faintest, brightest] = logRange(grid.seen.unit);
  const position = (sample: number) =>
    (Math.log10(Math.max(grid.valueAt(sky, sample), DARKEST)) - faintest) / (brightest - faintest);
  return { isTable: true, texels: texelsOf(grid, (sample) => [position(sample)]), groundRgb: GROUND_RGB };
}

/** The grid's rows and one above them: the highest row seen across the zenith, so that the sky is continuous there. */
export function texelsOf({ azimuthCount, elevationCount }: SkyGrid, colour: (sample: number) => readonly number[]): Float32Array {
  const texels = new Float32Array((elevationCount + 1) * azimuthCount * 4);
  for (let sample = 0; sample < elevationCount * azimuthCount; sample++) texels.set(colour(sample), 4 * sample);
  const rowLength = 4 * azimuthCount;
  const last = elevationCount * rowLength;
  texels.copyWithin(last, last - rowLength / 2, last);
  texels.copyWithin(last + rowLength / 2, last - rowLength, last - rowLength / 2);
  return texels;
}

/** The table of a colour map. */
export function tableOf(map: ColourMapName): Uint8ClampedArray {
  return colourTable(map, TABLE_SIZE);
}
