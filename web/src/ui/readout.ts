// What the pointed direction of the sky shows, in words.

import { placeWords } from "../language/words.ts";
import { type SkyKind, type SkySample, valueFor } from "../sky/grid.ts";
import { compassName } from "../sky/projection.ts";
import type { Seen } from "../sky/seen.ts";
import { type BrightnessUnit, unitBeside, unitFor } from "../sky/units.ts";
import { seenOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId, make } from "./dom.ts";
import { fixed, inUnit } from "./format.ts";

export function mountReadout(store: AppStore): void {
  const container = byId("sky-readout", HTMLElement);
  store.watch(["pointed", "sky", "unit"], (state) => {
    const seen = seenOf(state);
    showReadout(container, state.pointed, state.sky, unitFor(state.unit, seen), seen);
  });
}

function showReadout(container: HTMLElement, sample: SkySample | null, kind: SkyKind, unit: BrightnessUnit, seen: Seen): void {
  const say = placeWords().readout;
  if (sample === null) {
    container.replaceChildren(make("span", "hint", say.hint));
    container.removeAttribute("data-azimuth-deg");
    return;
  }
  const value = valueFor(sample, kind);
  const other = valueFor(sample, kind === "total" ? "artificial" : "total");
  const beside = unitBeside(unit, seen);
  // The exact numbers, for scripts and tests; the text rounds them.
  container.dataset.azimuthDeg = String(sample.azimuthDeg);
  container.dataset.elevationDeg = String(sample.elevationDeg);
  container.dataset.seen = String(value);
  if (sample.isBelowHorizon) {
    container.dataset.seen = "0";
    container.replaceChildren(...directionItems(sample), make("span", "readout-item", make("b", "", say.belowHorizon)));
    return;
  }
  container.replaceChildren(
    ...directionItems(sample),
    item(say.brightness, ...inUnit(value, unit, seen)),
    ...(beside === null ? [] : [item(unit === "magnitude" ? say.luminance : "", ...inUnit(value, beside, seen))]),
    item(kind === "total" ? say.artificialAlone : say.withNatural, ...inUnit(other, unit, seen)),
  );
}

function item(name: string, value: string, unit: string): HTMLElement {
  return make(
    "span",
    "readout-item",
    ...(name === "" ? [] : [make("small", "", name), " "]),
    make("b", "", value),
    unit === "" ? "" : ` ${unit}`,
  );
}

function directionItems({ azimuthDeg, elevationDeg }: SkySample): HTMLElement[] {
  return [
    item(placeWords().readout.azimuth, `${fixed(azimuthDeg, 1)}°`, compassName(azimuthDeg)),
    item(placeWords().readout.elevation, `${fixed(elevationDeg, 1)}°`, ""),
  ];
}
