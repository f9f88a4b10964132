// The legend of the picture: its colours or greys, and round numbers of the chosen unit along them.

import { words } from "../language/words.ts";
import { luminanceFromBrightnessCdM2 } from "../photometry.ts";
import { type AppState, landCdM2Of, seenOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { RESPONSES } from "../state/view-state.ts";
import { byId, make } from "../ui/dom.ts";
import { decimal, inUnit } from "../ui/format.ts";
import { colourGradient, isOfLight } from "./colour-maps.ts";
import type { FourValues } from "./compact.ts";
import { eyeBytes } from "./eye.ts";
import { valueFor } from "./grid.ts";
import { cameraGrey } from "./realistic.ts";
import { SCALE, scalePosition } from "./scale.ts";
import type { Seen } from "./seen.ts";
import { adaptationOf } from "./shading.ts";
import { type BrightnessUnit, type Tick, ticks, unitBeside, unitFor } from "./units.ts";

/** Steps of the gradient of greys. */
const GREYS = 40;
/** X, Y, Z and scotopic luminance of light of D65 by its luminance. */
const WHITE: FourValues = [0.9505, 1, 1.0888, 2.47];

/** The colours that luminances of white light along the scale are shown as. */
function lightGradient(colours: "eye" | "realistic", exposureEv: number, adaptationCdM2: number): string {
  const span = SCALE.faintestMagArcsec2 - SCALE.brightestMagArcsec2;
  const stops = Array.from({ length: GREYS + 1 }, (_, i) => {
    const luminanceCdM2 = luminanceFromBrightnessCdM2(SCALE.faintestMagArcsec2 - (i / GREYS) * span);
    if (colours === "eye")
      return `rgb(${eyeBytes(WHITE.map((part) => part * luminanceCdM2) as unknown as FourValues, exposureEv, adaptationCdM2)})`;
    const grey = cameraGrey(luminanceCdM2, exposureEv);
    return `rgb(${grey}, ${grey}, ${grey})`;
  });
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

/** A round number: 20, not 20.0. */
function round(value: string): string {
  const point = decimal(".");
  const [whole = "", part = ""] = value.split(point);
  const digits = part.replace(/0+(?= |$)/, "");
  return digits === "" || digits.startsWith(" ") ? `${whole}${digits}` : `${whole}${point}${digits}`;
}

/** What white light is shown as before a sky of this mean luminance, where there is no sky yet: the dark reference. */
const NO_SKY_CD_M2 = 2e-4;

/** The luminance that the eye is adapted to. */
function adaptationIn(state: Readonly<AppState>): number {
  return state.panorama === null ? (state.adaptationCdM2 ?? NO_SKY_CD_M2) : adaptationOf(state.panorama, state, landCdM2Of(state));
}

export class Legend {
  private readonly container = byId("legend", HTMLElement);
  private readonly title = byId("legend-title", HTMLElement);
  private readonly bar = make("div", "legend-bar");
  private readonly pointer = make("div", "legend-pointer");
  private readonly ticks = make("div", "legend-ticks");

  constructor(store: AppStore) {
    this.bar.append(this.pointer);
    this.container.append(this.bar, this.ticks);
    store.watch(["colours", "exposureEv", "unit", seenOf, adaptationIn], (state) => this.show(state));
    store.watch(["pointed", "sky"], (state) => {
      const { pointed, sky } = state;
      const value = pointed === null || pointed.isBelowHorizon ? 0 : valueFor(pointed, sky);
      this.pointer.hidden = value === 0;
      if (value > 0) this.pointer.style.left = `${100 * scalePosition(seenOf(state).unit, value)}%`;
    });
  }

  private show(state: Readonly<AppState>): void {
    const { colours, exposureEv } = state;
    const seen = seenOf(state);
    const unit = unitFor(state.unit, seen);
    this.container.dataset.unit = unit;
    this.title.textContent = legendTitle(unit, seen);
    this.bar.style.background = isOfLight(colours)
      ? lightGradient(colours, exposureEv, adaptationIn(state))
      : colourGradient(colours);
    this.ticks.replaceChildren(...ticks(unit, seen).map((mark) => tickElement(mark, unit, seen)));
  }
}

/** What the marks say, and what sees the sky where that is not the eye. */
function legendTitle(unit: BrightnessUnit, seen: Seen): string {
  const { sky, responses } = words();
  const beside = unitBeside(unit, seen);
  const luminance =
    beside === null
      ? sky.legendValue(seen.unit)
      : beside === "magnitude"
        ? sky.legendLuminance
        : sky.legendBesideNatural(seen.unit);
  const ratio = beside === "magnitude" ? sky.legendRatio : sky.legendBeside(seen.unit);
  const title = { magnitude: sky.legend, luminance, ratio }[unit];
  const response = RESPONSES.find((name) => name === seen.response);
  return response === undefined || response === "photopic" ? title : `${responses[response]} · ${title}`;
}

function tickElement({ value: shown, isMinor }: Tick, unit: BrightnessUnit, seen: Seen): HTMLElement {
  const isNatural = seen.natural !== null && Math.abs(shown / seen.natural - 1) < 1e-6;
  const [value, name] = inUnit(shown, unit, seen);
  // The title says the unit; of luminances the prefix belongs to the number. The second line says the other quantity.
  const beside = unitBeside(unit, seen);
  const [other, otherUnit] = beside === null ? ["", ""] : inUnit(shown, beside, seen);
  const first = unit === "luminance" ? `${round(value)} ${name.replace(seen.unit, "")}` : round(value.replace(" ×", ""));
  const second = unit === "magnitude" ? `${other} ${otherUnit}` : other;
  const kinds = ["legend-tick", ...(isNatural ? ["natural"] : []), ...(isMinor ? ["minor"] : [])];
  const mark = make("span", kinds.join(" "), make("b", "", first), make("small", "", second));
  mark.style.left = `${100 * scalePosition(seen.unit, shown)}%`;
  if (isNatural) mark.title = words().sky.natural;
  return mark;
}
