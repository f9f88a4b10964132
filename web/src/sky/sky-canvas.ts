// The picture of the sky on three canvases: the sky with its frame; the same painted by WebGL alone, which is shown while it moves; and
// over them what moves with the pointer.

import type { NamedPlace } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { Place } from "../state/view-state.ts";
import { frameOf } from "./frame.ts";
import { GpuPainter, type SkyPlot } from "./gpu-painter.ts";
import type { SkyGrid } from "./grid.ts";
import type { Landscape } from "./landscape.ts";
import { type Drawing, drawAll, pieces } from "./lines.ts";
import { drawCross, drawCurve, drawTown, skyline, type TownDirection, townsOver } from "./overlay.ts";
import { Pace } from "./pace.ts";
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
import { outline, type Region } from "./region.ts";
import { adaptationOf, type PictureLook } from "./shading.ts";
import { type TownOnHorizon, townsOnHorizon } from "./towns.ts";

/** All that the picture is drawn from. */
export interface SkyScene extends PictureLook {
  grid: SkyGrid | null;
  /** Another sky left of the split. */
  other: SkyGrid | null;
  /** The land in light below each; null: it is dark. */
  landscape: Landscape | null;
  otherLandscape: Landscape | null;
  landCdM2: number;
  /** Where the other sky ends, as a part of the picture's width. */
  split: number;
  projection: ProjectionName;
  /** Where a perspective looks. */
  gaze: Gaze;
  place: Place | null;
  /** The towns around the place, whose names stand where their glow is. */
  places: readonly NamedPlace[];
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
  /** From back to front. */
  get canvases(): readonly HTMLCanvasElement[] {
    return [this.gpu.canvas, this.picture, this.overlay];
  }
  plot: Plot = { leftPx: 0, topPx: 0, widthPx: 1, heightPx: 1 };
  projection: Projection | null = null;
  private scale = 1;
  private readonly pace = new Pace();
  private towns: { place: Place; places: readonly NamedPlace[]; minSeparationDeg: number; found: TownOnHorizon[] } | null = null;
  private isMarked = false;
  private readonly gpu: GpuPainter;

  /** `changed` is called when the picture must be drawn anew. */
  constructor(changed: () => void) {
    this.gpu = new GpuPainter(changed);
    this.picture.className = "sky-picture";
    this.gpu.canvas.setAttribute("aria-hidden", "true");
    this.setMoving(false);
    this.picture.setAttribute("aria-hidden", "true");
    this.overlay.className = "sky-overlay";
    this.overlay.tabIndex = 0;
    this.overlay.setAttribute("role", "application");
    this.overlay.setAttribute("aria-roledescription", words().sky.pictureKind);
    this.overlay.setAttribute("aria-describedby", "sky-readout");
    this.overlay.setAttribute("aria-label", words().sky.picture);
  }

  /** Draws the sky as fine as the screen is, as large as its container. */
  draw(container: HTMLElement, scene: SkyScene, marks: SkyMarks): void {
    const scale = Math.min(window.devicePixelRatio || 1, MAX_PIXELS_PER_CSS_PX);
    const placed = this.place(container, scene);
    if (placed === null) return;
    const { projection, plot } = placed;
    this.scale = scale;
    const [width, height] = [placed.widthPx, placed.heightPx].map((px) => Math.round(px * scale)) as [number, number];
    for (const canvas of [this.picture, this.overlay]) {
      // Setting a size makes a canvas anew, which takes longer than drawing on it.
      if (canvas.width !== width) canvas.width = width;
      if (canvas.height !== height) canvas.height = height;
    }
    const context = this.picture.getContext("2d");
    if (context === null) return;
    context.clearRect(0, 0, width, height);
    if (scene.grid !== null) this.drawSkies(context, scene.grid, scene, projection);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    for (const drawing of this.drawings(scene, projection)) drawAll(context, drawing, plot);
    context.setTransform(1, 0, 0, 1, 0, 0);
    this.setMoving(false);
    this.drawMarks(scene.grid, marks);
  }

  /** Draws the sky as fast as it moves; whether that was done. */
  drawMoving(container: HTMLElement, scene: SkyScene, { trail, region }: SkyMarks): boolean {
    const { gpu, pace } = this;
    const { grid } = scene;
    if (grid === null || !gpu.isReady) return false;
    const placed = this.place(container, scene);
    if (placed === null) return false;
    const { projection, plot } = placed;
    pace.frame(performance.now());
    const scale = pace.scale(window.devicePixelRatio || 1, placed.widthPx * placed.heightPx);
    const [width, height] = [placed.widthPx, placed.heightPx].map((px) => Math.round(px * scale)) as [number, number];
    const splitPx = this.paintSkies(grid, scene, { projection, plot, gaze: scene.gaze, pixelsPerCssPx: scale, isMoving: true }, [
      width,
      height,
    ]);
    const curve = trail ?? (region === null ? null : outline(region));
    const marks: Drawing = {
      lines: [
        ...pieces(projection, curve ?? []).map((points) => ({ points, ink: [111, 240, 220, 1] as const, widthPx: 2 })),
        ...(splitPx === null ? [] : [splitLine(plot, splitPx / scale)]),
      ],
      names: [],
      isClipped: true,
    };
    gpu.drawOver([...this.drawings(scene, projection), marks], plot, scale);
    this.setMoving(true);
    return true;
  }

  /** Which canvas is shown. A canvas that cannot be seen costs no time: marks are among what WebGL draws. */
  private setMoving(isMoving: boolean): void {
    this.picture.style.visibility = isMoving ? "hidden" : "visible";
    this.gpu.canvas.style.visibility = isMoving ? "visible" : "hidden";
    this.overlay.style.opacity = isMoving ? "0" : "1";
  }

  /** Where the picture lies in its container; null where there is no room. */
  private place(
    container: HTMLElement,
    scene: SkyScene,
  ): { projection: Projection; plot: Plot; widthPx: number; heightPx: number } | null {
    const widthPx = Math.floor(container.clientWidth);
    const heightPx = Math.floor(container.clientHeight);
    if (widthPx < MIN_SIZE_PX || heightPx < MIN_SIZE_PX) return null;
    const { left, right, top, bottom } = MARGINS[scene.projection];
    const plot = { leftPx: left, topPx: top, widthPx: widthPx - left - right, heightPx: heightPx - top - bottom };
    const projection = { equirectangular, fisheye, perspective }[scene.projection](plot, scene.gaze);
    this.plot = plot;
    this.projection = projection;
    return { projection, plot, widthPx, heightPx };
  }

  /** What stands over the sky. */
  private drawings(scene: SkyScene, projection: Projection): Drawing[] {
    const { plot } = this;
    const { grid } = scene;
    const frame = frameOf(projection, plot);
    if (grid === null) return [frame];
    // By night the ground ends where the stars do, and land in light where it does.
    const ridge = scene.colours === "eye" || scene.landscape !== null ? [] : skyline(projection, grid);
    const fieldDeg = scene.projection === "perspective" ? scene.gaze.fieldDeg : 90;
    return [
      frame,
      { lines: ridge, names: [], isClipped: projection.name === "perspective" },
      townsOver(projection, plot, fieldDeg, grid, this.townsOf(scene)),
    ];
  }

  /** The towns that are named, which are found once for a place. */
  private townsOf(scene: SkyScene): readonly TownOnHorizon[] {
    const { place, places } = scene;
    if (place === null) return [];
    const minSeparationDeg = this.minSeparationDeg(scene);
    const { towns } = this;
    if (towns?.place === place && towns.places === places && towns.minSeparationDeg === minSeparationDeg) return towns.found;
    const found = townsOnHorizon(place, places, minSeparationDeg);
    this.towns = { place, places, minSeparationDeg, found };
    return found;
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
    const { scale, gpu } = this;
    const { width, height } = this.picture;
    let splitPx: number | null;
    if (gpu.isReady) {
      const { plot } = this;
      splitPx = this.paintSkies(grid, scene, { projection, plot, gaze: scene.gaze, pixelsPerCssPx: scale, isMoving: false }, [
        width,
        height,
      ]);
      context.drawImage(gpu.canvas, 0, 0);
    } else {
      splitPx = this.splitPx(scene, scale);
      for (const [each, untilPx, landscape] of skiesOf(grid, scene, splitPx, width)) {
        const image = context.createImageData(untilPx, height);
        paintSky(image, each, lookOf(grid, scene), projection, scale, landscape);
        context.putImageData(image, 0, 0);
      }
    }
    if (splitPx === null) return;
    context.setTransform(scale, 0, 0, scale, 0, 0);
    drawAll(context, { lines: [splitLine(this.plot, splitPx / scale)], names: [], isClipped: false }, this.plot);
    context.setTransform(1, 0, 0, 1, 0, 0);
  }

  /** Paints on the canvas of WebGL; where the other sky ends, device pixels. */
  private paintSkies(grid: SkyGrid, scene: SkyScene, plot: SkyPlot, [width, height]: readonly [number, number]): number | null {
    const look = lookOf(grid, scene);
    const splitPx = this.splitPx(scene, plot.pixelsPerCssPx);
    this.gpu.begin(width, height);
    for (const [each, untilPx, landscape] of skiesOf(grid, scene, splitPx, width))
      this.gpu.paint(each, look, plot, untilPx, landscape);
    return splitPx;
  }

  private splitPx({ other, split }: SkyScene, scale: number): number | null {
    const splitPx = Math.round((this.plot.leftPx + split * this.plot.widthPx) * scale);
    return other === null || splitPx < 1 ? null : splitPx;
  }

  /** Names nearer to each other than this would overlap. */
  private minSeparationDeg({ projection, gaze }: SkyScene): number {
    const { widthPx, heightPx } = this.plot;
    if (projection === "perspective") return (NAME_PX / heightPx) * gaze.fieldDeg;
    const aroundPx = projection === "fisheye" ? Math.PI * Math.min(widthPx, heightPx) : widthPx;
    return Math.min((NAME_PX / aroundPx) * 360, 90);
  }
}

/** How both skies are shown: the eye is adapted to one of them. */
function lookOf(grid: SkyGrid, scene: SkyScene): PictureLook {
  const { sky, colours, exposureEv } = scene;
  return { sky, colours, exposureEv, adaptationCdM2: colours === "eye" ? adaptationOf(grid, scene, scene.landCdM2) : null };
}

/** The skies that are painted one over the other, each until a column of the canvas. */
function skiesOf(
  grid: SkyGrid,
  { other, landscape, otherLandscape }: SkyScene,
  splitPx: number | null,
  width: number,
): [SkyGrid, number, Landscape | null][] {
  const whole: [SkyGrid, number, Landscape | null] = [grid, width, landscape];
  return other === null || splitPx === null ? [whole] : [whole, [other, splitPx, otherLandscape]];
}

function splitLine({ topPx, heightPx }: Plot, xPx: number) {
  const points = [
    [xPx, topPx],
    [xPx, topPx + heightPx],
  ] as const;
  return { points, ink: [255, 255, 255, 1] as const, widthPx: 1 };
}
