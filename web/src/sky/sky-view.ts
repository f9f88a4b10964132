// The picture of the sky, and what pointers and keys do over it: read a direction, look around, draw a region.

import { landCdM2Of } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { debounced, make } from "../ui/dom.ts";
import { distanceAndBearing } from "../ui/nearby.ts";
import { movedCursor } from "./cursor.ts";
import { gazeOf, turnGaze, ZOOM_STEP, zoomGaze } from "./gaze.ts";
import type { Gaze, SkyDirection } from "./projection.ts";
import type { Region } from "./region.ts";
import { RegionDrawing } from "./region-drawing.ts";
import { SkyCanvas } from "./sky-canvas.ts";

/** A sky that does not move for so long is drawn fine. */
const REST_MS = 200;

/** CSS pixels from the canvas's left and upper edge. */
type Point = readonly [xPx: number, yPx: number];

export class SkyView {
  private readonly canvas = new SkyCanvas(() => this.drawSoon());
  private readonly drawing = new RegionDrawing();
  /** As it is while it is dragged; the state has it once that ends. */
  private gaze: Gaze | null = null;
  private draggedFrom: Point | null = null;
  /** Where every pointer that is down was last. */
  private readonly fingers = new Map<number, Point>();
  private pointed: SkyDirection | null = null;
  private isDrawnSoon = false;
  private readonly sharpenSoon = debounced(REST_MS, () => this.draw());

  constructor(
    private readonly container: HTMLElement,
    private readonly store: AppStore,
  ) {
    const { overlay, canvases } = this.canvas;
    container.append(make("div", "sky-canvases", ...canvases));
    this.listen(overlay);
    store.watch(["gaze"], ({ gaze }) => {
      if (gaze === this.gaze) return;
      this.gaze = gaze;
      if (this.isPerspective()) this.redraw();
    });
    const drawn = [
      "panorama",
      "panoramaToday",
      "projection",
      "sky",
      "colours",
      "exposureEv",
      "adaptationCdM2",
      "landscape",
      "landscapeToday",
      landCdM2Of,
      "places",
    ] as const;
    // Another place alone is no reason: its sky is on its way, and to draw the last one once more would hold it up.
    store.watch(drawn, () => this.redraw());
    store.watch(["split"], ({ panoramaToday }) => {
      if (panoramaToday !== null) this.drawSoon();
    });
    store.watch(["region", "shownTown"], () => this.drawMarks());
    store.watch(["isDrawing"], ({ isDrawing }) => {
      this.drawing.set(isDrawing);
      overlay.classList.toggle("drawing", isDrawing);
      if (isDrawing) overlay.focus();
      this.drawMarks();
    });
    new ResizeObserver(() => this.draw()).observe(container);
  }

  private listen(overlay: HTMLCanvasElement): void {
    overlay.addEventListener("pointermove", (event) => {
      if (this.pinch(event) || this.turn(event)) return;
      this.pointAt(event);
      if (event.buttons !== 0) this.extendCurve();
    });
    overlay.addEventListener("pointerdown", (event) => {
      const point: Point = [event.offsetX, event.offsetY];
      this.fingers.set(event.pointerId, point);
      // A second finger zooms; other buttons do nothing.
      if (!event.isPrimary || event.button !== 0) return;
      this.pointAt(event);
      const isDrawing = this.drawing.trail !== null;
      if (!isDrawing && !this.isPerspective()) return;
      overlay.setPointerCapture(event.pointerId);
      if (!isDrawing) {
        this.draggedFrom = point;
        return;
      }
      this.drawing.restart();
      this.extendCurve();
    });
    overlay.addEventListener("pointerup", (event) => {
      this.fingers.delete(event.pointerId);
      if (!event.isPrimary) return;
      this.endTurn();
      this.finishCurve(this.drawing.close());
    });
    overlay.addEventListener("pointercancel", (event) => {
      this.fingers.delete(event.pointerId);
      this.endTurn();
      this.drawing.restart();
      this.drawMarks();
    });
    const zoomByWheel = (event: WheelEvent) => {
      if (!this.isPerspective()) return;
      event.preventDefault();
      this.zoom(event.deltaY > 0 ? ZOOM_STEP : 1 / ZOOM_STEP);
    };
    overlay.addEventListener("wheel", zoomByWheel, { passive: false });
    overlay.addEventListener("pointerleave", (event) => {
      // A finger that was lifted leaves its readout; a mouse that goes away takes it along.
      if (event.pointerType === "mouse") this.setPointed(null);
    });
    overlay.addEventListener("keydown", (event) => this.keyPressed(event));
  }

  private isPerspective(): boolean {
    return this.store.state.projection === "perspective";
  }

  private currentGaze(): Gaze {
    return gazeOf(this.gaze, this.store.state.panorama);
  }

  private redraw(): void {
    this.draw();
    this.announce();
  }

  private draw(): void {
    this.canvas.draw(this.container, this.scene(), this.marks());
    this.store.set({ skyAspect: this.canvas.plot.widthPx / this.canvas.plot.heightPx });
  }

  private scene() {
    const { state } = this.store;
    return {
      ...state,
      grid: state.panorama,
      other: state.panoramaToday,
      otherLandscape: state.landscapeToday,
      landCdM2: landCdM2Of(state),
      gaze: this.currentGaze(),
    };
  }

  /** Once in a frame, however often something moves in it; fine once it rests. */
  private drawSoon(): void {
    if (this.isDrawnSoon) return;
    this.isDrawnSoon = true;
    requestAnimationFrame(() => {
      this.isDrawnSoon = false;
      if (this.canvas.drawMoving(this.container, this.scene(), this.marks())) this.sharpenSoon();
      else this.draw();
    });
  }

  private drawMarks(): void {
    this.canvas.drawMarks(this.store.state.panorama, this.marks());
  }

  private marks() {
    const { region, place, shownTown } = this.store.state;
    const town =
      place === null || shownTown === null
        ? null
        : { name: shownTown.name, azimuthDeg: distanceAndBearing(place, shownTown).bearingDeg };
    return { trail: this.drawing.trail, region, pointed: this.pointed, town };
  }

  /** Two fingers zoom; whether there are two. */
  private pinch({ pointerId, offsetX, offsetY }: PointerEvent): boolean {
    const before = this.fingers.get(pointerId);
    if (before === undefined) return false;
    const now: Point = [offsetX, offsetY];
    this.fingers.set(pointerId, now);
    const other = [...this.fingers].find(([id]) => id !== pointerId)?.[1];
    if (other === undefined || !this.isPerspective()) return false;
    const distancePx = ([x, y]: Point) => Math.max(Math.hypot(x - other[0], y - other[1]), 1);
    this.zoom(distancePx(before) / distancePx(now));
    this.draggedFrom = null;
    return true;
  }

  /** The picture follows the pointer that holds it; whether one does. */
  private turn({ offsetX, offsetY }: PointerEvent): boolean {
    if (this.draggedFrom === null) return false;
    const [fromX, fromY] = this.draggedFrom;
    this.gaze = turnGaze(this.currentGaze(), offsetX - fromX, offsetY - fromY, this.canvas.plot.heightPx);
    this.draggedFrom = [offsetX, offsetY];
    this.drawSoon();
    return true;
  }

  private endTurn(): void {
    if (this.draggedFrom === null) return;
    this.draggedFrom = null;
    this.draw();
    this.lookAt(this.currentGaze());
  }

  private zoom(factor: number): void {
    this.lookAt(zoomGaze(this.currentGaze(), factor));
    this.drawSoon();
  }

  private lookAt(gaze: Gaze): void {
    this.gaze = gaze;
    this.store.set({ gaze });
  }

  private pointAt({ offsetX, offsetY }: PointerEvent): void {
    this.setPointed(this.canvas.directionAt(offsetX, offsetY));
  }

  private setPointed(direction: SkyDirection | null): void {
    this.pointed = direction;
    this.drawMarks();
    this.announce();
  }

  private announce(): void {
    const { pointed } = this;
    const { panorama } = this.store.state;
    const sample = pointed === null || panorama === null ? null : panorama.nearest(pointed.azimuthDeg, pointed.elevationDeg);
    this.store.set({ pointed: sample });
  }

  /** The curve goes on to where is pointed. */
  private extendCurve(): void {
    if (this.drawing.trail === null) return;
    this.drawing.extend(this.pointed);
    this.drawMarks();
  }

  /** Marks a closed region; without one, drawing goes on. */
  private finishCurve(region: Region | null): void {
    if (region === null) {
      this.drawMarks();
      return;
    }
    this.store.set({ isDrawing: false });
    this.store.markRegion(region);
  }

  private keyPressed(event: KeyboardEvent): void {
    const { panorama } = this.store.state;
    if (event.key === "Escape") {
      if (this.drawing.trail === null) this.setPointed(null);
      else this.store.set({ isDrawing: false });
      return;
    }
    if (panorama === null) return;
    if (this.isPerspective() && (event.key === "+" || event.key === "-")) {
      this.zoom(event.key === "-" ? ZOOM_STEP : 1 / ZOOM_STEP);
      return;
    }
    if (event.key === "Enter" && this.drawing.trail !== null) {
      event.preventDefault();
      this.finishCurve(this.drawing.setCorner(this.pointed));
      return;
    }
    const ahead = this.isPerspective() ? this.currentGaze() : { azimuthDeg: 180, elevationDeg: 45 };
    const moved = movedCursor(event, this.pointed ?? ahead, panorama);
    if (moved === null) return;
    event.preventDefault();
    // The perspective looks at where the cross went out of the picture.
    if (this.isPerspective() && !this.canvas.shows(moved)) {
      this.lookAt({ ...moved, fieldDeg: this.currentGaze().fieldDeg });
      this.drawSoon();
    }
    this.setPointed(moved);
  }
}
