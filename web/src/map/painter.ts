// Strokes on the map by mouse, finger or keyboard, and how painted areas are shown.

import type { GeoJSONSource, Map as MapLibreMap, PointLike } from "maplibre-gl";
import type { EditBody } from "../api/schema.ts";
import type { LonLat, PaintedArea } from "../painting.ts";

export interface Brush {
  shape: PaintedArea["shape"];
  /** Of the brush. */
  radius_m: number;
}

const EARTH_CIRCUMFERENCE_M = 40_075_017;
/** MapLibre's world at zoom 0. */
const WORLD_PX = 512;
/** Points of a stroke nearer to each other than this tell nothing. */
const LEAST_STEP_PX = 4;
const STEPS_A_WIDTH = 4;
const MOST_POINTS = 400;
/** A stroke's end set again nearer than this closes an area by keyboard. */
const SAME_PX = 2;

type Feature = { type: "Feature"; properties: Record<string, number>; geometry: { type: string; coordinates: unknown } };

/** Width of a brush at zoom 0; the style doubles it at each level. */
function width_px_at_zoom_0(radius_m: number, latitude_deg: number): number {
  const metres_a_px = (EARTH_CIRCUMFERENCE_M * Math.cos((latitude_deg * Math.PI) / 180)) / WORLD_PX;
  return (2 * radius_m) / metres_a_px;
}

function feature_of(area: PaintedArea, closed = true): Feature | null {
  const [first] = area.points;
  if (first === undefined) return null;
  if (area.shape === "brush") {
    // A line without length is not drawn.
    const points = area.points.length > 1 ? area.points : [first, [first[0] + 1e-6, first[1]]];
    return { type: "Feature", properties: { width_px: width_px_at_zoom_0(area.radius_m, first[1]) }, geometry: { type: "LineString", coordinates: points } };
  }
  const ring = closed ? [...area.points, first] : area.points;
  return { type: "Feature", properties: {}, geometry: closed ? { type: "Polygon", coordinates: [ring] } : { type: "LineString", coordinates: ring } };
}

/** The area of an edit, as it is shown. */
function feature_of_edit({ brush, polygon }: EditBody): Feature | null {
  if (brush != null) return feature_of({ shape: "brush", points: brush.points, radius_m: brush.radius_m });
  const geometry = polygon as { type: string; coordinates: unknown } | null | undefined;
  return geometry == null ? null : { type: "Feature", properties: {}, geometry };
}

function show(source: GeoJSONSource | undefined, features: readonly (Feature | null)[]): void {
  source?.setData({ type: "FeatureCollection", features: features.filter((feature) => feature !== null) } as GeoJSON.FeatureCollection);
}

export class Painter {
  private brush: Brush | null = null;
  private points: LonLat[] = [];
  private last_px: { x: number; y: number } | null = null;
  private pointer: number | null = null;

  constructor(
    private readonly map: MapLibreMap,
    private readonly painted: (area: PaintedArea) => void,
  ) {
    const canvas = map.getCanvasContainer();
    canvas.addEventListener("pointerdown", (event) => this.begin(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.go_on(event), { capture: true });
    canvas.addEventListener("pointerup", (event) => this.end(event), { capture: true });
    canvas.addEventListener("pointercancel", () => this.forget(), { capture: true });
  }

  /** Strokes paint with this brush; null: they move the map. */
  set_brush(brush: Brush | null): void {
    const is_same_stroke = brush !== null && brush.shape === this.brush?.shape;
    this.brush = brush;
    const canvas = this.map.getCanvasContainer();
    canvas.classList.toggle("painting", brush !== null);
    for (const handler of [this.map.dragPan, this.map.doubleClickZoom, this.map.boxZoom]) {
      if (brush === null) handler.enable();
      else handler.disable();
    }
    if (!is_same_stroke) this.forget();
  }

  is_painting(): boolean {
    return this.brush !== null;
  }

  show_edits(edits: readonly EditBody[]): void {
    show(this.map.getSource<GeoJSONSource>("painted"), edits.map(feature_of_edit));
  }

  /** By keyboard: a dab of the brush in the middle of the map, or a corner there; twice in one place closes the area. */
  press_enter(): void {
    const { lng, lat } = this.map.getCenter();
    const place_px = this.map.project([lng, lat]);
    if (this.brush?.shape === "brush") {
      this.points = [[lng, lat]];
      this.tell();
      return;
    }
    const before = this.points.at(-1);
    if (before !== undefined) {
      const before_px = this.map.project([before[0], before[1]]);
      if (Math.hypot(before_px.x - place_px.x, before_px.y - place_px.y) < SAME_PX) {
        this.tell();
        return;
      }
    }
    this.points.push([lng, lat]);
    this.show_stroke();
  }

  private begin(event: PointerEvent): void {
    if (this.brush === null || !event.isPrimary || event.button !== 0) {
      // A second finger zooms: that is no stroke.
      if (this.pointer !== null) this.forget();
      return;
    }
    this.pointer = event.pointerId;
    // A stroke may leave the map, and end beside it.
    this.map.getCanvasContainer().setPointerCapture(event.pointerId);
    this.points = [];
    this.last_px = null;
    this.add(event);
  }

  private go_on(event: PointerEvent): void {
    if (event.pointerId !== this.pointer) return;
    if (event.buttons === 0) this.end(event);
    else this.add(event);
  }

  private end(event: PointerEvent): void {
    if (event.pointerId !== this.pointer) return;
    this.pointer = null;
    this.tell();
  }

  private add(event: PointerEvent): void {
    const box = this.map.getCanvasContainer().getBoundingClientRect();
    const place_px = { x: event.clientX - box.left, y: event.clientY - box.top };
    const { last_px } = this;
    if (last_px !== null && Math.hypot(place_px.x - last_px.x, place_px.y - last_px.y) < this.step_px()) return;
    this.last_px = place_px;
    const point: PointLike = [place_px.x, place_px.y];
    const { lng, lat } = this.map.unproject(point);
    this.points.push([lng, lat]);
    this.show_stroke();
  }

  /** Points nearer to each other than a good part of the brush tell nothing, and their strokes overlap. */
  private step_px(): number {
    if (this.brush?.shape !== "brush") return LEAST_STEP_PX;
    const width_px = width_px_at_zoom_0(this.brush.radius_m, this.map.getCenter().lat) * 2 ** this.map.getZoom();
    return Math.max(width_px / STEPS_A_WIDTH, LEAST_STEP_PX);
  }

  private area(): PaintedArea | null {
    if (this.brush === null || this.points.length === 0) return null;
    const { shape, radius_m } = this.brush;
    return shape === "brush" ? { shape, points: this.points, radius_m } : { shape, points: this.points };
  }

  private show_stroke(): void {
    const area = this.area();
    show(this.map.getSource<GeoJSONSource>("stroke"), area === null ? [] : [feature_of(area, false)]);
  }

  /** The stroke is done: its points are told, on one side of the antimeridian and not too many. */
  private tell(): void {
    const every = Math.ceil(this.points.length / MOST_POINTS);
    const kept = this.points.filter((_, i) => i % every === 0);
    const turns = Math.floor((Math.min(...kept.map(([lon]) => lon)) + 180) / 360);
    this.points = kept.map(([lon, lat]) => [lon - 360 * turns, lat]);
    const area = this.area();
    this.forget();
    if (area !== null && (area.shape === "brush" || area.points.length >= 3)) this.painted(area);
  }

  private forget(): void {
    this.points = [];
    this.last_px = null;
    this.pointer = null;
    this.show_stroke();
  }
}
