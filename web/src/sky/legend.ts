// The legend of the picture: its colours or greys, and round numbers of the chosen unit along them.

import { words } from "../language/words.ts";
import { brightnessMagArcsec2, luminanceFromBrightnessCdM2, NATURAL_SKY_MAG_ARCSEC2 } from "../photometry.ts";
import type { AppStore } from "../state/app-store.ts";
import type { ViewState } from "../state/view-state.ts";
import { byId, make } from "../ui/dom.ts";
import { decimal, inUnit } from "../ui/format.ts";
import { colourGradient } from "./colour-maps.ts";
import { luminanceOf } from "./grid.ts";
import { ToneMap } from "./realistic.ts";
import { SCALE, scalePosition } from "./scale.ts";
import { type BrightnessUnit, type Tick, ticks } from "./units.ts";

/** Steps of the gradient of greys. */
const GREYS = 40;

/** The greys that luminances along the scale are shown as. */
function greyGradient(exposureEv: number): string {
  const toneMap = new ToneMap(exposureEv);
  const span = SCALE.faintestMagArcsec2 - SCALE.brightestMagArcsec2;
  const stops = Array.from({ length: GREYS + 1 }, (_, i) => {
    const grey = toneMap.grey(luminanceFromBrightnessCdM2(SCALE.faintestMagArcsec2 - (i / GREYS) * span));
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

export class Legend {
  private readonly container = byId("legend", HTMLElement);
  private readonly title = byId("legend-title", HTMLElement);
  private readonly bar = make("div", "legend-bar");
  private readonly pointer = make("div", "legend-pointer");
  private readonly ticks = make("div", "legend-ticks");

  constructor(store: AppStore) {
    this.bar.append(this.pointer);
    this.container.append(this.bar, this.ticks);
    store.watch(["colours", "exposureEv", "unit"], (state) => this.show(state));
    store.watch(["pointed", "sky"], ({ pointed, sky }) => {
      const luminanceCdM2 = pointed === null || pointed.isBelowHorizon ? null : luminanceOf(pointed, sky);
      this.point(luminanceCdM2 === null ? null : brightnessMagArcsec2(luminanceCdM2));
    });
  }

  private show({ colours, exposureEv, unit }: ViewState): void {
    const { sky } = words();
    this.container.dataset.unit = unit;
    this.title.textContent = { magnitude: sky.legend, luminance: sky.legendLuminance, ratio: sky.legendRatio }[unit];
    this.bar.style.background = colours === "realistic" ? greyGradient(exposureEv) : colourGradient(colours);
    this.ticks.replaceChildren(...ticks(unit).map((mark) => tickElement(mark, unit)));
  }

  /** Marks a brightness on the bar; null takes the mark away. */
  private point(brightnessMagArcsec2: number | null): void {
    this.pointer.hidden = brightnessMagArcsec2 === null;
    if (brightnessMagArcsec2 !== null) {
      this.pointer.style.left = `${100 * scalePosition(SCALE, brightnessMagArcsec2)}%`;
    }
  }
}

function tickElement({ luminanceCdM2, isMinor }: Tick, unit: BrightnessUnit): HTMLElement {
  const mag = brightnessMagArcsec2(luminanceCdM2) ?? SCALE.faintestMagArcsec2;
  const isNatural = Math.abs(mag - NATURAL_SKY_MAG_ARCSEC2) < 1e-6;
  const [value, name] = inUnit(luminanceCdM2, unit);
  // The title says the unit; of luminances the prefix belongs to the number. The second line says the other quantity.
  const [other, otherUnit] = inUnit(luminanceCdM2, unit === "magnitude" ? "luminance" : "magnitude");
  const first = unit === "luminance" ? `${round(value)} ${name.replace("cd/m²", "")}` : round(value.replace(" ×", ""));
  const second = unit === "magnitude" ? `${other} ${otherUnit}` : other;
  const kinds = ["legend-tick", ...(isNatural ? ["natural"] : []), ...(isMinor ? ["minor"] : [])];
  const mark = make("span", kinds.join(" "), make("b", "", first), make("small", "", second));
  mark.style.left = `${100 * scalePosition(SCALE, mag)}%`;
  if (isNatural) mark.title = words().sky.natural;
  return mark;
}
