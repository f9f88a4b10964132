// What other lights change, number by number: before, after, and the change as people say it.

import type { SkyQuantities } from "../api/types.ts";
import { placeWords } from "../language/words.ts";
import { changeOf, type plannedChange } from "./comparison.ts";
import { make } from "./dom.ts";
import { bothWithPrefix, fixed, magnitude } from "./format.ts";
import { cell, headed, table } from "./table.ts";

type Values = readonly [before: number | null | undefined, after: number | null | undefined];

/** What is known besides the sky. */
export interface LampChange {
  /** What a plan was to reduce, where that is none of the other rows. */
  planned?: ReturnType<typeof plannedChange>;
  /** Upward flux of the changed pixels, DNB watts. */
  fluxesDnbW: readonly [before: number, after: number] | null;
  /** Energy of the lamps after over before; null where nobody knows. */
  energyRatio: number | null;
}

/** A number of magnitudes brighter or darker. */
function magnitudesApart([before, after]: Values): string {
  if (before == null || after == null) return "–";
  const { brighter, darker } = placeWords().comparison;
  const size = fixed(Math.abs(after - before), 2);
  if (Number(Math.abs(after - before).toFixed(2)) === 0) return "±0";
  return after < before ? brighter(size) : darker(size);
}

function row(key: string, name: string, from: string, to: string, change: string): HTMLElement {
  const shown = headed(name, cell(from, "value"), cell(make("b", "", to), "value"), cell(change, "value"));
  shown.dataset.row = key;
  return shown;
}

function magRow(key: string, name: string, values: Values): HTMLElement {
  const [from, to] = values.map((value) => magnitude(value ?? null));
  return row(key, `${name}, mag/arcsec²`, from ?? "", to ?? "", magnitudesApart(values));
}

function amountRow(key: string, name: string, [from, to]: readonly [number, number], unit: string): HTMLElement {
  const [before, after, shown] = bothWithPrefix(from, to, unit);
  return row(key, name, `${before} ${shown}`, `${after} ${shown}`, changeOf(from, to) ?? "–");
}

export function changeTable(
  before: SkyQuantities,
  after: SkyQuantities,
  { fluxesDnbW, energyRatio, planned = null }: LampChange,
): HTMLElement {
  const { numbers, comparison: say } = placeWords();
  const ofBoth = (
    from: number | null | undefined,
    to: number | null | undefined,
    show: (values: [number, number]) => HTMLElement,
  ) => (from == null || to == null ? [] : [show([from, to])]);
  const rows = [
    ...(planned === null
      ? []
      : [row("planned", planned.name, `${planned.from} ${planned.unit}`, `${planned.to} ${planned.unit}`, planned.change)]),
    ...(energyRatio === null
      ? []
      : [row("energy", say.energy, "100 %", `${fixed(100 * energyRatio, 0)} %`, changeOf(1, energyRatio) ?? "–")]),
    magRow("zenith", numbers.zenithTotal, [before.zenith_total_brightness_mag_arcsec2, after.zenith_total_brightness_mag_arcsec2]),
    magRow("sqm", numbers.sqm, [before.sqm_total_brightness_mag_arcsec2, after.sqm_total_brightness_mag_arcsec2]),
    amountRow("photopic", say.photopic, [before.zenith_luminance_cd_m2, after.zenith_luminance_cd_m2], "cd/m²"),
    amountRow("scotopic", say.scotopic, [before.zenith_scotopic_luminance_cd_m2, after.zenith_scotopic_luminance_cd_m2], "cd/m²"),
    amountRow("illuminance", say.illuminated, [before.horizontal_illuminance_lx, after.horizontal_illuminance_lx], "lx"),
    ...ofBoth(before.bortle_class, after.bortle_class, ([from, to]) =>
      row("bortle", numbers.bortleClass, String(from), String(to), ""),
    ),
    ...ofBoth(before.naked_eye_limit_mag, after.naked_eye_limit_mag, ([from, to]) =>
      row("faintest", `${numbers.faintestStars}, mag`, fixed(from, 2), fixed(to, 2), ""),
    ),
    ...(fluxesDnbW === null ? [] : [amountRow("upward", say.upward, fluxesDnbW, "W")]),
  ];
  return table([say.what, say.before, say.after, say.change], rows, "changes");
}
