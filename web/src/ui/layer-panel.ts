// The panel of the map's layers: which are shown, how opaque, and what must be so before.

import { words } from "../language/words.ts";
import { type AppState, sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { LAYERS, type LayerName, type MeasureName, mapMeasure, SURFACES, withLayer } from "../state/view-state.ts";
import { byId } from "./dom.ts";
import { showLayerState } from "./layer-legend.ts";
import { setRegionOption } from "./select.ts";

export function mountLayerPanel(store: AppStore): void {
  for (const layer of LAYERS) mountLayer(store, layer);
  const measure = byId("measure", HTMLSelectElement);
  measure.addEventListener("change", () => store.set({ measure: measure.value as MeasureName }));
  store.watch(["measure", "region", "layers"], (state) => {
    setRegionOption(measure, state.region !== null);
    measure.value = state.measure;
    measure.hidden = state.layers.influence === 0;
  });
  const ofMap = byId("map-measure", HTMLSelectElement);
  ofMap.addEventListener("change", () => {
    const surface = SURFACES.find((name) => name === ofMap.value) ?? null;
    store.set(surface === null ? { measure: ofMap.value as MeasureName, surface } : { surface });
  });
  store.watch(["measure", "surface", "layers"], (state) => {
    ofMap.value = mapMeasure(state);
    ofMap.hidden = state.layers.brightness === 0;
  });
}

function mountLayer(store: AppStore, layer: LayerName): void {
  const box = byId(`layer-${layer}`, HTMLInputElement);
  const slider = byId(`opacity-${layer}`, HTMLInputElement);
  const hintBelow = byId(`layer-hint-${layer}`, HTMLElement);
  const changed = () => store.set({ layers: withLayer(store.state.layers, layer, box.checked ? Number(slider.value) : 0) });
  box.addEventListener("change", changed);
  slider.addEventListener("input", changed);
  const show = (state: Readonly<AppState>) => {
    const hint = hintOf(layer, state);
    box.disabled = hint !== "";
    box.title = hint;
    hintBelow.textContent = hint;
    const opacity = state.layers[layer];
    box.checked = opacity > 0 && !box.disabled;
    slider.disabled = !box.checked;
    if (opacity > 0) slider.value = String(opacity);
  };
  store.watch([sceneOf, "clouds", "cloudCover", "place", "layers"], show);
  store.watch([({ layerStates }) => layerStates[layer]], ({ layerStates, response }) => {
    const state = layerStates[layer];
    if (state !== undefined) showLayerState(layer, state, response);
  });
}

/** What must be so before a layer can be shown; empty where it is. */
function hintOf(layer: LayerName, state: Readonly<AppState>): string {
  const { noTerrain, notBetweenClouds, placeFirst } = words().layers;
  return {
    elevation: sceneOf(state)?.terrain === false ? noTerrain : "",
    brightness: state.clouds === null || state.cloudCover >= 100 ? "" : notBetweenClouds,
    radiance: "",
    influence: state.place === null ? placeFirst : "",
  }[layer];
}
