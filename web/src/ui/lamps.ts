// The lamps and emission patterns that the server knows by name.

export const LAMPS: readonly [name: string, title: string][] = [
  ["mixed", "mixed: half sodium, half white LED"],
  ["hps", "high-pressure sodium"],
  ["lps", "low-pressure sodium"],
  ["pc_amber", "amber LED"],
  ["led_3000k", "white LED, 3000 K"],
  ["led_4000k", "white LED, 4000 K"],
  ["metal_halide", "metal halide"],
  ["mercury", "mercury vapour"],
];

export const EMISSIONS: readonly [name: string, title: string][] = [
  ["garstang", "usual: some light near the horizon"],
  ["shielded", "shielded: none near the horizon"],
  ["lambert", "Lambertian"],
];

export function lamp_title(lamp: string): string {
  return LAMPS.find(([name]) => name === lamp)?.[1] ?? `own fluxes ${lamp}`;
}
