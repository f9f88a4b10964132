// Light that the eye scatters over what it looks at: the general disability glare equation (CIE 146:2002; Vos 2003), which is Stiles and
// Holladay's 10/θ² at middle angles. The server's `glare` is the authority.

import type { Disc, FourValues } from "./compact.ts";
import type { SkyGrid, SkyKind } from "./grid.ts";
import { vectorFromDirection } from "./projection.ts";
import { angleDeg } from "./region.ts";

const RADIANS = Math.PI / 180;
/** Of the observer, and the pigment of brown to green eyes. */
const AGE_YEARS = 30;
const PIGMENT = 0.5;
const AGEING = 1 + (AGE_YEARS / 62.5) ** 4;
/** The sky is its own veil within this: it is summed over cells of 4 × 4 samples. */
const CELL_SAMPLES = 4;
const NEAREST_CELL_DEG = 4;
/** Nearer to Moon and Sun than this their veil is found for every pixel; samples of the grid have that of this angle. */
export const HALO_DEG = 5;
/** The equation holds from here on. */
const LEAST_DEG = 0.1;

/** Luminance of the veil over illuminance at the eye, sr⁻¹, at an angle from a light. */
export function veilPerLx(angle: number): number {
  const theta = Math.max(angle, LEAST_DEG);
  return 10 / theta ** 3 + (5 / theta ** 2 + (0.1 * PIGMENT) / theta) * AGEING + 0.0025 * PIGMENT;
}

/** The same of the illuminance of a surface that faces the light. */
function veilFacing(angle: number): number {
  return veilPerLx(angle) * Math.max(Math.cos(angle * RADIANS), 0);
}

/** Illuminance that a disc gives a surface which faces it, as X, Y, Z and scotopic, lx. */
export function illuminanceOf({ lit_cd_m2: lit, dark_cd_m2: dark, lit_share: share, radius_deg: radius }: Disc): FourValues {
  const solidAngle = Math.PI * (radius * RADIANS) ** 2;
  const of = (i: number) => solidAngle * (share * (lit[i] ?? 0) + (1 - share) * (dark[i] ?? 0));
  return [of(0), of(1), of(2), of(3)];
}

/** What an eye makes of a whole sky before it looks at a part. */
export interface Glare {
  /** Mean luminance of the sky, which the eye adapts to. */
  meanCdM2: number;
  /** X, Y, Z and scotopic luminance of the veil over each sample. */
  veil: Float32Array;
}

const known = new WeakMap<SkyGrid, Partial<Record<SkyKind, Glare>>>();

export function glareOf(grid: SkyGrid, kind: SkyKind): Glare {
  const kinds = known.get(grid) ?? {};
  known.set(grid, kinds);
  const made = kinds[kind] ?? compute(grid, kind);
  kinds[kind] = made;
  return made;
}

function compute(grid: SkyGrid, kind: SkyKind): Glare {
  const { azimuthCount, elevationCount } = grid;
  const across = azimuthCount / CELL_SAMPLES;
  const up = elevationCount / CELL_SAMPLES;
  const flux = new Float64Array(4 * across * up);
  let sum = 0;
  for (let row = 0; row < elevationCount; row++) {
    const solidAngle = solidAngleOf(grid, row);
    for (let column = 0; column < azimuthCount; column++) {
      const light = grid.eyeAt(kind, row * azimuthCount + column);
      const cell = 4 * (Math.floor(row / CELL_SAMPLES) * across + Math.floor(column / CELL_SAMPLES));
      for (let i = 0; i < 4; i++) flux[cell + i] = (flux[cell + i] ?? 0) + solidAngle * (light[i] ?? 0);
      sum += solidAngle * light[1];
    }
  }
  const coarse = veilOfCells(grid, flux, across, up);
  const veil = new Float32Array(4 * azimuthCount * elevationCount);
  const bodies = kind === "total" ? bodiesOf(grid) : [];
  for (let row = 0; row < elevationCount; row++) {
    for (let column = 0; column < azimuthCount; column++) {
      const at = 4 * (row * azimuthCount + column);
      veil.set(between(coarse, [column, row], across, up), at);
      const direction = {
        azimuthDeg: grid.azimuthFirstDeg + column * grid.azimuthStepDeg,
        elevationDeg: grid.elevationFirstDeg + row * grid.elevationStepDeg,
      };
      for (const { where, illuminance } of bodies) {
        const part = veilFacing(Math.max(angleDeg(direction, where), HALO_DEG));
        for (let i = 0; i < 4; i++) veil[at + i] = (veil[at + i] ?? 0) + part * (illuminance[i] ?? 0);
      }
    }
  }
  return { meanCdM2: sum / (2 * Math.PI), veil };
}

/** Moon and Sun that no ground hides. */
export function bodiesOf(grid: SkyGrid) {
  return grid.discs
    .filter((disc) => disc.elevation_deg >= Math.max(grid.horizonAt(disc.azimuth_deg), 0))
    .map((disc) => ({
      where: { azimuthDeg: disc.azimuth_deg, elevationDeg: disc.elevation_deg },
      illuminance: illuminanceOf(disc),
    }));
}

function solidAngleOf({ elevationStepDeg, azimuthStepDeg }: SkyGrid, row: number): number {
  const [low, high] = [row, row + 1].map((edge) => Math.sin(edge * elevationStepDeg * RADIANS)) as [number, number];
  return azimuthStepDeg * RADIANS * (high - low);
}

/** The veil over the middle of every cell. */
function veilOfCells(grid: SkyGrid, flux: Float64Array, across: number, up: number): Float64Array {
  const vector = (row: number, column: number) =>
    vectorFromDirection({
      azimuthDeg: column * CELL_SAMPLES * grid.azimuthStepDeg,
      elevationDeg: (row + 0.5) * CELL_SAMPLES * grid.elevationStepDeg,
    });
  const veil = new Float64Array(flux.length);
  const kernel = new Float64Array(across);
  for (let to = 0; to < up; to++) {
    const [x, y, z] = vector(to, 0);
    for (let from = 0; from < up; from++) {
      for (let turn = 0; turn < across; turn++) {
        const [east, north, height] = vector(from, turn);
        const cosine = Math.min(Math.max(x * east + y * north + z * height, -1), 1);
        kernel[turn] = veilFacing(Math.max(Math.acos(cosine) / RADIANS, NEAREST_CELL_DEG));
      }
      for (let column = 0; column < across; column++) {
        const at = 4 * (to * across + column);
        for (let turn = 0; turn < across; turn++) {
          const part = kernel[turn] ?? 0;
          const source = 4 * (from * across + ((column + turn) % across));
          for (let i = 0; i < 4; i++) veil[at + i] = (veil[at + i] ?? 0) + part * (flux[source + i] ?? 0);
        }
      }
    }
  }
  return veil;
}

/** Between the middles of the cells, by bilinear interpolation; the highest and the lowest hold beyond. */
function between(cells: Float64Array, [column, row]: readonly [number, number], across: number, up: number): FourValues {
  const x = (column + 0.5) / CELL_SAMPLES - 0.5 + across;
  const y = Math.min(Math.max((row + 0.5) / CELL_SAMPLES - 0.5, 0), up - 1);
  const [left, low] = [Math.floor(x), Math.min(Math.floor(y), up - 2)];
  const [right, above] = [x - left, y - low];
  const cell = (rowAt: number, columnAt: number, i: number) => cells[4 * (rowAt * across + (columnAt % across)) + i] ?? 0;
  const value = (i: number) =>
    (1 - above) * ((1 - right) * cell(low, left, i) + right * cell(low, left + 1, i)) +
    above * ((1 - right) * cell(low + 1, left, i) + right * cell(low + 1, left + 1, i));
  return [value(0), value(1), value(2), value(3)];
}
