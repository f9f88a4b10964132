// The legend of the picture: its colours or greys, and round numbers of the chosen unit along them.

import { words } from "../language/words.ts";
import { NATURAL_SKY_MAG_ARCSEC2, brightness_mag_arcsec2, luminance_from_brightness_cd_m2 } from "../photometry.ts";
import { make } from "../ui/dom.ts";
import { decimal, in_unit } from "../ui/format.ts";
import { colour_gradient, type PictureStyle } from "./colour_maps.ts";
import { ToneMap } from "./realistic.ts";
import { SCALE, scale_position } from "./scale.ts";
import { marks, type BrightnessUnit, type Mark } from "./units.ts";

export interface LegendLook {
  colours: PictureStyle;
  /** Of the realistic picture, stops. */
  exposure_ev: number;
  unit: BrightnessUnit;
}

/** Steps of the gradient of greys. */
const GREYS = 40;

/** The greys that luminances along the scale are shown as. */
function grey_gradient(exposure_ev: number): string {
  const tone_map = new ToneMap(exposure_ev);
  const span = SCALE.faintest_mag_arcsec2 - SCALE.brightest_mag_arcsec2;
  const stops = Array.from({ length: GREYS + 1 }, (_, i) => {
    const grey = tone_map.grey(luminance_from_brightness_cd_m2(SCALE.faintest_mag_arcsec2 - (i / GREYS) * span));
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
  private readonly bar = make("div", "legend-bar");
  private readonly pointer = make("div", "legend-pointer");
  private readonly ticks = make("div", "legend-ticks");

  constructor(
    private readonly container: HTMLElement,
    private readonly title: HTMLElement,
  ) {
    this.bar.append(this.pointer);
    this.pointer.hidden = true;
    container.append(this.bar, this.ticks);
  }

  show({ colours, exposure_ev, unit }: LegendLook): void {
    const { sky } = words();
    this.container.dataset["unit"] = unit;
    this.title.textContent = { magnitude: sky.legend, luminance: sky.legend_luminance, ratio: sky.legend_ratio }[unit];
    this.bar.style.background = colours === "realistic" ? grey_gradient(exposure_ev) : colour_gradient(colours);
    this.ticks.replaceChildren(...marks(unit).map((mark) => tick(mark, unit)));
  }

  /** Marks a brightness on the bar; null takes the mark away. */
  point(brightness_mag_arcsec2: number | null): void {
    this.pointer.hidden = brightness_mag_arcsec2 === null;
    if (brightness_mag_arcsec2 !== null) {
      this.pointer.style.left = `${100 * scale_position(SCALE, brightness_mag_arcsec2)}%`;
    }
  }
}

function tick({ luminance_cd_m2, is_minor }: Mark, unit: BrightnessUnit): HTMLElement {
  const mag = brightness_mag_arcsec2(luminance_cd_m2) ?? SCALE.faintest_mag_arcsec2;
  const is_natural = Math.abs(mag - NATURAL_SKY_MAG_ARCSEC2) < 1e-6;
  const [value, name] = in_unit(luminance_cd_m2, unit);
  // The title says the unit; of luminances the prefix belongs to the number. The second line says the other quantity.
  const [other, other_unit] = in_unit(luminance_cd_m2, unit === "magnitude" ? "luminance" : "magnitude");
  const first = unit === "luminance" ? `${round(value)} ${name.replace("cd/m²", "")}` : round(value.replace(" ×", ""));
  const second = unit === "magnitude" ? `${other} ${other_unit}` : other;
  const kinds = ["legend-tick", ...(is_natural ? ["natural"] : []), ...(is_minor ? ["minor"] : [])];
  const mark = make("span", kinds.join(" "), make("b", "", first), make("small", "", second));
  mark.style.left = `${100 * scale_position(SCALE, mag)}%`;
  if (is_natural) mark.title = words().sky.natural;
  return mark;
}
