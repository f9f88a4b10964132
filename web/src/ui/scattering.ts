// Orders of scattering: their titles, and the turbidities of the server's packs of each.

import type { ScatteringName } from "../api/client.ts";
import type { Atmosphere } from "../api/types.ts";
import { words } from "../language/words.ts";
import { SCATTERINGS } from "../state/view-state.ts";

export function scatteringTitle(scattering: string): string {
  const name = SCATTERINGS.find((known) => known === scattering);
  return name === undefined ? scattering : words().scatterings[name];
}

type Pack = Pick<Atmosphere, "turbidity" | "scattering">;

/** Scatterings with a resident pack, the best first: the default of a request. */
export function residentScatterings(packs: readonly Pack[]): ScatteringName[] {
  return SCATTERINGS.filter((name) => packs.some(({ scattering }) => scattering === name));
}

/** Smallest and largest turbidity of a scattering (null: the best); null without packs. */
export function turbidityRange(packs: readonly Pack[], scattering: ScatteringName | null): [min: number, max: number] | null {
  const name = scattering ?? residentScatterings(packs)[0];
  const values = packs.filter((pack) => pack.scattering === name).map(({ turbidity }) => turbidity);
  return values.length === 0 ? null : [Math.min(...values), Math.max(...values)];
}

/** A turbidity that the packs of a scattering reach; null, the server's default, stays so. */
export function clampTurbidity(packs: readonly Pack[], scattering: ScatteringName | null, turbidity: number | null): number | null {
  const range = turbidityRange(packs, scattering);
  return turbidity === null || range === null ? turbidity : Math.min(Math.max(turbidity, range[0]), range[1]);
}
