// Light that the eye scatters over what it looks at: the general disability glare equation (CIE 146:2002; Vos 2003), which is Stiles and
// Holladay's 10/θ² at middle angles. The server's `glare` is the authority.

import type { Disc, FourValues } from "./compact.ts";
import type { SkyGrid, SkyKind } from "./grid.ts";
import { type SkyDirection, vectorFromDirection } from "./projection.ts";

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
      for (let i = 0; i < 4; i++) flux[cell + i] = (flux[cell + i] as number) + solidAngle * (light[i] as number);
      sum += solidAngle * light[1];
    }
  }
  const veil = betweenCells(veilOfCells(flux, across, up), across, up);
  if (kind === "total") for (const body of bodiesOf(grid)) addVeilOf(veil, grid, body);
  return { meanCdM2: sum / (2 * Math.PI), veil };
}

interface Body {
  where: SkyDirection;
  illuminance: FourValues;
}

/** Adds what a body veils to every sample. */
function addVeilOf(veil: Float32Array, grid: SkyGrid, { where, illuminance }: Body): void {
  const [x, y, z] = vectorFromDirection(where);
  for (let row = 0; row < grid.elevationCount; row++) {
    const elevation = (grid.elevationFirstDeg + row * grid.elevationStepDeg) * RADIANS;
    const [flat, height] = [Math.cos(elevation), Math.sin(elevation)];
    for (let column = 0; column < grid.azimuthCount; column++) {
      const azimuth = (grid.azimuthFirstDeg + column * grid.azimuthStepDeg) * RADIANS;
      const cosine = flat * (Math.sin(azimuth) * x + Math.cos(azimuth) * y) + height * z;
      const part = veilFacing(Math.max(Math.acos(Math.min(cosine, 1)) / RADIANS, HALO_DEG));
      const at = 4 * (row * grid.azimuthCount + column);
      for (let i = 0; i < 4; i++) veil[at + i] = (veil[at + i] as number) + part * (illuminance[i] as number);
    }
  }
}

/** Moon and Sun that no ground hides. */
function bodiesOf(grid: SkyGrid): Body[] {
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

/** What a cell sends to another, by their rows and how many cells of azimuth are between them; made once. */
let kernel: { across: number; up: number; parts: Float64Array } | null = null;

function kernelOf(across: number, up: number): Float64Array {
  if (kernel?.across === across && kernel.up === up) return kernel.parts;
  const parts = new Float64Array(up * up * across);
  const elevation = (row: number) => ((row + 0.5) / up) * (Math.PI / 2);
  for (let to = 0; to < up; to++) {
    for (let from = 0; from < up; from++) {
      const sines = Math.sin(elevation(to)) * Math.sin(elevation(from));
      const cosines = Math.cos(elevation(to)) * Math.cos(elevation(from));
      for (let turn = 0; turn < across; turn++) {
        const cosine = sines + cosines * Math.cos((turn / across) * 2 * Math.PI);
        const angle = Math.acos(Math.min(Math.max(cosine, -1), 1)) / RADIANS;
        parts[(to * up + from) * across + turn] = veilFacing(Math.max(angle, NEAREST_CELL_DEG));
      }
    }
  }
  kernel = { across, up, parts };
  return parts;
}

/** The veil over the middle of every cell. */
function veilOfCells(flux: Float64Array, across: number, up: number): Float64Array {
  const parts = kernelOf(across, up);
  const veil = new Float64Array(flux.length);
  for (let to = 0; to < up; to++) {
    for (let from = 0; from < up; from++) {
      const row = (to * up + from) * across;
      for (let column = 0; column < across; column++) {
        let [x, y, z, scotopic] = [0, 0, 0, 0];
        for (let turn = 0; turn < across; turn++) {
          const part = parts[row + turn] as number;
          const source = 4 * (from * across + ((column + turn) % across));
          x += part * (flux[source] as number);
          y += part * (flux[source + 1] as number);
          z += part * (flux[source + 2] as number);
          scotopic += part * (flux[source + 3] as number);
        }
        const at = 4 * (to * across + column);
        veil[at] = (veil[at] as number) + x;
        veil[at + 1] = (veil[at + 1] as number) + y;
        veil[at + 2] = (veil[at + 2] as number) + z;
        veil[at + 3] = (veil[at + 3] as number) + scotopic;
      }
    }
  }
  return veil;
}

/** Samples between the middles of the cells, by bilinear interpolation; the highest and the lowest cells hold beyond. */
function betweenCells(cells: Float64Array, across: number, up: number): Float32Array {
  const width = across * CELL_SAMPLES;
  const veil = new Float32Array(4 * width * up * CELL_SAMPLES);
  for (let row = 0; row < up * CELL_SAMPLES; row++) {
    const y = Math.min(Math.max((row + 0.5) / CELL_SAMPLES - 0.5, 0), up - 1);
    const low = Math.min(Math.floor(y), up - 2);
    for (let column = 0; column < width; column++) {
      const x = (column + 0.5) / CELL_SAMPLES - 0.5 + across;
      const left = Math.floor(x);
      const [right, above] = [x - left, y - low];
      const a = 4 * (low * across + (left % across));
      const b = 4 * (low * across + ((left + 1) % across));
      for (let i = 0; i < 4; i++) {
        const [nearLeft, nearRight] = [cells[a + i] as number, cells[b + i] as number];
        const [farLeft, farRight] = [cells[a + 4 * across + i] as number, cells[b + 4 * across + i] as number];
        veil[4 * (row * width + column) + i] =
          (1 - above) * ((1 - right) * nearLeft + right * nearRight) + above * ((1 - right) * farLeft + right * farRight);
      }
    }
  }
  return veil;
}
