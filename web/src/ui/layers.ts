// The panel of the map's layers: what each shows, what its colours mean, and whether it is still being found.

import { plain_words } from "../api/problem.ts";
import type { TileJson } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { LayerState } from "../map/raster_layers.ts";
import { NATURAL_SKY_MAG_ARCSEC2, luminance_from_brightness_cd_m2 } from "../photometry.ts";
import { tile_gradient } from "../sky/colour_maps.ts";
import type { LayerName } from "../state.ts";
import { by_id, make } from "./dom.ts";
import { decimal, whole, with_prefix } from "./format.ts";

/** The server's hypsometric tints, from the sea to 6 000 m. */
const TINTS = "linear-gradient(to right, #3a5e4a, #547a54 3%, #8a9864 10%, #b2a474 20%, #a88868 33%, #96766a 50%, #c8c0be 75%, #fafafa)";
const GRADIENTS: Record<LayerName, string> = {
  elevation: TINTS,
  brightness: tile_gradient("plasma"),
  radiance: tile_gradient("inferno"),
  influence: tile_gradient("viridis"),
};

/** What is said of a layer that is on its way. */
function finding(name: LayerName): string {
  const { loading, finding_brightness, finding_influence } = words().layers;
  return { elevation: loading, brightness: finding_brightness, radiance: loading, influence: finding_influence }[name];
}

/** Two digits, which is what an end of a scale needs. */
function about(value: number): string {
  return decimal(Number(value.toPrecision(2)));
}

/** A share of the natural sky, as people say it. */
function of_natural(luminance_cd_m2: number): string {
  const share = luminance_cd_m2 / luminance_from_brightness_cd_m2(NATURAL_SKY_MAG_ARCSEC2);
  return share < 0.1 ? `${about(100 * share)} %` : `${about(share)} ×`;
}

const POWERS: Record<string, string> = { "-1": "", "-2": "²", "-3": "³" };

/** "nW cm-2 sr-1" as "nW/cm²/sr". */
export function typeset(unit: string): string {
  return unit.replace(/ ?\b([A-Za-zµ]+)(-[123])\b/g, (_, name: string, power: string) => `/${name}${POWERS[power] ?? ""}`);
}

/** What stands at the dark and the bright end of a layer's colours. */
export function layer_ends(name: LayerName, { range, unit }: Pick<TileJson, "range" | "unit">): [string, string] {
  if (range == null) return [words().layers.sea_level, words().layers.highest];
  const [dark = 0, bright = 0] = range;
  if (name === "brightness") return [of_natural(dark), words().layers.of_natural(of_natural(bright))];
  if (name === "influence") return [`1/${whole(Math.round(bright / dark))}`, words().layers.a_pixel(with_prefix(bright, typeset(unit)))];
  return [about(dark), `${about(bright)} ${typeset(unit)}`];
}

/** What must be so before a layer can be shown; null where it is. */
export function show_layer_hint(name: LayerName, hint: string | null): void {
  const box = by_id(`layer-${name}`, HTMLInputElement);
  box.disabled = hint !== null;
  box.title = hint ?? "";
  by_id(`layer-hint-${name}`, HTMLElement).textContent = hint ?? "";
}

/** Says below a layer's switch what its colours mean, or why there are none. */
export function show_layer_state(name: LayerName, state: LayerState): void {
  const note = by_id(`layer-note-${name}`, HTMLElement);
  note.dataset["state"] = state.kind;
  switch (state.kind) {
    case "off":
      note.replaceChildren();
      break;
    case "finding":
      note.replaceChildren(finding(name));
      break;
    case "failed":
      {
        const { headline, sentences } = plain_words(state.reason);
        note.replaceChildren([headline, ...sentences].join(". "));
      }
      break;
    case "shown": {
      const bar = make("div", "layer-bar");
      bar.style.background = GRADIENTS[name];
      const ends = layer_ends(name, state.description).map((end) => make("span", "", end));
      note.replaceChildren(bar, make("div", "ends", ...ends));
      note.title = state.description.description;
    }
  }
}
