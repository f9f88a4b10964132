// Lines and names over the sky as data, drawn on a canvas here and by WebGL in `live-lines.ts`.

import type { Plot, Projection, SkyDirection } from "./projection.ts";

/** Pixels from the left and from the top. */
export type Point = readonly [number, number];
/** Red, green and blue, 0 to 255, and how much of it covers, 0 to 1. */
export type Ink = readonly [number, number, number, number];

export interface Line {
  points: readonly Point[];
  ink: Ink;
  widthPx: number;
}

export interface Name {
  text: string;
  at: Point;
  font: string;
  ink: Ink;
  align: CanvasTextAlign;
  baseline: CanvasTextBaseline;
  /** Whether a dark edge lifts it from the sky. */
  hasEdge?: boolean;
  /** It is moved so that it lies between these, pixels from the left. */
  within?: readonly [number, number];
}

/** What stands over the sky. */
export interface Drawing {
  lines: readonly Line[];
  names: readonly Name[];
  /** Whether it ends where the plot does. */
  isClipped: boolean;
}

export function font(sizePx: number, weight = 500): string {
  return `${weight} ${sizePx}px system-ui, sans-serif`;
}

export function clip(context: CanvasRenderingContext2D, plot: Plot): void {
  context.beginPath();
  context.rect(plot.leftPx, plot.topPx, plot.widthPx, plot.heightPx);
  context.clip();
}

/** The pieces of a line through directions: it is broken where it passes the end of a strip or goes behind the observer. */
export function pieces(projection: Projection, directions: readonly SkyDirection[]): Point[][] {
  const all: Point[][] = [];
  let beforeDeg: number | null = null;
  for (const direction of directions) {
    const { xPx, yPx } = projection.pointFromDirection(direction);
    if (Number.isNaN(xPx)) {
      beforeDeg = null;
      continue;
    }
    const isAround =
      projection.name === "equirectangular" && beforeDeg !== null && Math.abs(direction.azimuthDeg - beforeDeg) > 180;
    if (beforeDeg === null || isAround) all.push([]);
    all.at(-1)?.push([xPx, yPx]);
    beforeDeg = direction.azimuthDeg;
  }
  return all;
}

export function trace(context: CanvasRenderingContext2D, projection: Projection, directions: readonly SkyDirection[]): void {
  context.beginPath();
  for (const piece of pieces(projection, directions)) path(context, piece);
  context.stroke();
}

function path(context: CanvasRenderingContext2D, points: readonly Point[]): void {
  points.forEach((point, i) => {
    if (i === 0) context.moveTo(...point);
    else context.lineTo(...point);
  });
}

export function stroke(context: CanvasRenderingContext2D, points: readonly Point[]): void {
  context.beginPath();
  path(context, points);
  context.stroke();
}

export function css(ink: Ink): string {
  return `rgba(${ink})`;
}

/** Draws all of it on a canvas whose unit is a CSS pixel. */
export function drawAll(context: CanvasRenderingContext2D, { lines, names, isClipped }: Drawing, plot: Plot): void {
  context.save();
  if (isClipped) clip(context, plot);
  for (const { points, ink, widthPx } of lines) {
    context.strokeStyle = css(ink);
    context.lineWidth = widthPx;
    stroke(context, points);
  }
  for (const name of names) drawName(context, name);
  context.restore();
}

/** Where a name stands once it lies within its bounds. */
export function placed(context: CanvasRenderingContext2D, { text, at: [xPx, yPx], within, font }: Name): Point {
  context.font = font;
  if (within === undefined) return [xPx, yPx];
  const halfPx = context.measureText(text).width / 2;
  return [Math.min(Math.max(xPx, within[0] + halfPx), within[1] - halfPx), yPx];
}

export function drawName(context: CanvasRenderingContext2D, name: Name): void {
  const at = placed(context, name);
  context.textAlign = name.align;
  context.textBaseline = name.baseline;
  if (name.hasEdge === true) {
    context.lineJoin = "round";
    context.strokeStyle = "rgba(5, 8, 16, 0.85)";
    context.lineWidth = 3.5;
    context.strokeText(name.text, ...at);
  }
  context.fillStyle = css(name.ink);
  context.fillText(name.text, ...at);
}
