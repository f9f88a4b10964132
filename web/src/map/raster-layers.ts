// The layers of tiles on the map: each is requested when it becomes visible, and again when its query changes.

import type { Map as MapLibreMap } from "maplibre-gl";
import { api, type LayerQuery } from "../api/client.ts";
import type { TileJson } from "../api/types.ts";
import { LAYERS, type LayerName } from "../state/view-state.ts";
import { IS_STILL } from "./motion.ts";
import { FIRST_LAYER_ABOVE_TILES } from "./style.ts";

/** A layer as it is to be shown. */
export interface LayerRequest {
  scene: string;
  query: LayerQuery;
  /** 0..1; 0 is off. */
  opacity: number;
}

export type LayerState =
  | { kind: "off" }
  /** `part`: of what the tiles show, 0..1, how much is found; null where nobody says. */
  | { kind: "loading"; part: number | null }
  | { kind: "shown"; description: TileJson }
  | { kind: "failed"; reason: unknown };

/** Pictures of twice the pixels where the screen has them. */
function templates(tiles: readonly string[]): string[] {
  return tiles.map((tile) => (devicePixelRatio > 1.5 ? tile.replace("{y}.png", "{y}@2x.png") : tile));
}

export class RasterLayers {
  private readonly active = new Map<LayerName, { key: string; controller: AbortController }>();

  constructor(
    private readonly map: MapLibreMap,
    private readonly styled: Promise<unknown>,
    private readonly changed: (name: LayerName, state: LayerState) => void,
  ) {}

  /** Shows a layer; null where there is nothing to show. */
  show(name: LayerName, request: LayerRequest | null): void {
    const key = request === null || request.opacity === 0 ? "" : JSON.stringify([request.scene, request.query]);
    const before = this.active.get(name);
    if (request !== null && key !== "" && before?.key === key) {
      this.setOpacity(name, request.opacity);
      return;
    }
    if (key === "" && before === undefined) return;
    before?.controller.abort();
    this.active.delete(name);
    this.remove(name);
    if (request === null || key === "") {
      this.changed(name, { kind: "off" });
      return;
    }
    const controller = new AbortController();
    this.active.set(name, { key, controller });
    this.changed(name, { kind: "loading", part: null });
    this.load(name, request, controller.signal).catch((reason: unknown) => {
      if (controller.signal.aborted) return;
      // The same request is then a new try.
      this.active.delete(name);
      this.changed(name, { kind: "failed", reason });
    });
  }

  /** Cancels all requests; the map may be gone. */
  stop(): void {
    for (const { controller } of this.active.values()) controller.abort();
    this.active.clear();
  }

  /** Asks again for the tiles of all layers. */
  refreshTiles(): void {
    for (const name of this.active.keys()) if (this.map.getSource(name) !== undefined) this.map.refreshTiles(name);
  }

  /** The opacity of a layer that is shown, at once. */
  setOpacity(name: LayerName, opacity: number): void {
    if (this.map.getLayer(name) !== undefined) this.map.setPaintProperty(name, "raster-opacity", opacity);
  }

  private async load(name: LayerName, { scene, query, opacity }: LayerRequest, signal: AbortSignal): Promise<void> {
    const progress = (part: number) => this.changed(name, { kind: "loading", part });
    const description = await api.layer(scene, name, query, signal, progress);
    await this.styled;
    if (signal.aborted) return;
    const { minzoom, maxzoom, attribution } = description;
    const [west = -180, south = -90, east = 180, north = 90] = description.bounds;
    const credit = attribution == null ? {} : { attribution };
    this.map.addSource(name, {
      type: "raster",
      tiles: templates(description.tiles),
      tileSize: description.tileSize,
      minzoom,
      maxzoom,
      bounds: [west, south, east, north],
      ...credit,
    });
    const above = LAYERS.slice(LAYERS.indexOf(name) + 1).find((other) => this.map.getLayer(other) !== undefined);
    const paint = { "raster-fade-duration": IS_STILL ? 0 : 150, "raster-opacity": opacity };
    this.map.addLayer({ id: name, type: "raster", source: name, paint }, above ?? FIRST_LAYER_ABOVE_TILES);
    this.changed(name, { kind: "shown", description });
  }

  private remove(name: LayerName): void {
    if (this.map.getLayer(name) !== undefined) this.map.removeLayer(name);
    if (this.map.getSource(name) !== undefined) this.map.removeSource(name);
  }
}
