// What the pointed direction of the sky shows, in words.

import { words } from "../language/words.ts";
import type { SkyKind, SkySample } from "../sky/grid.ts";
import { compass_name } from "../sky/projection.ts";
import type { BrightnessUnit } from "../sky/units.ts";
import { make } from "./dom.ts";
import { fixed, in_unit } from "./format.ts";

export function show_readout(container: HTMLElement, sample: SkySample | null, kind: SkyKind, unit: BrightnessUnit): void {
  const say = words().readout;
  if (sample === null) {
    container.replaceChildren(make("span", "hint", say.hint));
    container.removeAttribute("data-azimuth-deg");
    return;
  }
  const luminance_cd_m2 = kind === "total" ? sample.total_cd_m2 : sample.artificial_cd_m2;
  const other_cd_m2 = kind === "total" ? sample.artificial_cd_m2 : sample.total_cd_m2;
  // The exact numbers, for scripts and tests; the text rounds them.
  container.dataset["azimuthDeg"] = String(sample.azimuth_deg);
  container.dataset["elevationDeg"] = String(sample.elevation_deg);
  container.dataset["luminanceCdM2"] = String(luminance_cd_m2);
  if (sample.is_below_horizon) {
    container.dataset["luminanceCdM2"] = "0";
    container.replaceChildren(...direction_items(sample), make("span", "readout-item", make("b", "", say.below_horizon)));
    return;
  }
  container.replaceChildren(
    ...direction_items(sample),
    item(say.brightness, ...in_unit(luminance_cd_m2, unit)),
    ...(unit === "magnitude" ? [item(say.luminance, ...in_unit(luminance_cd_m2, "luminance"))] : [item("", ...in_unit(luminance_cd_m2, "magnitude"))]),
    item(kind === "total" ? say.artificial_alone : say.with_natural, ...in_unit(other_cd_m2, unit)),
  );
}

function item(name: string, value: string, unit: string): HTMLElement {
  return make("span", "readout-item", ...(name === "" ? [] : [make("small", "", name), " "]), make("b", "", value), unit === "" ? "" : ` ${unit}`);
}

function direction_items({ azimuth_deg, elevation_deg }: SkySample): HTMLElement[] {
  return [
    item(words().readout.azimuth, `${fixed(azimuth_deg, 1)}°`, compass_name(azimuth_deg)),
    item(words().readout.elevation, `${fixed(elevation_deg, 1)}°`, ""),
  ];
}
