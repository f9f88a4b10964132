// What the pointed direction of the sky shows, in words.

import { words } from "../language/words.ts";
import { luminanceOf, type SkyKind, type SkySample } from "../sky/grid.ts";
import { compassName } from "../sky/projection.ts";
import type { BrightnessUnit } from "../sky/units.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId, make } from "./dom.ts";
import { fixed, inUnit } from "./format.ts";

export function mountReadout(store: AppStore): void {
  const container = byId("sky-readout", HTMLElement);
  store.watch(["pointed", "sky", "unit"], ({ pointed, sky, unit }) => showReadout(container, pointed, sky, unit));
}

function showReadout(container: HTMLElement, sample: SkySample | null, kind: SkyKind, unit: BrightnessUnit): void {
  const say = words().readout;
  if (sample === null) {
    container.replaceChildren(make("span", "hint", say.hint));
    container.removeAttribute("data-azimuth-deg");
    return;
  }
  const luminanceCdM2 = luminanceOf(sample, kind);
  const otherCdM2 = luminanceOf(sample, kind === "total" ? "artificial" : "total");
  // The exact numbers, for scripts and tests; the text rounds them.
  container.dataset.azimuthDeg = String(sample.azimuthDeg);
  container.dataset.elevationDeg = String(sample.elevationDeg);
  container.dataset.luminanceCdM2 = String(luminanceCdM2);
  if (sample.isBelowHorizon) {
    container.dataset.luminanceCdM2 = "0";
    container.replaceChildren(...directionItems(sample), make("span", "readout-item", make("b", "", say.belowHorizon)));
    return;
  }
  container.replaceChildren(
    ...directionItems(sample),
    item(say.brightness, ...inUnit(luminanceCdM2, unit)),
    ...(unit === "magnitude"
      ? [item(say.luminance, ...inUnit(luminanceCdM2, "luminance"))]
      : [item("", ...inUnit(luminanceCdM2, "magnitude"))]),
    item(kind === "total" ? say.artificialAlone : say.withNatural, ...inUnit(otherCdM2, unit)),
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
    item(words().readout.azimuth, `${fixed(azimuthDeg, 1)}°`, compassName(azimuthDeg)),
    item(words().readout.elevation, `${fixed(elevationDeg, 1)}°`, ""),
  ];
}
