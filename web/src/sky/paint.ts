// The sky as pixels without WebGL: the shading's colours by bilinear interpolation. No stars.

import type { ColourMapName } from "./colour-maps.ts";
import type { SkyGrid } from "./grid.ts";
import type { Landscape } from "./landscape.ts";
import type { Projection } from "./projection.ts";
import { type PictureLook, type Shading, shadingOf, TABLE_SIZE, tableOf } from "./shading.ts";
import type { Three } from "./srgb.ts";

/** The interpolated colour of a direction. */
function colourAt(grid: SkyGrid, { texels }: Shading, azimuthDeg: number, elevationDeg: number): Three {
  const { azimuthCount, elevationCount } = grid;
  const across = (azimuthDeg - grid.azimuthFirstDeg) / grid.azimuthStepDeg + azimuthCount;
  const up = Math.min(Math.max((elevationDeg - grid.elevationFirstDeg) / grid.elevationStepDeg, 0), elevationCount - 0.5);
  const [column, row] = [Math.floor(across), Math.min(Math.floor(up), elevationCount - 1)];
  const [right, above] = [across - column, up - row];
  const at = (rowAt: number, columnAt: number) => 4 * (rowAt * azimuthCount + (columnAt % azimuthCount));
  const [a, b, c, d] = [at(row, column), at(row, column + 1), at(row + 1, column), at(row + 1, column + 1)] as const;
  const channel = (i: number) =>
    (1 - above) * ((1 - right) * (texels[a + i] ?? 0) + right * (texels[b + i] ?? 0)) +
    above * ((1 - right) * (texels[c + i] ?? 0) + right * (texels[d + i] ?? 0));
  return [channel(0), channel(1), channel(2)];
}

/** Bytes of an interpolated colour. */
function finisher({ isTable }: Shading, colours: PictureLook["colours"]): (colour: Three) => ArrayLike<number> {
  if (!isTable) return (colour) => colour.map((channel) => 255 * channel);
  const table = tableOf(colours as ColourMapName);
  return ([position]) => {
    const entry = 3 * Math.round(Math.min(Math.max(position, 0), 1) * (TABLE_SIZE - 1));
    return table.subarray(entry, entry + 3);
  };
}

/** Paints the sky into a picture of `pixelsPerCssPx` device pixels a CSS pixel. Outside the sky stays transparent. */
export function paintSky(
  picture: ImageData,
  grid: SkyGrid,
  look: PictureLook,
  projection: Projection,
  pixelsPerCssPx: number,
  landscape: Landscape | null = null,
): void {
  const shading = shadingOf(grid, look);
  const finished = finisher(shading, look.colours);
  const { data } = picture;
  for (let y = 0; y < picture.height; y++) {
    for (let x = 0; x < picture.width; x++) {
      const at = (y * picture.width + x) * 4;
      const direction = projection.directionFromPoint((x + 0.5) / pixelsPerCssPx, (y + 0.5) / pixelsPerCssPx);
      if (direction === null) continue;
      const { azimuthDeg, elevationDeg } = direction;
      const isGround = elevationDeg < Math.max(grid.horizonAt(azimuthDeg), 0);
      const colour = isGround
        ? (landscape?.rgbAt(direction) ?? shading.groundRgb)
        : finished(colourAt(grid, shading, azimuthDeg, elevationDeg));
      data.set(colour, at);
      data[at + 3] = 255;
    }
  }
}
