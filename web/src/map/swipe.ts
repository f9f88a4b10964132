// The map of today over the map of other lights, as far as the split: a second map that follows the first.

import type { GeoJSON } from "geojson";
import type { GeoJSONSource, Map as MapLibreMap } from "maplibre-gl";
import type { BasemapAnswer } from "../api/schema.ts";
import type { LayerName } from "../state/view-state.ts";
import { make } from "../ui/dom.ts";
import { nightMap } from "./night-map.ts";
import { type LayerRequest, RasterLayers } from "./raster-layers.ts";
import { NAME_ANCHORS } from "./style.ts";
import { addBasemap } from "./vector-basemap.ts";

export interface SwipeEvents {
  /** The line between the two maps was drawn to this part of the width. */
  split: (part: number) => void;
  failed: (reason: unknown) => void;
}

/** What both maps show: outlines and names by the name of their source. */
export type SharedData = ReadonlyMap<string, GeoJSON>;

/** A name that may stand on several sides of its town stands where the map's own history left it: two maps would not agree. */
function placeNamesAlike(map: MapLibreMap, isAlike: boolean): void {
  const place = () => map.setLayoutProperty("places", "text-variable-anchor", isAlike ? [NAME_ANCHORS[0]] : [...NAME_ANCHORS]);
  if (map.getLayer("places") === undefined) void map.once("load", place);
  else place();
}

export class Swipe {
  private readonly map: MapLibreMap;
  private readonly styled: Promise<unknown>;
  private readonly layers: RasterLayers;
  private readonly container = make("div", "swipe-map");
  private readonly titles = [make("span", "swipe-left"), make("span", "swipe-right")] as const;
  private readonly line = make("div", "swipe-line", make("div", "swipe-handle"), ...this.titles);
  private readonly follow: () => void;
  private isRemoved = false;

  constructor(
    private readonly main: MapLibreMap,
    shared: SharedData,
    private readonly events: SwipeEvents,
  ) {
    // Below the marker of the picked place, above all that is drawn.
    this.main.getCanvas().after(this.container);
    try {
      const camera = { center: main.getCenter(), zoom: main.getZoom() };
      this.map = nightMap({ container: this.container, ...camera, interactive: false, fadeDuration: 0 });
    } catch (reason) {
      // The browser draws no more than one.
      this.container.remove();
      throw reason;
    }
    this.main.getContainer().append(this.line);
    // What the first map says of its own tiles holds for these.
    this.map.on("error", () => {});
    this.container.inert = true;
    this.styled = new Promise((resolve) => this.map.once("load", resolve));
    this.layers = new RasterLayers(this.map, this.styled, (_, state) => {
      if (state.kind === "failed") events.failed(state.reason);
    });
    // Names that cross the line stand at the same place on both sides of it.
    for (const map of [this.map, main]) placeNamesAlike(map, true);
    this.follow = () => this.map.jumpTo({ center: main.getCenter(), zoom: main.getZoom() });
    this.main.on("move", this.follow);
    for (const [name, data] of shared) void this.setData(name, data);
    this.line.addEventListener("pointerdown", (event) => {
      if (event.isPrimary && event.button === 0) this.line.setPointerCapture(event.pointerId);
    });
    this.line.addEventListener("pointermove", (event) => {
      if (!this.line.hasPointerCapture(event.pointerId)) return;
      const { left, width } = this.main.getContainer().getBoundingClientRect();
      this.events.split(Math.min(Math.max((event.clientX - left) / width, 0), 1));
    });
  }

  async setData(name: string, data: GeoJSON): Promise<void> {
    await this.styled;
    if (this.isRemoved) return;
    this.map.getSource<GeoJSONSource>(name)?.setData(data);
  }

  async showBasemap(basemap: BasemapAnswer): Promise<void> {
    await this.styled;
    if (!this.isRemoved) addBasemap(this.map, basemap);
  }

  showLayer(name: LayerName, request: LayerRequest | null): void {
    this.layers.show(name, request);
  }

  /** Today's map reaches this part of the width from the left, 0 to 1. */
  setSplit(part: number): void {
    this.container.style.clipPath = `inset(0 ${100 * (1 - part)}% 0 0)`;
    this.line.style.left = `${100 * part}%`;
  }

  /** What each side shows, beside the line: one note below the map would stand under both. */
  setTitles(titles: readonly [left: string, right: string]): void {
    for (const [i, title] of this.titles.entries()) title.textContent = titles[i] ?? "";
  }

  remove(): void {
    this.isRemoved = true;
    placeNamesAlike(this.main, false);
    this.main.off("move", this.follow);
    this.layers.stop();
    this.map.remove();
    this.container.remove();
    this.line.remove();
  }
}
