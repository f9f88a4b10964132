// The raw panorama of the API as luminance on its grid, and lookups in it.

import type { PanoramaAnswer } from "../api/types.ts";
import { words } from "../language/words.ts";
import { LUMINOUS_EFFICACY_LM_W, luminanceCdM2, NATURAL_SKY_CD_M2 } from "../photometry.ts";

/** Artificial light alone, or with the natural sky. */
export type SkyKind = "artificial" | "total";

/** One grid direction and what the sky shows there. */
export interface SkySample {
  azimuthDeg: number;
  elevationDeg: number;
  /** Artificial light, cd m⁻². */
  artificialCdM2: number;
  /** With the natural sky, cd m⁻². */
  totalCdM2: number;
  /** Whether terrain hides the sky there: both luminances are then 0. */
  isBelowHorizon: boolean;
}

/** The luminance of that light there, cd m⁻². */
export function luminanceOf({ artificialCdM2, totalCdM2 }: SkySample, kind: SkyKind): number {
  return kind === "total" ? totalCdM2 : artificialCdM2;
}

/** Luminance of the whole sky. Row 0 is lowest, column 0 looks north. */
export class SkyGrid {
  readonly azimuthCount: number;
  readonly elevationCount: number;
  readonly azimuthFirstDeg: number;
  readonly azimuthStepDeg: number;
  readonly elevationFirstDeg: number;
  readonly elevationStepDeg: number;
  /** Artificial luminance [row][column], cd m⁻². */
  readonly artificialCdM2: Float64Array;
  /** Artificial radiance [row][column] in R, G, B, W m⁻² sr⁻¹. */
  readonly artificialWM2Sr: readonly [Float32Array, Float32Array, Float32Array];
  /** Elevation of the terrain horizon in each column, degrees. Empty when the answer has none. */
  readonly horizonDeg: readonly number[];
  /** Luminance of the natural sky that is seen, cd m⁻²: nothing of it through clouds. */
  readonly naturalCdM2: number;

  constructor(answer: PanoramaAnswer) {
    const { grid, radiance } = answer;
    this.azimuthCount = grid.azimuth_count;
    this.elevationCount = grid.elevation_count;
    this.azimuthFirstDeg = grid.azimuth_first_deg;
    this.azimuthStepDeg = grid.azimuth_step_deg;
    this.elevationFirstDeg = grid.elevation_first_deg;
    this.elevationStepDeg = grid.elevation_step_deg;
    this.horizonDeg = answer.horizon_deg ?? [];
    this.naturalCdM2 = answer.clouds === "none" ? NATURAL_SKY_CD_M2 : 0;
    const [red, green, blue] = radiance;
    if (red?.length !== this.elevationCount || green?.length !== this.elevationCount || blue?.length !== this.elevationCount) {
      throw new Error(words().problems.panoramaRows(red?.length ?? 0, this.elevationCount));
    }
    this.artificialCdM2 = new Float64Array(this.azimuthCount * this.elevationCount);
    const band = (rows: readonly (readonly number[])[]) => {
      const values = new Float32Array(this.azimuthCount * this.elevationCount);
      for (const [i, row] of rows.entries()) values.set(row.slice(0, this.azimuthCount), i * this.azimuthCount);
      return values;
    };
    this.artificialWM2Sr = [band(red), band(green), band(blue)];
    for (let row = 0; row < this.elevationCount; row++) {
      for (let column = 0; column < this.azimuthCount; column++) {
        this.artificialCdM2[row * this.azimuthCount + column] = luminanceCdM2(
          red[row]?.[column] ?? 0,
          green[row]?.[column] ?? 0,
          blue[row]?.[column] ?? 0,
        );
      }
    }
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
    this.artificialCdM2.forEach((value, i) => {
      if (value > (this.artificialCdM2[brightest] ?? 0)) brightest = i;
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
    const artificialCdM2 = this.artificialCdM2[row * this.azimuthCount + column] ?? 0;
    const isBelowHorizon = this.isHidden(row, column);
    return {
      azimuthDeg: this.azimuthFirstDeg + column * this.azimuthStepDeg,
      elevationDeg: this.elevationFirstDeg + row * this.elevationStepDeg,
      artificialCdM2,
      totalCdM2: isBelowHorizon ? 0 : artificialCdM2 + this.naturalCdM2,
      isBelowHorizon,
    };
  }

  /**
   * log10 luminance for drawing, [row][column]; darkness counts as `floorCdM2`. Hidden samples take the lowest visible
   * one of their column, so that no darkness of the ground runs into the sky above it.
   */
  logLuminance(kind: SkyKind, floorCdM2: number): Float32Array {
    const added = kind === "total" ? this.naturalCdM2 : 0;
    return this.fillHidden(Float32Array.from(this.artificialCdM2, (value) => Math.log10(Math.max(value + added, floorCdM2))));
  }

  /** Radiance in R, G, B for drawing, [row][column], W m⁻² sr⁻¹; of hidden samples as above. The natural sky is white. */
  radianceWM2Sr(kind: SkyKind): readonly [Float32Array, Float32Array, Float32Array] {
    const whiteLmW = LUMINOUS_EFFICACY_LM_W.reduce((sum, efficacy) => sum + efficacy, 0);
    const added = kind === "total" ? this.naturalCdM2 / whiteLmW : 0;
    const [red, green, blue] = this.artificialWM2Sr;
    const shown = (band: Float32Array) => this.fillHidden(band.map((value) => value + added));
    return [shown(red), shown(green), shown(blue)];
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
