// The legend of a layer of the map: its colours, its progress or its error.

import { problemLine } from "../api/problem.ts";
import type { TileJson } from "../api/types.ts";
import { typeset } from "../api/units.ts";
import { words } from "../language/words.ts";
import type { LayerState } from "../map/raster-layers.ts";
import { tileGradient } from "../sky/colour-maps.ts";
import type { LayerName, ResponseName } from "../state/view-state.ts";
import { byId, make, told } from "./dom.ts";
import { decimal, quantity, whole } from "./format.ts";

/** The server's hypsometric tints, from the sea to 6 000 m. */
const TINTS =
  "linear-gradient(to right, #3a5e4a, #547a54 3%, #8a9864 10%, #b2a474 20%, #a88868 33%, #96766a 50%, #c8c0be 75%, #fafafa)";
const GRADIENTS: Record<LayerName, string> = {
  elevation: TINTS,
  brightness: tileGradient("plasma"),
  radiance: tileGradient("inferno"),
  influence: tileGradient("viridis"),
};

/** Text of a layer that is loading. */
function loadingText(name: LayerName, part: number | null): string {
  const { loading, loadingBrightness, loadingInfluence } = words().layers;
  const text = { elevation: loading, brightness: loadingBrightness, radiance: loading, influence: loadingInfluence }[name];
  return part === null ? text : `${text} ${whole(Math.round(100 * part))} %`;
}

/** Two digits, which is what an end of a scale needs. */
function about(value: number): string {
  return decimal(Number(value.toPrecision(2)));
}

/** A share, as people say it. */
function asShare(share: number): string {
  return share < 0.1 ? `${about(100 * share)} %` : `${about(share)} ×`;
}

/** What stands at the dark and the bright end of a layer's colours. */
export function scaleEnds(
  name: LayerName,
  { range, unit, natural }: Pick<TileJson, "range" | "unit" | "natural">,
  response: ResponseName,
): [string, string] {
  if (range == null) return [words().layers.seaLevel, words().layers.highest];
  const [dark = 0, bright = 0] = range;
  if (name === "brightness" && response === "photopic" && natural != null)
    return [asShare(dark / natural), words().layers.ofNatural(asShare(bright / natural))];
  if (name === "brightness") return [quantity(dark, typeset(unit)), quantity(bright, typeset(unit))];
  if (name === "influence")
    return [`1/${whole(Math.round(bright / dark))}`, words().layers.aPixel(quantity(bright, typeset(unit)))];
  return [about(dark), `${about(bright)} ${typeset(unit)}`];
}

/** Shows below a layer's switch its legend, its progress or its error. */
export function showLayerState(name: LayerName, state: LayerState, response: ResponseName): void {
  const note = byId(`layer-note-${name}`, HTMLElement);
  note.dataset.state = state.kind;
  switch (state.kind) {
    case "off":
      note.replaceChildren();
      break;
    case "loading":
      note.replaceChildren(loadingText(name, state.part));
      break;
    case "failed":
      note.replaceChildren(told("span", "", problemLine(state.reason)));
      break;
    case "shown": {
      const bar = make("div", "layer-bar");
      bar.style.background = GRADIENTS[name];
      const ends = scaleEnds(name, state.description, response).map((end) => make("span", "", end));
      const isSeen = response !== "photopic" && (name === "brightness" || name === "influence");
      const by = isSeen ? [make("div", "", words().seen.by(words().responses[response]))] : [];
      note.replaceChildren(bar, make("div", "ends", ...ends), ...by);
      note.title = state.description.description;
    }
  }
}
