// Strokes on the map by mouse, finger or keyboard, and how painted areas are shown.

import type { FeatureCollection } from "geojson";
import type { GeoJSONSource, Map as MapLibreMap, PointLike } from "maplibre-gl";
import type { EditBody } from "../api/schema.ts";
import type { LonLat, PaintedArea } from "../lights/painting.ts";

export interface Brush {
  shape: PaintedArea["shape"];
  /** Of the brush. */
  radiusM: number;
}

const EARTH_CIRCUMFERENCE_M = 40_075_017;
/** MapLibre's world at zoom 0. */
const WORLD_PX = 512;
/** Smallest distance between two points of a stroke. */
const MIN_STEP_PX = 4;
const STEPS_A_WIDTH = 4;
const MAX_POINTS = 400;
/** A stroke's end set again nearer than this closes an area by keyboard. */
const SAME_PX = 2;

type Feature = { type: "Feature"; properties: Record<string, number>; geometry: { type: string; coordinates: unknown } };

/** Width of a brush at zoom 0; the style doubles it at each level. */
function widthPxAtZoom0(radiusM: number, latitudeDeg: number): number {
  const metresAPx = (EARTH_CIRCUMFERENCE_M * Math.cos((latitudeDeg * Math.PI) / 180)) / WORLD_PX;
  return (2 * radiusM) / metresAPx;
}

function featureOf(area: PaintedArea, closed = true): Feature | null {
  const [first] = area.points;
  if (first === undefined) return null;
  if (area.shape === "brush") {
    // A line without length is not drawn.
    const points = area.points.length > 1 ? area.points : [first, [first[0] + 1e-6, first[1]]];
    return {
      type: "Feature",
      properties: { widthPx: widthPxAtZoom0(area.radiusM, first[1]) },
      geometry: { type: "LineString", coordinates: points },
    };
  }
  const ring = closed ? [...area.points, first] : area.points;
  return {
    type: "Feature",
    properties: {},
    geometry: closed ? { type: "Polygon", coordinates: [ring] } : { type: "LineString", coordinates: ring },
  };
}

/** The area of an edit, as it is shown. */
function featureOfEdit({ brush, polygon }: EditBody): Feature | null {
  if (brush != null) return featureOf({ shape: "brush", points: brush.points, radiusM: brush.radius_m });
  const geometry = polygon as { type: string; coordinates: unknown } | null | undefined;
  return geometry == null ? null : { type: "Feature", properties: {}, geometry };
}

function show(source: GeoJSONSource | undefined, features: readonly (Feature | null)[]): void {
  source?.setData({
    type: "FeatureCollection",
    features: features.filter((feature) => feature !== null),
  } as FeatureCollection);
}

export class Painter {
  private brush: Brush | null = null;
  private points: LonLat[] = [];
  private lastPx: { x: number; y: number } | null = null;
  private pointer: number | null = null;

  constructor(
    private readonly map: MapLibreMap,
    private readonly painted: (area: PaintedArea) => void,
  ) {
    const canvas = map.getCanvasContainer();
    canvas.addEventListener("pointerdown", (event) => this.begin(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.extend(event), { capture: true });
    canvas.addEventListener("pointerup", (event) => this.end(event), { capture: true });
    canvas.addEventListener("pointercancel", () => this.reset(), { capture: true });
  }

  /** Strokes paint with this brush; null: they move the map. */
  setBrush(brush: Brush | null): void {
    const isSameStroke = brush !== null && brush.shape === this.brush?.shape;
    this.brush = brush;
    const canvas = this.map.getCanvasContainer();
    canvas.classList.toggle("painting", brush !== null);
    for (const handler of [this.map.dragPan, this.map.doubleClickZoom, this.map.boxZoom]) {
      if (brush === null) handler.enable();
      else handler.disable();
    }
    if (!isSameStroke) this.reset();
  }

  isPainting(): boolean {
    return this.brush !== null;
  }

  showEdits(edits: readonly EditBody[]): void {
    show(this.map.getSource<GeoJSONSource>("painted"), edits.map(featureOfEdit));
  }

  /** By keyboard: a dab of the brush in the middle of the map, or a corner there; twice in one place closes the area. */
  pressEnter(): void {
    const { lng, lat } = this.map.getCenter();
    const placePx = this.map.project([lng, lat]);
    if (this.brush?.shape === "brush") {
      this.points = [[lng, lat]];
      this.finish();
      return;
    }
    const before = this.points.at(-1);
    if (before !== undefined) {
      const beforePx = this.map.project([before[0], before[1]]);
      if (Math.hypot(beforePx.x - placePx.x, beforePx.y - placePx.y) < SAME_PX) {
        this.finish();
        return;
      }
    }
    this.points.push([lng, lat]);
    this.showStroke();
  }

  private begin(event: PointerEvent): void {
    if (this.brush === null || !event.isPrimary || event.button !== 0) {
      // A second finger zooms: that is no stroke.
      if (this.pointer !== null) this.reset();
      return;
    }
    this.pointer = event.pointerId;
    // A stroke may leave the map, and end beside it.
    this.map.getCanvasContainer().setPointerCapture(event.pointerId);
    this.points = [];
    this.lastPx = null;
    this.add(event);
  }

  private extend(event: PointerEvent): void {
    if (event.pointerId !== this.pointer) return;
    if (event.buttons === 0) this.end(event);
    else this.add(event);
  }

  private end(event: PointerEvent): void {
    if (event.pointerId !== this.pointer) return;
    this.pointer = null;
    this.finish();
  }

  private add(event: PointerEvent): void {
    const box = this.map.getCanvasContainer().getBoundingClientRect();
    const placePx = { x: event.clientX - box.left, y: event.clientY - box.top };
    const { lastPx } = this;
    if (lastPx !== null && Math.hypot(placePx.x - lastPx.x, placePx.y - lastPx.y) < this.stepPx()) return;
    this.lastPx = placePx;
    const point: PointLike = [placePx.x, placePx.y];
    const { lng, lat } = this.map.unproject(point);
    this.points.push([lng, lat]);
    this.showStroke();
  }

  /** Points nearer to each other than a part of the brush add nothing, and their strokes overlap. */
  private stepPx(): number {
    if (this.brush?.shape !== "brush") return MIN_STEP_PX;
    const widthPx = widthPxAtZoom0(this.brush.radiusM, this.map.getCenter().lat) * 2 ** this.map.getZoom();
    return Math.max(widthPx / STEPS_A_WIDTH, MIN_STEP_PX);
  }

  private area(): PaintedArea | null {
    if (this.brush === null || this.points.length === 0) return null;
    const { shape, radiusM } = this.brush;
    return shape === "brush" ? { shape, points: this.points, radiusM } : { shape, points: this.points };
  }

  private showStroke(): void {
    const area = this.area();
    show(this.map.getSource<GeoJSONSource>("stroke"), area === null ? [] : [featureOf(area, false)]);
  }

  /** Ends the stroke: its points lie on one side of the antimeridian, and are not too many. */
  private finish(): void {
    const every = Math.ceil(this.points.length / MAX_POINTS);
    const thinned = this.points.filter((_, i) => i % every === 0);
    const turns = Math.floor((Math.min(...thinned.map(([lon]) => lon)) + 180) / 360);
    this.points = thinned.map(([lon, lat]) => [lon - 360 * turns, lat]);
    const area = this.area();
    this.reset();
    if (area !== null && (area.shape === "brush" || area.points.length >= 3)) this.painted(area);
  }

  private reset(): void {
    this.points = [];
    this.lastPx = null;
    this.pointer = null;
    this.showStroke();
  }
}
