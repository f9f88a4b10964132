// Layers of cloud that the server has packs for.

import type { Atmosphere, SkyAnswer } from "../api/types.ts";
import { words } from "../language/words.ts";
import { fixed } from "./format.ts";

type Pack = Pick<Atmosphere, "cloud_base_m">;

/** The packs under a layer of cloud with that base; null: of a clear sky. */
export function packsUnder<P extends Pack>(packs: readonly P[], clouds: number | null): P[] {
  return packs.filter(({ cloud_base_m }) => (cloud_base_m ?? null) === clouds);
}

/** Cloud bases with a resident pack, metres, ascending. */
export function cloudBases(packs: readonly Pack[]): number[] {
  const bases = packs.map(({ cloud_base_m }) => cloud_base_m).filter((base) => base !== null && base !== undefined);
  return [...new Set(bases)].sort((a, b) => a - b);
}

/** What a choice of clouds is called; of a layer with gaps, with the share of it that is cloud, 0 to 1. */
export function cloudsTitle(clouds: number | null, cover = 1): string {
  const { noClouds, closedClouds, brokenClouds } = words().assumptions;
  if (clouds === null) return noClouds;
  return cover >= 1 ? closedClouds(clouds) : brokenClouds(clouds, coverTitle(100 * cover));
}

/** The clouds that an answer assumes. */
export function assumedClouds(answer: Pick<SkyAnswer, "clouds" | "cloud_cover">): string {
  return cloudsTitle(answer.clouds === "none" ? null : Number(answer.clouds), coverOf(answer.cloud_cover));
}

/** The share of a layer of cloud that is cloud, 0 to 1. */
export function coverOf(cover: number | null | undefined): number {
  return cover ?? 1;
}

/** A cover in per cent. */
export function coverTitle(percent: number): string {
  return `${fixed(percent, 0)} %`;
}
