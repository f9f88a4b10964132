// Layers of cloud that the server has packs for.

import type { Atmosphere } from "../api/types.ts";
import { words } from "../language/words.ts";

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

/** What a choice of clouds is called. */
export function cloudsTitle(clouds: number | null): string {
  return clouds === null ? words().assumptions.noClouds : words().assumptions.closedClouds(clouds);
}
