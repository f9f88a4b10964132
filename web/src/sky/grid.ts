// The raw panorama of the API as luminance on its grid, and lookups in it.

import type { PanoramaAnswer } from "../api/types.ts";
import { words } from "../language/words.ts";
import { LUMINOUS_EFFICACY_LM_W, luminance_cd_m2, NATURAL_SKY_CD_M2 } from "../photometry.ts";

/** Artificial light alone, or with the natural sky. */
export type SkyKind = "artificial" | "total";

/** One grid direction and what the sky shows there. */
export interface SkySample {
  azimuth_deg: number;
  elevation_deg: number;
  /** Artificial light, cd m⁻². */
  artificial_cd_m2: number;
  /** With the natural sky, cd m⁻². */
  total_cd_m2: number;
  /** Whether terrain hides the sky there: both luminances are then 0. */
  is_below_horizon: boolean;
}

/** Luminance of the whole sky. Row 0 is lowest, column 0 looks north. */
export class SkyGrid {
  readonly azimuth_count: number;
  readonly elevation_count: number;
  readonly azimuth_first_deg: number;
  readonly azimuth_step_deg: number;
  readonly elevation_first_deg: number;
  readonly elevation_step_deg: number;
  /** Artificial luminance [row][column], cd m⁻². */
  readonly artificial_cd_m2: Float64Array;
  /** Artificial radiance [row][column] in R, G, B, W m⁻² sr⁻¹. */
  readonly artificial_w_m2_sr: readonly [Float32Array, Float32Array, Float32Array];
  /** Elevation of the terrain horizon in each column, degrees. Empty when the answer has none. */
  readonly horizon_deg: readonly number[];
  /** Luminance of the natural sky that is seen, cd m⁻²: nothing of it through clouds. */
  readonly natural_cd_m2: number;

  constructor(answer: PanoramaAnswer) {
    const { grid, radiance } = answer;
    this.azimuth_count = grid.azimuth_count;
    this.elevation_count = grid.elevation_count;
    this.azimuth_first_deg = grid.azimuth_first_deg;
    this.azimuth_step_deg = grid.azimuth_step_deg;
    this.elevation_first_deg = grid.elevation_first_deg;
    this.elevation_step_deg = grid.elevation_step_deg;
    this.horizon_deg = answer.horizon_deg ?? [];
    this.natural_cd_m2 = answer.clouds === "none" ? NATURAL_SKY_CD_M2 : 0;
    const [red, green, blue] = radiance;
    if (red?.length !== this.elevation_count || green?.length !== this.elevation_count || blue?.length !== this.elevation_count) {
      throw new Error(words().problems.panorama_rows(red?.length ?? 0, this.elevation_count));
    }
    this.artificial_cd_m2 = new Float64Array(this.azimuth_count * this.elevation_count);
    const band = (rows: readonly (readonly number[])[]) => {
      const values = new Float32Array(this.azimuth_count * this.elevation_count);
      rows.forEach((row, i) => values.set(row.slice(0, this.azimuth_count), i * this.azimuth_count));
      return values;
    };
    this.artificial_w_m2_sr = [band(red), band(green), band(blue)];
    for (let row = 0; row < this.elevation_count; row++) {
      for (let column = 0; column < this.azimuth_count; column++) {
        this.artificial_cd_m2[row * this.azimuth_count + column] = luminance_cd_m2(
          red[row]?.[column] ?? 0,
          green[row]?.[column] ?? 0,
          blue[row]?.[column] ?? 0,
        );
      }
    }
  }

  /** Whether terrain hides a sample of the grid. */
  is_hidden(row: number, column: number): boolean {
    return this.elevation_first_deg + row * this.elevation_step_deg < (this.horizon_deg[column] ?? 0);
  }

  /** Elevation of the terrain horizon at any azimuth, degrees: linear between the columns, 0 where there is none. */
  horizon_at(azimuth_deg: number): number {
    if (this.horizon_deg.length === 0) return 0;
    const across = (azimuth_deg - this.azimuth_first_deg) / this.azimuth_step_deg;
    const left = Math.floor(across);
    const wrapped = (column: number) => ((column % this.azimuth_count) + this.azimuth_count) % this.azimuth_count;
    const low = this.horizon_deg[wrapped(left)] ?? 0;
    return low + (across - left) * ((this.horizon_deg[wrapped(left + 1)] ?? 0) - low);
  }

  /** The direction of the brightest sample. */
  brightest(): SkySample {
    let most = 0;
    this.artificial_cd_m2.forEach((value, i) => {
      if (value > (this.artificial_cd_m2[most] ?? 0)) most = i;
    });
    const column = most % this.azimuth_count;
    const row = (most - column) / this.azimuth_count;
    return this.nearest(this.azimuth_first_deg + column * this.azimuth_step_deg, this.elevation_first_deg + row * this.elevation_step_deg);
  }

  /** The sample nearest to a direction: exactly the API's value, nothing interpolated. */
  nearest(azimuth_deg: number, elevation_deg: number): SkySample {
    const turn = Math.round((azimuth_deg - this.azimuth_first_deg) / this.azimuth_step_deg);
    const column = ((turn % this.azimuth_count) + this.azimuth_count) % this.azimuth_count;
    const step = Math.round((elevation_deg - this.elevation_first_deg) / this.elevation_step_deg);
    const row = Math.min(Math.max(step, 0), this.elevation_count - 1);
    const artificial_cd_m2 = this.artificial_cd_m2[row * this.azimuth_count + column] ?? 0;
    const is_below_horizon = this.is_hidden(row, column);
    return {
      azimuth_deg: this.azimuth_first_deg + column * this.azimuth_step_deg,
      elevation_deg: this.elevation_first_deg + row * this.elevation_step_deg,
      artificial_cd_m2,
      total_cd_m2: is_below_horizon ? 0 : artificial_cd_m2 + this.natural_cd_m2,
      is_below_horizon,
    };
  }

  /**
   * log10 luminance for drawing, [row][column]; darkness counts as `floor_cd_m2`. Hidden samples take the lowest visible
   * one of their column, so that no darkness of the ground runs into the sky above it.
   */
  log_luminance(kind: SkyKind, floor_cd_m2: number): Float32Array {
    const added = kind === "total" ? this.natural_cd_m2 : 0;
    return this.fill_hidden(Float32Array.from(this.artificial_cd_m2, (value) => Math.log10(Math.max(value + added, floor_cd_m2))));
  }

  /** Radiance in R, G, B for drawing, [row][column], W m⁻² sr⁻¹; of hidden samples as above. The natural sky is white. */
  radiance_w_m2_sr(kind: SkyKind): readonly [Float32Array, Float32Array, Float32Array] {
    const white_lm_w = LUMINOUS_EFFICACY_LM_W.reduce((sum, efficacy) => sum + efficacy, 0);
    const added = kind === "total" ? this.natural_cd_m2 / white_lm_w : 0;
    const [red, green, blue] = this.artificial_w_m2_sr;
    const shown = (band: Float32Array) => this.fill_hidden(band.map((value) => value + added));
    return [shown(red), shown(green), shown(blue)];
  }

  private fill_hidden(values: Float32Array): Float32Array {
    for (let column = 0; column < this.azimuth_count; column++) {
      let lowest = 0;
      while (lowest < this.elevation_count && this.is_hidden(lowest, column)) lowest++;
      const value = values[lowest * this.azimuth_count + column];
      for (let row = 0; value !== undefined && row < lowest; row++) values[row * this.azimuth_count + column] = value;
    }
    return values;
  }
}
