// For experts: what other eyes and instruments see at the zenith, and the colour of its artificial light.

import type { SkyAnswer } from "../api/types.ts";
import { typeset } from "../api/units.ts";
import { placeWords, words } from "../language/words.ts";
import type { SkyKind } from "../sky/grid.ts";
import { PHOTOPIC } from "../sky/seen.ts";
import type { AppStore } from "../state/app-store.ts";
import { RESPONSES } from "../state/view-state.ts";
import { byId } from "./dom.ts";
import { fixed, inUnit } from "./format.ts";
import { row } from "./row.ts";

const NONE = "–";
/** A colour temperature is told to so many kelvins. */
const STEP_K = 10;

export function mountColourNumbers(store: AppStore): void {
  const numbers = byId("colour-numbers", HTMLElement);
  store.watch(["answer", "sky"], ({ answer, sky }) => {
    byId("colour", HTMLDetailsElement).hidden = answer === null;
    numbers.replaceChildren(...(answer === null ? [] : [...responseRows(answer, sky), ...colourRows(answer)]));
  });
}

function temperature(kelvin: number | null | undefined): [value: string, unit: string] {
  return kelvin == null ? [NONE, ""] : [String(STEP_K * Math.round(kelvin / STEP_K)), "K"];
}

function scotopicRatio(value: number | null | undefined): string {
  return value == null ? NONE : fixed(value, 2);
}

/** The eye adapted to light and the meter stand in the list above. */
function responseRows({ sky }: SkyAnswer, kind: SkyKind): HTMLElement[] {
  return sky.zenith_by_response.flatMap((zenith) => {
    const name = RESPONSES.find((known) => known === zenith.response);
    if (name === undefined || name === "photopic" || name === "sqm") return [];
    const [value, mag] =
      kind === "total" ? [zenith.total, zenith.total_brightness_mag_arcsec2] : [zenith.value, zenith.brightness_mag_arcsec2];
    const seen = { ...PHOTOPIC, unit: typeset(zenith.unit) };
    const shown = inUnit(value, mag == null ? "luminance" : "magnitude", seen);
    return [row(words().responses[name], ...shown, `zenith_${name}`)];
  });
}

function colourRows({ sky, lamp }: SkyAnswer): HTMLElement[] {
  const say = placeWords().colour;
  const xy = sky.zenith_chromaticity?.map((part) => fixed(part, 3)).join(" · ") ?? NONE;
  const lampRatio = say.lampRatio(scotopicRatio(lamp.scotopic_photopic_ratio));
  return [
    row(say.ratio, scotopicRatio(sky.zenith_scotopic_photopic_ratio), "", "scotopic_photopic_ratio"),
    row(say.temperature, ...temperature(sky.zenith_colour_temperature_k), "colour_temperature"),
    row(say.chromaticity, xy, "", "chromaticity"),
    row(say.lamps, ...temperature(lamp.colour_temperature_k), "lamp_colour_temperature", lampRatio),
  ];
}
