// The sky as pixels: the grid's logarithmic luminance, interpolated bilinearly, through a colour table.

import { colour_table, type ColourMapName } from "./colour_maps.ts";
import type { SkyGrid, SkyKind } from "./grid.ts";
import type { Projection } from "./projection.ts";
import { log_luminance_ends, SCALE } from "./scale.ts";

const TABLE_SIZE = 1024;
const DARKEST_CD_M2 = 1e-9;
/** Ground that hides the sky: brown-grey, as in the server's pictures. */
export const GROUND_RGB = [58, 54, 49] as const;

/** The grid in scale units 0..1 with one row added below (the horizon) and one above (the zenith). */
function padded_scale_values(grid: SkyGrid, kind: SkyKind): Float32Array {
  const [faintest, brightest] = log_luminance_ends(SCALE);
  const log_luminance = grid.log_luminance(kind, DARKEST_CD_M2);
  const width = grid.azimuth_count;
  const rows = grid.elevation_count;
  const values = new Float32Array((rows + 2) * width);
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < width; column++) {
      values[(row + 1) * width + column] =
        ((log_luminance[row * width + column] ?? 0) - faintest) / (brightest - faintest);
    }
  }
  values.copyWithin(0, width, 2 * width);
  // All azimuths meet at the zenith: one value, the mean of the highest ring.
  let zenith = 0;
  for (let column = 0; column < width; column++) zenith += (values[rows * width + column] ?? 0) / width;
  values.fill(zenith, (rows + 1) * width);
  return values;
}

/** Paints the sky into a picture of `scale` device pixels a CSS pixel. Outside the sky stays transparent. */
export function paint_sky(
  picture: ImageData,
  grid: SkyGrid,
  kind: SkyKind,
  map: ColourMapName,
  projection: Projection,
  pixels_per_css_px: number,
): void {
  const values = padded_scale_values(grid, kind);
  const table = colour_table(map, TABLE_SIZE);
  const width = grid.azimuth_count;
  const last_row = grid.elevation_count + 1;
  const { data } = picture;
  const has_ground = grid.horizon_deg.some((elevation_deg) => elevation_deg > 0);
  for (let y = 0; y < picture.height; y++) {
    for (let x = 0; x < picture.width; x++) {
      const at = (y * picture.width + x) * 4;
      const direction = projection.direction_from_point((x + 0.5) / pixels_per_css_px, (y + 0.5) / pixels_per_css_px);
      if (direction === null) {
        data[at + 3] = 0;
        continue;
      }
      if (direction.elevation_deg < (has_ground ? grid.horizon_at(direction.azimuth_deg) : 0)) {
        [data[at], data[at + 1], data[at + 2], data[at + 3]] = [...GROUND_RGB, 255];
        continue;
      }
      const across = (direction.azimuth_deg - grid.azimuth_first_deg) / grid.azimuth_step_deg + width;
      const up = Math.min(Math.max((direction.elevation_deg - grid.elevation_first_deg) / grid.elevation_step_deg + 1, 0), last_row - 1e-6);
      const column = Math.floor(across);
      const row = Math.floor(up);
      const right = across - column;
      const above = up - row;
      const low = row * width;
      const high = low + width;
      const here = column % width;
      const next = (column + 1) % width;
      const value =
        (1 - above) * ((1 - right) * (values[low + here] ?? 0) + right * (values[low + next] ?? 0)) +
        above * ((1 - right) * (values[high + here] ?? 0) + right * (values[high + next] ?? 0));
      const colour = Math.round(Math.min(Math.max(value, 0), 1) * (TABLE_SIZE - 1)) * 3;
      data[at] = table[colour] ?? 0;
      data[at + 1] = table[colour + 1] ?? 0;
      data[at + 2] = table[colour + 2] ?? 0;
      data[at + 3] = 255;
    }
  }
}
