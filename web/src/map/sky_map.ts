// The map: outlines, the scene's tiles, its places, and the picked place.

import { AttributionControl, Map as MapLibreMap, Marker, NavigationControl, ScaleControl, setWorkerUrl } from "maplibre-gl";
import type { ErrorEvent, GeoJSONSource } from "maplibre-gl";
import type { GeoJSON } from "geojson";
import worker_url from "maplibre-gl/dist/maplibre-gl-worker.mjs?worker&url";
import "maplibre-gl/dist/maplibre-gl.css";
import type { Bounds, DimmedPixel, NamedPlace, Scene } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { LayerName, MapView, Place } from "../state.ts";
import { make } from "../ui/dom.ts";
import type { EditBody } from "../api/schema.ts";
import type { PaintedArea } from "../painting.ts";
import { load_basemap } from "./basemap.ts";
import { IS_STILL } from "./motion.ts";
import { Painter, type Brush } from "./painter.ts";
import { reachable } from "./reachable.ts";
import { RasterLayers, type LayerState, type WantedLayer } from "./raster_layers.ts";
import { night_style } from "./style.ts";
import { Swipe } from "./swipe.ts";

// Without this the map stays blank without a word.
setWorkerUrl(worker_url);

export interface SkyMapEvents {
  picked: (place: Place) => void;
  painted: (area: PaintedArea) => void;
  moved: (view: MapView) => void;
  layer: (name: LayerName, state: LayerState) => void;
  /** The line between the maps of today and of other lights was drawn to this part of the width. */
  split: (part: number) => void;
  failed: (reason: unknown) => void;
}

const MOVE_MS = IS_STILL ? 0 : 700;

/** A picked place nearer to the map's edge than this counts as out of view. */
const EDGE_PX = 40;

/** Continuous across the antimeridian: east is never less than west. */
function unwrapped([west = -180, south = -90, east = 180, north = 90]: Bounds): [number, number, number, number] {
  return [west, south, east < west ? east + 360 : east, north];
}

export class SkyMap {
  private readonly map: MapLibreMap;
  private readonly marker: Marker;
  private readonly styled: Promise<unknown>;
  private readonly layers: RasterLayers;
  private readonly painter: Painter;
  private readonly failed_sources = new Set<string>();
  private marked: Place | null = null;
  /** Outlines and names, by the source that shows them. */
  private readonly shared = new Map<string, GeoJSON>();
  private swipe: Swipe | null = null;
  private cannot_compare = false;

  constructor(
    container: HTMLElement,
    view: MapView | null,
    private readonly events: SkyMapEvents,
  ) {
    this.map = new MapLibreMap({
      container,
      style: night_style(),
      center: view === null ? [20, 15] : [view.longitude_deg, view.latitude_deg],
      zoom: view?.zoom ?? 1.5,
      minZoom: 1,
      maxZoom: 14,
      dragRotate: false,
      pitchWithRotate: false,
      touchPitch: false,
      attributionControl: false,
      fadeDuration: IS_STILL ? 0 : 300,
      transformRequest: reachable,
      locale: {
        "Map.Title": words().map.title,
        "NavigationControl.ZoomIn": words().map.zoom_in,
        "NavigationControl.ZoomOut": words().map.zoom_out,
        "AttributionControl.ToggleAttribution": words().map.toggle_credits,
      },
    });
    this.map.touchZoomRotate.disableRotation();
    this.map.keyboard.disableRotation();
    this.map.addControl(new NavigationControl({ showCompass: false }), "bottom-right");
    this.map.addControl(new ScaleControl({ maxWidth: 120 }), "bottom-left");
    this.map.addControl(new AttributionControl({ compact: true, customAttribution: words().map.credits }), "bottom-left");
    this.styled = new Promise((resolve) => this.map.once("load", resolve));
    // The scene's own credits stand above the map; all of them are behind the button and hide none of it.
    void this.styled.then(() => this.fold_credits());
    this.layers = new RasterLayers(this.map, this.styled, (name, state) => {
      this.failed_sources.delete(name);
      events.layer(name, state);
    });

    this.painter = new Painter(this.map, events.painted);
    container.append(make("div", "crosshair"));
    const pin = document.createElement("div");
    pin.className = "pin";
    pin.setAttribute("role", "img");
    pin.setAttribute("aria-label", words().map.picked);
    this.marker = new Marker({ element: pin, anchor: "center" });

    this.map.on("click", ({ lngLat }) => {
      if (this.painter.is_painting()) return;
      const { lng, lat } = lngLat.wrap();
      events.picked({ latitude_deg: lat, longitude_deg: lng });
    });
    this.map.getCanvas().addEventListener("keydown", (event) => {
      if (event.key !== "Enter") return;
      event.preventDefault();
      if (this.painter.is_painting()) {
        this.painter.press_enter();
        return;
      }
      const { lng, lat } = this.map.getCenter().wrap();
      events.picked({ latitude_deg: lat, longitude_deg: lng });
    });
    this.map.on("moveend", () => events.moved(this.view()));
    this.map.on("resize", () => this.keep_in_view());
    this.map.on("error", (event) => this.report(event, events.failed));
    this.show_basemap("coarse")
      .then(() => this.show_basemap("fine"))
      .catch(events.failed);
  }

  view(): MapView {
    const { lng, lat } = this.map.getCenter();
    return { zoom: this.map.getZoom(), latitude_deg: lat, longitude_deg: lng };
  }

  private async show_basemap(detail: "coarse" | "fine"): Promise<void> {
    const basemap = await load_basemap(detail);
    await this.styled;
    for (const name of ["land", "coasts", "borders", "names", "graticule"] as const) this.share(name, basemap[name]);
    this.map.getContainer().dataset["basemap"] = detail;
  }

  private fold_credits(): void {
    const credits = this.map.getContainer().querySelector(".maplibregl-ctrl-attrib");
    credits?.classList.remove("maplibregl-compact-show");
    credits?.removeAttribute("open");
  }

  /** A tile that is not there is no news; a source that fails is told once, not for each tile. */
  private report(event: ErrorEvent & { sourceId?: string; tile?: unknown }, failed: (reason: unknown) => void): void {
    const status = (event.error as { status?: number }).status;
    if (event.tile !== undefined && (status === 404 || status === 204)) return;
    if (event.sourceId !== undefined) {
      if (this.failed_sources.has(event.sourceId)) return;
      this.failed_sources.add(event.sourceId);
    }
    failed(event.error);
  }

  /** When the sky takes its part of the page, the picked place must not end up behind it. */
  private keep_in_view(): void {
    const place = this.marked;
    if (place === null) return;
    const { x, y } = this.map.project([place.longitude_deg, place.latitude_deg]);
    const { clientWidth, clientHeight } = this.map.getContainer();
    const inside = x > EDGE_PX && y > EDGE_PX && x < clientWidth - EDGE_PX && y < clientHeight - EDGE_PX;
    if (!inside && clientHeight > 2 * EDGE_PX) this.map.easeTo({ center: [place.longitude_deg, place.latitude_deg], duration: MOVE_MS });
  }

  /** Shows something that does not depend on the lights. */
  private share(name: string, data: GeoJSON): void {
    this.shared.set(name, data);
    this.source(name)?.setData(data);
    void this.swipe?.set_data(name, data);
  }

  private source(name: string): GeoJSONSource | undefined {
    return this.map.getSource<GeoJSONSource>(name);
  }

  /** Shows a scene's outline, and moves to it where asked. */
  async show_scene(scene: Scene, move: boolean): Promise<void> {
    const [west, south, east, north] = unwrapped(scene.bounds);
    if (move) this.map.fitBounds([west, south, east, north], { padding: 24, duration: 0 });
    await this.styled;
    this.failed_sources.clear();
    const corners = [[west, south], [east, south], [east, north], [west, north], [west, south]];
    this.share("scene", { type: "LineString", coordinates: corners });
  }

  /** Shows a layer of tiles as it is wanted, and left of the split as it is today; null where there is nothing to show. */
  show_layer(name: LayerName, wanted: WantedLayer | null, today: WantedLayer | null): void {
    this.layers.want(name, wanted);
    this.swipe?.show_layer(name, today);
  }

  /** A map of today reaches this part of the width from the left, 0 to 1; null: there is none. */
  compare(part: number | null): void {
    if (part === null) {
      this.swipe?.remove();
      this.swipe = null;
      return;
    }
    if (this.cannot_compare) return;
    try {
      this.swipe ??= new Swipe(this.map, this.shared, this.events);
      this.swipe.set_split(part);
    } catch (reason) {
      // The two skies are still there to be compared.
      this.cannot_compare = true;
      this.events.failed(reason);
    }
  }

  async show_places(places: readonly NamedPlace[]): Promise<void> {
    await this.styled;
    this.share("places", {
      type: "FeatureCollection",
      features: places.map(({ name, population, longitude_deg, latitude_deg }) => ({
        type: "Feature",
        properties: { name, population: population ?? 0 },
        geometry: { type: "Point", coordinates: [longitude_deg, latitude_deg] },
      })),
    });
  }

  /** Strokes paint with this brush; null: they move the map. */
  set_brush(brush: Brush | null): void {
    this.painter.set_brush(brush);
  }

  async show_painted(edits: readonly EditBody[]): Promise<void> {
    await this.styled;
    this.painter.show_edits(edits);
  }

  /** Shows which lights a plan dims, and how far. */
  async show_dimmed(pixels: readonly DimmedPixel[]): Promise<void> {
    await this.styled;
    this.source("dimmed")?.setData({
      type: "FeatureCollection",
      features: pixels.map(({ cut, longitude_deg, latitude_deg }) => ({
        type: "Feature",
        properties: { cut },
        geometry: { type: "Point", coordinates: [longitude_deg, latitude_deg] },
      })),
    });
  }

  mark(place: Place | null): void {
    if (place === null) {
      this.marker.remove();
      this.marked = null;
      return;
    }
    this.marker.setLngLat([place.longitude_deg, place.latitude_deg]);
    if (this.marked === null) this.marker.addTo(this.map);
    this.marked = place;
  }

  /** Moves so that a place is in view, zooming in where the map is far away. */
  go_to(place: Place): void {
    this.map.easeTo({
      center: [place.longitude_deg, place.latitude_deg],
      zoom: Math.max(this.map.getZoom(), 7),
      duration: MOVE_MS,
    });
  }

  jump_to(view: MapView): void {
    this.map.jumpTo({ center: [view.longitude_deg, view.latitude_deg], zoom: view.zoom });
  }

  /** Where a place lies inside the map's element, CSS pixels. */
  point_of(place: Place): { x: number; y: number } {
    return this.map.project([place.longitude_deg, place.latitude_deg]);
  }

  resize(): void {
    this.map.resize();
  }
}
