// The picture of the sky: canvas, frame, pointer and keyboard readout.

import type { NamedPlace } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { Place } from "../state.ts";
import { make } from "../ui/dom.ts";
import type { SkyGrid, SkySample } from "./grid.ts";
import { drawCross, drawCurve, drawFrame, drawHorizon, drawTowns } from "./overlay.ts";
import { type PictureLook, paintSky } from "./paint.ts";
import {
  equirectangular,
  fisheye,
  type Gaze,
  type Plot,
  type Projection,
  type ProjectionName,
  perspective,
  type SkyDirection,
} from "./projection.ts";
import { type Region, regionFromTrail } from "./region.ts";
import { townsOnHorizon } from "./towns.ts";

export interface SkyLook extends PictureLook {
  projection: ProjectionName;
  /** A part of the sky that is marked. */
  region: Region | null;
  /** Where the perspective looks; null: towards the brightest light. */
  gaze: Gaze | null;
}

export interface SkyViewEvents {
  pointed: (sample: SkySample | null) => void;
  /** A curve was closed, or drawing ended without one. */
  drawn: (region: Region | null) => void;
  /** Somebody looks elsewhere. */
  gazed: (gaze: Gaze) => void;
}

const FIELD_DEG = { initial: 55, least: 15, most: 110 };
/** How far the eye is raised from the brightest light, which is low. */
const INITIAL_ELEVATION_DEG = 17;
const ZOOM_STEP = 1.15;
/** The server draws no wider perspective. */
const WIDEST_FOV_DEG = 150;

/** Room for a town's name along the horizon. */
const NAME_PX = 74;

/** Finer pictures than this cost time and show nothing more: the grid has 256 × 64 samples. */
const FINEST_PIXELS_PER_CSS_PX = 2;

const MARGIN = { view: 8, strip: { left: 34, right: 8, top: 8, bottom: 28 }, disc: 26 };

export class SkyView {
  private readonly picture = document.createElement("canvas");
  private readonly overlay = document.createElement("canvas");
  private grid: SkyGrid | null = null;
  private other: SkyGrid | null = null;
  /** Where the other sky ends, as a part of the picture's width. */
  private split = 0.5;
  private projection: Projection | null = null;
  private plot: Plot = { leftPx: 0, topPx: 0, widthPx: 1, heightPx: 1 };
  private draggedFrom: { xPx: number; yPx: number } | null = null;
  private drawingSoon = false;
  /** Where every pointer that is down was last. */
  private readonly fingers = new Map<number, { xPx: number; yPx: number }>();
  private place: Place | null = null;
  private places: readonly NamedPlace[] = [];
  private pointed: SkyDirection | null = null;
  /** What is drawn so far; null while nothing is to be drawn. */
  private trail: SkyDirection[] | null = null;

  constructor(
    private readonly container: HTMLElement,
    private look: SkyLook,
    private readonly events: SkyViewEvents,
  ) {
    this.picture.className = "sky-picture";
    this.picture.setAttribute("aria-hidden", "true");
    this.overlay.className = "sky-overlay";
    this.overlay.tabIndex = 0;
    this.overlay.setAttribute("role", "application");
    this.overlay.setAttribute("aria-roledescription", words().sky.pictureKind);
    this.overlay.setAttribute("aria-describedby", "sky-readout");
    this.overlay.setAttribute("aria-label", words().sky.picture);
    this.container.append(make("div", "sky-canvases", this.picture, this.overlay));
    this.overlay.addEventListener("pointermove", (event) => {
      if (this.pinch(event) || this.turn(event)) return;
      this.pointAt(event);
      if (event.buttons !== 0) this.drawOn();
    });
    this.overlay.addEventListener("pointerdown", (event) => {
      this.fingers.set(event.pointerId, { xPx: event.offsetX, yPx: event.offsetY });
      // A second finger zooms; other buttons do nothing.
      if (!event.isPrimary || event.button !== 0) return;
      this.pointAt(event);
      if (this.trail === null && this.look.projection !== "perspective") return;
      this.overlay.setPointerCapture(event.pointerId);
      if (this.trail === null) {
        this.draggedFrom = { xPx: event.offsetX, yPx: event.offsetY };
        return;
      }
      this.trail = [];
      this.drawOn();
    });
    this.overlay.addEventListener("pointerup", (event) => {
      this.fingers.delete(event.pointerId);
      if (!event.isPrimary) return;
      this.endTurn();
      this.closeCurve();
    });
    this.overlay.addEventListener("pointercancel", (event) => {
      this.fingers.delete(event.pointerId);
      this.endTurn();
      if (this.trail !== null) this.trail = [];
      this.drawMarks();
    });
    this.overlay.addEventListener(
      "wheel",
      (event) => {
        if (this.look.projection !== "perspective") return;
        event.preventDefault();
        this.zoom(event.deltaY > 0 ? ZOOM_STEP : 1 / ZOOM_STEP);
      },
      { passive: false },
    );
    this.overlay.addEventListener("pointerleave", (event) => {
      // A finger that was lifted leaves its readout; a mouse that goes away takes it along.
      if (event.pointerType === "mouse") this.setPointed(null);
    });
    this.overlay.addEventListener("keydown", (event) => this.keyPressed(event));
    new ResizeObserver(() => this.draw()).observe(this.container);
  }

  /** Shows a sky; left of the split another one, where there is one. */
  show(grid: SkyGrid | null, other: SkyGrid | null = null): void {
    this.grid = grid;
    this.other = other;
    this.draw();
    this.announce();
  }

  setSplit(part: number): void {
    this.split = part;
    if (this.other !== null) this.drawSoon();
  }

  /** The look may come with more than that; what is drawn already is not drawn again. */
  setLook({ projection, sky, colours, exposureEv, region, gaze }: SkyLook): void {
    const before = this.look;
    this.look = { projection, sky, colours, exposureEv, region, gaze };
    if (Object.entries(this.look).every(([name, value]) => before[name as keyof SkyLook] === value)) return;
    this.draw();
    this.announce();
  }

  /** The place below this sky and the towns around it, whose names stand where their glow is. */
  setTowns(place: Place | null, places: readonly NamedPlace[]): void {
    if (place === this.place && places === this.places) return;
    this.place = place;
    this.places = places;
    this.draw();
  }

  /** What a perspective shows, as the API takes it; null for the others. */
  view(): { azimuth: number; elevation: number; fov: number } | null {
    if (this.look.projection !== "perspective") return null;
    const { azimuthDeg, elevationDeg, fieldDeg } = this.gaze();
    const halfRad = Math.atan((Math.tan((fieldDeg / 2) * (Math.PI / 180)) * this.plot.widthPx) / this.plot.heightPx);
    return {
      azimuth: +azimuthDeg.toFixed(1),
      elevation: +elevationDeg.toFixed(1),
      fov: Math.min(+((2 * halfRad * 180) / Math.PI).toFixed(1), WIDEST_FOV_DEG),
    };
  }

  /** The next curve by hand marks a part of the sky. */
  setDrawing(on: boolean): void {
    this.trail = on ? [] : null;
    this.overlay.classList.toggle("drawing", on);
    if (on) this.overlay.focus();
    this.drawMarks();
  }

  /** Where a direction lies, CSS pixels inside the canvas; null before anything is drawn. */
  pointOf(direction: SkyDirection): { xPx: number; yPx: number } | null {
    return this.projection?.pointFromDirection(direction) ?? null;
  }

  private draw(): void {
    const widthPx = Math.floor(this.container.clientWidth);
    const heightPx = Math.floor(this.container.clientHeight);
    if (widthPx < 40 || heightPx < 40) return;
    const scale = this.pixelsPerCssPx();
    for (const canvas of [this.picture, this.overlay]) {
      canvas.width = Math.round(widthPx * scale);
      canvas.height = Math.round(heightPx * scale);
    }
    if (this.look.projection === "fisheye") {
      const m = MARGIN.disc;
      this.plot = { leftPx: m, topPx: m, widthPx: widthPx - 2 * m, heightPx: heightPx - 2 * m };
      this.projection = fisheye(this.plot);
    } else if (this.look.projection === "perspective") {
      const m = MARGIN.view;
      this.plot = { leftPx: m, topPx: m, widthPx: widthPx - 2 * m, heightPx: heightPx - 2 * m };
      this.projection = perspective(this.plot, this.gaze());
    } else {
      const m = MARGIN.strip;
      this.plot = { leftPx: m.left, topPx: m.top, widthPx: widthPx - m.left - m.right, heightPx: heightPx - m.top - m.bottom };
      this.projection = equirectangular(this.plot);
    }
    const context = this.picture.getContext("2d");
    if (context === null) return;
    if (this.grid !== null) {
      const image = context.createImageData(this.picture.width, this.picture.height);
      paintSky(image, this.grid, this.look, this.projection, scale);
      context.putImageData(image, 0, 0);
      if (this.other !== null) this.drawOther(context, this.other, this.projection, scale);
    }
    context.setTransform(scale, 0, 0, scale, 0, 0);
    drawFrame(context, this.projection, this.plot);
    if (this.grid !== null) {
      drawHorizon(context, this.projection, this.plot, this.grid);
      if (this.place !== null)
        drawTowns(
          context,
          this.projection,
          this.plot,
          this.fieldDeg(),
          this.grid,
          townsOnHorizon(this.place, this.places, this.apartDeg()),
        );
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    this.drawMarks();
  }

  /** Names nearer to each other than this would overlap. */
  private apartDeg(): number {
    if (this.look.projection === "perspective") return (NAME_PX / this.plot.heightPx) * this.gaze().fieldDeg;
    const aroundPx =
      this.look.projection === "fisheye" ? Math.PI * Math.min(this.plot.widthPx, this.plot.heightPx) : this.plot.widthPx;
    return Math.min((NAME_PX / aroundPx) * 360, 90);
  }

  /** How much of the sky fits between the lower and the upper edge. */
  private fieldDeg(): number {
    return this.look.projection === "perspective" ? this.gaze().fieldDeg : 90;
  }

  /** While it is dragged, a picture comes soon rather than fine. */
  private pixelsPerCssPx(): number {
    const screen = window.devicePixelRatio || 1;
    return Math.min(screen, this.draggedFrom === null ? FINEST_PIXELS_PER_CSS_PX : 1);
  }

  private gaze(): Gaze {
    if (this.look.gaze !== null) return this.look.gaze;
    return {
      azimuthDeg: this.grid?.brightest().azimuthDeg ?? 180,
      elevationDeg: INITIAL_ELEVATION_DEG,
      fieldDeg: FIELD_DEG.initial,
    };
  }

  /** Two fingers zoom; whether there are two. */
  private pinch({ pointerId, offsetX, offsetY }: PointerEvent): boolean {
    const before = this.fingers.get(pointerId);
    if (before === undefined) return false;
    const now = { xPx: offsetX, yPx: offsetY };
    this.fingers.set(pointerId, now);
    const other = [...this.fingers].find(([id]) => id !== pointerId)?.[1];
    if (other === undefined || this.look.projection !== "perspective") return false;
    const distancePx = (at: { xPx: number; yPx: number }) => Math.max(Math.hypot(at.xPx - other.xPx, at.yPx - other.yPx), 1);
    this.zoom(distancePx(before) / distancePx(now));
    this.draggedFrom = null;
    return true;
  }

  /** The picture follows the pointer that holds it; whether one does. */
  private turn({ offsetX, offsetY }: PointerEvent): boolean {
    const from = this.draggedFrom;
    if (from === null) return false;
    const gaze = this.gaze();
    const degreesAPx = gaze.fieldDeg / this.plot.heightPx;
    // Near the zenith a degree of azimuth is a short way.
    const around = degreesAPx / Math.max(Math.cos((gaze.elevationDeg * Math.PI) / 180), 0.25);
    this.lookAt({
      azimuthDeg: (gaze.azimuthDeg - (offsetX - from.xPx) * around + 720) % 360,
      elevationDeg: gaze.elevationDeg + (offsetY - from.yPx) * degreesAPx,
      fieldDeg: gaze.fieldDeg,
    });
    this.draggedFrom = { xPx: offsetX, yPx: offsetY };
    return true;
  }

  private endTurn(): void {
    if (this.draggedFrom === null) return;
    this.draggedFrom = null;
    this.draw();
    this.events.gazed(this.gaze());
  }

  private zoom(factor: number): void {
    const gaze = this.gaze();
    this.lookAt({ ...gaze, fieldDeg: Math.min(Math.max(gaze.fieldDeg * factor, FIELD_DEG.least), FIELD_DEG.most) });
    this.events.gazed(this.gaze());
  }

  private lookAt(gaze: Gaze): void {
    this.look = { ...this.look, gaze: { ...gaze, elevationDeg: Math.min(Math.max(gaze.elevationDeg, -10), 90) } };
    this.drawSoon();
  }

  /** Once in a frame, however often something moves in it. */
  private drawSoon(): void {
    if (this.drawingSoon) return;
    this.drawingSoon = true;
    requestAnimationFrame(() => {
      this.drawingSoon = false;
      this.draw();
    });
  }

  /** Looks at where the keyboard's cross went out of the picture. */
  private keepCrossInView(direction: SkyDirection): void {
    const point = this.pointOf(direction);
    const { leftPx, topPx, widthPx, heightPx } = this.plot;
    const inside =
      point !== null && point.xPx > leftPx && point.xPx < leftPx + widthPx && point.yPx > topPx && point.yPx < topPx + heightPx;
    if (this.look.projection !== "perspective" || inside) return;
    this.lookAt({ ...direction, fieldDeg: this.gaze().fieldDeg });
    this.events.gazed(this.gaze());
  }

  /** The other sky lies left of the split, with a line between them. */
  private drawOther(context: CanvasRenderingContext2D, other: SkyGrid, projection: Projection, scale: number): void {
    const splitPx = Math.round((this.plot.leftPx + this.split * this.plot.widthPx) * scale);
    if (splitPx < 1) return;
    const image = context.createImageData(splitPx, this.picture.height);
    paintSky(image, other, this.look, projection, scale);
    context.putImageData(image, 0, 0);
    context.fillStyle = "#ffffff";
    context.fillRect(splitPx - scale / 2, this.plot.topPx * scale, scale, this.plot.heightPx * scale);
  }

  /** The curve and the cross. */
  private drawMarks(): void {
    const context = this.overlay.getContext("2d");
    if (context === null || this.projection === null) return;
    context.clearRect(0, 0, this.overlay.width, this.overlay.height);
    if (this.grid === null) return;
    const scale = this.pixelsPerCssPx();
    context.setTransform(scale, 0, 0, scale, 0, 0);
    if (this.trail !== null) drawCurve(context, this.projection, this.plot, this.trail, false);
    else if (this.look.region !== null) drawCurve(context, this.projection, this.plot, this.look.region, true);
    if (this.pointed !== null)
      drawCross(context, this.projection, this.grid.nearest(this.pointed.azimuthDeg, this.pointed.elevationDeg));
    context.setTransform(1, 0, 0, 1, 0, 0);
  }

  private pointAt(event: PointerEvent): void {
    const direction = this.projection?.directionFromPoint(event.offsetX, event.offsetY) ?? null;
    this.setPointed(direction !== null && direction.elevationDeg < 0 ? null : direction);
  }

  private setPointed(direction: SkyDirection | null): void {
    this.pointed = direction;
    this.drawMarks();
    this.announce();
  }

  /** The curve goes on to where is pointed. */
  private drawOn(): void {
    if (this.trail === null || this.pointed === null) return;
    this.trail.push(this.pointed);
    this.drawMarks();
  }

  private closeCurve(): void {
    if (this.trail === null || this.trail.length === 0) return;
    const region = regionFromTrail(this.trail);
    // A click encloses nothing: drawing goes on.
    this.trail = [];
    if (region !== null) this.endDrawing(region);
    else this.drawMarks();
  }

  private endDrawing(region: Region | null): void {
    this.setDrawing(false);
    this.events.drawn(region);
  }

  /** Sets a corner at the cross; a second one in the same place closes the curve. */
  private setCorner(): void {
    if (this.trail === null || this.pointed === null) return;
    const before = this.trail.at(-1);
    const isSame = before?.azimuthDeg === this.pointed.azimuthDeg && before.elevationDeg === this.pointed.elevationDeg;
    if (isSame) this.closeCurve();
    else this.drawOn();
  }

  private announce(): void {
    const { pointed, grid } = this;
    this.events.pointed(pointed === null || grid === null ? null : grid.nearest(pointed.azimuthDeg, pointed.elevationDeg));
  }

  private keyPressed(event: KeyboardEvent): void {
    const { grid } = this;
    if (event.key === "Escape") {
      if (this.trail === null) this.setPointed(null);
      else this.endDrawing(null);
      return;
    }
    if (grid === null) return;
    if (this.look.projection === "perspective" && (event.key === "+" || event.key === "-")) {
      this.zoom(event.key === "-" ? ZOOM_STEP : 1 / ZOOM_STEP);
      return;
    }
    if (event.key === "Enter" && this.trail !== null) {
      event.preventDefault();
      this.setCorner();
      return;
    }
    const steps = event.shiftKey ? 8 : 1;
    const moves: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1],
    };
    const move = moves[event.key];
    if (move === undefined) return;
    event.preventDefault();
    const ahead = this.look.projection === "perspective" ? this.gaze() : { azimuthDeg: 180, elevationDeg: 45 };
    const from = this.pointed ?? ahead;
    const nearest = grid.nearest(from.azimuthDeg, from.elevationDeg);
    const azimuthDeg = (nearest.azimuthDeg + move[0] * steps * grid.azimuthStepDeg + 360) % 360;
    const lastDeg = grid.elevationFirstDeg + (grid.elevationCount - 1) * grid.elevationStepDeg;
    const elevationDeg = Math.min(
      Math.max(nearest.elevationDeg + move[1] * steps * grid.elevationStepDeg, grid.elevationFirstDeg),
      lastDeg,
    );
    this.keepCrossInView({ azimuthDeg, elevationDeg });
    this.setPointed({ azimuthDeg, elevationDeg });
  }
}
