// What the pointed direction of the sky shows, in words.

import { words } from "../language/words.ts";
import { brightness_mag_arcsec2 } from "../photometry.ts";
import type { SkyKind, SkySample } from "../sky/grid.ts";
import { compass_name } from "../sky/projection.ts";
import { make } from "./dom.ts";
import { fixed, magnitude, with_prefix } from "./format.ts";

export function show_readout(container: HTMLElement, sample: SkySample | null, kind: SkyKind): void {
  if (sample === null) {
    container.replaceChildren(make("span", "hint", words().readout.hint));
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
    container.replaceChildren(...direction_items(sample), make("span", "readout-item", make("b", "", words().readout.below_horizon)));
    return;
  }
  container.replaceChildren(
    ...direction_items(sample),
    item(words().readout.brightness, magnitude(brightness_mag_arcsec2(luminance_cd_m2)), "mag/arcsec²"),
    item(words().readout.luminance, with_prefix(luminance_cd_m2, "cd/m²"), ""),
    item(kind === "total" ? words().readout.artificial_alone : words().readout.with_natural, magnitude(brightness_mag_arcsec2(other_cd_m2)), "mag/arcsec²"),
  );
}

function item(name: string, value: string, unit: string): HTMLElement {
  return make("span", "readout-item", make("small", "", name), " ", make("b", "", value), unit === "" ? "" : ` ${unit}`);
}

function direction_items({ azimuth_deg, elevation_deg }: SkySample): HTMLElement[] {
  return [
    item(words().readout.azimuth, `${fixed(azimuth_deg, 1)}°`, compass_name(azimuth_deg)),
    item(words().readout.elevation, `${fixed(elevation_deg, 1)}°`, ""),
  ];
}
