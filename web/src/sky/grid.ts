// What is seen of the sky on the grid of the API's panorama, and lookups in it.

import type { CompactPanorama, Disc, FourValues, PointLight } from "./compact.ts";
import { type Seen, seenFrom } from "./seen.ts";

/** Artificial light alone, or with the natural sky. */
export type SkyKind = "artificial" | "total";

/** One grid direction and what the sky shows there. */
export interface SkySample {
  azimuthDeg: number;
  elevationDeg: number;
  /** Of artificial light, in the unit of what sees it. */
  artificial: number;
  /** With the natural sky. */
  total: number;
  /** Whether terrain hides the sky there: both values are then 0. */
  isBelowHorizon: boolean;
}

/** The value of that light there. */
export function valueFor({ artificial, total }: SkySample, kind: SkyKind): number {
  return kind === "total" ? total : artificial;
}

/** Values over the grid, [row][column], and what adds to each. */
interface Layer {
  values: Float32Array;
  added: number;
}

/** What X, Y, Z and the dark-adapted eye see, in the order of `FourValues`. */
const EYE = ["cie_x", "photopic", "cie_z", "scotopic"] as const;
type OfEye = readonly [Layer, Layer, Layer, Layer];

/** Values of the whole sky. Row 0 is lowest, column 0 looks north. */
export class SkyGrid {
  readonly azimuthCount: number;
  readonly elevationCount: number;
  readonly azimuthFirstDeg: number;
  readonly azimuthStepDeg: number;
  readonly elevationFirstDeg: number;
  readonly elevationStepDeg: number;
  readonly seen: Seen;
  /** Elevation of the terrain horizon in each column, degrees. */
  readonly horizonDeg: readonly number[];
  /** Stars and planets that are seen, and Moon and Sun, where the sky is that of a time. */
  readonly points: readonly PointLight[];
  readonly discs: readonly Disc[];
  private readonly ofResponse: Record<SkyKind, Layer>;
  private readonly ofEye: Record<SkyKind, OfEye>;

  constructor({ grid, planes, horizon_deg, clouds, response, points, discs }: CompactPanorama) {
    this.azimuthCount = grid.azimuth_count;
    this.elevationCount = grid.elevation_count;
    this.azimuthFirstDeg = grid.azimuth_first_deg;
    this.azimuthStepDeg = grid.azimuth_step_deg;
    this.elevationFirstDeg = grid.elevation_first_deg;
    this.elevationStepDeg = grid.elevation_step_deg;
    this.horizonDeg = horizon_deg;
    this.points = points;
    this.discs = discs;
    const isClear = clouds === "none";
    const hasTime = planes.some(({ light }) => light === "total");
    const layer = (kind: SkyKind, name: string): Layer => {
      const light = hasTime ? kind : "artificial";
      const plane = planes.find((candidate) => candidate.light === light && candidate.response === name);
      // The sky of a time is in the planes already.
      const added = kind === "total" && isClear && !hasTime ? (plane?.natural ?? 0) : 0;
      return { values: plane?.values ?? new Float32Array(this.azimuthCount * this.elevationCount), added };
    };
    const both = <L>(make: (kind: SkyKind) => L) => ({ artificial: make("artificial"), total: make("total") });
    this.ofResponse = both((kind) => layer(kind, response.name));
    this.ofEye = both((kind) => EYE.map((name) => layer(kind, name)) as unknown as OfEye);
    const natural = planes.find(({ response: name }) => name === response.name)?.natural ?? 0;
    this.seen = seenFrom(response, natural);
  }

  /** What the eye sees at a sample of the grid. */
  eyeAt(kind: SkyKind, sample: number): FourValues {
    const [x, photopic, z, scotopic] = this.ofEye[kind];
    const value = ({ values, added }: Layer) => (values[sample] ?? 0) + added;
    return [value(x), value(photopic), value(z), value(scotopic)];
  }

  /** Between samples of four numbers each, in any direction. */
  between(samples: Float32Array, azimuthDeg: number, elevationDeg: number): FourValues {
    const { azimuthCount, elevationCount } = this;
    const across = (azimuthDeg - this.azimuthFirstDeg) / this.azimuthStepDeg + azimuthCount;
    const up = Math.min(Math.max((elevationDeg - this.elevationFirstDeg) / this.elevationStepDeg, 0), elevationCount - 1);
    const [left, low] = [Math.floor(across), Math.min(Math.floor(up), elevationCount - 2)];
    const [right, above] = [across - left, up - low];
    const at = (row: number, column: number, i: number) => samples[4 * (row * azimuthCount + (column % azimuthCount)) + i] ?? 0;
    const value = (i: number) =>
      (1 - above) * ((1 - right) * at(low, left, i) + right * at(low, left + 1, i)) +
      above * ((1 - right) * at(low + 1, left, i) + right * at(low + 1, left + 1, i));
    return [value(0), value(1), value(2), value(3)];
  }

  /** What is seen at a sample of the grid, where no ground hides it. */
  valueAt(kind: SkyKind, sample: number): number {
    const { values, added } = this.ofResponse[kind];
    return (values[sample] ?? 0) + added;
  }

  /** Whether terrain hides a sample of the grid. */
  isHidden(row: number, column: number): boolean {
    return this.elevationFirstDeg + row * this.elevationStepDeg < (this.horizonDeg[column] ?? 0);
  }

  /** Elevation of the terrain horizon at any azimuth, degrees: linear between the columns, 0 where there is none. */
  horizonAt(azimuthDeg: number): number {
    if (this.horizonDeg.length === 0) return 0;
    const across = (azimuthDeg - this.azimuthFirstDeg) / this.azimuthStepDeg;
    const left = Math.floor(across);
    const wrapped = (column: number) => ((column % this.azimuthCount) + this.azimuthCount) % this.azimuthCount;
    const low = this.horizonDeg[wrapped(left)] ?? 0;
    return low + (across - left) * ((this.horizonDeg[wrapped(left + 1)] ?? 0) - low);
  }

  /** The direction of the brightest visible sample of artificial light. */
  brightest(): SkySample {
    const { values } = this.ofResponse.artificial;
    let [brightest, most] = [0, -1];
    for (let row = 0; row < this.elevationCount; row++) {
      for (let column = 0; column < this.azimuthCount; column++) {
        const value = values[row * this.azimuthCount + column] ?? 0;
        if (value > most && !this.isHidden(row, column)) [brightest, most] = [row * this.azimuthCount + column, value];
      }
    }
    const column = brightest % this.azimuthCount;
    const row = (brightest - column) / this.azimuthCount;
    return this.nearest(this.azimuthFirstDeg + column * this.azimuthStepDeg, this.elevationFirstDeg + row * this.elevationStepDeg);
  }

  /** The sample nearest to a direction: the API's value, nothing interpolated. */
  nearest(azimuthDeg: number, elevationDeg: number): SkySample {
    const turn = Math.round((azimuthDeg - this.azimuthFirstDeg) / this.azimuthStepDeg);
    const column = ((turn % this.azimuthCount) + this.azimuthCount) % this.azimuthCount;
    const step = Math.round((elevationDeg - this.elevationFirstDeg) / this.elevationStepDeg);
    const row = Math.min(Math.max(step, 0), this.elevationCount - 1);
    const sample = row * this.azimuthCount + column;
    const isBelowHorizon = this.isHidden(row, column);
    return {
      azimuthDeg: this.azimuthFirstDeg + column * this.azimuthStepDeg,
      elevationDeg: this.elevationFirstDeg + row * this.elevationStepDeg,
      artificial: isBelowHorizon ? 0 : this.valueAt("artificial", sample),
      total: isBelowHorizon ? 0 : this.valueAt("total", sample),
      isBelowHorizon,
    };
  }
}
