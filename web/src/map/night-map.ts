// A map of the night: MapLibre with the viewer's style, and around the main one its controls and credits.

import {
  AttributionControl,
  Map as MapLibreMap,
  type MapOptions,
  NavigationControl,
  ScaleControl,
  setWorkerUrl,
} from "maplibre-gl";
import workerUrl from "maplibre-gl/dist/maplibre-gl-worker.mjs?worker&url";
import "maplibre-gl/dist/maplibre-gl.css";
import { words } from "../language/words.ts";
import type { MapView } from "../state/view-state.ts";
import { IS_STILL } from "./motion.ts";
import { reachable } from "./reachable.ts";
import { nightStyle } from "./style.ts";

// Without this the map stays blank without a word.
setWorkerUrl(workerUrl);

export function nightMap(options: MapOptions): MapLibreMap {
  const ours = { style: nightStyle(), minZoom: 1, maxZoom: 14, attributionControl: false, transformRequest: reachable } as const;
  return new MapLibreMap({ ...ours, ...options });
}

/** The map that people move: north is up. */
export function mainMap(container: HTMLElement, view: MapView | null): MapLibreMap {
  const { title, zoomIn, zoomOut, toggleCredits, credits } = words().map;
  const map = nightMap({
    container,
    center: view === null ? [20, 15] : [view.longitude_deg, view.latitude_deg],
    zoom: view?.zoom ?? 1.5,
    dragRotate: false,
    pitchWithRotate: false,
    touchPitch: false,
    fadeDuration: IS_STILL ? 0 : 300,
    locale: {
      "Map.Title": title,
      "NavigationControl.ZoomIn": zoomIn,
      "NavigationControl.ZoomOut": zoomOut,
      "AttributionControl.ToggleAttribution": toggleCredits,
    },
  });
  endDragsAnywhere(map);
  map.touchZoomRotate.disableRotation();
  map.keyboard.disableRotation();
  map.addControl(new NavigationControl({ showCompass: false }), "bottom-right");
  map.addControl(new ScaleControl({ maxWidth: 120 }), "bottom-left");
  map.addControl(new AttributionControl({ compact: true, customAttribution: credits }), "bottom-left");
  return map;
}

/** MapLibre hears the end of a drag over the map alone; one that ends over a panel would go on. */
function endDragsAnywhere(map: MapLibreMap): void {
  const canvas = map.getCanvasContainer();
  document.addEventListener("mouseup", ({ target, button, buttons, clientX, clientY }) => {
    if (!map.dragPan.isActive() || (target instanceof Node && canvas.contains(target))) return;
    canvas.dispatchEvent(new MouseEvent("mouseup", { button, buttons, clientX, clientY }));
  });
}

/** The credits stand above the map; all of them are behind their button and hide none of it. */
export function collapseCredits(map: MapLibreMap): void {
  const credits = map.getContainer().querySelector(".maplibregl-ctrl-attrib");
  credits?.classList.remove("maplibregl-compact-show");
  credits?.removeAttribute("open");
}
