// The lamps and emission patterns that the server knows by name.

import { words } from "../language/words.ts";

type Named = [name: string, title: string];

export function lamps(): Named[] {
  return Object.entries(words().lamps);
}

export function emissions(): Named[] {
  return Object.entries(words().emissions);
}

/** Shares of the lamps' light that the server's named emissions mean: directly above the horizon, and sent back by the ground. */
const SHARES: Readonly<Record<string, readonly [directUplight: number, groundReflectance: number]>> = {
  modern_city: [0.02, 0.15],
  garstang_1986: [0.15, 0.15],
  full_cutoff: [0, 0.15],
};

/** null for what follows from no shares: weights of lobes. */
export function sharesOf(emission: string): readonly [directUplight: number, groundReflectance: number] | null {
  return SHARES[emission] ?? null;
}

export function lampTitle(lamp: string): string {
  return lamps().find(([name]) => name === lamp)?.[1] ?? words().assumptions.ownFluxes(lamp);
}

/** Components of the server's mixture. */
const MIXTURE: readonly string[] = ["hps", "led_4000k"];

/** Presets that an assumed lamp consists of; none for custom fluxes. */
export function lampsIn(assumed: string): readonly string[] {
  if (assumed === "mixed") return MIXTURE;
  return lamps().some(([name]) => name === assumed) ? [assumed] : [];
}
