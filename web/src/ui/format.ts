// Numbers as people read them.

import { placeWords, words } from "../language/words.ts";
import { brightnessMagArcsec2 } from "../photometry.ts";
import type { Seen } from "../sky/seen.ts";
import type { BrightnessUnit } from "../sky/units.ts";

/** A number in digits, with the decimal sign of the language. */
export function decimal(digits: string | number): string {
  return String(digits).replace(".", words().decimalSign);
}

export function fixed(value: number, decimals: number): string {
  return decimal(value.toFixed(decimals));
}

/** A time as cameras have it: 1/4 s, 15 s, 2 min. */
export function exposureTime(seconds: number): string {
  const digits = (value: number) => decimal(value.toFixed(value < 9.95 ? 1 : 0).replace(/\.0$/, ""));
  if (seconds < 0.7) return `1/${Math.round(1 / seconds)} s`;
  return seconds < 59.5 ? `${digits(seconds)} s` : `${digits(seconds / 60)} min`;
}

/** A text whose numbers stay on one line with their units. */
export function unbroken(text: string): string {
  return text.replaceAll(/(\d) (?=%|km|mag|h |min)/g, "$1\u00a0");
}

/** A share as people say it: 0.3 %, 12 %. */
export function percent(share: number): string {
  const size = 100 * share;
  if (size > 0 && size < 0.1) return `< ${decimal(0.1)} %`;
  return `${size < 9.95 ? fixed(size, 1) : fixed(size, 0)} %`;
}

/** A whole number, its thousands apart. */
export function whole(value: number): string {
  return value.toLocaleString(words().locale);
}

/** A number with three significant digits or so, never in exponent form. */
export function shortNumber(value: number): string {
  const size = Math.abs(value);
  if (size === 0) return "0";
  const digits = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : Math.min(2 - Math.floor(Math.log10(size)), 6);
  return fixed(value, digits);
}

/** From each size on, its factor and its prefix. */
const PREFIXES: readonly (readonly [fromSize: number, factor: number, prefix: string])[] = [
  [1e6, 1e-6, "M"],
  [1e4, 1e-3, "k"],
  [1, 1, ""],
  [1e-3, 1e3, "m"],
  [1e-6, 1e6, "µ"],
  [1e-9, 1e9, "n"],
  [1e-12, 1e12, "p"],
];

function prefixOf(value: number): [factor: number, prefix: string] {
  const size = Math.abs(value);
  if (size === 0) return [1, ""];
  const [, factor, prefix] = PREFIXES.find(([fromSize]) => size >= fromSize) ?? [0, 1e15, "f"];
  return [factor, prefix];
}

/** A quantity with the prefix that keeps it between 1 and 1000. */
export function withPrefix(value: number, unit: string): string {
  const [factor, prefix] = prefixOf(value);
  return `${shortNumber(value * factor)} ${prefix}${unit}`;
}

/** Two values of a quantity in one unit, that of the larger. */
export function bothWithPrefix(from: number, to: number, unit: string): [from: string, to: string, unit: string] {
  const [factor, prefix] = prefixOf(Math.max(Math.abs(from), Math.abs(to)));
  return [shortNumber(from * factor), shortNumber(to * factor), `${prefix}${unit}`];
}

/** A quantity in a unit that may have a prefix of its own. */
export function quantity(value: number, unit: string): string {
  return unit.startsWith("nW") ? withPrefix(value * 1e-9, unit.slice(1)) : withPrefix(value, unit);
}

export function magnitude(brightnessMagArcsec2: number | null): string {
  return brightnessMagArcsec2 === null ? placeWords().numbers.noLight : fixed(brightnessMagArcsec2, 2);
}

/** How many times the natural sky: 0.003, 0.84, 12, 340. */
export function ratio(value: number): string {
  if (value === 0) return "0";
  if (value < 0.001) return `< ${decimal(0.001)}`;
  return value >= 10 ? whole(Math.round(value)) : decimal(value.toPrecision(2));
}

/** A value of what sees the sky, as a number and its unit. */
export function inUnit(value: number, unit: BrightnessUnit, seen: Seen): [value: string, unit: string] {
  if (unit === "magnitude") return [magnitude(brightnessMagArcsec2(value)), "mag/arcsec²"];
  if (unit === "ratio") return [`${ratio(value / (seen.natural ?? NaN))} ×`, placeWords().numbers.natural];
  // Radiances of satellites are told in nW all over.
  if (seen.unit.startsWith("nW")) return [shortNumber(value), seen.unit];
  const [shown = "", name = ""] = withPrefix(value, seen.unit).split(" ");
  return [shown, name];
}

/** Names of north, east, south and west. */
export function cardinalNames(): [north: string, east: string, south: string, west: string] {
  const [north = "", , , , east = "", , , , south = "", , , , west = ""] = words().compass;
  return [north, east, south, west];
}

/** Letters part both, so that the search reads a comma in each. */
export function coordinates(latitudeDeg: number, longitudeDeg: number): string {
  const [north, east, south, west] = cardinalNames();
  const latitude = `${fixed(Math.abs(latitudeDeg), 4)}° ${latitudeDeg < 0 ? south : north}`;
  return `${latitude}, ${fixed(Math.abs(longitudeDeg), 4)}° ${longitudeDeg < 0 ? west : east}`;
}
