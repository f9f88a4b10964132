// The sky as pixels by bilinear interpolation: of the logarithm through a colour table, or of light through a tone map.

import { type ColourMapName, colourTable, type PictureStyle } from "./colour-maps.ts";
import type { SkyGrid, SkyKind } from "./grid.ts";
import type { Projection } from "./projection.ts";
import { ToneMap } from "./realistic.ts";
import { logRange } from "./scale.ts";

const TABLE_SIZE = 1024;
/** Below every unit's scale. */
const DARKEST = 1e-9;
/** Ground that hides the sky: brown-grey, as in the server's pictures. */
export const GROUND_RGB = [58, 54, 49] as const;

/** What a picture shows, and how. */
export interface PictureLook {
  sky: SkyKind;
  colours: PictureStyle;
  /** Of the realistic picture, stops. */
  exposureEv: number;
}

/** Interpolation stencil: the four samples around a direction in padded rows. */
interface Stencil {
  /** Offsets of the lower row and of the upper one. */
  low: number;
  high: number;
  /** Columns. */
  here: number;
  next: number;
  /** Parts of the way to the next column, and to the upper row. */
  right: number;
  above: number;
}

type Colourer = (stencil: Stencil, bytes: Uint8ClampedArray, at: number) => void;

/** The grid's rows with one added below (the horizon) and one above (the zenith). */
function padded({ azimuthCount, elevationCount }: SkyGrid, rows: Float32Array): Float32Array {
  const values = new Float32Array((elevationCount + 2) * azimuthCount);
  values.set(rows, azimuthCount);
  values.copyWithin(0, azimuthCount, 2 * azimuthCount);
  // All azimuths meet at the zenith: one value, the mean of the highest ring.
  let zenith = 0;
  for (let column = 0; column < azimuthCount; column++)
    zenith += (values[elevationCount * azimuthCount + column] ?? 0) / azimuthCount;
  values.fill(zenith, (elevationCount + 1) * azimuthCount);
  return values;
}

function interpolated(values: Float32Array, { low, high, here, next, right, above }: Stencil): number {
  const lower = (1 - right) * (values[low + here] ?? 0) + right * (values[low + next] ?? 0);
  const upper = (1 - right) * (values[high + here] ?? 0) + right * (values[high + next] ?? 0);
  return (1 - above) * lower + above * upper;
}

function falseColour(grid: SkyGrid, sky: SkyKind, map: ColourMapName): Colourer {
  const [faintest, brightest] = logRange(grid.seen.unit);
  const logValues = grid.logValues(sky, DARKEST);
  const values = padded(
    grid,
    logValues.map((log) => (log - faintest) / (brightest - faintest)),
  );
  const table = colourTable(map, TABLE_SIZE);
  return (stencil, bytes, at) => {
    const colour = Math.round(Math.min(Math.max(interpolated(values, stencil), 0), 1) * (TABLE_SIZE - 1)) * 3;
    bytes[at] = table[colour] ?? 0;
    bytes[at + 1] = table[colour + 1] ?? 0;
    bytes[at + 2] = table[colour + 2] ?? 0;
  };
}

function realistic(grid: SkyGrid, sky: SkyKind, exposureEv: number): Colourer {
  const [red, green, blue] = grid.radianceWM2Sr();
  const naturalCdM2 = sky === "total" ? grid.naturalCdM2 : 0;
  const bands = [padded(grid, red), padded(grid, green), padded(grid, blue)] as const;
  const toneMap = new ToneMap(exposureEv, grid.tint);
  return (stencil, bytes, at) =>
    toneMap.write(
      bytes,
      at,
      interpolated(bands[0], stencil),
      interpolated(bands[1], stencil),
      interpolated(bands[2], stencil),
      naturalCdM2,
    );
}

/** Paints the sky into a picture of `pixelsPerCssPx` device pixels a CSS pixel. Outside the sky stays transparent. */
export function paintSky(
  picture: ImageData,
  grid: SkyGrid,
  { sky, colours, exposureEv }: PictureLook,
  projection: Projection,
  pixelsPerCssPx: number,
): void {
  const colour = colours === "realistic" ? realistic(grid, sky, exposureEv) : falseColour(grid, sky, colours);
  const width = grid.azimuthCount;
  const lastRow = grid.elevationCount + 1;
  const { data } = picture;
  const hasGround = grid.horizonDeg.some((elevationDeg) => elevationDeg > 0);
  const stencil: Stencil = { low: 0, high: 0, here: 0, next: 0, right: 0, above: 0 };
  for (let y = 0; y < picture.height; y++) {
    for (let x = 0; x < picture.width; x++) {
      const at = (y * picture.width + x) * 4;
      const direction = projection.directionFromPoint((x + 0.5) / pixelsPerCssPx, (y + 0.5) / pixelsPerCssPx);
      if (direction === null) {
        data[at + 3] = 0;
        continue;
      }
      if (direction.elevationDeg < (hasGround ? grid.horizonAt(direction.azimuthDeg) : 0)) {
        [data[at], data[at + 1], data[at + 2], data[at + 3]] = [...GROUND_RGB, 255];
        continue;
      }
      const across = (direction.azimuthDeg - grid.azimuthFirstDeg) / grid.azimuthStepDeg + width;
      const up = Math.min(
        Math.max((direction.elevationDeg - grid.elevationFirstDeg) / grid.elevationStepDeg + 1, 0),
        lastRow - 1e-6,
      );
      const column = Math.floor(across);
      const row = Math.floor(up);
      stencil.low = row * width;
      stencil.high = stencil.low + width;
      stencil.here = column % width;
      stencil.next = (column + 1) % width;
      stencil.right = across - column;
      stencil.above = up - row;
      colour(stencil, data, at);
      data[at + 3] = 255;
    }
  }
}
