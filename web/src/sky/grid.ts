// What is seen of the sky on the grid of the API's panorama, and lookups in it.

import type { PanoramaAnswer } from "../api/types.ts";
import { words } from "../language/words.ts";
import { NATURAL_SKY_CD_M2 } from "../photometry.ts";
import { NO_TINT, type Tint, tintOf } from "./realistic.ts";
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

/** Values of the whole sky. Row 0 is lowest, column 0 looks north. */
export class SkyGrid {
  readonly azimuthCount: number;
  readonly elevationCount: number;
  readonly azimuthFirstDeg: number;
  readonly azimuthStepDeg: number;
  readonly elevationFirstDeg: number;
  readonly elevationStepDeg: number;
  readonly seen: Seen;
  /** Values of artificial light [row][column], in the unit of what sees it. */
  readonly artificial: Float64Array;
  /** Artificial radiance [row][column] in R, G, B, W m⁻² sr⁻¹. */
  readonly artificialWM2Sr: readonly [Float32Array, Float32Array, Float32Array];
  /** Elevation of the terrain horizon in each column, degrees. Empty when the answer has none. */
  readonly horizonDeg: readonly number[];
  /** What the natural sky adds to them: nothing through clouds. */
  readonly natural: number;
  /** Luminance of the natural sky that is there, cd m⁻². */
  readonly naturalCdM2: number;
  /** How lamps differ in colour from what the bands say. */
  readonly tint: Tint;

  constructor(answer: PanoramaAnswer) {
    const { grid, radiance, values } = answer;
    this.azimuthCount = grid.azimuth_count;
    this.elevationCount = grid.elevation_count;
    this.azimuthFirstDeg = grid.azimuth_first_deg;
    this.azimuthStepDeg = grid.azimuth_step_deg;
    this.elevationFirstDeg = grid.elevation_first_deg;
    this.elevationStepDeg = grid.elevation_step_deg;
    this.horizonDeg = answer.horizon_deg ?? [];
    this.seen = seenFrom(answer);
    this.natural = answer.clouds === "none" ? (this.seen.natural ?? 0) : 0;
    this.naturalCdM2 = answer.clouds === "none" ? NATURAL_SKY_CD_M2 : 0;
    const { zenith_radiance_w_m2_sr, zenith_luminance_cd_m2, zenith_chromaticity } = answer.sky;
    this.tint =
      zenith_chromaticity == null ? NO_TINT : tintOf(zenith_radiance_w_m2_sr, zenith_luminance_cd_m2, zenith_chromaticity);
    const [red = [], green = [], blue = []] = radiance;
    for (const { length } of [values, red, green, blue]) {
      if (length !== this.elevationCount) throw new Error(words().problems.panoramaRows(length, this.elevationCount));
    }
    this.artificial = new Float64Array(this.azimuthCount * this.elevationCount);
    for (const [i, row] of values.entries()) this.artificial.set(row.slice(0, this.azimuthCount), i * this.azimuthCount);
    const band = (rows: readonly (readonly number[])[]) => {
      const values = new Float32Array(this.azimuthCount * this.elevationCount);
      for (const [i, row] of rows.entries()) values.set(row.slice(0, this.azimuthCount), i * this.azimuthCount);
      return values;
    };
    this.artificialWM2Sr = [band(red), band(green), band(blue)];
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

  /** The direction of the brightest sample. */
  brightest(): SkySample {
    let brightest = 0;
    this.artificial.forEach((value, i) => {
      if (value > (this.artificial[brightest] ?? 0)) brightest = i;
    });
    const column = brightest % this.azimuthCount;
    const row = (brightest - column) / this.azimuthCount;
    return this.nearest(this.azimuthFirstDeg + column * this.azimuthStepDeg, this.elevationFirstDeg + row * this.elevationStepDeg);
  }

  /** The sample nearest to a direction: exactly the API's value, nothing interpolated. */
  nearest(azimuthDeg: number, elevationDeg: number): SkySample {
    const turn = Math.round((azimuthDeg - this.azimuthFirstDeg) / this.azimuthStepDeg);
    const column = ((turn % this.azimuthCount) + this.azimuthCount) % this.azimuthCount;
    const step = Math.round((elevationDeg - this.elevationFirstDeg) / this.elevationStepDeg);
    const row = Math.min(Math.max(step, 0), this.elevationCount - 1);
    const artificial = this.artificial[row * this.azimuthCount + column] ?? 0;
    const isBelowHorizon = this.isHidden(row, column);
    return {
      azimuthDeg: this.azimuthFirstDeg + column * this.azimuthStepDeg,
      elevationDeg: this.elevationFirstDeg + row * this.elevationStepDeg,
      artificial,
      total: isBelowHorizon ? 0 : artificial + this.natural,
      isBelowHorizon,
    };
  }

  /**
   * log10 of the values for drawing, [row][column]; darkness counts as `floor`. Hidden samples take the lowest visible
   * one of their column, so that no darkness of the ground runs into the sky above it.
   */
  logValues(kind: SkyKind, floor: number): Float32Array {
    const added = kind === "total" ? this.natural : 0;
    return this.fillHidden(Float32Array.from(this.artificial, (value) => Math.log10(Math.max(value + added, floor))));
  }

  /** Radiance of artificial light in R, G, B for drawing, [row][column], W m⁻² sr⁻¹; of hidden samples as above. */
  radianceWM2Sr(): readonly [Float32Array, Float32Array, Float32Array] {
    const [red, green, blue] = this.artificialWM2Sr;
    return [this.fillHidden(red.slice()), this.fillHidden(green.slice()), this.fillHidden(blue.slice())];
  }

  private fillHidden(values: Float32Array): Float32Array {
    for (let column = 0; column < this.azimuthCount; column++) {
      let lowest = 0;
      while (lowest < this.elevationCount && this.isHidden(lowest, column)) lowest++;
      const value = values[lowest * this.azimuthCount + column];
      for (let row = 0; value !== undefined && row < lowest; row++) values[row * this.azimuthCount + column] = value;
    }
    return values;
  }
}
