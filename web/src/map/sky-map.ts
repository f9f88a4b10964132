// The map: outlines, the scene's tiles, its places, and the picked place.

import type { GeoJSON } from "geojson";
import { type ErrorEvent, type GeoJSONSource, LngLatBounds, type Map as MapLibreMap, Marker } from "maplibre-gl";
import { api } from "../api/client.ts";
import { ApiError, noAnswer } from "../api/problem.ts";
import type { BasemapAnswer, EditBody } from "../api/schema.ts";
import type { Bounds, DarkerPlace, DimmedPixel, NamedPlace, Scene } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { PaintedArea } from "../lights/painting.ts";
import type { LayerName, MapView, Place } from "../state/view-state.ts";
import { make } from "../ui/dom.ts";
import { AreasLayer, type SharedAreas } from "./areas-layer.ts";
import { loadBasemap } from "./basemap.ts";
import { type Light, LightTip } from "./light-tip.ts";
import { IS_STILL } from "./motion.ts";
import { collapseCredits, mainMap } from "./night-map.ts";
import { type Brush, Painter } from "./painter.ts";
import { type LayerRequest, type LayerState, RasterLayers } from "./raster-layers.ts";
import { Swipe } from "./swipe.ts";
import { addBasemap } from "./vector-basemap.ts";

export interface SkyMapEvents {
  picked: (place: Place) => void;
  painted: (area: PaintedArea) => void;
  moved: (view: MapView) => void;
  layer: (name: LayerName, state: LayerState) => void;
  /** The line between the maps of today and of other lights was drawn to this part of the width. */
  split: (part: number) => void;
  /** Outlines and names are there in full. */
  drawn: () => void;
  failed: (reason: unknown) => void;
}

const MOVE_MS = IS_STILL ? 0 : 700;

/** A picked place nearer to the map's edge than this counts as out of view. */
const EDGE_PX = 40;

/** Continuous across the antimeridian: east is never less than west. */
function unwrapped([west = -180, south = -90, east = 180, north = 90]: Bounds): [number, number, number, number] {
  return [west, south, east < west ? east + 360 : east, north];
}

/** An error of the map's own requests in the words of all others. */
function problemOf(error: { message: string; status?: number }): Error {
  if (error.status === undefined) return new Error(error.message);
  return error.status === 0 ? noAnswer() : new ApiError(error.status, {});
}

export class SkyMap {
  private readonly map: MapLibreMap;
  private readonly marker: Marker;
  private readonly styled: Promise<unknown>;
  private readonly layers: RasterLayers;
  private readonly painter: Painter;
  private readonly areas: AreasLayer;
  private readonly lights: LightTip;
  private readonly failedSources = new Set<string>();
  private readonly town: Marker;
  private darker: Marker[] = [];
  private marked: Place | null = null;
  /** Whether the place was picked since the map was last moved by hand: only then may the map follow it. */
  private isFollowing = false;
  /** Outlines and names, by the source that shows them. */
  private readonly shared = new Map<string, GeoJSON>();
  private swipe: Swipe | null = null;
  private basemap: BasemapAnswer | null = null;
  private cannotCompare = false;

  constructor(
    container: HTMLElement,
    view: MapView | null,
    private readonly events: SkyMapEvents,
  ) {
    this.map = mainMap(container, view);
    this.styled = new Promise((resolve) => this.map.once("load", resolve));
    void this.styled.then(() => collapseCredits(this.map));
    this.layers = new RasterLayers(this.map, this.styled, (name, state) => {
      this.failedSources.delete(name);
      events.layer(name, state);
    });

    this.painter = new Painter(this.map, events.painted);
    this.areas = new AreasLayer(this.map, this.styled);
    this.lights = new LightTip(this.map);
    container.append(make("div", "crosshair"));
    const pin = document.createElement("div");
    pin.className = "pin";
    pin.setAttribute("role", "img");
    pin.setAttribute("aria-label", words().map.picked);
    this.marker = new Marker({ element: pin, anchor: "center" });

    const town = make("div", "shown-town");
    town.setAttribute("aria-hidden", "true");
    this.town = new Marker({ element: town, anchor: "center" });

    this.map.on("click", (event) => {
      if (this.painter.isPainting() || this.areas.takesTap(event)) return;
      const { lng, lat } = event.lngLat.wrap();
      events.picked({ latitude_deg: lat, longitude_deg: lng });
    });
    this.map.getCanvas().addEventListener("keydown", (event) => {
      if (event.key !== "Enter") return;
      event.preventDefault();
      if (this.painter.isPainting()) {
        this.painter.pressEnter();
        return;
      }
      const { lng, lat } = this.map.getCenter().wrap();
      events.picked({ latitude_deg: lat, longitude_deg: lng });
    });
    this.map.on("moveend", () => events.moved(this.view()));
    this.map.on("movestart", ({ originalEvent }) => {
      if (originalEvent !== undefined) this.isFollowing = false;
    });
    this.map.on("resize", () => this.keepInView());
    this.map.on("error", (event) => this.report(event, events.failed));
    this.showBasemap("coarse")
      .then(() => this.showBasemap("fine"))
      .then(events.drawn)
      // Without it the map is whole.
      .then(() => this.showOperatorsBasemap().catch(() => undefined))
      .catch(events.failed);
  }

  view(): MapView {
    const { lng, lat } = this.map.getCenter();
    return { zoom: this.map.getZoom(), latitude_deg: lat, longitude_deg: lng };
  }

  private async showBasemap(detail: "coarse" | "fine"): Promise<void> {
    const basemap = await loadBasemap(detail);
    await this.styled;
    for (const name of ["land", "coasts", "borders", "names", "graticule"] as const) this.share(name, basemap[name]);
    this.map.getContainer().dataset.basemap = detail;
  }

  /** Roads, lakes and parks come after all else, and only where the operator has them. */
  private async showOperatorsBasemap(): Promise<void> {
    const basemap = await api.basemap(new AbortController().signal);
    if (basemap.tiles.length === 0) return;
    this.basemap = basemap;
    addBasemap(this.map, basemap);
    void this.swipe?.showBasemap(basemap);
  }

  /** Missing tiles are no error; a failing source is reported once, not for each tile. */
  private report(event: ErrorEvent & { sourceId?: string; tile?: unknown }, failed: (reason: unknown) => void): void {
    const status = (event.error as { status?: number }).status;
    if (event.tile !== undefined && (status === 404 || status === 204)) return;
    if (event.sourceId !== undefined) {
      if (this.failedSources.has(event.sourceId)) return;
      this.failedSources.add(event.sourceId);
    }
    failed(problemOf(event.error));
  }

  private isInView({ longitude_deg, latitude_deg }: Place): boolean {
    const { x, y } = this.map.project([longitude_deg, latitude_deg]);
    const { clientWidth, clientHeight } = this.map.getContainer();
    return x > EDGE_PX && y > EDGE_PX && x < clientWidth - EDGE_PX && y < clientHeight - EDGE_PX;
  }

  /** When the sky takes its part of the page, the picked place must not end up behind it. */
  private keepInView(): void {
    const place = this.marked;
    if (place === null || !this.isFollowing) return;
    if (!this.isInView(place) && this.map.getContainer().clientHeight > 2 * EDGE_PX)
      this.map.easeTo({ center: [place.longitude_deg, place.latitude_deg], duration: MOVE_MS });
  }

  /** Shows something that does not depend on the lights. */
  private share(name: string, data: GeoJSON): void {
    this.shared.set(name, data);
    this.source(name)?.setData(data);
    void this.swipe?.setData(name, data);
  }

  private source(name: string): GeoJSONSource | undefined {
    return this.map.getSource<GeoJSONSource>(name);
  }

  /** Shows a scene's outline, and moves to it where asked. */
  async showScene(scene: Scene, move: boolean): Promise<void> {
    const [west, south, east, north] = unwrapped(scene.bounds);
    if (move) this.map.fitBounds([west, south, east, north], { padding: 24, duration: 0 });
    await this.styled;
    this.failedSources.clear();
    const corners = [
      [west, south],
      [east, south],
      [east, north],
      [west, north],
      [west, south],
    ];
    this.share("scene", { type: "LineString", coordinates: corners });
  }

  /** Shows a layer of tiles, and left of the split that of today; null where there is nothing to show. */
  showLayer(name: LayerName, request: LayerRequest | null, today: LayerRequest | null): void {
    this.layers.show(name, request);
    this.swipe?.showLayer(name, today);
  }

  /** A map of today reaches a part of the width from the left, 0 to 1, and both sides have titles; null: there is none. */
  compare(sides: { part: number; titles: [left: string, right: string] } | null): void {
    if (sides === null) {
      this.swipe?.remove();
      this.swipe = null;
      return;
    }
    if (this.cannotCompare) return;
    try {
      if (this.swipe === null) {
        this.swipe = new Swipe(this.map, this.shared, this.events);
        if (this.basemap !== null) void this.swipe.showBasemap(this.basemap);
      }
      this.swipe.setSplit(sides.part);
      this.swipe.setTitles(sides.titles);
    } catch (reason) {
      // The two skies are still there to be compared.
      this.cannotCompare = true;
      this.events.failed(reason);
    }
  }

  /** The lights that say their share where one points at them. */
  showLights(lights: readonly Light[]): void {
    this.lights.show(lights);
  }

  /** Shows areas with their shares; null: none. */
  showAreas(areas: SharedAreas | null): Promise<void> {
    return this.areas.show(areas);
  }

  async showPlaces(places: readonly NamedPlace[]): Promise<void> {
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
  setBrush(brush: Brush | null): void {
    this.painter.setBrush(brush);
  }

  async showPainted(edits: readonly EditBody[]): Promise<void> {
    await this.styled;
    this.painter.showEdits(edits);
  }

  /** Shows which lights a plan dims, and how far. */
  async showDimmed(pixels: readonly DimmedPixel[]): Promise<void> {
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

  /** Marks a place; one that was picked just now stays in view when the sky takes its part of the page. */
  mark(place: Place | null, isPicked: boolean): void {
    this.isFollowing = isPicked;
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
  goTo(place: Place): void {
    this.map.easeTo({
      center: [place.longitude_deg, place.latitude_deg],
      zoom: Math.max(this.map.getZoom(), 7),
      duration: MOVE_MS,
    });
  }

  /** Shows a town that someone points at. */
  showTown(town: NamedPlace | null): void {
    this.town.remove();
    if (town === null) return;
    this.town.getElement().textContent = town.name;
    this.town.setLngLat([town.longitude_deg, town.latitude_deg]).addTo(this.map);
  }

  /** Marks darker places by their rank; their list says the same. */
  showDarker(places: readonly DarkerPlace[]): void {
    for (const marker of this.darker) marker.remove();
    this.darker = places.map(({ rank, latitude_deg, longitude_deg }) => {
      const element = make("div", "darker-mark", String(rank));
      element.setAttribute("aria-hidden", "true");
      element.addEventListener("click", (event) => {
        event.stopPropagation();
        this.events.picked({ latitude_deg, longitude_deg });
      });
      return new Marker({ element, anchor: "center" }).setLngLat([longitude_deg, latitude_deg]).addTo(this.map);
    });
  }

  /** Moves so that a place and the picked one are in view. */
  showBeside(place: Place): void {
    if (this.isInView(place)) return;
    const bounds = new LngLatBounds();
    for (const { longitude_deg, latitude_deg } of [place, this.marked ?? place]) bounds.extend([longitude_deg, latitude_deg]);
    this.map.fitBounds(bounds, { padding: 2 * EDGE_PX, maxZoom: this.map.getZoom(), duration: MOVE_MS });
  }

  jumpTo(view: MapView): void {
    this.isFollowing = false;
    this.map.jumpTo({ center: [view.longitude_deg, view.latitude_deg], zoom: view.zoom });
  }

  /** Asks again for tiles that did not come. */
  refreshTiles(): void {
    this.failedSources.clear();
    this.layers.refreshTiles();
  }

  resize(): void {
    this.map.resize();
  }
}
