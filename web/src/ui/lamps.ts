// The lamps and emission patterns that the server knows by name.

import { words } from "../language/words.ts";
import type { ChoiceGroup } from "./select.ts";

type Named = [name: string, title: string];
type LampName = keyof ReturnType<typeof words>["lamps"];

/**
 * Lamps with the colour temperatures by which they are told apart, K: of LEDs and metal halide lamps those that they are sold under,
 * of the others that of the server's spectrum to a hundred. The default is in no group; `neutral`, for tests, is not offered.
 */
const GROUPS: readonly (readonly [group: "none" | "sodium" | "led" | "other", lamps: readonly (readonly [LampName, number])[]])[] =
  [
    ["none", [["mixed", 2800]]],
    [
      "sodium",
      [
        ["lps", 1800],
        ["hps", 2000],
        ["hps_colour_enhanced", 2500],
      ],
    ],
    [
      "led",
      [
        ["pc_amber", 1800],
        ["led_2700k", 2700],
        ["led_violet_2700k", 2700],
        ["led_rgb", 2800],
        ["led_hybrid", 2900],
        ["led_3000k", 3000],
        ["led_4000k", 4000],
        ["led_violet_4000k", 4000],
        ["led_5000k", 5000],
        ["led_6500k", 6500],
      ],
    ],
    [
      "other",
      [
        ["incandescent", 2900],
        ["fluorescent", 2900],
        ["metal_halide_3000k", 3000],
        ["metal_halide", 4000],
        ["metal_halide_ceramic", 4000],
        ["fluorescent_three_band", 4000],
        ["mercury", 6300],
      ],
    ],
  ];

function named([name, temperatureK]: readonly [LampName, number]): Named {
  return [name, `${words().lamps[name]}, ${temperatureK} K`];
}

/** All lamps by kind, with their colour temperatures. */
export function lampGroups(): ChoiceGroup[] {
  const { sodium, led, other } = words().lampGroups;
  const titles = { none: "", sodium, led, other };
  return GROUPS.map(([group, known]) => ({ title: titles[group], choices: known.map(named) }));
}

export function lamps(): Named[] {
  return GROUPS.flatMap(([, known]) => known.map(named));
}

export function emissions(): Named[] {
  return Object.entries(words().emissions);
}

/** What a way of sending light is called; weights of the user's own as they are. */
export function emissionTitle(emission: string): string {
  return emissions().find(([name]) => name === emission)?.[1] ?? words().assumptions.own(emission);
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

/** The named lamps of a mix `name:share,…`, with their shares; null for all else. */
function mixOf(lamp: string): [name: string, share: number][] | null {
  if (!/^[a-z]\w*:/.test(lamp)) return null;
  const parts = lamp.split(",").map((part): [string, number] => {
    const [name = "", share] = part.split(":");
    return [name, Number(share)];
  });
  const sum = parts.reduce((total, [, share]) => total + share, 0);
  return sum > 0 ? parts.map(([name, share]) => [name, share / sum]) : null;
}

/** What lamps are called: by name, as a mix, as a spectrum or fluxes of the user's own. */
export function lampTitle(lamp: string): string {
  const title = lamps().find(([name]) => name === lamp)?.[1];
  if (title !== undefined) return title;
  const { own, ownFluxes, ownSpectrum } = words().assumptions;
  const mix = mixOf(lamp);
  if (mix !== null) return mix.map(([name, share]) => `${Math.round(100 * share)} % ${lampTitle(name)}`).join(" + ");
  if (lamp.includes(":")) return ownSpectrum;
  return lamp.includes(",") ? ownFluxes(lamp) : own(lamp);
}

/** Components of the server's mixture. */
const MIXTURE: readonly string[] = ["hps", "led_4000k"];

/** Presets that an assumed lamp consists of; none for custom fluxes. */
export function lampsIn(assumed: string): readonly string[] {
  if (assumed === "mixed") return MIXTURE;
  const mix = mixOf(assumed);
  if (mix !== null) return mix.map(([name]) => name);
  return lamps().some(([name]) => name === assumed) ? [assumed] : [];
}
