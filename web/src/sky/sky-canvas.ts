// The picture of the sky on two canvases: the sky with its frame, and over it what moves with the pointer.

import type { NamedPlace } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { Place } from "../state/view-state.ts";
import { drawFrame } from "./frame.ts";
import { GpuPainter } from "./gpu-painter.ts";
import type { SkyGrid } from "./grid.ts";
import { drawCross, drawCurve, drawHorizon, drawTown, drawTowns, type TownDirection } from "./overlay.ts";
import { paintSky } from "./paint.ts";
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
import type { Region } from "./region.ts";
import type { PictureLook } from "./shading.ts";
import { townsOnHorizon } from "./towns.ts";

/** All that the picture is drawn from. */
export interface SkyScene extends PictureLook {
  grid: SkyGrid | null;
  /** Another sky left of the split. */
  other: SkyGrid | null;
  /** Where the other sky ends, as a part of the picture's width. */
  split: number;
  projection: ProjectionName;
  /** Where a perspective looks. */
  gaze: Gaze;
  place: Place | null;
  /** The towns around the place, whose names stand where their glow is. */
  places: readonly NamedPlace[];
  /** While it is dragged, a picture comes soon rather than fine. */
  isDragged: boolean;
}

/** What is drawn over the picture. */
export interface SkyMarks {
  /** A curve that is being drawn. */
  trail: Region | null;
  region: Region | null;
  pointed: SkyDirection | null;
  /** A town that someone points at elsewhere. */
  town: TownDirection | null;
}

/** Room for a town's name along the horizon. */
const NAME_PX = 74;
/** Finer pictures than this cost time and show nothing more: the grid has 256 × 64 samples. */
const MAX_PIXELS_PER_CSS_PX = 2;
/** A smaller container shows nothing. */
const MIN_SIZE_PX = 40;

interface Margin {
  left: number;
  right: number;
  top: number;
  bottom: number;
}
const even = (px: number): Margin => ({ left: px, right: px, top: px, bottom: px });
const MARGINS: Record<ProjectionName, Margin> = {
  equirectangular: { left: 34, right: 8, top: 8, bottom: 28 },
  fisheye: even(26),
  perspective: even(8),
};

export class SkyCanvas {
  readonly picture = document.createElement("canvas");
  readonly overlay = document.createElement("canvas");
  plot: Plot = { leftPx: 0, topPx: 0, widthPx: 1, heightPx: 1 };
  projection: Projection | null = null;
  private scale = 1;
  private isMarked = false;
  private readonly gpu: GpuPainter;

  /** `changed` is called when the picture must be drawn anew. */
  constructor(changed: () => void) {
    this.gpu = new GpuPainter(changed);
    this.picture.className = "sky-picture";
    this.picture.setAttribute("aria-hidden", "true");
    this.overlay.className = "sky-overlay";
    this.overlay.tabIndex = 0;
    this.overlay.setAttribute("role", "application");
    this.overlay.setAttribute("aria-roledescription", words().sky.pictureKind);
    this.overlay.setAttribute("aria-describedby", "sky-readout");
    this.overlay.setAttribute("aria-label", words().sky.picture);
  }

  /** Draws the sky, as large as its container. */
  draw(container: HTMLElement, scene: SkyScene, marks: SkyMarks): void {
    const widthPx = Math.floor(container.clientWidth);
    const heightPx = Math.floor(container.clientHeight);
    if (widthPx < MIN_SIZE_PX || heightPx < MIN_SIZE_PX) return;
    this.scale = Math.min(window.devicePixelRatio || 1, scene.isDragged ? 1 : MAX_PIXELS_PER_CSS_PX);
    const { scale } = this;
    const [width, height] = [Math.round(widthPx * scale), Math.round(heightPx * scale)];
    for (const canvas of [this.picture, this.overlay]) {
      // Setting a size makes a canvas anew, which takes longer than drawing on it.
      if (canvas.width !== width) canvas.width = width;
      if (canvas.height !== height) canvas.height = height;
    }
    const { left, right, top, bottom } = MARGINS[scene.projection];
    this.plot = { leftPx: left, topPx: top, widthPx: widthPx - left - right, heightPx: heightPx - top - bottom };
    const { plot } = this;
    const projection = { equirectangular, fisheye, perspective }[scene.projection](plot, scene.gaze);
    this.projection = projection;
    const context = this.picture.getContext("2d");
    if (context === null) return;
    context.clearRect(0, 0, width, height);
    if (scene.grid !== null) this.drawSkies(context, scene.grid, scene, projection);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    drawFrame(context, projection, plot);
    if (scene.grid !== null) {
      // By night the ground ends where the stars do.
      if (scene.colours !== "eye") drawHorizon(context, projection, plot, scene.grid);
      if (scene.place !== null) {
        const towns = townsOnHorizon(scene.place, scene.places, this.minSeparationDeg(scene));
        const fieldDeg = scene.projection === "perspective" ? scene.gaze.fieldDeg : 90;
        drawTowns(context, projection, plot, fieldDeg, scene.grid, towns);
      }
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    this.drawMarks(scene.grid, marks);
  }

  /** Draws the curve and the cross. */
  drawMarks(grid: SkyGrid | null, { trail, region, pointed, town }: SkyMarks): void {
    const context = this.overlay.getContext("2d");
    if (context === null || this.projection === null) return;
    const isMarked = grid !== null && (trail ?? region ?? pointed ?? town) !== null;
    // What is empty and stays so need not be shown anew.
    if (isMarked || this.isMarked) context.clearRect(0, 0, this.overlay.width, this.overlay.height);
    this.isMarked = isMarked;
    if (!isMarked) return;
    context.setTransform(this.scale, 0, 0, this.scale, 0, 0);
    if (trail !== null) drawCurve(context, this.projection, this.plot, trail, false);
    else if (region !== null) drawCurve(context, this.projection, this.plot, region, true);
    if (town !== null) drawTown(context, this.projection, this.plot, grid, town);
    if (pointed !== null) drawCross(context, this.projection, grid.nearest(pointed.azimuthDeg, pointed.elevationDeg));
    context.setTransform(1, 0, 0, 1, 0, 0);
  }

  /** The direction at a point of the canvas, CSS pixels; null where there is no sky. */
  directionAt(xPx: number, yPx: number): SkyDirection | null {
    const direction = this.projection?.directionFromPoint(xPx, yPx) ?? null;
    return direction !== null && direction.elevationDeg < 0 ? null : direction;
  }

  /** Whether a direction lies inside the plot. */
  shows(direction: SkyDirection): boolean {
    const point = this.projection?.pointFromDirection(direction);
    if (point === undefined) return false;
    const { leftPx, topPx, widthPx, heightPx } = this.plot;
    return point.xPx > leftPx && point.xPx < leftPx + widthPx && point.yPx > topPx && point.yPx < topPx + heightPx;
  }

  /** The sky, and another one left of the split with a line between them. */
  private drawSkies(context: CanvasRenderingContext2D, grid: SkyGrid, scene: SkyScene, projection: Projection): void {
    const { plot, scale, gpu } = this;
    const { width, height } = this.picture;
    const splitPx = Math.round((plot.leftPx + scene.split * plot.widthPx) * scale);
    const { sky, colours, exposureEv, gaze, other } = scene;
    const look = { sky, colours, exposureEv };
    const skies: [SkyGrid, number][] =
      other === null || splitPx < 1
        ? [[grid, width]]
        : [
            [grid, width],
            [other, splitPx],
          ];
    if (gpu.isReady) {
      gpu.begin(width, height);
      for (const [each, untilPx] of skies) gpu.paint(each, look, { projection, gaze, plot, pixelsPerCssPx: scale }, untilPx);
      context.drawImage(gpu.canvas, 0, 0);
    } else {
      for (const [each, untilPx] of skies) {
        const image = context.createImageData(untilPx, height);
        paintSky(image, each, look, projection, scale);
        context.putImageData(image, 0, 0);
      }
    }
    if (skies.length === 1) return;
    context.fillStyle = "#ffffff";
    context.fillRect(splitPx - scale / 2, plot.topPx * scale, scale, plot.heightPx * scale);
  }

  /** Names nearer to each other than this would overlap. */
  private minSeparationDeg({ projection, gaze }: SkyScene): number {
    const { widthPx, heightPx } = this.plot;
    if (projection === "perspective") return (NAME_PX / heightPx) * gaze.fieldDeg;
    const aroundPx = projection === "fisheye" ? Math.PI * Math.min(widthPx, heightPx) : widthPx;
    return Math.min((NAME_PX / aroundPx) * 360, 90);
  }
}
