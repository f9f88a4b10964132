// The legend of the false-colour picture: colours, magnitudes, and the luminance each stands for.

import { words } from "../language/words.ts";
import { NATURAL_SKY_MAG_ARCSEC2, luminance_from_brightness_cd_m2 } from "../photometry.ts";
import { make } from "../ui/dom.ts";
import { with_prefix } from "../ui/format.ts";
import { colour_gradient, type ColourMapName } from "./colour_maps.ts";
import { SCALE, scale_position } from "./scale.ts";

export class Legend {
  private readonly bar = make("div", "legend-bar");
  private readonly pointer = make("div", "legend-pointer");
  private readonly ticks = make("div", "legend-ticks");

  constructor(container: HTMLElement) {
    this.bar.append(this.pointer);
    this.pointer.hidden = true;
    container.append(this.bar, this.ticks);
  }

  show(colours: ColourMapName): void {
    const scale = SCALE;
    this.bar.style.background = colour_gradient(colours);
    this.ticks.replaceChildren();
    for (let mag = scale.faintest_mag_arcsec2; mag >= scale.brightest_mag_arcsec2; mag--) {
      const tick = make(
        "span",
        mag === NATURAL_SKY_MAG_ARCSEC2 ? "legend-tick natural" : "legend-tick",
        make("b", "", String(mag)),
        make("small", "", with_prefix(luminance_from_brightness_cd_m2(mag), "cd/m²")),
      );
      tick.style.left = `${100 * scale_position(scale, mag)}%`;
      if (mag === NATURAL_SKY_MAG_ARCSEC2) tick.title = words().sky.natural;
      this.ticks.append(tick);
    }
  }

  /** Marks a brightness on the bar; null takes the mark away. */
  point(brightness_mag_arcsec2: number | null): void {
    this.pointer.hidden = brightness_mag_arcsec2 === null;
    if (brightness_mag_arcsec2 !== null) {
      this.pointer.style.left = `${100 * scale_position(SCALE, brightness_mag_arcsec2)}%`;
    }
  }
}
